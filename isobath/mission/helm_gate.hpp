// HelmGate: the last word on what the vehicle does: the latest order of the Pilot, under the Safety Officer's action,
// and what is done when either of them has fallen silent (Ganesan 2015, 5.1; Herman 1988, 3.4; ledger S2-28, S2-E10).
//
//   surface   the Safety Officer is lost: depth 0 on the heading of that instant; or says so: on the heading he says
//   turn      the Safety Officer's set-point
//   stop      the Safety Officer says so, or no order for `patience_s`: speed 0, heading and depth of that instant
//   slow      the order, no faster than the action allows
//   orders    the order
//   waiting   no order has come yet, for `patience_s` after the operator's order to start: speed 0 where it is
// The first that holds. A vehicle that needs way on to hold its depth cannot stop: it surfaces at its least speed; nor
// is it slowed below that speed. An order or an action that is not finite counts as none, and as a stop. Heading and
// depth are those that the vehicle had by its own navigation, or that it was last asked for where there is none.
//
// Whoever asks, nothing goes out that is deeper than the vehicle and the mission under way may be, above the surface,
// or faster than the vehicle goes; what is cut is counted. How near the bottom may be is the Pilot's (DepthKeeper) and
// the Safety Officer's; how fast a set-point is followed is the autopilot's: one that turned by and by would delay a
// turn away from an obstacle.
//
// A function of what it hears and of time. One thread at a time.
#pragma once

#include <isobath/mission/messages.hpp>
#include <isobath/vehicle/vehicle_sheet.hpp>
#include <optional>
#include <string>

namespace isobath {

enum class HelmState : std::uint8_t { kWaiting, kOrders, kSlow, kStop, kTurn, kSurface };
const char* to_text(HelmState state);

struct HelmGateConfig {
  double patience_s = 2;
  std::string safety_officer = "safety officer";  ///< name of its seat; empty: there is none
};
std::vector<Field> fields(HelmGateConfig& config);

class HelmGate {
 public:
  HelmGate(const HelmGateConfig& config, const VehicleSheet& vehicle)
      : config_(config), vehicle_(vehicle), deepest_(vehicle.limits.max_depth) {}

  void hear(const Message& message, Time now);
  Setpoint steer(Time now);

  [[nodiscard]] HelmState state() const { return state_; }
  /// The change of the last steer, if there was one.
  [[nodiscard]] std::optional<Decision> take_change();
  [[nodiscard]] std::uint64_t refused() const { return refused_; }  ///< orders and actions that were not finite
  [[nodiscard]] std::uint64_t limited() const { return limited_; }  ///< set-points that were cut to what is allowed

 private:
  struct Verdict {
    HelmState state = HelmState::kWaiting;
    std::string fault;  ///< a new one is a new decision
    std::string why;
  };
  [[nodiscard]] Verdict judge(Time now) const;
  [[nodiscard]] Setpoint setpoint() const;
  [[nodiscard]] Setpoint allowed(Setpoint wanted) const;
  void take_action(SafetyAction action);

  HelmGateConfig config_;
  VehicleSheet vehicle_;
  std::optional<Time> first_;
  std::optional<Setpoint> own_;   ///< heading and depth of the vehicle as it is
  std::optional<Setpoint> kept_;  ///< heading and depth since the state was entered
  std::optional<HelmOrder> order_;
  Time ordered_;
  SafetyAction action_;
  std::optional<std::string> safety_lost_;
  Setpoint last_;
  HelmState state_ = HelmState::kWaiting;
  std::string fault_;
  std::optional<Decision> change_;
  double deepest_;  ///< for the vehicle, and the mission under way
  std::uint64_t refused_ = 0;
  std::uint64_t limited_ = 0;
};

}  // namespace isobath
