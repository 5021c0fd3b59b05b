// MoosStandIn: speaks as the database of a MOOS community (MOOSDB) does with one client, and moves a simulated vehicle
// as a front seat behind it would. Written from public descriptions; no MOOSDB was run beside it.
//
// - It answers the handshake, and each packet with one packet: its time, then what the client has registered for. A
//   variable that is registered is told at once with its value.
// - NAV_X, NAV_Y, NAV_HEADING, NAV_DEPTH and NAV_SPEED change with each fix, at most 20 times a second.
// MOOS_MANUAL_OVERRIDE is true until the
//   pilot gives the vehicle to the client, and while the pilot takes it over.
// - A set-point is DESIRED_HEADING, DESIRED_SPEED and DESIRED_DEPTH in one packet. It counts while the override is
// false,
//   and ends 3 s after the last one: the vehicle then stops and holds its depth. DESIRED_SPEED 0 alone stops it at
//   once.
#pragma once

#include <deque>
#include <isobath/io/formats/moos/moos_messages.hpp>
#include <isobath/standin/front_seat_stand_in.hpp>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace isobath {

class MoosStandIn final : public FrontSeatStandIn {
 public:
  static constexpr Duration kNavigationInterval = std::chrono::milliseconds(50);
  static constexpr Duration kTargetEnds = std::chrono::seconds(3);
  static constexpr std::size_t kMaxMail = 2000;

  MoosStandIn(double given_after_s, std::vector<PilotTurn> turns, const UnplugConfig& unplug)
      : FrontSeatStandIn(unplug), pilot_(given_after_s, std::move(turns)) {}

  void on_open(Time time) override;
  void on_bytes(Bytes bytes, Time time) override;
  void on_tick(Time now) override;

  void on_fix(const Navigation& fix, Time now) override;
  [[nodiscard]] Setpoint setpoint(double dt_s) override;
  [[nodiscard]] bool deserted() const override;
  [[nodiscard]] AutopilotCounts counts() const override;

 private:
  enum class Stage : std::uint8_t { kNew, kGreeted, kTalking };
  void on_packet(const std::vector<MoosMessage>& messages, Time now);
  void on_message(const MoosMessage& message);
  void on_desired(const std::vector<MoosMessage>& messages, Time now);
  void answer(std::vector<MoosMessage> messages, Time now);
  /// A variable has a value, which the client is told if it has registered.
  void publish(MoosMessage message);
  void post(const MoosMessage& message);

  Stage stage_ = Stage::kNew;
  SourceReport report_;
  FrameStream frames_{moos_frame_at};

  mutable std::mutex mutex_;  ///< guards all below
  StandInPilot pilot_;
  bool override_ = true;
  std::map<std::string, MoosMessage> variables_;
  std::set<std::string> registered_;
  std::deque<MoosMessage> mail_;  ///< that the client has not been told yet
  std::optional<Navigation> fix_;
  Time told_{};  ///< when NAV_... changed last
  struct Target {
    Angle heading;
    double speed = 0, depth = 0;
    Time time;
  };
  std::optional<Target> target_;
  std::optional<Time> last_target_;  ///< since the pilot gave the vehicle
  std::optional<Angle> heading_;
  std::optional<double> depth_;
  AutopilotCounts counts_;
};

}  // namespace isobath
