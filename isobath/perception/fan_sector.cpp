#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/perception/fan_sector.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

/// Beyond upright there is nothing more to ensonify.
double sine_of_half(const BeamFan& fan) { return std::sin(std::min(0.5 * pi, 0.5 * fan.height.radians())); }

/// What of W a fan can touch, in F.
struct Reach {
  Reach(const Pose& X_WF, const RangeWindow& window, double half_width, double sine_of_half_height, double voxel_m)
      : X_FW(X_WF.inverse()), near(window.start_m), far(window.end_m()), sine(sine_of_half_height), half(half_width) {
    constexpr double kStep = pi / 18;
    least = most = X_WF.translation;
    const int steps = static_cast<int>(std::ceil(2 * half / kStep));
    for (int i = 0; i <= steps; ++i) {
      const double azimuth = half * (2.0 * i / steps - 1);
      for (const double s : {-sine, 0.0, sine}) {
        const double flat = far * std::sqrt(1 - s * s);
        const Vector3d p = X_WF * Vector3d(flat * std::cos(azimuth), flat * std::sin(azimuth), far * s);
        least = least.cwiseMin(p);
        most = most.cwiseMax(p);
      }
    }
    const double margin = far * (1 - std::cos(kStep / 2)) + 2 * voxel_m;  // the arc bulges out between the steps
    least.array() -= margin;
    most.array() += margin;
  }
  /// Whether a ball about a point of W may reach into it.
  [[nodiscard]] bool meets(const Vector3d& p_W, double radius) const {
    const Vector3d p = X_FW * p_W;
    const double range = p.norm(), flat = p.head<2>().norm();
    if (range - radius > far || range + radius < near) return false;
    if (std::abs(p.z()) - radius > (range + radius) * sine) return false;
    return flat <= radius || std::abs(std::atan2(p.y(), p.x())) - half <= std::asin(radius / flat);
  }

  Pose X_FW;
  double near, far, sine, half;
  Vector3d least, most;
};

}  // namespace

const char* FanSector::fault_of(const Ping& ping, double voxel_m) {
  constexpr double kMaxVoxels = 1e9, kMaxAcross = 4000;
  const BeamFan& fan = *ping.fan;
  const double range = ping.window.end_m() / voxel_m;
  const double cells = (std::sqrt(3.0) * voxel_m / ping.window.bin_m + 2) * fan.beams();
  if (!(cells < 65536)) return "voxels far too large for the bins of a ping";
  const Angle span = fan.azimuth.back() - fan.azimuth.front() + fan.width.front() * 0.5 + fan.width.back() * 0.5;
  const double angle = std::min(2 * pi, span.radians()) * 2 * std::max(sine_of_half(fan), 1 / range);  // steradians
  if (!(range < kMaxAcross && angle * range * range * range / 3 < kMaxVoxels)) {
    return "voxels far too small for the range of a ping";
  }
  return nullptr;
}

/// Counts of beams by direction (FanView::beams_at), from the ends of the beams.
void FanSector::set_directions(const std::vector<double>& left, const std::vector<double>& right, double middle) {
  beams_at_.assign(FanView::kDirections, 0);
  const auto index_of = [&](double azimuth) {
    const double a = std::clamp(azimuth - middle, -pi, pi);
    return direction_index(static_cast<float>(std::cos(a)), static_cast<float>(std::sin(a)));
  };
  std::vector<std::int32_t> ended(FanView::kDirections + 1, 0), begun(FanView::kDirections + 1, 0);
  for (std::size_t b = 0; b < left.size(); ++b) {
    ++begun[static_cast<std::size_t>(index_of(left[b]))];
    ++ended[static_cast<std::size_t>(index_of(right[b])) + 1];
  }
  std::int32_t left_of = 0, begin = 0;
  for (std::size_t e = 0; e < FanView::kDirections; ++e) {
    left_of += ended[e];
    begin += begun[e];
    beams_at_[e] = left_of | begin << 16;
  }
}

