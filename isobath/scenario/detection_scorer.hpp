// DetectionScorer: scores the detections of a run against ground truth. Only for simulated runs, where the true cause
// of every sample is known.
//
// The obstacles of each scan are compared in plan with the bodies of the scene. An obstacle belongs to a body if their
// outlines come within a tolerance of each other: half a beam width at that range, plus a range bin, plus a cell. An
// obstacle that belongs to no body is an echo of the bottom or the surface, or a mirror image, if samples of the sweep
// from there are labelled so; otherwise it is a false alarm. Obstacles are placed with the true pose of the vehicle.
// The other pieces of an obstacle (Obstacle::number) that touches a body belong to the body too, up to kAttached_m from
// it: side lobes, and echoes of its upper and lower parts, make a body look larger than it is.
// The delay of a body counts the pings whose ground truth held the body above the background, up to the end of the
// first scan that shows it.
//
// A false obstacle is defined by its effect on the vehicle, not by its cause: the map is sure of it (existence of at
// least kSureObstacle), but there is nothing to avoid: no body near, and a bottom deeper than the hull plus 1 m. It
// counts only where a ping since the last scan could have heard it: in its sector, and within its range. What the map
// remembers elsewhere is counted apart, because the drift of the navigation moves it off its body.
#pragma once

#include <isobath/map/occupancy/obstacle.hpp>
#include <isobath/onboard/onboard_observer.hpp>
#include <isobath/scenario/map_delay_scorer.hpp>
#include <isobath/scenario/motion_scorer.hpp>
#include <isobath/scenario/scenario.hpp>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace isobath {

inline constexpr double kSureObstacle = 0.95;  ///< minimum existence of a false obstacle
inline constexpr double kNearObstacle_m = 20;  ///< distance from the vehicle within which its planner acts
inline constexpr double kAttached_m = 2;       ///< maximum distance from a body of pieces that belong to it
inline constexpr double kAboveAndBelow_m = 1;  ///< margin above and below the hull in which bodies must be avoided

struct BodyScore {
  std::string name;
  int pings_heard = 0;  ///< pings in which a sample of the body stood above the background
  int scans_found = 0;
  int delay_pings = 0;            ///< such pings until it was found
  double delay_s = 0;             ///< from the first such ping until it was found
  double first_range_m = 0;       ///< range at which it was first found
  bool compact = false;           ///< below 6 m across: it has one range; range errors of other bodies mean nothing
  double range_error_mean_m = 0;  ///< reported minus true range of the nearest point, over all scans that show it
  double range_error_rms_m = 0;
  double range_error_worst_m = 0;  ///< the one with the largest magnitude
  double fix_offset_m = 0;         ///< from the body to the mean of its fixes, which are placed with the estimated pose
  double fix_spread_m = 0;         ///< root mean square distance of its fixes from their mean
};

struct TruthScore {
  int scans = 0;
  std::vector<BodyScore> bodies;  ///< bodies with at least one echo
  int obstacles = 0;              ///< over all scans; each is one of the following
  int of_bodies = 0, of_bottom = 0, of_surface = 0, of_mirrors = 0, false_alarms = 0;
  int scans_with_false_alarms = 0;
  int false_obstacles = 0, near_false_obstacles = 0;  ///< in view, over all scans; near: within kNearObstacle_m
  int unseen_false_obstacles = 0;                     ///< the same out of view
  std::vector<MappedBody> mapped;                     ///< bodies that range sonars heard, and the depth map
  MotionScore motion;                                 ///< of the bodies that move
};

class DetectionScorer : public SimulatedSource::TruthSink, public OnboardObserver {
 public:
  explicit DetectionScorer(Simulator& simulator);

  void on_truth(const EchoTruth& echoes) override;
  void on_truth(const TrueMotion& motion) override;
  void on_ping(const PosedPing& ping) override;
  void on_scan(const ScanResult& scan) override;

  [[nodiscard]] const TruthScore& score();
  /// Outlines of all bodies at their current positions, in L of the last scan (x forward, y starboard), for pictures.
  [[nodiscard]] std::vector<Polygon> outlines() const;

 private:
  enum Kind : std::uint8_t { kBottomEcho = 1, kSurfaceEcho = 2, kMirrorEcho = 4 };
  /// What a ping could hear: a sector in W.
  struct View {
    Eigen::Vector2d origin;
    Angle middle, half_width;
    double reach_m = 0;
  };
  struct Watch {
    BodyScore score;
    double first_heard_s = -1;
    double error_sum = 0, error_squares = 0;
    Eigen::Vector2d fix_sum = Eigen::Vector2d::Zero();  ///< of fixes less the true place of the body
    double fix_squares = 0;
    bool heard = false;                               ///< since the last scan
    Eigen::Vector2d moved = Eigen::Vector2d::Zero();  ///< until the last scan
  };
  [[nodiscard]] std::uint8_t kinds_near(const Polygon& outline, double within) const;
  /// The plan outlines of every body at its current position.
  [[nodiscard]] std::vector<std::vector<Polygon>> plans_now() const;
  void look(const Ping& ping, const Pose& X_WS);
  void compare_motion(const Detection& found);
  [[nodiscard]] bool in_view(const Polygon& outline) const;
  [[nodiscard]] Pose true_level_pose(Time time) const;
  /// Whether the bottom there is too shallow for the vehicle to pass over.
  [[nodiscard]] bool bottom_in_the_way(const Polygon& outline) const;

  Simulator& simulator_;
  std::vector<Watch> bodies_;
  std::unordered_map<std::int64_t, std::uint8_t> marks_, last_marks_;  ///< kinds of echoes, by square metre of W
  std::vector<View> views_;                                            ///< of the pings since the last scan
  std::vector<EchoTruth> waiting_;                                     ///< truths whose pings have not come yet
  std::vector<TrueMotion> motions_;                                    ///< the last few true motions
  double beam_ = 0, bin_ = 0;
  Pose X_WL_;
  double keel_m_ = 0;  ///< depth of water that the vehicle needs below its reference point
  MotionScorer motion_;
  std::optional<Time> compared_;  ///< when motions were last compared
  TruthScore score_;
};

}  // namespace isobath
