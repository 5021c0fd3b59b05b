// AutopilotStandIn: speaks MAVLink as an ArduSub autopilot does, and moves a simulated vehicle. It keeps the rules of
// ArduSub that matter beside it, as its public sources have them; ArduSub itself was not run.
//
// - A velocity target counts in GUIDED and armed only, in frame LOCAL_NED, with acceleration ignored; it ends 3 s after
//   the last one: the vehicle then stops and holds its depth.
// - SET_MESSAGE_INTERVAL sets the rate of ATTITUDE and LOCAL_POSITION_NED; before, they come once a second.
// - The mission protocol gives mission, fence and rally points; TIMESYNC is answered, and asked once a second.
//
// The pilot arms and chooses GUIDED `guided_after_s` after a companion is first heard, and has the vehicle in POSHOLD
// in each PilotTurn.
#pragma once

#include <isobath/geometry/geodesy.hpp>
#include <isobath/io/formats/mavlink/mavlink_messages.hpp>
#include <isobath/links/mission_download.hpp>
#include <isobath/standin/front_seat_stand_in.hpp>
#include <mutex>
#include <optional>

namespace isobath {

class AutopilotStandIn final : public FrontSeatStandIn {
 public:
  AutopilotStandIn(AutopilotPlan plan, const GeoOrigin& origin, double guided_after_s, std::vector<PilotTurn> turns,
                   const UnplugConfig& unplug);
  void sign_with(const MavlinkKey& key) {
    writer_.sign_with(key);
    trust_.emplace(key);
  }

  void on_bytes(Bytes bytes, Time time) override;
  void on_tick(Time now) override;

  void on_fix(const Navigation& fix, Time now) override;
  void on_battery(double share) override;
  [[nodiscard]] Setpoint setpoint(double dt_s) override;
  [[nodiscard]] bool deserted() const override;
  [[nodiscard]] AutopilotCounts counts() const override;

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
  MavlinkWriter writer_{1, 1};
  std::optional<SignatureCheck> trust_;
  SourceReport report_;
  FrameStream frames_{mavlink_frame_at};
  std::uint64_t offset_ = 0;

  mutable std::mutex mutex_;  ///< guards all below
  StandInPilot pilot_;
  std::optional<Time> booted_;
  mavlink::SubMode mode_ = mavlink::SubMode::kDepthHold;
  bool armed_ = false;
  std::optional<Navigation> fix_;
  double battery_ = 1;
  Duration interval_ = std::chrono::seconds(1);
  Time beat_{}, state_due_{};
  std::optional<mavlink::VelocityTarget> target_;
  Time target_time_{};
  std::optional<double> depth_;
  Angle heading_;
  bool heading_known_ = false;
  AutopilotCounts counts_;
};

}  // namespace isobath
