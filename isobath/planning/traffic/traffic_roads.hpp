// TrafficRoads: the road map of what lies still, kept from step to step, and motions along its paths (the Goal Selector
// of Rodin, Amin c. 1988, 2.2; ledger S3-13, S3-16 to S3-24, S3-26).
//
// 1. `update` gives the outlines of bodies that do not move, or slowly, to a PathFinder, when they are new or have
// moved.
// 2. `find` asks it for candidate paths from the vehicle to the goal. They hold from then on: corners that are passed,
//    because the next one is in sight, are dropped. New ones are asked for when the outlines change, and after 2 s. A
//    candidate that does not bend as the vehicle needs is left for the next one; where none does, the first one guides
//    the search, and `reason` tells the place (S3-24).
// 3. `motion` smooths each candidate (smooth_path.hpp) and plans its speeds (speed_plan.hpp) past the bodies that move.
//    The path in force is a candidate, too, as far as the vehicle is on it: a motion along it mends the plan by other
//    speeds only (S3-19). The motion of earliest arrival is taken.
// 4. `guide` is the path for a search in time: that of the last motion, or the preferred candidate.
//
// Where no path leads to the goal, because it is shut off or too near to an outline, there is no guide, and `is_shut`
// tells it. Where only the vehicle is too near to an outline, the last guide remains.
//
// All paths keep the distance of a plan from the still outlines. What it does not promise: paths past bodies that move
// (the search finds those), and motions for a vehicle that cannot stop, because they end at rest. An outline that is
// not convex and has a radius or an uncertain position counts as its hull. Units: m, s, frame W. Cost:
// `isobath traffic --scene walls` measures a step of the planner with it, 1.6 to 2 ms (99 %) with 12 pieces of wall.
#pragma once

#include <isobath/planning/roadmap/path_finder.hpp>
#include <isobath/planning/traffic/speed_plan.hpp>
#include <isobath/planning/traffic/traffic_search.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace isobath {

struct RoadRules {
  double kept_m = 0.8;        ///< between the vehicle's centre and still outlines
  double still_speed = 0.05;  ///< m/s, of bodies that belong to the road map
  SpeedRules speeds;          ///< its `arrival_m` is that of the goal
};

struct RoadMotion {
  Trajectory trajectory;  ///< with braking and rest at its end
  double arrival_s = 0;   ///< from its start
  double free_s = 0;      ///< before the braking
  bool mends = false;     ///< it follows the path in force
};

/// Of all steps since the goal was set.
struct RoadWork {
  int searches = 0;                              ///< for candidates
  int refused_paths = 0;                         ///< that could not be smoothed
  int blocked_paths = 0;                         ///< that have no speeds
  ShapeDetail detail = ShapeDetail::kEnclosure;  ///< the finest of any outline
};

class TrafficRoads {
 public:
  TrafficRoads(const TrafficVehicle& vehicle, const RoadRules& rules);

  void set_goal(const Eigen::Vector2d& goal_W, double arrival_m);
  /// The valid bodies now. False if none of them lies still; then there is nothing else to ask.
  bool update(const MotionState& own, std::span<const MovingBody> bodies);
  /// Candidates for the vehicle's place, if those that it has do not hold.
  void find(const MotionState& own, Time now);
  /// The motion of earliest arrival along a candidate that keeps clear of the bodies of the last update.
  std::optional<RoadMotion> motion(const MotionState& own, Time now);
  /// The last motion becomes the path in force.
  void follow();

  /// Whether no path led to the goal from the vehicle's last place; `reason` says why.
  [[nodiscard]] bool is_shut() const { return is_shut_; }
  /// Null where no path leads to the goal.
  [[nodiscard]] const TrafficGuide* guide() const { return guide_.corners_W.empty() ? nullptr : &guide_; }
  /// Why there is no path or no motion along one; else empty.
  [[nodiscard]] const std::string& reason() const { return reason_; }
  [[nodiscard]] const RoadWork& work() const { return work_; }

 private:
  using Corners = std::vector<Eigen::Vector2d>;
  struct Still {
    MovingBody body;
    bool seen = true;
  };
  [[nodiscard]] Polygon outline_of(const MovingBody& body) const;
  void rebuild(const MotionState& own);
  void grow();
  void search(const MotionState& own);
  [[nodiscard]] Eigen::Vector2d start_beside(Eigen::Vector2d p) const;
  [[nodiscard]] bool is_passed(const MotionState& own, const Corners& corners) const;
  void take_guide(const Corners& corners);
  [[nodiscard]] std::optional<SmoothPath> rest_of_path(const MotionState& own) const;
  double run_out(SmoothPath& path) const;

  TrafficVehicle vehicle_;
  RoadRules rules_;
  Eigen::Vector2d goal_W_ = Eigen::Vector2d::Zero();
  std::map<int, Still> still_;
  std::vector<MovingBody> moving_;
  std::unique_ptr<PathFinder> finder_;  ///< its region grows with what it must hold
  Eigen::AlignedBox2d region_;
  std::unique_ptr<GrownObstacles> water_, hidden_;  ///< by the kept distance, and by the hull's radius
  SpeedPlanner speeds_;
  std::vector<Corners> candidates_;  ///< without their start, the preferred one first
  TrafficGuide guide_;
  struct Path {
    SmoothPath smooth;
    Corners corners;
  };
  Path found_, in_force_;
  bool changed_ = true, is_shut_ = false;
  std::optional<Time> searched_;
  std::string reason_;
  RoadWork work_;
};

}  // namespace isobath
