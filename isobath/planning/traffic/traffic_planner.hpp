// TrafficPlanner: motion to a goal among moving bodies and still structures, as a path with times and speeds, planned
// anew as it goes (ledger S3-01, S3-18 to S3-22, S3-26, S3-30, S3-37).
//
// Each step is given the vehicle's state and the bodies that its sensors know. The last plan is kept while it stays
// free by the present prediction; a search (traffic_search.hpp) runs when it does not, and every `replan_s`. A free
// plan is replaced only by one that arrives earlier by `gain_s`, or when half of its horizon has passed. Each plan ends
// in an escape: at rest, or on a circle if the vehicle cannot stop. Where no motion keeps the margin, half of it and
// none are tried; where that fails, the plan is the action of least harm, with the reason.
//
// Where bodies lie still, a road map of their outlines (traffic_roads.hpp) leads past walls and out of dead ends that
// are larger than the horizon: the better one is taken of the best motion along its paths and of the motion that the
// search finds with the path as its guide. Without still bodies the search goes for the goal itself. Where no path
// leads to the goal, the vehicle stops where it is, with room to turn, and goes on when one does.
//
// The plan keeps `margin_m` from the shapes of all valid bodies, grown by k sigma at each time (S3-30), if they keep
// their velocities. It does not promise a margin from bodies that it does not know or that turn. Times in seconds, m,
// m/s, frame W (see vehicle_motion.hpp).
//
// As an option (`rules`, off) the plan follows the steering rules of the sea (rules_of_the_road.hpp). A search first
// keeps out of the zones that the rules forbid, too, at the full margin, and leaves out the bodies toward which the
// vehicle keeps its course and speed, unless it must manoeuvre for another one and would come near them. Where the plan
// is not free, or for 2 s no search has found such a motion, the zones are given up (rule 2 b), and then the margin, as
// without rules. Motions along the road map do not know the zones, and are not taken while there are any.
//
// Cost on one core, 100 bodies of which some 35 are in reach: 0.06 ms a step (median), 4 to 6 ms (99 %), 20 ms
// (longest); `isobath traffic` measures it. Memory is allocated only while a search is larger than all before. One
// thread at a time.
#pragma once

#include <isobath/planning/traffic/rules_of_the_road.hpp>
#include <isobath/planning/traffic/traffic_roads.hpp>
#include <isobath/planning/traffic/traffic_search.hpp>
#include <string>

namespace isobath {

struct TrafficConfig {
  double margin_m = 0.25;  ///< between the vehicle's disc and the shape of a body
  double sigmas = 3;
  double replan_s = 0.5;
  double gain_s = 0.2;
  bool roads = true;          ///< whether there is a road map of what lies still
  double still_speed = 0.05;  ///< m/s, of bodies that the road map holds
  SteeringRulesConfig rules = {};
  TrafficSearchConfig search;
};

std::vector<Field> fields(TrafficConfig& config);

enum class TrafficAction : std::uint8_t {
  kFollow,   ///< a free motion to the horizon, or to the goal
  kEvade,    ///< a free motion that ends in an escape before the horizon
  kStop,     ///< no free motion, or no path to the goal: brake
  kRetreat,  ///< no free motion: turn away
  kHold,     ///< no free motion: keep the speed
  kRefuse,   ///< the vehicle's state or the goal is not finite; there is no trajectory
};
std::string to_text(TrafficAction action);

/// Closest approach to one body.
struct Passage {
  int number = 0;     ///< of the body
  double time_s = 0;  ///< from the time of asking
  double gap_m = 0;   ///< between the vehicle's disc and the body's shape, which is grown by its uncertainty
};

struct TrafficPlan {
  TrafficAction action = TrafficAction::kRefuse;
  Trajectory trajectory;  ///< from `start` on, with the escape at its end
  Time start{};
  double arrival_s = 0;              ///< from the start; beyond the horizon in open water
  double free_s = 0;                 ///< from the start: time before the escape
  double margin_m = 0;               ///< that the search kept: the configured one, half of it, or 0
  int number = 0;                    ///< rises by one with each new plan (S3-21)
  std::string reason;                ///< why there is no free motion; else empty
  bool on_road = false;              ///< it follows a path of the road map; else the search found it
  bool mends = false;                ///< it follows the path of the plan before with other speeds (S3-19)
  std::string road_reason;           ///< why no path of the road map leads to the goal; else empty (S3-37)
  std::vector<SteeringDuty> duties;  ///< with rules: the roles toward the bodies at the last step, by number
  bool departs = false;              ///< it does not keep out of all zones of these roles (rule 2 b)
};

/// Work of one step.
struct TrafficWork {
  int searches = 0, expansions = 0;
  std::int64_t checks = 0;  ///< of a piece of motion against a body
  int refused_bodies = 0;   ///< that are not valid and were left out
};

class TrafficPlanner {
 public:
  /// Throws Error if the minimum speed of the vehicle is not below its maximum speed.
  TrafficPlanner(const TrafficConfig& config, const TrafficVehicle& vehicle);

