#include <algorithm>
#include <cmath>
#include <Eigen/LU>
#include <isobath/perception/reading_evidence.hpp>
#include <isobath/perception/sounding_comparison.hpp>

namespace isobath {
namespace {

constexpr int kMaxReach = 64;         // pixels around a sounding, to either side
constexpr double kSlopeReach = 5;     // m around a sounding, over which the map's slope is fitted
constexpr double kFewestAround = 40;  // pixels
constexpr double kNarrowest = 1;      // m, standard deviation of their positions across

}  // namespace

std::optional<MappedBottom> SoundingComparison::at(const Read& read, const Eigen::Vector2d& north_east, double radius_m,
                                                   std::uint32_t latest) {
  const int reach = std::min(kMaxReach, footprint_half_width(radius_m, grid_.pixel_m));
  const int side = 2 * reach + 1;
  const Pixel middle = grid_.at(north_east);
  patch_.resize(static_cast<std::size_t>(side) * side);
  read({middle.column - reach, middle.row - reach, side, side}, patch_);
  MappedBottom mean;
  double weight = 0;
  bool land = false, only_clear = false;
  for (const DepthPixel& pixel : patch_) {
    if (!pixel.known() || pixel.minute() > latest) continue;
    const bool measured = pixel.has(kSensed);
    const bool dry = !measured && pixel.depth_cm() <= 0, clear = measured && !pixel.has(kSeenByDepth);
    land = land || dry;
    only_clear = only_clear || clear;
    if (dry || clear) continue;
    const double w = 1 + pixel.confidence();
    weight += w;
    mean.depth_m += w * pixel.depth_m();
    mean.confidence += w * pixel.confidence();
    mean.minute += w * pixel.minute();
    mean.flags |= pixel.flags();
  }
  if (weight == 0) {
    why_ = only_clear ? NoBottom::kOnlyClear : land ? NoBottom::kLand : NoBottom::kUnknown;
    return std::nullopt;
  }
  mean.depth_m /= weight;
  mean.confidence /= weight;
  mean.minute /= weight;
  return mean;
}

std::optional<Eigen::Vector2d> SoundingComparison::gradient(const Read& read, const Eigen::Vector2d& north_east) {
  const int reach = std::max(1, static_cast<int>(std::lround(kSlopeReach / grid_.pixel_m)));
  const int side = 2 * reach + 1;
  const Pixel middle = grid_.at(north_east);
  patch_.resize(static_cast<std::size_t>(side) * side);
  read({middle.column - reach, middle.row - reach, side, side}, patch_);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (int i = 0; i < side * side; ++i) {
    const DepthPixel& pixel = patch_[static_cast<std::size_t>(i)];
    if (!pixel.known() || !pixel.has(kSeenByDepth)) continue;
    const int north = reach - i / side, east = i % side - reach;  // pixels
    const Eigen::Vector3d a{1, north * grid_.pixel_m, east * grid_.pixel_m};
    normal += a * a.transpose();
    right += pixel.depth_m() * a;
  }
  // Spread of the pixels along their narrower direction: a single track gives only the slope along it.
  if (normal(0, 0) < kFewestAround) return std::nullopt;
  const Eigen::Vector2d mean = normal.block<2, 1>(1, 0) / normal(0, 0);
  const Eigen::Matrix2d spread = normal.block<2, 2>(1, 1) / normal(0, 0) - mean * mean.transpose();
  const double half = 0.5 * spread.trace();
  const double narrow = half - std::sqrt(std::max(0.0, half * half - spread.determinant()));
  if (narrow < kNarrowest * kNarrowest) return std::nullopt;
  return Eigen::Vector2d(normal.inverse().eval().bottomRows<2>() * right);
}

}  // namespace isobath
