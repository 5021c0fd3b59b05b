// AutopilotLink: the MAVLink connection to an ArduSub autopilot: its state comes in as events, set-points go out.
//
// In: HEARTBEAT, SYS_STATUS, TIMESYNC, the messages of mavlink_vehicle.hpp, and the mission (mission_download.hpp).
// Only frames of the vehicle's system count; the vehicle is the one of FrontSeatConfig::system, else the first
// ArduPilot that is heard. Frames whose checksum is wrong are counted. With a key, all frames of ours are signed, and
// those of others that are not, or are not by this key, are refused and counted. Each second a health report of
// "vehicle" gives the charge; none comes while the autopilot has been silent for 3 s, which the fault table notices.
//
// Out: HEARTBEAT and TIMESYNC, SET_MESSAGE_INTERVAL for what is needed, SET_POSITION_TARGET_LOCAL_NED (velocity and
// yaw) with each set-point, at most every 50 ms, OBSTACLE_DISTANCE or _3D, STATUSTEXT, NAMED_VALUE_FLOAT, and, with
// `dvl_motion`, VISION_POSITION_DELTA. A set-point carries
// the time of the event that it answers, in the autopilot's own time.
//
// Authority: set-points go out only while the autopilot is armed and in GUIDED. This class never arms
// it and never sets its mode: the pilot gives and takes authority, and STATUSTEXT tells each change.
//
// Velocity down: depth_gain times the error of the depth, within the vehicle's rates. ArduSub itself was not run
// against this.
#pragma once

#include <isobath/io/bytes/framing.hpp>
#include <isobath/io/formats/mavlink/mavlink_vehicle.hpp>
#include <isobath/links/front_seat.hpp>
#include <isobath/links/mission_download.hpp>
#include <optional>
#include <string>

namespace isobath {

class AutopilotLink final : public FrontSeat {
 public:
  static constexpr Duration kMotionGap = std::chrono::seconds(1);

  AutopilotLink(const FrontSeatConfig& config, LinkSource& events);

  void on_open(Time time) override;
  void on_bytes(Bytes bytes, Time time) override;
  void on_tick(Time now) override;

  [[nodiscard]] std::string mode() const override;
  [[nodiscard]] std::optional<GeoOrigin> origin() const override;
  void want_mission() override;
  [[nodiscard]] std::optional<std::string> mission() const override;

  bool command(const Setpoint& setpoint, const VehicleParameters& limits, Time answers) override;
  void say(int severity, const std::string& text) override;
  /// OBSTACLE_DISTANCE or OBSTACLE_DISTANCE_3D, and the distance of the nearest obstacle as "nearest".
  void show(const Surroundings& around, const Navigation& fix, Time now) override;
  /// VISION_POSITION_DELTA, for the autopilot's own navigation; how the DVL has turned is the autopilot's attitude.
  /// Nothing is sent after a gap of more than kMotionGap.
  void show_motion(const BodyMotion& motion) override;

 private:
  void send(std::uint32_t id, const mavlink::PayloadBytes& body);
  void on_frame(const MavlinkFrame& frame, Time time);
  void on_heartbeat(const MavlinkFrame& frame, Time time);
  void on_timesync(const mavlink::TimeSync& sync, Time time);
  void ask_for_messages();
  void report_health(Time now);
  [[nodiscard]] Authority authority_at(Time now) const override;
  void show(const mavlink::ObstacleDistance& ring);
  void show(const std::vector<mavlink::ObstacleDistance3d>& points);
  void show_value(const std::string& name, double value);

  InputConfig input_;
  SourceReport report_;
  MavlinkVehicle vehicle_;
  FrameStream frames_;
  std::uint64_t offset_ = 0;
  mavlink::PayloadBytes pending_;
  MavlinkWriter writer_;
  std::optional<SignatureCheck> trust_;
  std::optional<MissionDownload> download_;

  // mutex_ guards all below.
  bool wants_mission_ = false;
  std::optional<AutopilotPlan> plan_;
  std::string mission_problem_;
  std::uint8_t system_ = 1;    ///< of the vehicle
  std::optional<Time> heard_;  ///< its last heartbeat
  mavlink::Heartbeat heartbeat_;
  std::optional<GeoOrigin> origin_;
  std::optional<double> battery_;
  std::optional<Navigation> fix_;
  std::optional<Duration> boot_;  ///< what to add to host time for the autopilot's time since it booted
  Time beat_{}, sync_{}, health_{}, asked_{};
  struct Moved {
    Time time;
    Rotation R_WB;
  };
  std::optional<Moved> moved_;  ///< when the DVL's motion was last sent
  Authority told_ = Authority::kNoAutopilot;
};

}  // namespace isobath
