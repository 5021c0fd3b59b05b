// AutopilotStandIn: speaks MAVLink as an ArduSub autopilot does, and moves a simulated vehicle. It keeps the rules of
// ArduSub that matter beside it, as its public sources have them; ArduSub itself was not run.
//
// - A velocity target counts in GUIDED and armed only, in frame LOCAL_NED, with acceleration ignored; it ends 3 s after
//   the last one: the vehicle then stops and holds its depth.
// - SET_MESSAGE_INTERVAL sets the rate of ATTITUDE and LOCAL_POSITION_NED; before, they come once a second.
// - The mission protocol gives mission, fence and rally points; TIMESYNC is answered, and asked once a second.
//
// The pilot arms and chooses GUIDED `guided_after_s` after a companion is first heard, and may take over for a while
// (PilotTurn). All calls of ByteReceiver come from the thread of the links; `on_fix` and `setpoint` from the
// simulator's.
#pragma once

#include <deque>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/io/formats/mavlink/mavlink_messages.hpp>
#include <isobath/links/mission_download.hpp>
#include <isobath/standin/stand_in_link.hpp>
#include <isobath/vehicle/autopilot.hpp>
#include <isobath/vehicle/navigation.hpp>
#include <mutex>
#include <optional>

namespace isobath {

/// The pilot has the vehicle in POSHOLD in this time, s after GUIDED was first chosen.
struct PilotTurn {
  double from_s = 0, to_s = 0;
};

struct AutopilotCounts {
  std::uint64_t setpoints = 0;  ///< that it followed
  std::uint64_t refused = 0;    ///< that came without authority, or of another form
  double oldest_s = 0;          ///< of those it followed: age of the event that it answers, on arrival
  double longest_gap_s = 0;     ///< between two of them, while it was in GUIDED and armed, after the first
  std::uint64_t rings = 0, points = 0, texts = 0;  ///< OBSTACLE_DISTANCE, OBSTACLE_DISTANCE_3D, STATUSTEXT
  double moved_m = 0;                              ///< length of the motions that a DVL was said to have measured
  std::string last_text;
  int pulled = 0;               ///< how often its cable was pulled
  std::uint64_t untrusted = 0;  ///< frames without the right signature
};

class AutopilotStandIn final : public ByteReceiver {
 public:
  AutopilotStandIn(AutopilotPlan plan, const GeoOrigin& origin, double guided_after_s, std::vector<PilotTurn> turns,
                   const UnplugConfig& unplug);
  void sign_with(const MavlinkKey& key) {
    writer_.sign_with(key);
    trust_.emplace(key);
  }
  void use(LinkHub& hub, ByteLink& link) {
    hub_ = &hub;
    link_.use(link);
  }

  void on_bytes(Bytes bytes, Time time) override;
  void on_tick(Time now) override;

  /// The vehicle's own estimate; the links send it.
  void on_fix(const Navigation& fix);
  void on_battery(double share);
  /// What the vehicle is to do now, dt after the last call.
  [[nodiscard]] Setpoint setpoint(double dt_s);
  /// Whether a companion was heard and has been silent for 5 s.
  [[nodiscard]] bool deserted() const;
  [[nodiscard]] int port() const { return link_.port(); }
  [[nodiscard]] AutopilotCounts counts() const;

 private:
  void send(std::uint32_t id, const mavlink::PayloadBytes& body, Time now);
  void on_frame(const MavlinkFrame& frame, Time now);
  void on_target(const mavlink::VelocityTarget& target, Time now);
  void on_mission_frame(const MavlinkFrame& frame, const MavlinkPayload& p, Time now);
  void beat(Time now);
  void choose_mode(Time now);
  [[nodiscard]] std::uint32_t boot_ms(Time now) const;
  [[nodiscard]] const std::vector<mavlink::MissionItem>& items(mavlink::MissionKind kind) const;
  [[nodiscard]] bool steers() const { return armed_ && mode_ == mavlink::SubMode::kGuided; }

  const AutopilotPlan plan_;
  const GeoOrigin origin_;
  const double guided_after_s_;
  const std::vector<PilotTurn> turns_;
  LinkHub* hub_ = nullptr;
  StandInLink link_;
  MavlinkWriter writer_{1, 1};
  std::optional<SignatureCheck> trust_;
  SourceReport report_;
  FrameStream frames_{mavlink_frame_at};
  std::uint64_t offset_ = 0;

  mutable std::mutex mutex_;  ///< guards all below
  std::optional<Time> booted_, companion_first_, companion_last_, guided_since_;
  mavlink::SubMode mode_ = mavlink::SubMode::kDepthHold;
  bool armed_ = false;
  std::optional<Navigation> fix_;
  double battery_ = 1;
  Duration interval_ = std::chrono::seconds(1);
  Time beat_{}, state_{};
  std::optional<mavlink::VelocityTarget> target_;
  Time target_time_{};
  std::optional<double> depth_;
  Angle heading_;
  bool heading_known_ = false;
  AutopilotCounts counts_;
};

}  // namespace isobath