  /// A vehicle within `arrival_m` of the goal has arrived. A free plan stays until the next step finds a better one for
  /// this goal.
  void set_goal(const Eigen::Vector2d& goal_W, double arrival_m);

  /// The plan in force from now on. `own` should be on the last plan; it is planned anew if it is off by 0.05 m.
  const TrafficPlan& step(const MotionState& own, Time now, std::span<const MovingBody> bodies);

  [[nodiscard]] const TrafficPlan& plan() const { return plan_; }
  [[nodiscard]] const TrafficWork& work() const { return work_; }
  /// Since the goal was set.
  [[nodiscard]] const RoadWork& road_work() const { return roads_.work(); }
  /// The roles toward the bodies.
  [[nodiscard]] const RulesOfTheRoad& rules() const { return rules_; }
  /// Takes the goal, the roles and the plan of a planner with other settings. The plan is dropped if that vehicle may
  /// be faster than this one; else it stays in force while it is free.
  void continue_from(const TrafficPlanner& before);
  /// Bodies of the last step that the plan passes within `within_m`, by time.
  [[nodiscard]] std::vector<Passage> passages(Time now, double within_m) const;

 private:
  [[nodiscard]] bool on_plan(const MotionState& own, Time now) const;
  void sample(const Trajectory& motion, double from_s) const;
  struct Approach {
    Passage passage;
    double contact_s, contact_speed;  ///< of the first contact; infinite, 0: there is none
  };
  /// The closest approach of the sampled motion to a body.
  [[nodiscard]] Approach closest(const MovingBody& body, Time now) const;
  /// The closest passage and the first contact of a motion that starts now.
  [[nodiscard]] Approach worst_of(const Trajectory& motion, Time now) const;
  /// The roles now; parts the bodies that the plan leaves out, and makes the zones.
  void follow_rules(const MotionState& own, Time now);
  /// Distance of the vehicle's place from a shape that the search keeps.
  [[nodiscard]] double kept_m(double margin_m) const;
  /// Whether the motion found keeps course and speed to the goal for the time in which the bodies left out count not.
  [[nodiscard]] bool goes_straight(const MotionState& own) const;
  /// From here on the plan counts the bodies that were left out.
  void count_all_bodies();
  [[nodiscard]] bool plan_is_free(Time now, double margin_m) const;
  /// The best motion along the road map, at the full margin.
  std::optional<RoadMotion> search_roads(const MotionState& own, Time now);
  /// A motion among these bodies that arrives before a time.
  bool search(std::span<const MovingBody> bodies, const MotionState& own, Time now, double margin_m, double before_s);
  /// One that keeps out of the zones, at the full margin.
  bool search_by_rules(const MotionState& own, Time now);
  void take_found(Time now, double margin_m, bool keeps_zones);
  /// After a change of the plan or of the zones.
  void note_departure();
  /// To rest straight ahead, if that keeps the margin.
  bool take_stop(const MotionState& own, Time now);
  void take_least_harm(const MotionState& own, Time now);

  TrafficConfig config_;
  TrafficVehicle vehicle_;
  TrafficSearch search_;
  TrafficRoads roads_;
  bool has_roads_ = false;  ///< in this step
  PredictedTraffic traffic_;
  Eigen::Vector2d goal_W_ = Eigen::Vector2d::Zero();
  double arrival_m_ = 0;
  std::vector<MovingBody> bodies_;    ///< that the plan counts
  std::vector<MovingBody> left_out_;  ///< toward which the vehicle keeps course and speed
  RulesOfTheRoad rules_;
  RulesOfTheRoad::Zones zones_;
  Time ruled_;                          ///< when a search last found a motion that follows the rules
  bool keeps_zones_ = true;             ///< the plan
  std::vector<MovingBody> with_zones_;  ///< bodies and zones
  struct Sample {
    double time_s;  ///< from now
    Eigen::Vector2d p_W;
  };
  mutable std::vector<Sample> samples_;
  TrafficPlan plan_;
  Trajectory found_;
  TrafficSearchResult result_;
  std::optional<Time> searched_;
  TrafficWork work_;
};

}  // namespace isobath
