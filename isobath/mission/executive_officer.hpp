// ExecutiveOfficer: leads the vehicle through a mission, point by point (Ganesan 2015, 5.1; Herman 1988, 2; ledger
// S6-35, S6-51, S6-E21, S2-06 to S2-09).
//
// Hears MissionOrder, PointMoved, RoutePlanned, RouteRefused, WaypointPassed, TaskAward, TaskPlan, Navigation and
// AgentLost; says RouteRequest, FollowOrder, PointReport, MissionReport, Decision.
//
// The mission is a plan graph: a node a point, and nodes for what is done there and at the end. It is worked out from
// the MissionPlan, or taken from the library that the constructor is given, by its title (S2-09). The events of the
// graph are
//   point reached (i), point dropped (i), task done (i), returned     facts
//   waited (i)      s without a way to point i, all told; i = number of points: of the way back
//   depth           m
// A way that changes replaces what is left of the one before. Without a way the vehicle holds its place until there is
// one; a point is dropped after `patience_s` of that. A point that is passed abeam is approached anew, `approaches`
// times in all. Lost without a Captain, it surfaces.
#pragma once

#include <deque>
#include <isobath/mission/agent.hpp>
#include <isobath/mission/plan_graph.hpp>
#include <map>

namespace isobath {

struct ExecutiveConfig {
  double patience_s = 60;
  double move_wait_s = 2;
  double task_wait_s = 300;
  double surface_wait_s = 120;
  int approaches = 2;
};

std::vector<Field> fields(ExecutiveConfig& config);

/// Actions: "go to", "drop", "hold", "task" (each with "point"), "return", "surface", "finish".
PlanGraph mission_graph(const MissionPlan& plan, const ExecutiveConfig& config);
/// Only what is done at the end.
PlanGraph end_graph(MissionEnd end, std::size_t points, const ExecutiveConfig& config);

class ExecutiveOfficer final : public Agent, private PlanDatabase {
 public:
  explicit ExecutiveOfficer(const ExecutiveConfig& config, std::map<std::string, PlanGraph> library = {});

  void hear(const Message& message, Time now, Outbox& out) override;
  void tick(Time now, Outbox& out) override;

 private:
  enum class Errand : std::uint8_t { kNone, kPoint, kTask, kReturn };

  void take(const MissionOrder& order, Outbox& out);
  void start(const MissionOrder& order, Outbox& out);
  void end(MissionEnd how, const std::string& why, Outbox& out);
  void take(const PointMoved& moved, Outbox& out);
  void take(const RoutePlanned& route, Outbox& out);
  void take(const RouteRefused& refused, Outbox& out);
  void take(const WaypointPassed& passed, Outbox& out);
  void take(const TaskAward& award);
  void take(const TaskPlan& plan, Outbox& out);

  void cycle(Outbox& out);
  void act(const PlanAction& action, Outbox& out);
  void go(Errand errand, const MissionPoint& target, Outbox& out);
  void arrive(bool reached, Outbox& out);
  void reached(Outbox& out);
  void drop(const std::string& why, Outbox& out);
  void give_up_leg(const std::string& why, Outbox& out);
  void stop(Outbox& out);
  void report(MissionPhase phase, const std::string& why, Outbox& out);
  void decide(const char* what, std::string reason, Outbox& out) const;
  [[nodiscard]] std::optional<double> value(const std::string& quantity, std::optional<int> of) const override;
  void note(const std::string& fact, std::size_t of) { facts_[{fact, static_cast<int>(of)}] = 1; }
  [[nodiscard]] bool busy() const { return phase_ == MissionPhase::kUnderWay || phase_ == MissionPhase::kHolding; }

  ExecutiveConfig config_;
  std::map<std::string, PlanGraph> library_;
  std::shared_ptr<const MissionPlan> plan_;
  std::vector<MissionPoint> points_;  ///< of the plan, where they stand now
  std::optional<PlanExecutor> executor_;
  std::map<std::pair<std::string, int>, double> facts_;
  MissionPhase phase_ = MissionPhase::kWaiting;
  std::size_t reached_ = 0, dropped_ = 0;
  bool paused_ = false;  ///< by the operator
  Time now_;
  std::optional<Time> last_tick_;
  std::optional<Navigation> here_;
  Eigen::Vector2d home_ = Eigen::Vector2d::Zero();  ///< where the mission started

  Errand errand_ = Errand::kNone;
  std::size_t point_ = 0;  ///< that the errand is about
  MissionPoint target_;
  std::uint32_t request_ = 0;
  std::uint32_t version_ = 0;  ///< of the way that is followed
  int approaches_ = 0;
  bool no_way_ = false;
  std::string no_way_why_;
  std::optional<Time> move_until_;  ///< so long the Captain may move the point
  std::deque<Waypoint> visits_;     ///< of the task under way
};

}  // namespace isobath
