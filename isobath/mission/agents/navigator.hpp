// Navigator: plans the route to the mission point, and keeps it clear of obstacles (Ganesan 2015, 5.1, 5.2; ledger
// S6-36, S6-39, S6-45 to S6-47, S6-50, S6-51, S6-53 to S6-56, S6-65, S6-E21; emergency mode Herman 1988, 3.4, S2-29 to
// S2-31).
//
// Receives RouteRequest, ObstacleScan, WorldSnapshot, ChartedHazards, GroupHazards, Navigation, FollowOrder,
// WaypointPassed, MotionOrder, MissionOrder (fence, speed), SafetyAction and Health (of the planner: the share of its
// budget that an overloaded computer leaves it). Sends RoutePlanned, RouteRefused, StillHazards, LevelPlan, Decision.
//
// The depth map that sonar has measured counts as seen (HazardKind::kMapped): a vehicle that has only range sonars
// plans on it, and without scans each update of it is one cycle (ledger S1-03, S1-41).
//
// Each scan is one cycle: the rest of the route, from the vehicle on, is transformed into the frame L of the scan,
// checked there, and, if anything changes, transformed back with the same pose. A position error that route and
// obstacles share therefore has no effect (S6-53). When a position fix jumps, the corners of the route and the last
// scan move with it; the mission point, which is a place in the world, does not.
//
// Each scan lets it plan; without scans it plans at the interval of the timing table. With a route it also plans the
// first leg of the route to the point after, so that the Pilot knows the corner (S2-41).
//
// The route changes only for a reason (S6-54, S6-55):
//   - it would come nearer to a hazard than the clearance less `slack_m`. Its corners are then moved aside as far as
//     needed; a newly searched route is taken only if it is `switch_m` shorter than that;
//   - it goes round something that is no longer there: a route shorter by `shortcut_m` existed for `sure_scans` scans.
//     In three dimensions this search runs at most twice a second: it costs tens of milliseconds.
// A mission point on an obstacle, or with one within `drop_distance_m`, is refused (S6-51) as soon as the vehicle is
// within `decide_within_m` of it and `sure_scans` scans agree; from farther away the refusal is put off. Charted and
// injected obstacles are believed at once.
//
// Where a sonar measures height (WorldSnapshot), a route may lead over, under or between hazards that close the plan
// view, through water that was measured (planning/space_route.hpp; S5-35, S5-37). A route that already does so is kept.
// A new one is searched where the plane has no route, or only one that is more than `switch_m` longer than the straight
// line.
//
// Where the route leads through an opening between two bodies, such as the pylons of a bridge, the Navigator says how
// much of it is known to be free, and may fly a helix that looks round it (OpeningWatch; S5-40 to S5-46). The helix is
// a route like any other: what the sonar shows on the way may replace it.
//
// Bodies that move are left to the Goal Selector, which gets all still hazards, while it orders motions past them.
// Without it, and where the route leads over or under a hazard, they count with the water that they cross in the next
// seconds. While the vehicle holds its position, the Goal Selector gets the still hazards at each cycle.
//
// Where the mission has risk areas and priorities, a search weighs time, energy, detection and destruction
// (mission/plan/priorities.hpp), and decisions state what the route costs. A point with `deviation_m` is reached
// within that distance of the straight line, or refused. Routes over or under hazards, and those that move aside by a
// corner, weigh the way alone.
//
// If no route fits the turning radius, or the vehicle is nearer to a hazard than the clearance, a smaller clearance is
// used.
//
// A refusal stands until a route is found: the Navigator searches again at each scan. After a refusal, or when the
// Safety Officer has stopped or turned the vehicle, the mode is emergency: the Navigator searches again at the next
// tick, with `emergency_factor` times the expansions. Normal mode resumes when the vehicle has passed the obstacle.
//
// Frames: messages in W, planning in L of the scan. Not promised: that water that no sensor has observed is free.
#pragma once

#include <algorithm>
#include <isobath/mission/agents/navigator_config.hpp>
#include <isobath/mission/agents/opening_watch.hpp>
#include <isobath/mission/messages/agent.hpp>
#include <isobath/mission/messages/plan_clock.hpp>
#include <isobath/mission/plan/timing_table.hpp>
#include <isobath/planning/plan_frame.hpp>
#include <isobath/planning/route_planner.hpp>
#include <isobath/planning/space_route.hpp>
#include <isobath/vehicle/vehicle_parameters.hpp>

