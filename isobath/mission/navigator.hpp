// Navigator: the way to the mission point, kept clear of what is seen (Ganesan 2015, 5.1, 5.2; ledger S6-36, S6-39,
// S6-45 to S6-47, S6-50, S6-51, S6-53 to S6-56, S6-65, S6-E21; emergency mode Herman 1988, 3.4, S2-29 to S2-31).
//
// Hears RouteRequest, ObstacleScan, SpaceSeen, ChartedHazards, Navigation, WaypointPassed, MissionOrder (fence, speed),
// SafetyAction and Health (of the planner: how much of its budget an overloaded computer leaves it); says RoutePlanned,
// RouteRefused, Decision.
//
// Each scan is one cycle: what is left of the way, from the vehicle on, is turned into the frame L of the scan,
// checked there, and if anything changes, turned back with the same pose; an error of the position that is the same for
// way and obstacles so has no say (S6-53). A position fix that jumps moves the corners and what was seen with it; the
// mission point, which is a place in the world, it does not move.
//
// The way changes only for a reason (S6-54, S6-55):
//   - it would come nearer to a hazard than the clearance less `slack_m`; then its corners are moved aside as far as
//     needed, and a way that is searched anew is taken only if it is `switch_m` shorter than that one;
//   - it goes round something that is not there any more: a way `shortcut_m` shorter was there for `sure_scans` scans.
//     In three dimensions that is looked for twice a second at most: it costs tens of milliseconds.
// A mission point on an obstacle, or with one within `drop_distance_m`, is refused (S6-51), as soon as the
// vehicle is within `decide_within_m` of it and `sure_scans` scans agree: from afar it is put off. Charted and injected
// obstacles are believed at once.
//
// Where a sonar tells height (SpaceSeen), a way may lead over, under or between what closes the plan view, through
// water that was measured (planning/space_route.hpp; S5-35, S5-37): a way that does so already is kept; one is searched
// where the plane has no way, or one more than `switch_m` longer than straight.
//
// Where no way can be turned into, or the vehicle stands nearer to a hazard than the clearance, a smaller one must do.
//
// A refusal stands until a way is found: it looks again at each scan. After a refusal, or where the Safety Officer has
// stopped or turned the vehicle, the mode is emergency: it looks again at the next tick, with `emergency_factor` times
// the expansions. Normal mode resumes when the vehicle has passed what was in the way.
//
// Frames: messages in W, planning in L of the scan. Does not promise that water nobody has looked at is free.
#pragma once

#include <isobath/mission/agent.hpp>
#include <isobath/planning/plan_frame.hpp>
#include <isobath/planning/route_planner.hpp>
#include <isobath/planning/space_route.hpp>
#include <isobath/vehicle/vehicle_sheet.hpp>

namespace isobath {

struct NavigatorConfig {
  double drop_distance_m = 10;
  double slack_m = 0.5;
  double switch_m = 5;
  double shortcut_m = 3;
  int sure_scans = 3;
  double sure_within_m = 20;
  double decide_within_m = 30;
  double fence_clearance_m = 1;
  double chart_sigmas = 2;
  double jump_m = 2;
  double map_age_s = 20;
  double tight_m = 0.5;
  double tight_speed = 0.8;
  int emergency_factor = 4;
};

std::vector<Field> fields(NavigatorConfig& config);

class Navigator : public Agent {
 public:
  Navigator(const NavigatorConfig& config, const RouteConfig& route, const VehicleSheet& vehicle,
            const SpaceRouteConfig& space_route = {});

  void hear(const Message& message, Time now, Outbox& out) override;
  void tick(Time now, Outbox& out) override;

 private:
  using Way = std::vector<Eigen::Vector2d>;
  enum class Mode : std::uint8_t { kNormal, kEmergency };
  /// What one cycle looks at in three dimensions, in W.
  struct Space {
    std::vector<Hazard> hazards;
    SpaceRouteTask task;
    SpaceRoom room;
  };
  /// All that one cycle looks at, in the plan frame.
  struct View {
    HazardMap map;
    PlanFrame frame;
    Way way;  ///< vehicle, what is left of the way; the vehicle alone without one
    Eigen::Vector2d goal;
    Angle heading;
    std::unique_ptr<Space> space = {};  ///< made when it is first asked for
  };
  struct Refusal {
    RouteRefused::Reason reason = RouteRefused::Reason::kNoPath;
    std::string why;
    std::optional<Eigen::Vector2d> safe_nearby = {};
    std::optional<Eigen::Vector2d> obstacle = {};  ///< N, E
  };

