// GoalSelector: the motion past bodies that move, to the way-point ahead (the Goal Selector and Adapter of Rodin, Amin
// c. 1988, 2.2, 2.3; ledger S3-18 to S3-22, S3-30, S3-37).
//
// Receives Sweep (bodies that move or may move, with velocity and covariance), StillHazards, FollowOrder,
// WaypointPassed, Navigation and SafetyAction. Sends MotionOrder at each tick while a body that moves is within reach,
// and Decision.
//
// The Navigator's route leads past what lies still. The goal is the last of its way-points that can be reached in a
// straight line past the still hazards, else the way-point ahead. A TrafficPlanner plans place and speed over time:
// past moving bodies as they are predicted, with their uncertainty, and past the still hazards. A body is within reach
// if it could meet the vehicle within the planner's horizon. Out of their reach, and where the route leads over or
// under a hazard, the Pilot follows the legs of the route, and the Navigator avoids moving bodies by the water that
// they cross in the next seconds.
//
// A vehicle that holds its position is steered past moving bodies, too, and one that cannot stop also past still ones:
// its goal is then to be near the place where it began to hold, and each plan must end in kHold_s at rest, or on a
// circle to either side, clear of all bodies. The Pilot circles to starboard, whatever lies there.
//
// The vehicle need not follow the plan exactly. While it is within `track_m` of the place and speed of the plan, the
// plan is checked and continued from its own state; farther off, it is made anew from the vehicle's. The margin to all
// bodies must therefore be more than `track_m`. The Safety Officer has the last word: while it stops or turns the
// vehicle there is no order.
//
// New readings will come before a body is met: its outline grows by at most `max_growth_m` within the horizon, however
// little its velocity is known now. Without that bound the water ahead of a few new bodies would be closed.
//
// The situation selects parameters (S3-03). Clear: no body within reach, no order. Crossing: as configured. Pursued: a
// body comes from astern and would pass within kNear_m; there is time, so the plan keeps a larger margin, and it may
// use more than the speed of the order. Blocked: the planner finds no free motion, or no path (S3-37); it looks for one
// more often. A less urgent situation than the present one begins when that has not been so for kSituation_s.
//
// A decision tells which body the plan passes, when, and how near (S3-21), once for each body in kTellAgain_s; and each
// change of the situation, with the reason.
//
// As an option (`goal_selector.rules`) plans follow the steering rules of the sea
// (planning/traffic/rules_of_the_road.hpp). All bodies that the sensors see get their roles, and a decision "rule of
// the road" tells each role, the rule, and when the vehicle that stands on acts. A body from astern makes the situation
// pursued only then: before, the vehicle keeps course and speed (rule 17).
//
// Frame W, m, s. A function of its messages. Cost: one step of the planner at each tick, see traffic_planner.hpp.
#pragma once

#include <isobath/mission/messages/agent.hpp>
#include <isobath/planning/traffic/traffic_planner.hpp>
#include <isobath/vehicle/vehicle_parameters.hpp>
#include <map>
#include <optional>

namespace isobath {

struct GoalSelectorConfig {
  bool on = true;
  double track_m = 0.6;
  double turn_reserve = 1.2;
  double max_growth_m = 1;
  double pursued_speed = 1.3;  ///< of the speed of the order, as far as the vehicle can
  double pursued_margin_m = 4;
  double blocked_replan_s = 0.2;
  TrafficConfig planner = {.margin_m = 1.2, .sigmas = 1, .roads = false, .search = {}};
};

std::vector<Field> fields(GoalSelectorConfig& config);

/// In order of urgency.
enum class TrafficSituation : std::uint8_t { kClear, kCrossing, kPursued, kBlocked };
const char* to_text(TrafficSituation situation);

class GoalSelector final : public Agent {
 public:
  static constexpr double kTellAgain_s = 20, kSituation_s = 5, kNear_m = 5, kHold_s = 20;

  GoalSelector(const GoalSelectorConfig& config, const VehicleParameters& vehicle);

  void on_message(const Message& message, Time now, Outbox& out) override;
  void tick(Time now, Outbox& out) override;

 private:
  void take_bodies(const Sweep& sweep);
  [[nodiscard]] MovingBody bounded(MovingBody body) const;
  [[nodiscard]] bool may_steer(Time now) const;
  [[nodiscard]] double ordered_speed() const;
  [[nodiscard]] bool in_reach(const MovingBody& body, Time now) const;
  [[nodiscard]] MotionState own_state(Time now) const;
  [[nodiscard]] std::size_t waypoint_in_sight() const;
  void begin_hold();
  [[nodiscard]] double turning_radius_m() const;
  void make_planner(double speed);
  void aim();
  struct Assessment {
    TrafficSituation situation = TrafficSituation::kClear;
    std::string why;
    const MovingBody* body = nullptr;
  };
  [[nodiscard]] Assessment assess(Time now) const;
  [[nodiscard]] const MovingBody* pursuer(Time now) const;
  void enter(const Assessment& assessment, Time now, Outbox& out);
  void tell(Time now, Outbox& out);
  void tell_rules(Time now, Outbox& out);

  GoalSelectorConfig config_;
  VehicleParameters vehicle_;
  std::optional<TrafficPlanner> planner_;                    ///< for the speed of the present order
  double speed_ = 0;                                         ///< of that planner, m/s
  TrafficSituation planned_for_ = TrafficSituation::kClear;  ///< of that planner
  bool planned_hold_ = false;                                ///< of that planner
  std::size_t waypoint_ = 0;                                 ///< its goal
  struct MotionGoal {
    Eigen::Vector2d place_W;
    double radius_m;  ///< within which it is reached
    friend bool operator==(const MotionGoal&, const MotionGoal&) = default;
  };
  std::optional<MotionGoal> goal_;

  std::optional<Navigation> here_;
  FollowOrder order_;
  std::size_t passed_ = 0;                 ///< way-points of the order that lie behind
  std::optional<Eigen::Vector2d> hold_W_;  ///< where the vehicle began to hold its position; none: it goes on
  double went_ = 0.5;                      ///< speed of the last order that led somewhere, m/s
  struct Still {
    Time heard;
    HazardMap map;
    std::vector<MovingBody> bodies;  ///< its hazards
  };
  std::optional<Still> still_;
  std::vector<MovingBody> moving_, bodies_;
  bool overruled_ = false;  ///< the Safety Officer stops or turns the vehicle
  TrafficSituation situation_ = TrafficSituation::kClear;
  Time situation_held_;  ///< when it last was so
  int told_plan_ = 0;    ///< number of the last plan that `tell` has seen
  std::map<int, Time> told_;
  std::vector<SteeringDuty> told_duties_;
  std::optional<Time> told_departure_;
};

}  // namespace isobath
