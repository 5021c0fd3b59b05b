// MavlinkVehicle: converts the messages of one vehicle to events, in a telemetry log and on a live link.
//
// Read are the vehicle's messages
//   ATTITUDE                               attitude, from which each Navigation comes (navigation_parts.hpp)
//   LOCAL_POSITION_NED                     position, velocity and depth; GPS_GLOBAL_ORIGIN ties it to the globe
//   GLOBAL_POSITION_INT                    the same, of a vehicle that does not begin with LOCAL_POSITION_NED
//   ODOMETRY                               attitude, position, velocity and depth, of an autopilot (component 1) that
//                                          states its position in no other message
//   SCALED_PRESSURE2, else SCALED_PRESSURE depth, of a vehicle whose positions state none
//   DISTANCE_SENSOR, else RANGEFINDER      a RangeReading along the orientation that the message states (RANGEFINDER:
//                                          down), at the origin of the body and moved by InputConfig::mount_m
// A distance at or above the stated maximum is no echo. The beam is hfov wide, else 25 degrees as of a Ping1D, unless
// InputConfig::beam_width sets it. Times are those at which a frame was received: late by the delay of the link.
// Messages that cannot be used are counted in the report, by reason. One thread at a time. Throws nothing.
#pragma once

#include <isobath/io/formats/mavlink/mavlink_frames.hpp>
#include <isobath/io/input/input_config.hpp>
#include <isobath/io/input/navigation_parts.hpp>

namespace isobath {

/// What a vehicle is known to send: a log is read ahead, a link learns it.
struct MavlinkHabits {
  std::optional<std::uint8_t> system;  ///< of the vehicle; empty: the first that states its attitude or position
  bool local = false;                  ///< LOCAL_POSITION_NED
  bool pressure2 = false, distance = false;
};

class MavlinkVehicle {
 public:
  /// The arguments must outlive this object.
  MavlinkVehicle(const InputConfig& config, SourceReport& report);

  void expect(const MavlinkHabits& habits) { habits_ = habits; }
  /// The event of a frame whose checksum is right. Frames of other systems give none.
  std::optional<Event> take(Time time, const MavlinkFrame& frame);

  [[nodiscard]] std::optional<std::uint8_t> system() const { return habits_.system; }
  /// Whether messages of this kind, which the vehicle has sent, were used.
  [[nodiscard]] bool uses(MavlinkId id) const;

 private:
  std::optional<Event> refused(const char* reason);
  std::optional<Event> local_position(Time time, const MavlinkPayload& p);
  std::optional<Event> global_position(Time time, const MavlinkPayload& p);
  std::optional<Event> odometry(Time time, const MavlinkPayload& p);
  std::optional<Event> distance(Time time, const MavlinkPayload& p);
  std::optional<Event> rangefinder(Time time, const MavlinkPayload& p);
  void pressure(Time time, const MavlinkPayload& p);
  [[nodiscard]] Pose mounted_along(const Rotation& R_BS) const;

  const InputConfig& config_;
  SourceReport& report_;
  NavigationParts parts_;
  MavlinkHabits habits_;
  bool states_depth_ = false, uses_global_ = false;
  std::optional<GeoPoint> global_;  ///< the newest GLOBAL_POSITION_INT
};

}  // namespace isobath
