// TruthJudge: how well a run saw what was there. Only for simulated runs, where the truth of every sample is known.
//
// Each scan's obstacles are held against the bodies of the scene in plan. An obstacle belongs to a body if their
// outlines come within a tolerance of each other: half a beam's width at that range, a range bin and a cell. One that
// belongs to no body is an echo of the bottom, of the surface, or a mirror image of something, if samples of the sweep
// that came from there are labelled so; else it is a false alarm. Positions are compared in the true world: an error of
// navigation counts. The other pieces of an obstacle (Obstacle::number) that belongs to a body belong to it as well, up
// to kAttached_m from it: side lobes and echoes of its upper and lower parts draw a body larger than it is. Delay:
// pings whose truth held the body above the background, up to the end of the first scan that shows it.
//
// Apart from where an obstacle comes from, what it does to the vehicle: a false obstacle is one that the map is sure of
// (existence from kSureObstacle on) with nothing there that the vehicle would have to avoid: near no body, and over a
// bottom that lies deeper than the hull and 1 m.
#pragma once

#include <isobath/map/obstacle.hpp>
#include <isobath/runtime/onboard_observer.hpp>
#include <isobath/runtime/scenario.hpp>
#include <string>
#include <unordered_map>
#include <vector>

namespace isobath {

inline constexpr double kSureObstacle = 0.95;  ///< existence from which a false obstacle counts
inline constexpr double kNearObstacle_m = 20;  ///< from the vehicle: what its planner acts on
inline constexpr double kAttached_m = 2;       ///< of a body: pieces of its obstacle that stand so near are no others
inline constexpr double kAboveAndBelow_m = 1;  ///< beyond the hull: what is there has to be avoided

struct BodyScore {
  std::string name;
  int pings_heard = 0;  ///< in which a sample of it stood above the background
  int scans_found = 0;
  int delay_pings = 0;            ///< of those heard, before it was found
  double delay_s = 0;             ///< from the first that was heard
  double first_range_m = 0;       ///< where it was found first
  bool compact = false;           ///< below 6 m across: has one range; the errors of others mean nothing
  double range_error_mean_m = 0;  ///< nearest point as reported less as it is, over all scans that show it
  double range_error_rms_m = 0;
  double range_error_worst_m = 0;  ///< largest in size
};

struct TruthScore {
  int scans = 0;
  std::vector<BodyScore> bodies;  ///< those that were heard
  int obstacles = 0;              ///< over all scans; each is one of:
  int of_bodies = 0, of_bottom = 0, of_surface = 0, of_mirrors = 0, false_alarms = 0;
  int scans_with_false_alarms = 0;
  int false_obstacles = 0, near_false_obstacles = 0;  ///< over all scans; near: within kNearObstacle_m
};

class TruthJudge : public SimulatedSource::TruthSink, public OnboardObserver {
 public:
  explicit TruthJudge(Simulator& simulator);

  void take(const EchoTruth& echoes) override;
  void take(const TrueMotion& motion) override;
  void on_ping(const PosedPing& ping) override;
  void on_scan(const ScanResult& scan) override;

  [[nodiscard]] const TruthScore& score();
  /// Outlines of all bodies where they are now, in L of the last scan (x forward, y starboard), for pictures.
  [[nodiscard]] std::vector<Polygon> outlines() const;

 private:
  enum Kind : std::uint8_t { kBottomEcho = 1, kSurfaceEcho = 2, kMirrorEcho = 4 };
  struct Watch {
    BodyScore score;
    double first_heard_s = -1;
    double error_sum = 0, error_squares = 0;
  };
  [[nodiscard]] std::uint8_t kinds_near(const Polygon& outline, double within) const;
  /// Of every body, where it is now.
  [[nodiscard]] std::vector<std::vector<Polygon>> plans_now() const;
  [[nodiscard]] Pose true_level_pose(Time time) const;
  /// Whether the bottom there is one that the vehicle cannot go over.
  [[nodiscard]] bool bottom_in_the_way(const Polygon& outline) const;

  Simulator& simulator_;
  std::vector<Watch> bodies_;
  std::unordered_map<std::int64_t, std::uint8_t> marks_, last_marks_;  ///< by square metre of the world
  std::vector<EchoTruth> waiting_;                                     ///< for their pings
  std::vector<TrueMotion> motions_;                                    ///< the last few
  double beam_ = 0, bin_ = 0;
  Pose X_WL_;
  double keel_m_ = 0;  ///< depth that the vehicle needs under its middle
  TruthScore score_;
};

}  // namespace isobath