  void take_fix(const Navigation& fix, Outbox& out);
  void take_scan(const ObstacleScan& scan, Outbox& out);
  void take_request(const RouteRequest& request, Outbox& out);
  void take_passage(const WaypointPassed& passed);
  void take_action(const SafetyAction& action, Outbox& out);

  void look(Outbox& out);
  [[nodiscard]] std::optional<Refusal> blind() const;
  [[nodiscard]] PlanFrame plan_frame() const;
  [[nodiscard]] std::vector<Hazard> hazards_in(const PlanFrame& frame) const;
  [[nodiscard]] std::optional<Refusal> judge_goal(const PlanFrame& frame, std::vector<Hazard>& hazards);
  [[nodiscard]] std::optional<Eigen::Vector2d> safe_near(const Eigen::Vector2d& goal, const Eigen::Vector2d& vehicle,
                                                         const PlanFrame& frame, std::vector<Hazard> hazards) const;
  void keep(View& view, Outbox& out);
  void avoid(View& view, const Conflict& conflict, Outbox& out);
  void shorten(View& view, Outbox& out);
  void start(View& view, Outbox& out);
  [[nodiscard]] Result<RoutePath, RouteRefusal> search(const View& view) const;
  [[nodiscard]] int most_expanded() const;
  [[nodiscard]] Refusal refusal_of(RouteRefusal refusal, const View& view) const;

  [[nodiscard]] double turning_radius() const;
  [[nodiscard]] double wanted_speed() const;
  [[nodiscard]] double speed_on(const View& view, const Way& way) const;
  void take_way(const View& view, const Way& way, Decision decision, Outbox& out);
  void adopt(std::vector<Waypoint> waypoints, double longer_m, Decision decision, Outbox& out);

  // in three dimensions: navigator_space.cpp
  [[nodiscard]] std::vector<Hazard> hazards_W(const View& view) const;
  [[nodiscard]] SpaceRouteTask space_task(std::span<const Hazard> hazards) const;
  [[nodiscard]] const Space& space_of(View& view) const;
  [[nodiscard]] bool leads_through(View& view, const Conflict& conflict, Outbox& out);
  [[nodiscard]] std::optional<SpaceRoutePath> search_space(View& view, std::optional<double> plane_m) const;
  void take_space_way(const View& view, const SpaceRoutePath& path, Decision decision, Outbox& out);

  void refuse(const Refusal& refusal, Outbox& out);
  void enter(Mode mode, const std::string& why, Outbox& out);
  [[nodiscard]] Decision decision(std::string what, std::string reason) const;
  [[nodiscard]] Decision about(const View& view, const Way& way, const Conflict& conflict) const;

  [[nodiscard]] double clearance() const { return route_.clearance_m + vehicle_.half_width_m; }
  [[nodiscard]] bool inside_fence(const Eigen::Vector2d& p_W, double by_m) const;

  NavigatorConfig config_;
  RouteConfig route_;
  SpaceRouteConfig space_route_;
  VehicleSheet vehicle_;

  std::shared_ptr<const MissionPlan> plan_;
  std::optional<Navigation> here_;
  std::optional<ObstacleScan> scan_;
  Time now_;
  Time scan_heard_;
  ChartedHazards chart_;
  std::shared_ptr<const SpaceGrid> space_;  ///< null where no sonar tells height

  std::optional<RouteRequest> request_;
  std::vector<Waypoint> way_;  ///< what is left; the last is the mission point
  std::uint32_t version_ = 0;
  std::size_t passed_ = 0;  ///< way-points of this version that are behind
  std::optional<RouteRefused::Reason> refused_;
  int goal_blocked_ = 0;  ///< scans in a row
  int shorter_ = 0;       ///< scans in a row that had a shorter way
  Time space_searched_;   ///< for one that is shorter, and whether there was
  bool space_shorter_ = false;
  bool through_ = false;  ///< the way leads through measured water, over or under a hazard of the plane
  Mode mode_ = Mode::kNormal;
  double budget_share_ = 1;  ///< that the computer leaves it
  SafetyActionKind action_ = SafetyActionKind::kNone;
  bool look_at_tick_ = false;
  bool new_scan_ = false;  ///< the cycle under way is that of a new scan
};

}  // namespace isobath
