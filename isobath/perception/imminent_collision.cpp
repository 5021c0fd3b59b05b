#include <algorithm>
#include <bit>
#include <cmath>
#include <isobath/perception/imminent_collision.hpp>

namespace isobath {
namespace {

constexpr double kStanding = 0.05;  // m/s: below it the direction of travel is noise

bool usable(const RangeReading& r, double min_confidence) {
  if (!(r.confidence >= min_confidence) || !r.X_BS.is_finite()) return false;
  return !r.range_m || (std::isfinite(*r.range_m) && *r.range_m >= 0);
}

}  // namespace

std::vector<Field> fields(ImminentCollisionConfig& c) {
  return {
      Field::real("reaction_s", &c.reaction_s, {0, 60}, "s",
                  "Time from an echo that is too near until the vehicle brakes."),
      Field::real("braking", &c.braking, {0.001, 20}, "m/s2", "Deceleration that the vehicle reliably achieves."),
      Field::real("margin_m", &c.margin_m, {0, 100}, "m", "Distance to be left between vehicle and obstacle."),
      Field::integer("hits", &c.hits, {1, 32}, "1",
                     "Dangerous readings of one sensor, among its last `looks`, that raise the alarm."),
      Field::integer("looks", &c.looks, {1, 32}, "1", "Number of last readings of a sensor that are considered."),
      Field::degrees("cone_slack_deg", &c.cone_slack, {0, 90},
                     "A direction of travel this far outside a sensor's cone still counts as ahead of it."),
      Field::real("unknown_speed", &c.unknown_speed, {0, 20}, "m/s", "Assumed speed while the velocity is not known."),
      Field::real("min_confidence", &c.min_confidence, {0, 1}, "1",
                  "Minimum confidence of a reading, as stated by the device."),
  };
}

ImminentCollision::ImminentCollision(const ImminentCollisionConfig& config, std::size_t sensors)
    : config_(config), looks_(sensors, 0) {
  if (config.hits < 1 || config.looks > 32 || config.hits > config.looks) {
    throw Error("more hits than looks", {{}, {}, {}, {}, "hits"}, "1 .. looks, which is at most 32");
  }
}

double ImminentCollision::danger_range(double closing_speed) const {
  const double v = std::max(0.0, closing_speed);
  return config_.margin_m + v * config_.reaction_s + v * v / (2 * config_.braking);
}

bool ImminentCollision::dangerous(const RangeReading& reading, const std::optional<Eigen::Vector3d>& v_B) const {
  if (!reading.range_m) return false;
  const bool known = v_B && v_B->allFinite();
  const double speed = known ? v_B->norm() : config_.unknown_speed;
  const Eigen::Vector3d travel_B =
      known && speed > kStanding ? Eigen::Vector3d(*v_B / speed) : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d axis_B = reading.X_BS.rotation * Eigen::Vector3d::UnitX();
  const double off = std::atan2(axis_B.cross(travel_B).norm(), axis_B.dot(travel_B));
  if (off > (reading.width / 2 + config_.cone_slack).radians()) return false;
  return *reading.range_m < danger_range(speed);
}

bool ImminentCollision::update(std::size_t sensor, const RangeReading& reading,
                               const std::optional<Eigen::Vector3d>& v_B) {
  ISOBATH_ASSERT(sensor < looks_.size());
  if (!usable(reading, config_.min_confidence)) {
    ++unusable_;
    return raised_;
  }
  const std::uint32_t window = config_.looks == 32 ? ~0U : (1U << config_.looks) - 1;
  looks_[sensor] = (looks_[sensor] << 1 | static_cast<std::uint32_t>(dangerous(reading, v_B))) & window;
  raised_ = std::any_of(looks_.begin(), looks_.end(),
                        [&](std::uint32_t looks) { return std::popcount(looks) >= config_.hits; });
  return raised_;
}

}  // namespace isobath
