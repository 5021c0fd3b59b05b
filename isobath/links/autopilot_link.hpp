// AutopilotLink: the MAVLink connection to an ArduSub autopilot: its state comes in as events, set-points go out.
//
// In: HEARTBEAT, SYS_STATUS, TIMESYNC, the messages of mavlink_vehicle.hpp, and the mission (mission_download.hpp).
// Only frames of the vehicle's system count; the vehicle is the one of AutopilotLinkConfig::system, else the first
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
// Velocity down: depth_gain times the error of the depth, within the vehicle's rates. All calls of ByteReceiver come
// from the thread of the links; the others may come from any thread. ArduSub itself was not run against this.
#pragma once

#include <isobath/geometry/geodesy.hpp>
#include <isobath/io/bytes/framing.hpp>
#include <isobath/io/formats/mavlink/mavlink_vehicle.hpp>
#include <isobath/links/device_link.hpp>
#include <isobath/links/link_hub.hpp>
#include <isobath/links/link_source.hpp>
#include <isobath/links/mission_download.hpp>
#include <isobath/vehicle/autopilot.hpp>
#include <isobath/vehicle/vehicle_parameters.hpp>
#include <mutex>
#include <optional>
#include <span>
#include <string>

namespace isobath {

struct AutopilotLinkConfig {
  std::string link = "udp-server:14550";
  int system = 0;                ///< of the vehicle; 0: the first that is heard
  double rate_hz = 10;           ///< of the attitude and position that are asked for
  double depth_gain = 0.5;       ///< 1/s
  double max_dive_rate = 0.4;    ///< m/s, up and down
  bool dvl_motion = false;       ///< whether the motion that a DVL measures is sent
  bool obstacle_points = false;  ///< as points in the body, not as a ring of distances
  std::string key_file;          ///< passphrase of signed frames, relative to the vehicle file; empty: no signatures
};
std::vector<Field> fields(AutopilotLinkConfig& config);

/// Who steers.
enum class Authority : std::uint8_t { kNoAutopilot, kDisarmed, kOtherMode, kOurs };

class AutopilotLink final : public ByteReceiver {
 public:
  static constexpr Duration kSilence = std::chrono::seconds(3);
  static constexpr Duration kMotionGap = std::chrono::seconds(1);
  static constexpr Duration kSetpointInterval = std::chrono::milliseconds(50);

  AutopilotLink(const AutopilotLinkConfig& config, LinkSource& events);
  AutopilotLink(const AutopilotLink&) = delete;
  AutopilotLink& operator=(const AutopilotLink&) = delete;
  void use(LinkHub& hub, ByteLink& link) {
    hub_ = &hub;
    link_ = &link;
  }

  /// Before the hub starts: a device gives the vehicle's navigation.
  void leave_navigation_to_device() { gives_navigation_ = false; }

  void on_open(Time time) override;
  void on_bytes(Bytes bytes, Time time) override;
  void on_tick(Time now) override;

  [[nodiscard]] Authority authority() const;
  /// "POSHOLD, armed"; for people.
  [[nodiscard]] std::string mode() const;
  [[nodiscard]] std::optional<GeoOrigin> origin() const;
  /// Starts to fetch the mission as soon as the autopilot is heard.
  void want_mission();
  /// Empty while it is being fetched. Throws Error if the autopilot does not give it.
  [[nodiscard]] std::optional<AutopilotPlan> mission() const;

  /// Sends a set-point that answers an event of this time; withholds it without authority, and where the event is more
  /// than 0.3 s old. Returns whether the thread of the links got it, which withholds it if it has become
  /// too old by then.
  bool command(const Setpoint& setpoint, const VehicleParameters& limits, Time answers);
  void say(int severity, const std::string& text);
  void show(const mavlink::ObstacleDistance& ring);
  /// Obstacles of one instant.
  void show(std::span<const mavlink::ObstacleDistance3d> points);
  /// How a DVL has moved since the last call (VISION_POSITION_DELTA), for the autopilot's own navigation; how it has
  /// turned is the autopilot's attitude. Nothing is sent after a gap of more than kMotionGap. In the thread of the
  /// links.
  void show_motion(const BodyMotion& motion);
  void show_value(const std::string& name, double value);
  struct Counts {
    std::uint64_t setpoints = 0, withheld = 0;  ///< sent; not sent
    std::uint64_t damaged = 0;                  ///< stretches of bytes that were no frame
  };
  [[nodiscard]] Counts counts() const;

 private:
  void send(std::uint32_t id, const mavlink::PayloadBytes& body);
  void on_frame(const MavlinkFrame& frame, Time time);
  void on_heartbeat(const MavlinkFrame& frame, Time time);
  void on_timesync(const mavlink::TimeSync& sync, Time time);
  void ask_for_messages();
  void report_health(Time now);
  [[nodiscard]] Authority authority_at(Time now) const;

  const AutopilotLinkConfig config_;
  LinkSource& events_;
  LinkHub* hub_ = nullptr;
  ByteLink* link_ = nullptr;
  bool gives_navigation_ = true;
  InputConfig input_;
  SourceReport report_;
  MavlinkVehicle vehicle_;
  FrameStream frames_;
  std::uint64_t offset_ = 0;
  mavlink::PayloadBytes pending_;
  MavlinkWriter writer_;
  std::optional<SignatureCheck> trust_;
  std::optional<MissionDownload> download_;

  mutable std::mutex mutex_;  ///< guards all below
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
  Time beat_{}, sync_{}, health_{}, asked_{}, setpoint_{};
  struct Moved {
    Time time;
    Rotation R_WB;
  };
  std::optional<Moved> moved_;  ///< when the DVL's motion was last sent
  Authority told_ = Authority::kNoAutopilot;
  Counts counts_;
};

}  // namespace isobath
