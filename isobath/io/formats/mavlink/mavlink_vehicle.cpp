#include <cmath>
#include <isobath/io/formats/mavlink/mavlink_vehicle.hpp>
#include <isobath/io/input/scanning_head.hpp>

namespace isobath {
namespace {

constexpr double kGravity = 9.80665;  // m/s2
constexpr Angle kPing1dBeam = Angle::degrees(25);

/// The direction of a MAV_SENSOR_ORIENTATION in the body; empty: one that is not a plain direction.
std::optional<Rotation> orientation_of(const MavlinkPayload& p, std::uint8_t orientation) {
  if (orientation < 8) return Rotation::from_heading(Angle::degrees(45.0 * orientation));
  if (orientation == 24 || orientation == 25) {
    return Rotation::from_heading_pitch_roll({}, Angle::degrees(orientation == 24 ? 90 : -90), {});
  }
  if (orientation != 100) return {};
  const Eigen::Quaterniond q(p.at<float>(22), p.at<float>(26), p.at<float>(30), p.at<float>(34));
  if (!(std::abs(q.norm() - 1) < 0.1)) return {};
  return Rotation::from_quaternion(q.normalized());
}

}  // namespace

MavlinkVehicle::MavlinkVehicle(const InputConfig& config, SourceReport& report)
    : config_(config), report_(report), parts_(config.survey, report) {
  if (config_.mavlink_system > 0) habits_.system = static_cast<std::uint8_t>(config_.mavlink_system);
}

bool MavlinkVehicle::uses(MavlinkId id) const {
  switch (id) {
    case MavlinkId::kScaledPressure:
    case MavlinkId::kScaledPressure2: return !states_depth_;
    case MavlinkId::kGlobalPositionInt: return !habits_.local;
    case MavlinkId::kLocalPositionNed: return !uses_global_;
    case MavlinkId::kOdometry: return !habits_.local && !uses_global_;
    default: return true;
  }
}

std::optional<Event> MavlinkVehicle::refused(const char* reason) {
  ++report_.rejected[reason];
  return {};
}

Pose MavlinkVehicle::mounted_along(const Rotation& R_BS) const {
  return {R_BS, Eigen::Vector3d(config_.mount_m[0], config_.mount_m[1], config_.mount_m[2])};
}

std::optional<Event> MavlinkVehicle::take(Time time, const MavlinkFrame& frame) {
  const auto id = static_cast<MavlinkId>(frame.id);
  const bool states =
      id == MavlinkId::kAttitude || id == MavlinkId::kLocalPositionNed || id == MavlinkId::kGlobalPositionInt;
  if (!habits_.system && states) habits_.system = frame.system;
  if (frame.system != habits_.system.value_or(frame.system)) return {};
  const MavlinkPayload p(frame.payload);
  switch (id) {
    case MavlinkId::kAttitude: {
      const auto roll = p.at<float>(4), pitch = p.at<float>(8), yaw = p.at<float>(12);
      if (!std::isfinite(roll) || !std::isfinite(pitch) || !std::isfinite(yaw))
        return refused("attitude that is not a number");
      return parts_.on_attitude(
          time, Rotation::from_heading_pitch_roll(Angle::radians(yaw), Angle::radians(pitch), Angle::radians(roll)));
    }
    case MavlinkId::kLocalPositionNed: return local_position(time, p);
    case MavlinkId::kGlobalPositionInt: return global_position(time, p);
    case MavlinkId::kGpsGlobalOrigin: {
      const GeoPoint origin{p.at<std::int32_t>(0) * 1e-7, p.at<std::int32_t>(4) * 1e-7};
      if (!uses_global_ && !report_.origin && valid(origin) && origin != GeoPoint{}) report_.origin = origin;
      return {};
    }
    case MavlinkId::kScaledPressure2: pressure(time, p); return {};
    case MavlinkId::kScaledPressure:
      if (!habits_.pressure2) pressure(time, p);
      return {};
    case MavlinkId::kDistanceSensor: habits_.distance = true; return distance(time, p);
    case MavlinkId::kOdometry: return frame.component == 1 ? odometry(time, p) : std::nullopt;
    case MavlinkId::kRangefinder: return habits_.distance ? std::nullopt : rangefinder(time, p);
  }
  return {};
}

std::optional<Event> MavlinkVehicle::local_position(Time time, const MavlinkPayload& p) {
  if (uses_global_) return {};  // two frames do not mix
  habits_.local = states_depth_ = true;
  const Eigen::Vector2d north_east(p.at<float>(4), p.at<float>(8));
  if (!report_.origin && global_ && north_east.norm() < 1e5) report_.origin = origin_from(*global_, north_east);
  parts_.on_depth(time, p.at<float>(12));
  return parts_.on_position(time, north_east, Eigen::Vector3d(p.at<float>(16), p.at<float>(20), p.at<float>(24)));
}

std::optional<Event> MavlinkVehicle::global_position(Time time, const MavlinkPayload& p) {
  constexpr double kDegree = 1e-7, kMillimetre = 1e-3, kCentimetre = 1e-2, kMaxLatitude = 80;
  const GeoPoint point{p.at<std::int32_t>(4) * kDegree, p.at<std::int32_t>(8) * kDegree};
  if (valid(point) && point != GeoPoint{} && std::abs(point.latitude_deg) < kMaxLatitude) global_ = point;
  if (habits_.local) return {};
  states_depth_ = uses_global_ = true;
  parts_.on_depth(time, -p.at<std::int32_t>(16) * kMillimetre);
  const Eigen::Vector3d v(p.at<std::int16_t>(20), p.at<std::int16_t>(22), p.at<std::int16_t>(24));
  return parts_.on_position(time, point, v * kCentimetre);
}

std::optional<Event> MavlinkVehicle::odometry(Time time, const MavlinkPayload& p) {
  constexpr std::uint8_t kLocalNed = 1, kBodyFrd = 12;
  if (habits_.local || uses_global_) return {};
  if (p.at<std::uint8_t>(228) != kLocalNed || p.at<std::uint8_t>(229) != kBodyFrd)
    return refused("odometry in other frames than local north-east-down and body");
  const Eigen::Quaterniond q(p.at<float>(20), p.at<float>(24), p.at<float>(28), p.at<float>(32));
  const Eigen::Vector3d at(p.at<float>(8), p.at<float>(12), p.at<float>(16));
  const Eigen::Vector3d v_B(p.at<float>(36), p.at<float>(40), p.at<float>(44));
  if (!(std::abs(q.norm() - 1) < 0.1) || !at.allFinite()) return refused("odometry that is not a number");
  const Rotation R_WB = Rotation::from_quaternion(q.normalized());
  states_depth_ = true;
  parts_.on_depth(time, at.z());
  std::optional<Eigen::Vector3d> v_W;
  if (v_B.allFinite()) v_W = R_WB * v_B;
  (void)parts_.on_attitude(time, R_WB);  // so that the position gives no fix of its own
  (void)parts_.on_position(time, Eigen::Vector2d(at.head<2>()), v_W);
  return parts_.on_attitude(time, R_WB);
}

void MavlinkVehicle::pressure(Time time, const MavlinkPayload& p) {
  constexpr double kHectopascal = 100;
  if (states_depth_ || habits_.local) return;
  parts_.on_depth(time,
                  (p.at<float>(4) * kHectopascal - config_.surface_pressure_pa) / (config_.water_density * kGravity));
}

std::optional<Event> MavlinkVehicle::distance(Time time, const MavlinkPayload& p) {
  constexpr double kCentimetre = 0.01;
  const auto most = p.at<std::uint16_t>(6), now = p.at<std::uint16_t>(8);
  const auto R_BS = orientation_of(p, p.at<std::uint8_t>(12));
  if (p.at<std::uint8_t>(38) == 1) return refused("distance that the sensor calls invalid");
  if (!R_BS || most == 0) return refused("distance without a direction or a limit");
  RangeReading reading;
  reading.time = time;
  reading.max_range_m = most * kCentimetre;
  if (now < most) reading.range_m = now * kCentimetre;
  const float stated = p.at<float>(14);
  const bool is_stated = std::isfinite(stated) && stated > 0 && stated < 3;
  reading.width = beam_size(config_, {is_stated ? Angle::radians(stated) : kPing1dBeam, {}}).width;
  reading.X_BS = mounted_along(*R_BS);
  const auto quality = p.at<std::uint8_t>(38);
  if (quality > 1 && quality <= 100) reading.confidence = quality / 100.0F;
  return reading;
}

std::optional<Event> MavlinkVehicle::rangefinder(Time time, const MavlinkPayload& p) {
  const float range = p.at<float>(0);
  if (!std::isfinite(range) || range <= 0) return refused("distance of 0: no bottom");
  RangeReading reading;
  reading.time = time;
  reading.range_m = range;
  reading.max_range_m = kAnyDepth;
  reading.width = beam_size(config_, {kPing1dBeam, {}}).width;
  reading.X_BS = mounted_along(looking_down(0).rotation);
  return reading;
}

}  // namespace isobath
