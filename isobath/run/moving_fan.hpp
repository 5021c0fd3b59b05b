// MovingFan: an observer of a run from a log. It places what a moving fan detects, remembers obstacles as a mission's
// detector does, and compares the poses with a reference track, if there is one.
#pragma once

#include <isobath/onboard/onboard_observer.hpp>
#include <isobath/report/placement_pages.hpp>
#include <isobath/report/run_outcome.hpp>
#include <isobath/world/placed_detections.hpp>
#include <isobath/world/track_drift.hpp>
#include <map>
#include <optional>
#include <vector>

namespace isobath {

class MovingFan final : public OnboardObserver {
 public:
  /// `reference`: empty: there is none.
  MovingFan(const ObstacleMemoryConfig& memory, PoseTimeline reference);

  void on_fix(const Navigation& fix) override;
  void on_ping(const PosedPing& ping) override;
  void on_scan(const ScanResult& scan) override;
  void on_soundings(const Swath& swath, const Pose& X_WB) override;

  /// Adds the sharpness and the drift to the outcome.
  void add_to(RunOutcome& outcome);
  /// For the pictures; after add_to.
  [[nodiscard]] PlacementView view(const RunOutcome& outcome) const;

 private:
  [[nodiscard]] std::vector<RememberedObstacle> remembered() const;
  [[nodiscard]] std::vector<KnownObstacle> known() const;

  PlacedDetections detections_;
  std::optional<PlacedDetections> by_reference_;
  ObstacleMemory memory_;
  std::map<std::uint32_t, Time> last_echo_;  ///< by id of the remembered obstacle
  std::optional<TrackDrift> drift_;
  std::vector<Eigen::Vector2d> track_;  ///< one place a scan
  std::optional<double> sigma_m_;       ///< of the position, as the last fix states it
  Eigen::Vector2d here_{0, 0};
  Angle heading_;
};

/// The poses of the track that a log is to be compared with (open_reference), in the frame of the log; empty: none.
PoseTimeline reference_of(const std::filesystem::path& input, const InputConfig& config,
                          const std::optional<GeoOrigin>& frame);

}  // namespace isobath
