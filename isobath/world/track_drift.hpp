// TrackDrift: how far the poses of a run are from those of a reference, and what that does to the obstacles that the
// vehicle remembers.
//
// A remembered obstacle stays where the vehicle saw it, while the estimated position drifts on. Two distances matter:
//   placed   of the obstacle from where the reference puts it, in W: what a chart made of it would be wrong by
//   moved    of the obstacle from where it is relative to the vehicle now: what the vehicle would miss its mark by. Its
//            margin (ObstacleMemory) is meant to cover it.
// With X the estimated and Y the reference pose at its last echo (1) and now (2), an obstacle at q in W really stands
// at Y1 X1^-1 q, and `moved` is the difference of X2^-1 q and Y2^-1 Y1 X1^-1 q. All poses are levelled. What counts is
// the last echo: the body grid goes on to show an obstacle that no beam meets any more, and moves it by the estimate.
//
// `add` is called at each scan with the obstacles known there; those with an echo in this very scan do not count. Scans
// at a time without a reference pose are left out. Deterministic. One thread.
#pragma once

#include <isobath/geometry/pose.hpp>
#include <isobath/vehicle/navigation.hpp>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

/// An obstacle that the vehicle knows.
struct KnownObstacle {
  Eigen::Vector2d middle{0, 0};  ///< of its outline in W, by the run's poses
  double margin_m = 0;           ///< how far it may be off, as the vehicle takes it
  Time last_echo;
};

struct DriftOutcome {
  std::size_t scans = 0;                         ///< with a reference pose
  double travelled_m = 0;                        ///< by the reference, from scan to scan
  double last_m = 0, rms_m = 0, max_m = 0;       ///< error of the position at the scans
  std::size_t remembered = 0;                    ///< obstacles at the end
  double placed_median_m = 0, placed_max_m = 0;  ///< of these
  std::size_t sightings = 0;                     ///< known obstacles without an echo in the scan, summed over the scans
  double moved_median_m = 0, moved_95_m = 0;     ///< of these
  double margin_median_m = 0;                    ///< of these
  double covered = 0;                            ///< share of these whose margin covers `moved`
  std::size_t cells = 0, reference_cells = 0;    ///< that the detections fill, by both tracks; 0: unknown
  double share_median = 0, share_95 = 0;  ///< `moved` as a share of the estimated path since, where that is 5 m or more
  std::vector<Eigen::Vector2d> estimate, reference;  ///< tracks, one place a scan
};

class TrackDrift {
 public:
  explicit TrackDrift(PoseTimeline reference) : reference_(std::move(reference)) {}

  void add(Time time, const Pose& X_WL, std::span<const KnownObstacle> known);
  /// Empty: no scan had a reference pose.
  [[nodiscard]] std::optional<DriftOutcome> outcome(std::span<const KnownObstacle> known) const;
  [[nodiscard]] const PoseTimeline& reference() const { return reference_; }

 private:
  struct Place {
    Time time;
    Pose X, Y;      ///< estimated and reference
    double path_m;  ///< estimated, from the first scan
  };
  /// The place of the first scan at or after a time; null: there is none.
  [[nodiscard]] const Place* place_at(Time time) const;

  PoseTimeline reference_;
  std::vector<Place> places_;  ///< by time
  std::vector<double> moved_m_, margin_m_, shares_;
};

}  // namespace isobath
