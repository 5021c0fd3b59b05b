// CommandArbiter: decides which set-point reaches the vehicle: the latest order of the Pilot, under the Safety
// Officer's action, or a fallback when either of them is silent (Ganesan 2015, 5.1; Herman 1988, 3.4; ledger S2-28,
// S2-E10).
//
//   surface   the Safety Officer is lost: depth 0 on the heading of that instant; or it orders this: on its heading
//   turn      the Safety Officer's set-point
//   stop      the Safety Officer orders it, or no order for `order_timeout_s`: speed 0, heading and depth then; where a
//             current carries it across its hull, the vehicle turns its bow to it, which its speed can stem
//   slow      the order, no faster than the action allows
//   orders    the order
//   waiting   no order yet, for `order_timeout_s` after the operator's command to start: speed 0 where the vehicle is
// The first state that applies is taken. A vehicle that needs forward speed to hold its depth cannot stop: it surfaces
// at its minimum speed, and is never slowed below that speed. An order that is not finite is ignored; an action that is
// not finite counts as a stop. Heading and depth are those of the vehicle's own navigation, or the last commanded ones
// where there is no navigation.
//
// In every state the set-point goes no deeper than the vehicle and the current mission allow, not above the surface,
// and no faster than the vehicle's maximum speed; set-points that had to be limited are counted. The Pilot
// (DepthKeeper) and the Safety Officer limit how near the bottom may be. The autopilot decides how fast a set-point is
// followed: a gradual turn here would delay a turn away from an obstacle.
//
// The output depends only on the messages received and on time. One thread at a time.
#pragma once

#include <isobath/mission/messages/messages.hpp>
#include <isobath/vehicle/vehicle_parameters.hpp>
#include <optional>
#include <string>

namespace isobath {

enum class HelmState : std::uint8_t { kWaiting, kOrders, kSlow, kStop, kTurn, kSurface };
const char* to_text(HelmState state);

struct CommandArbiterConfig {
  double order_timeout_s = 2;
  std::string safety_officer = "safety officer";  ///< name of the agent; empty: there is none
};
std::vector<Field> fields(CommandArbiterConfig& config);

class CommandArbiter {
 public:
  CommandArbiter(const CommandArbiterConfig& config, const VehicleParameters& vehicle)
      : config_(config), vehicle_(vehicle), deepest_(vehicle.limits.max_depth) {}

  /// `number`: that of the message's envelope.
  void on_message(const Message& message, Time now, std::uint64_t number = 0);
  Setpoint steer(Time now);

  [[nodiscard]] HelmState state() const { return state_; }
  /// Number of the helm order or safety action that the last set-point serves; 0: neither.
  [[nodiscard]] std::uint64_t served() const;
  /// The change of the last steer, if there was one.
  [[nodiscard]] std::optional<Decision> take_change();
  [[nodiscard]] std::uint64_t refused() const { return refused_; }  ///< orders and actions that were not finite
  [[nodiscard]] std::uint64_t limited() const { return limited_; }  ///< set-points that were limited

 private:
  struct Verdict {
    HelmState state = HelmState::kWaiting;
    std::string fault;  ///< a new fault is a new decision
    std::string why;
  };
  [[nodiscard]] Verdict judge(Time now) const;
  [[nodiscard]] Setpoint setpoint() const;
  [[nodiscard]] Setpoint allowed(Setpoint wanted) const;
  void on_action(SafetyAction action);
  void stem_current();

  CommandArbiterConfig config_;
  VehicleParameters vehicle_;
  std::optional<Time> first_;
  std::optional<Navigation> here_;  ///< the last one
  std::optional<Setpoint> kept_;    ///< heading and depth since the state was entered
  std::optional<HelmOrder> order_;
  Time ordered_;
  SafetyAction action_;
  std::uint64_t order_number_ = 0, action_number_ = 0;
  std::optional<std::string> safety_lost_;
  Setpoint last_;
  HelmState state_ = HelmState::kWaiting;
  std::string fault_;
  std::optional<Decision> change_;
  double deepest_;  ///< limit of the vehicle and of the current mission
  std::uint64_t refused_ = 0;
  std::uint64_t limited_ = 0;
};

}  // namespace isobath