void FanSector::update(const Ping& ping, FanView& view) {
  const BeamFan& fan = *ping.fan;
  const auto beams = static_cast<std::size_t>(fan.beams());
  if (const char* fault = fault_of(ping, voxel_m_)) {
    throw Error(fmt::format("voxels of {:g} m, bins of {:g} m to {:g} m in {} beams: {}", voxel_m_, ping.window.bin_m,
                            ping.window.end_m(), beams, fault),
                {}, "", "set voxel_m");
  }
  fan_ = ping.fan;
  window_ = ping.window;

  // A beam ends half way to the next, or where its width does.
  const auto radians = [](Angle a) { return a.radians(); };
  std::vector<double> left(beams), right(beams);
  double spacing = 0;
  for (std::size_t b = 0; b < beams; ++b) {
    const double azimuth = radians(fan.azimuth[b]), half = 0.5 * radians(fan.width[b]);
    left[b] = b > 0 ? std::max(azimuth - half, 0.5 * (radians(fan.azimuth[b - 1]) + azimuth)) : azimuth - half;
    right[b] = b + 1 < beams ? std::min(azimuth + half, 0.5 * (azimuth + radians(fan.azimuth[b + 1]))) : azimuth + half;
    if (b > 0) spacing += (azimuth - radians(fan.azimuth[b - 1])) / radians(fan.width[b]);
  }
  const double middle = 0.5 * (left.front() + right.back());
  X_SF_ = {Rotation::from_heading(Angle::radians(middle)), Vector3d::Zero()};
  half_width_ = std::min(pi, 0.5 * (right.back() - left.front()));
  sine_ = sine_of_half(fan);
  set_directions(left, right, middle);

  view.voxel_m = static_cast<float>(voxel_m_);
  view.sine = static_cast<float>(sine_);
  view.start_m = static_cast<float>(window_.start_m);
  view.bins_per_m = static_cast<float>(1 / window_.bin_m);
  view.beams = fan.beams();
  view.bins = window_.bins;
  view.looks_per_beam = static_cast<float>(beams > 1 ? std::min(1.0, spacing / static_cast<double>(beams - 1)) : 1.0);
  view.beams_at = beams_at_.data();
}

void FanSector::aim(const Pose& X_WF, double surface_m, FanView& view) const {
  const Rotation R_FW = X_WF.rotation.inverse();
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d along = voxel_m_ * (R_FW * Vector3d::Unit(axis));
    for (int c = 0; c < 3; ++c) view.step[axis][c] = static_cast<float>(along[c]);
  }
  view.ceiling_m = static_cast<float>(std::max(surface_m - X_WF.translation.z(), -1e9));
  view.slab_m = static_cast<float>(0.5 * voxel_m_ * (X_WF.rotation * Vector3d::UnitZ()).lpNorm<1>());
}

std::vector<EnsonifiedBlock> FanSector::blocks(const Pose& X_WF) const {
  const double block_m = VoxelBlocks::kSide * voxel_m_, radius = 0.5 * std::sqrt(3.0) * (block_m + 2 * voxel_m_);
  const Reach reach(X_WF, window_, half_width_, sine_, voxel_m_);
  std::vector<EnsonifiedBlock> blocks;
  const VoxelIndex least = floor_of(reach.least / block_m), most = floor_of(reach.most / block_m);
  for (int i = least.x(); i <= most.x(); ++i) {
    for (int j = least.y(); j <= most.y(); ++j) {
      for (int k = least.z(); k <= most.z(); ++k) {
        const VoxelIndex corner = VoxelBlocks::kSide * VoxelIndex(i, j, k);
        const Vector3d middle = (Vector3d(i, j, k).array() + 0.5) * block_m;
        if (!reach.meets(middle, radius) || !VoxelBlocks::holds(corner)) continue;
        const Vector3d first = (corner.cast<double>().array() + 0.5).matrix() * voxel_m_ - X_WF.translation;
        blocks.push_back({corner,
                          {static_cast<float>(first.x()), static_cast<float>(first.y()), static_cast<float>(first.z())},
                          nullptr});
      }
    }
  }
  return blocks;
}

}  // namespace isobath