namespace isobath {

class Navigator : public Agent {
 public:
  Navigator(const NavigatorConfig& config, const RouteConfig& route, const VehicleParameters& vehicle,
            const SpaceRouteConfig& space_route = {}, const OpeningConfig& opening = {},
            const TimingTable& timing = {});

  void on_message(const Message& message, Time now, Outbox& out) override;
  void tick(Time now, Outbox& out) override;

 private:
  using Way = std::vector<Eigen::Vector2d>;
  enum class Mode : std::uint8_t { kNormal, kEmergency };
  /// The data of one cycle in three dimensions, in W.
  struct Space {
    std::vector<Hazard> hazards;
    SpaceRouteTask task;
    ClearanceField room;
  };
  /// The data of one cycle, in the plan frame.
  struct View {
    HazardMap map;
    PlanFrame frame;
    Way way;  ///< vehicle, then the rest of the route; the vehicle alone without a route
    Eigen::Vector2d goal;
    Angle heading;
    std::unique_ptr<Space> space = {};  ///< created when first needed
  };
  struct Refusal {
    RouteRefused::Reason reason = RouteRefused::Reason::kNoPath;
    std::string why;
    std::optional<Eigen::Vector2d> safe_nearby = {};
    std::optional<Eigen::Vector2d> obstacle = {};  ///< N, E
    int obstacle_number = 0;
  };

  void on_fix(const Navigation& fix, Outbox& out);
  void on_scan(const ObstacleScan& scan, Outbox& out);
  void on_chart(const ChartedHazards& chart, Outbox& out);
  void on_group(const GroupHazards& group, Outbox& out);
  void on_request(const RouteRequest& request, Outbox& out);
  void on_passage(const WaypointPassed& passed);
  void on_action(const SafetyAction& action, Outbox& out);

  void look(Outbox& out);
  void note_plan(Outbox& out);
  [[nodiscard]] std::optional<Refusal> blind() const;
  void wait_for_goal_selector();
  [[nodiscard]] bool in_traffic() const;
  [[nodiscard]] int goal_scans() const;
  bool hand_over_moving(std::vector<Hazard>& hazards);
  void tell_still(std::span<const Hazard> hazards, const PlanFrame& frame, Outbox& out) const;
  [[nodiscard]] PlanFrame plan_frame() const;
  [[nodiscard]] std::vector<Hazard> hazards_in(const PlanFrame& frame) const;
  [[nodiscard]] bool is_steered() const;
  void begin_here(Outbox& out);
  void keep(View& view, Outbox& out);
  void avoid(View& view, const Conflict& conflict, Outbox& out);
  void shorten(View& view, Outbox& out);
  void start(View& view, Outbox& out);
  [[nodiscard]] Result<RoutePath, RouteRefusal> search(const View& view) const;
  [[nodiscard]] RouteTask task_of(const View& view) const;
  [[nodiscard]] bool deviates(const View& view, const Way& way) const;
  [[nodiscard]] bool weighs_risks() const { return plan_ && !plan_->risks.empty(); }
  [[nodiscard]] std::string cost_text() const;
  [[nodiscard]] std::optional<Eigen::Vector2d> corner_after(const View& view) const;
  [[nodiscard]] int max_expanded() const;
  [[nodiscard]] Refusal refusal_of(RouteRefusal refusal, const View& view) const;

  [[nodiscard]] double turning_radius() const;
  [[nodiscard]] double wanted_speed() const;
  [[nodiscard]] double speed_on(const View& view, const Way& way) const;
  void take_way(const View& view, const Way& way, Decision decision, Outbox& out);
  void adopt(const View& view, std::vector<Waypoint> waypoints, double longer_m, Decision decision, Outbox& out);

  // the mission point: navigator_goal.cpp
  [[nodiscard]] std::optional<Refusal> judge_goal(const PlanFrame& frame, std::vector<Hazard>& hazards);
  [[nodiscard]] std::optional<Eigen::Vector2d> safe_near(const Eigen::Vector2d& goal, const Eigen::Vector2d& vehicle,
                                                         const PlanFrame& frame, std::vector<Hazard> hazards) const;

