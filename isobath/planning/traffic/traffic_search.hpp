// TrafficSearch: best-first search for a motion in time that keeps clear of moving bodies (ledger S3-01, S3-22).
//
// A node is a state of the vehicle (position, heading, speed) at a whole step of time; from it lead the arcs of five
// curvatures at three accelerations. Nodes are taken in the order of their time of arrival at the goal in open water
// (direct_motion), which is exact beyond the horizon and a lower bound within it, less a small reward for each step
// that they lie ahead. A node whose direct motion is free up to the horizon, or to the goal, ends the search, if from
// its end the vehicle can escape: brake to rest and stay clear for a time, or, where it cannot stop, circle at its
// minimum speed. Of nodes in the same cell of position, heading, speed and time the first is kept, unless a later one
// arrives earlier. The number of nodes that are expanded is bounded. After an
// eighth of them, turns of all angles from the start with straight motions after them are added, which lead round wide
// bodies; the best motion found so far ends the search after half of the bound. Where there is none, the reward rises,
// and at the bound the motion that stays free longest and ends in an escape is taken. No clock is read: the result
// depends on the input alone.
//
// With a guide (the corners of a path past what lies still) the goal of a node is the corner that its predecessor goes
// to, or the first later one from which another corner or the goal is in sight; its time of arrival counts the rest of
// the path at full speed. So the search is not drawn into dead ends that are larger than its horizon (S3-22, S3-26).
//
// Without reward the motion found is the fastest of those that consist of the arcs and one direct motion, up to the
// merging of cells; a reward of w per second makes it later by at most w times the horizon.
#pragma once

#include <isobath/planning/roadmap/grown_obstacles.hpp>
#include <isobath/planning/traffic/predicted_traffic.hpp>
#include <isobath/planning/traffic/vehicle_motion.hpp>

namespace isobath {

struct TrafficSearchConfig {
  double horizon_s = 20;       ///< free motion that is looked for
  double clear_s = 3;          ///< time at rest, or on the circle, that the escape must stay clear
  double depth_reward = 0.06;  ///< seconds of arrival for each second that a node lies ahead
  int max_expansions = 2500;
};

std::vector<Field> fields(TrafficSearchConfig& config);

enum class SearchEnd : std::uint8_t {
  kHorizon,  ///< free up to the horizon or the goal, and an escape from there
  kEscape,   ///< the bound was met, or no motion reaches the horizon: free for some steps, then an escape
  kNone,     ///< no motion with an escape was found
};

struct TrafficSearchResult {
  SearchEnd end = SearchEnd::kNone;
  double arrival_s = 0;  ///< from the start, beyond the horizon in open water
  double free_s = 0;     ///< duration before the escape
  int expansions = 0;
};

/// A path past what lies still, for the cost beyond the horizon.
struct TrafficGuide {
  std::vector<Eigen::Vector2d> corners_W;  ///< after the start; the last one is the goal
  std::vector<double> rest_m;              ///< along the path from each corner to the goal
  const GrownObstacles* still = nullptr;   ///< that hide a corner from a place
};

/// Keeps its memory from search to search. One thread at a time.
class TrafficSearch {
 public:
  static constexpr double kStep_s = 1;
  static constexpr int kPieces = 2;  ///< chords of a step

  TrafficSearch(const TrafficSearchConfig& config, const TrafficVehicle& vehicle);

  /// Steps for which the traffic must be predicted.
  [[nodiscard]] int steps() const { return horizon_ + escape_; }
  /// Greatest distance of a motion from its chords, m.
  [[nodiscard]] double chord_error_m() const;
  /// Length of the longest chord, m.
  [[nodiscard]] double piece_m() const { return vehicle_.max_speed * kStep_s / kPieces; }

  /// `traffic` must have been built for `steps()` steps of kStep_s. Writes the motion, with the escape at its end. The
  /// goal of a guide, if one is given, is `goal_W`. Only motions are looked for that arrive before `before_s`; if that
  /// is finite, half of the expansions are spent on them at most, and a motion that ends before the horizon is none.
  TrafficSearchResult search(const PredictedTraffic& traffic, const MotionState& start, const Eigen::Vector2d& goal_W,
                             double arrival_m, const TrafficGuide* guide, double before_s, Trajectory& motion);

 private:
  struct Node {
    MotionState state;
    double arrival_s;
    int parent, step;
    double curvature, acceleration;  ///< of the arc that leads to it
    bool direct_meets = false;       ///< the direct motion from here meets a body
    int corner = 0;                  ///< of the guide, to which it goes
  };
  struct Open {
    double priority;
    int node;
  };
  struct Slot {
    std::uint64_t key;
    std::uint32_t search;
    int node;
  };
  [[nodiscard]] double priority_of(const Node& node) const;
  /// From here on deeper nodes come first, so that a motion is found before the bound.
  void hurry();
  void expand(int node);
  void add(const Node& node);
  /// Whether the arc from one node to the next is the beginning of the direct motion.
  [[nodiscard]] bool is_direct(const Node& from, const Node& to) const;
  [[nodiscard]] bool arc_is_free(const Node& from, const Node& to) const;
  /// Last step of the direct motion that must be free; 0: the direct motion meets a body, or there is none.
  int free_direct(const Node& node, DirectMotion& motion) const;
  /// The curvature of an escape from a state at a step, if one stays clear.
  [[nodiscard]] std::optional<double> escape(const MotionState& state, int step) const;
  void append_escape(double curvature, Trajectory& motion) const;
  /// The direct motion to the goal, or to a corner of the guide.
  [[nodiscard]] std::optional<DirectMotion> direct_to(const MotionState& state, int corner) const;
  /// The last corner of the guide that is in sight, from the given one on.
  [[nodiscard]] int corner_from(const MotionState& state, int corner) const;
  [[nodiscard]] bool goes_to_goal(int corner) const;
  [[nodiscard]] double arrival_of(const MotionState& state, int step, int corner) const;
  Slot& slot_of(const Node& node);
  void write(int node, Trajectory& motion) const;
  /// A motion that is free up to the horizon or the goal: node, direct motion, escape.
  struct Finish {
    int node, last;  ///< last step before the escape; 0: none
    double arrival_s, escape_curvature;
    DirectMotion direct;
  };
  [[nodiscard]] double reachable_speed(double speed, double acceleration) const;
  /// Adds one step of a turn or straight on, if it is free; returns its node, or -1.
  int roll(int node, double curvature, double acceleration);
  /// Adds, from the start, turns of all angles with straight motions after them, at rising, constant and falling speed.
  void add_turns();
  /// Whether a motion through this node is free and earlier than the best so far; keeps it.
  bool try_finish(int node);
  void write_best(TrafficSearchResult& result, Trajectory& motion) const;
  void fall_back(TrafficSearchResult& result, Trajectory& motion);

  TrafficSearchConfig config_;
  TrafficVehicle vehicle_;
  int horizon_ = 0, escape_ = 0;  ///< steps
  const PredictedTraffic* traffic_ = nullptr;
  Eigen::Vector2d goal_W_ = Eigen::Vector2d::Zero();
  double arrival_m_ = 0, reward_ = 0;
  const TrafficGuide* guide_ = nullptr;
  std::vector<Node> nodes_;
  std::vector<Open> open_;
  std::vector<Slot> slots_;
  std::vector<int> order_;
  Finish best_{};
  std::uint32_t searches_ = 0;
};

}  // namespace isobath
