#include <algorithm>
#include <cmath>
#include <isobath/stereo/motion_stereo.hpp>
#include <isobath/stereo/patch.hpp>
#include <limits>
#include <tuple>
#include <utility>

namespace isobath {
namespace {

using Eigen::Matrix3d, Eigen::Vector2d, Eigen::Vector3d;

constexpr double kStep_px = 0.5;
constexpr float kNoDepth = std::numeric_limits<float>::quiet_NaN();

/// One pixel's search along its epipolar line.
class EpipolarSearch {
 public:
  EpipolarSearch(const CameraImage& second, const CameraModel& camera, const Matrix3d& R_BA, const Vector3d& p_AB,
                 const MotionStereoConfig& config)
      : second_(second), camera_(camera), R_BA_(R_BA), p_AB_(p_AB), config_(config) {}

  /// Depth and its standard deviation; NaN: none.
  std::pair<float, float> depth(const Patch& patch, const Vector2d& normalised) {
    ray_ = {normalised.x(), normalised.y(), 1};
    sample(patch);
    if (places_.size() < 3) return {kNoDepth, kNoDepth};
    const auto best = static_cast<std::size_t>(
        std::max_element(places_.begin(), places_.end(),
                         [](const Sample& a, const Sample& b) { return a.correlation < b.correlation; }) -
        places_.begin());
    if (best == 0 || best + 1 == places_.size() || places_[best].correlation < config_.min_correlation)
      return {kNoDepth, kNoDepth};
    for (const Sample& other : places_) {
      const bool apart = (other.pixel - places_[best].pixel).norm() > 3;
      if (apart && other.correlation > places_[best].correlation - config_.uniqueness) return {kNoDepth, kNoDepth};
    }
    const Sample &before = places_[best - 1], &here = places_[best], &after = places_[best + 1];
    const double bend = before.correlation - 2 * here.correlation + after.correlation;
    const double offset = bend < 0 ? 0.5 * (before.correlation - after.correlation) / bend : 0;
    const double inverse = here.inverse_depth + offset * 0.5 * (after.inverse_depth - before.inverse_depth);
    const double z = 1 / inverse, pixels = (after.pixel - before.pixel).norm();
    const double per_inverse = pixels / (after.inverse_depth - before.inverse_depth);
    const double sigma = config_.sigma_px / per_inverse * z * z;
    if (!(z > 0) || sigma > config_.max_sigma_share * z) return {kNoDepth, kNoDepth};
    return {static_cast<float>(z), static_cast<float>(sigma)};
  }

 private:
  struct Sample {
    double inverse_depth, correlation;
    Vector2d pixel;
  };
  [[nodiscard]] std::optional<Vector2d> seen_at(double inverse_depth) const {
    const Vector3d p = R_BA_ * (ray_ - p_AB_ * inverse_depth);  // times the depth
    if (!(p.z() > 1e-3)) return {};
    return camera_.pixel(p.head<2>() / p.z());
  }
  void sample(const Patch& patch) {
    places_.clear();
    const double last = 1 / config_.min_depth_m;
    double inverse = 1 / config_.max_depth_m;
    while (inverse <= last) {
      const auto at = seen_at(inverse);
      const auto ahead = seen_at(inverse * 1.001);
      if (!at || !ahead) return;
      Patch other;
      if (patch_at(second_, *at, other)) {
        places_.push_back({inverse, correlation(patch, other), *at});
      } else if (!places_.empty()) {
        return;  // the line has left the picture
      }
      const double pixels_per_inverse = (*ahead - *at).norm() / (0.001 * inverse);
      inverse += std::clamp(kStep_px / std::max(1e-9, pixels_per_inverse), 1e-4 * inverse, 0.05 * inverse + 0.01);
    }
  }

  const CameraImage& second_;
  const CameraModel& camera_;
  Matrix3d R_BA_;
  Vector3d p_AB_;
  const MotionStereoConfig& config_;
  Vector3d ray_;
  std::vector<Sample> places_;
};

}  // namespace

MotionDepth motion_depth(const CameraImage& first, const CameraImage& second, const CameraModel& camera,
                         const Matrix3d& R_AB, const Vector3d& p_AB, const MotionStereoConfig& config) {
  const CameraImage a = grey_of(first), b = grey_of(second);
  MotionDepth out;
  out.every = config.every;
  out.width = a.width / config.every;
  out.height = a.height / config.every;
  const auto pixels = static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height);
  out.depth_m.assign(pixels, kNoDepth);
  out.sigma_m.assign(pixels, kNoDepth);
  if (std::abs(p_AB.z()) > 1e-3 * p_AB.norm()) out.focus = camera.pixel(p_AB.head<2>() / p_AB.z());
  EpipolarSearch search(b, camera, R_AB.transpose(), p_AB, config);
  for (int row = 0; row < out.height; ++row) {
    for (int column = 0; column < out.width; ++column) {
      const Vector2d at(column * config.every, row * config.every);
      Patch patch;
      if (!patch_at(a, at, patch) || patch.norm < config.min_contrast * std::sqrt(double{Patch::kPixels})) continue;
      const std::size_t i =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(out.width) + static_cast<std::size_t>(column);
      std::tie(out.depth_m[i], out.sigma_m[i]) = search.depth(patch, camera.normalised(at));
    }
  }
  return out;
}

std::vector<Field> fields(MotionStereoConfig& c) {
  return {Field::real("min_depth_m", &c.min_depth_m, {0.05, 100}, "m", "Nearest depth that is tried."),
          Field::real("max_depth_m", &c.max_depth_m, {0.1, 1000}, "m", "Farthest depth that is tried."),
          Field::real("min_correlation", &c.min_correlation, {0, 1}, "1", "Least correlation of a match."),
          Field::real("uniqueness", &c.uniqueness, {0, 1}, "1",
                      "By how much the second-best place must correlate less than the best."),
          Field::real("min_contrast", &c.min_contrast, {0, 100}, "grey levels",
                      "Least standard deviation of the brightness of a patch."),
          Field::real("sigma_px", &c.sigma_px, {0.01, 10}, "pixels", "Standard deviation of a place on the line."),
          Field::real("max_sigma_share", &c.max_sigma_share, {0.001, 10}, "1",
                      "Largest standard deviation of a depth, as a share of it."),
          Field::integer("every", &c.every, {1, 64}, "pixels", "Distance of the pixels that get a depth.")};
}

}  // namespace isobath