  // three dimensions: navigator_space.cpp
  [[nodiscard]] std::vector<Hazard> hazards_W(const View& view) const;
  [[nodiscard]] SpaceRouteTask space_task(std::span<const Hazard> hazards) const;
  [[nodiscard]] const Space& space_of(View& view) const;
  bool is_as_clear(View& view, double clearance_m) const;
  [[nodiscard]] std::vector<Eigen::Vector3d> current_way(const Space& space) const;
  [[nodiscard]] bool leads_through(View& view, const Conflict& conflict, Outbox& out);
  [[nodiscard]] bool is_clear_through(View& view, std::span<const Eigen::Vector3d> way) const;
  [[nodiscard]] std::optional<SpaceRoutePath> search_space(View& view, std::optional<double> plane_m) const;
  void take_space_way(const View& view, const SpaceRoutePath& path, Decision decision, Outbox& out);

  // openings: navigator_opening.cpp
  void look_at_opening(View& view, Outbox& out);
  [[nodiscard]] bool is_clear_helix(View& view, const SpacePath& path) const;
  void take_helix(const View& view, const SpacePath& path, Decision decision, Outbox& out);

  void refuse(const Refusal& refusal, Outbox& out);
  void enter(Mode mode, const std::string& why, Outbox& out);
  [[nodiscard]] Decision decision(std::string what, std::string reason) const;
  [[nodiscard]] Decision about(const View& view, const Way& way, const Conflict& conflict) const;

  /// Distance within which an obstacle blocks the point.
  [[nodiscard]] double drop_distance() const;
  [[nodiscard]] double clearance() const { return route_.clearance_m + vehicle_.half_width_m; }
  /// The clearance below which a route is changed.
  [[nodiscard]] double least_clearance() const { return std::max(0.0, clearance() - config_.slack_m); }
  [[nodiscard]] bool inside_fence(const Eigen::Vector2d& p_W, double by_m) const;

  NavigatorConfig config_;
  RouteConfig route_;
  SpaceRouteConfig space_route_;
  VehicleParameters vehicle_;
  OpeningWatch opening_;

  std::shared_ptr<const MissionPlan> plan_;
  std::optional<Navigation> here_;
  std::optional<ObstacleScan> scan_;
  Time now_;
  Time scan_heard_;
  ChartedHazards chart_;
  std::vector<Hazard> group_;                       ///< of the other vehicles
  Time mapped_;                                     ///< when `chart_` last had a new reading ahead
  std::shared_ptr<const OccupancySnapshot> space_;  ///< null where no sonar measures height

  std::optional<RouteRequest> request_;
  std::vector<Waypoint> way_;                           ///< the rest of the route; the last is the mission point
  Eigen::Vector2d way_from_ = Eigen::Vector2d::Zero();  ///< where it began
  Eigen::Vector2d leg_from_ = Eigen::Vector2d::Zero();  ///< where the vehicle was when the point was asked for
  std::optional<Eigen::Vector2d> then_W_;               ///< as in RoutePlanned
  PlanClock plans_;
  std::uint32_t version_ = 0;
  std::uint32_t noted_ = 0;  ///< the version of the last plan that was noted
  std::size_t passed_ = 0;   ///< way-points of this version that lie behind
  std::optional<RouteRefused::Reason> refused_;
  int goal_blocked_ = 0;        ///< scans in a row
  int shorter_ = 0;             ///< scans in a row with a shorter route
  Time space_searched_;         ///< last search in three dimensions for a shorter route
  bool space_shorter_ = false;  ///< whether that search found one
  bool through_ = false;        ///< the route leads through measured water, over or under a hazard of the plane
  Mode mode_ = Mode::kNormal;
  double budget_share_ = 1;  ///< share of the budget that the computer leaves
  SafetyActionKind action_ = SafetyActionKind::kNone;
  bool holds_ = false;               ///< the vehicle holds its position
  std::optional<Time> handed_over_;  ///< since when bodies move that the Goal Selector knows of
  std::optional<Time> traffic_;      ///< when a body last moved
  std::optional<Time> steered_;      ///< last order of the Goal Selector, while it is to steer
  bool look_at_tick_ = false;
  bool new_scan_ = false;  ///< the current cycle is that of a new scan
};

}  // namespace isobath
