#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/perception/sounding_gate.hpp>

namespace isobath {

std::vector<Field> fields(SoundingGateConfig& c) {
  return {
      Field::real("slack_m", &c.slack_m, {0, 1000}, "m",
                  "Allowed difference of a depth from the last one, on a level bottom."),
      Field::real("slack_share", &c.slack_share, {0, 1}, "1",
                  "Allowed difference as a share of the depth; the larger one counts."),
      Field::real("max_slope", &c.max_slope, {0, 1000}, "m/m",
                  "Maximum slope of the bottom that needs no confirmation.")
          .was("steepest"),
      Field::integer(
          "accept_after", &c.accept_after, {1, 1000}, "1",
          "Number of consecutive implausible depths that are accepted together if they agree among themselves.")
          .was("believe_after"),
      Field::real("min_depth_m", &c.min_depth_m, {-1000, 0}, "m",
                  "Minimum possible depth; drying heights are negative.")
          .was("highest_m"),
      Field::real("max_depth_m", &c.max_depth_m, {0.1, 12000}, "m", "Maximum possible depth in these waters.")
          .was("deepest_m"),
      Field::integer("neighbours", &c.neighbours, {1, 100}, "1",
                     "Beams on either side with which a sounding of a swath is compared."),
  };
}

SoundingGate::SoundingGate(const SoundingGateConfig& config) : config_(config) {
  depths_.reserve(2 * static_cast<std::size_t>(config.neighbours) + 1);
}

bool SoundingGate::plausible(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
  const double slack = std::max(config_.slack_m, config_.slack_share * std::max(std::abs(from.z()), std::abs(to.z())));
  const double distance = (to - from).head<2>().norm();
  return std::abs(to.z() - from.z()) <= slack + config_.max_slope * distance;
}

SoundingGate::Verdict SoundingGate::judge(int sensor, const Eigen::Vector3d& p_W) {
  ISOBATH_ASSERT(sensor >= 0 && sensor < kSensors);
  if (!possible(p_W.z())) return Verdict::kImpossible;
  Sensor& s = sensors_[static_cast<std::size_t>(sensor)];
  if (s.known && plausible(s.last, p_W)) {
    s.last = p_W;
    s.in_row = 0;
    return Verdict::kBelieved;
  }
  // The first reading of a sensor has nothing to compare with, so it is held too.
  s.in_row = s.in_row > 0 && plausible(s.held, p_W) ? s.in_row + 1 : 1;
  s.held = p_W;
  if (s.in_row < config_.accept_after) return Verdict::kHeld;
  s.known = true;
  s.last = p_W;
  s.in_row = 0;
  return Verdict::kConfirmed;
}

void SoundingGate::judge_swath(std::span<const Eigen::Vector3d> points, std::span<std::uint8_t> believed) {
  const auto count = static_cast<std::ptrdiff_t>(points.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const std::ptrdiff_t first = std::max<std::ptrdiff_t>(0, i - config_.neighbours);
    const std::ptrdiff_t last = std::min(count - 1, i + config_.neighbours);
    depths_.clear();
    for (std::ptrdiff_t k = first; k <= last; ++k) {
      const double depth = points[static_cast<std::size_t>(k)].z();
      if (possible(depth)) depths_.push_back(depth);  // excludes NaN
    }
    believed[static_cast<std::size_t>(i)] = 0;
    if (!possible(points[static_cast<std::size_t>(i)].z())) continue;
    const auto middle = depths_.begin() + static_cast<std::ptrdiff_t>(depths_.size() / 2);
    std::nth_element(depths_.begin(), middle, depths_.end());
    const Eigen::Vector3d& p = points[static_cast<std::size_t>(i)];
    // The position of the median is unknown: it may be as far off as the outermost of its beams.
    const double reach = std::max((points[static_cast<std::size_t>(first)] - p).head<2>().norm(),
                                  (points[static_cast<std::size_t>(last)] - p).head<2>().norm());
    const bool supported = plausible({0, 0, *middle}, {reach, 0, p.z()});
    believed[static_cast<std::size_t>(i)] = supported ? 1 : 0;
  }
}

}  // namespace isobath
