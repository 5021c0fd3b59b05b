// ExecutiveOfficer: takes the vehicle through a mission, point by point (Ganesan 2015, 5.1; Herman 1988, 2; ledger
// S6-35, S6-51, S6-E21, S2-06 to S2-09).
//
// Receives MissionOrder, VisitOrder, PointMoved, RoutePlanned, RouteRefused, WaypointPassed, TaskCall, TaskAward,
// TaskPlan, Navigation, Health, ObstacleScan, PassageWait and AgentLost. Sends RouteRequest, FollowOrder, PointReport,
// MissionReport, SonarOrder, LevelPlan, PlanStep, Decision.
//
// The mission is a plan graph: one node per point, and nodes for the work there and for the end. The graph is derived
// from the MissionPlan (executive_graphs.cpp). The events of the graph are
//   point reached (i), point dropped (i), task done (i), returned     facts
//   waited (i)      total time without a route to point i, s; i = number of points: without a route back
//   depth, sigma    m; sigma: of the horizontal position
//   battery         share of a full charge
//   range           m; to the nearest obstacle of the last scan
// Where it has to wait for its turn in a passage, the vehicle holds its position; that is no time without a route.
//
// A task of a mission point is one that the mission describes (task_steps.hpp), whose steps become nodes of the graph,
// or one of a back-seat driver, which is asked for once the vehicle is there.
//
// In a group the Commodore orders which points to visit, in which order; each order replaces what is still to come. The
// way to a point goes on, if the point is the first of the order (S2-24). Before the first order, and after
// the points of one that is not the last, the vehicle holds its position. If the Commodore is lost, the points that are
// ordered are the last.
//
// At the interval of the timing table the plan graph of what is still to come is derived anew and replaces the rest of
// the old one; where nothing has changed, the vehicle goes on as before (S2-24, S2-25).
//
// A new route replaces the rest of the one before. Without a route the vehicle holds its position until there is one;
// after a total of `route_timeout_s` without a route the point is dropped. A point that is passed abeam is approached
// again, `approaches` times in all. If the Captain is lost, the vehicle surfaces.
#pragma once

#include <deque>
#include <isobath/mission/messages/agent.hpp>
#include <isobath/mission/messages/plan_clock.hpp>
#include <isobath/mission/plan/plan_graph.hpp>
#include <isobath/mission/plan/timing_table.hpp>
#include <map>
#include <span>

namespace isobath {

struct ExecutiveConfig {
  double route_timeout_s = 60;
  double move_wait_s = 2;
  double task_wait_s = 300;
  double surface_wait_s = 120;
  int approaches = 2;
};

std::vector<Field> fields(ExecutiveConfig& config);

/// Actions: "go to", "drop", "hold", "task" (each with "point"), "step" (with "point" and "step"), "return", "surface",
/// "finish".
PlanGraph mission_graph(const MissionPlan& plan, const ExecutiveConfig& config);
/// The same for some of the points, in this order; if they are not the last, it ends in "wait".
PlanGraph visit_graph(const MissionPlan& plan, std::span<const std::size_t> points, bool last,
                      const ExecutiveConfig& config);
/// The nodes for the end of the mission only.
PlanGraph end_graph(MissionEnd end, std::size_t points, const ExecutiveConfig& config);

class ExecutiveOfficer final : public Agent, private PlanDatabase {
 public:
  explicit ExecutiveOfficer(const ExecutiveConfig& config, const TimingTable& timing = {})
      : config_(config), plans_(CommandLevel::kVehicle, timing.of(CommandLevel::kVehicle).replan_s) {}

  void on_message(const Message& message, Time now, Outbox& out) override;
  void tick(Time now, Outbox& out) override;

 private:
  enum class Errand : std::uint8_t { kNone, kPoint, kTask, kReturn };

  void on(const MissionOrder& order, Outbox& out);
  void start(const MissionOrder& order, Outbox& out);
  void end(MissionEnd how, const std::string& why, Outbox& out);
  void on(const VisitOrder& order, Outbox& out);
  void visit(const VisitOrder& order, Outbox& out);
  void on(const PointMoved& moved, Outbox& out);
  void on(const RoutePlanned& route, Outbox& out);
  void on(const RouteRefused& refused, Outbox& out);
  void on(const WaypointPassed& passed, Outbox& out);
  void on(const TaskAward& award);
  void on(const TaskPlan& plan, Outbox& out);

  void plan_again(Outbox& out);
  void tell_step(Outbox& out);
  [[nodiscard]] std::vector<std::size_t> points_left() const;
  [[nodiscard]] double time_for(const std::vector<std::size_t>& points) const;
  [[nodiscard]] std::optional<Eigen::Vector2d> next_W() const;
  void cycle(Outbox& out);
  void act(const PlanAction& action, Outbox& out);
  void go(Errand errand, const MissionPoint& target, Outbox& out);
  void arrive(bool reached, Outbox& out);
  void reached(Outbox& out);
  void drop(const std::string& why, bool no_way, Outbox& out);
  void begin_step(const TaskStep& step, Outbox& out);
  void look(const std::optional<ScanCommand>& scan, Outbox& out);
  void on(const PassageWait& wait, Outbox& out);
  void ask_driver(const std::string& task, Outbox& out);
  void note_range(const ObstacleScan& scan);
  [[nodiscard]] const PlanAction* present_action() const;
  void give_up_leg(const std::string& why, Outbox& out);
  void stop(Outbox& out);
  void report(MissionPhase phase, const std::string& why, Outbox& out);
  void decide(const char* what, std::string reason, Outbox& out) const;
  [[nodiscard]] std::optional<double> value(const std::string& quantity, std::optional<int> of) const override;
  void note(const std::string& fact, std::size_t of) { facts_[{fact, static_cast<int>(of)}] = 1; }
  /// Whether the Commodore orders which points to visit.
  [[nodiscard]] bool is_near(const MissionPoint& point) const;
  [[nodiscard]] bool is_shared() const { return plan_ && plan_->search.on() && !plan_->group.empty(); }
  [[nodiscard]] bool busy() const { return phase_ == MissionPhase::kUnderWay || phase_ == MissionPhase::kHolding; }

  ExecutiveConfig config_;
  std::shared_ptr<const MissionPlan> plan_;
  std::vector<MissionPoint> points_;  ///< of the plan, with their positions now
  std::optional<PlanExecutor> executor_;
  std::map<std::pair<std::string, int>, double> facts_;
  VisitOrder visits_ordered_;  ///< in a group: the newest
  PlanClock plans_;
  std::shared_ptr<const PlanGraph> told_graph_;
  std::size_t told_node_ = 0;
  bool other_graph_ = false;  ///< than told_graph_
  MissionPhase phase_ = MissionPhase::kWaiting;
  std::size_t reached_ = 0, dropped_ = 0;
  bool paused_ = false;  ///< by the operator
  Time now_;
  std::optional<Time> last_tick_;
  std::optional<Navigation> here_;
  std::optional<double> battery_share_, range_m_;
  bool waits_for_turn_ = false;                     ///< before a passage
  bool looks_as_ordered_ = false;                   ///< the scanning sonar
  std::optional<std::uint32_t> call_;               ///< for a back-seat driver, since it was last wanted
  std::string asked_task_;                          ///< of that driver
  Eigen::Vector2d home_ = Eigen::Vector2d::Zero();  ///< where the mission started

  Errand errand_ = Errand::kNone;
  std::size_t point_ = 0;  ///< of the errand
  MissionPoint target_;
  std::uint32_t request_ = 0;
  std::uint32_t version_ = 0;  ///< of the route that is followed
  int approaches_ = 0;
  bool no_way_ = false;
  std::string no_way_why_;
  std::optional<Time> move_until_;     ///< the Captain may move the point until then
  std::deque<Waypoint> visits_;        ///< way-points that are left of the current task
  double visits_drop_distance_m_ = 0;  ///< as in TaskPlan
};

}  // namespace isobath
