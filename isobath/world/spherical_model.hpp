// SphericalModel: the spherical grid of a run: what all sonars of the vehicle have heard, by direction and range,
// around the vehicle and moving with it (Auran, Silven 1995, 2 and 4; ledger S4-01, S4-05, S4-36, S4-48, S4-50).
//
// Every ping of a fan, horizontal or vertical, every range and every sounding in the body frame goes into one grid.
// Beams that are narrower than a bucket of directions are taken together, and the nearest echo of them counts. The
// beam of a fan is taken for a cone of its width, in the middle of its height: the grid holds an echo at the level of
// the sonar's axis, though it may come from above or below.
//
// A jump of the position (Pipeline) does not change the distance from vehicle to obstacle, and does not move the grid.
// A scan ends with each sweep of a horizontal sonar, and every kScan without one. Then a copy of the grid is published:
// any thread may read it (`newest`).
//
// Errors: the constructor throws Error if the configuration cannot work. One thread, but for `newest`.
#pragma once

#include <cstdint>
#include <isobath/map/spherical/grid_snapshots.hpp>
#include <isobath/map/spherical/spherical_passage.hpp>
#include <isobath/perception/spherical_mapper.hpp>
#include <isobath/world/result_sinks.hpp>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

namespace isobath {

struct SphericalModelConfig {
  bool keep = true;
  std::string sonar;  ///< one of listed_resolution: gives range, layers and buckets; empty: those of `grid`
  /// Twice as coarse near the vehicle as the paper's grid: a run feeds it ten times as often.
  SphericalGridConfig grid{.min_layer_m = 0.3, .range_m = 100, .rebin_at = 1, .lock_echoes = 0};
  SphericalMapperConfig mapper{.contrast = 6};
};
std::vector<Field> fields(SphericalModelConfig& config);

/// Counts of the spherical grid of a run.
struct SphericalOutcome {
  std::uint64_t pings = 0, ranges = 0, swaths = 0, scans = 0;
  std::uint64_t cells = 0, occupied = 0, locked = 0, bytes = 0;
  double range_m = 0;
  WayAhead ahead;               ///< straight ahead, at the end of the run
  double empty_directions = 0;  ///< share of the directions at the vehicle's level without any echo, at the end (S4-11)
  std::string coarser;          ///< why the grid is coarser than one of the sonars; empty: it is not
};

class SphericalModel {
 public:
  static constexpr Duration kScan = std::chrono::seconds(2);

  explicit SphericalModel(const SphericalModelConfig& config);

  void update(const PosedPing& posed);
  void update(const RangeReading& reading, const Pose& X_WB);
  void update(const Swath& swath, const Pose& X_WB);
  /// The position jumped by this much: later poses agree with the new position.
  void move_along(const Eigen::Vector3d& jump_W) { jumped_ += jump_W; }
  /// Ends the scan at the last reading, and publishes the grid. Does nothing without a reading since the last scan.
  void end_scan();

  /// Null before the first reading.
  [[nodiscard]] const SphericalGrid* grid() const { return told() ? &grid_ : nullptr; }
  /// The vehicle's course at the last reading, in the axes of the grid.
  [[nodiscard]] Angle course() const { return X_WB_.rotation.heading() - grid_.turned(); }
  [[nodiscard]] bool course_up() const { return config_.mapper.axes == SphericalMapperConfig::Axes::kCourseUp; }
  /// The grid at the end of the last scan; null before.
  [[nodiscard]] std::shared_ptr<const GridSnapshot> newest() const { return snapshots_.newest(); }
  /// `radius_m`: of the vehicle, for the way ahead.
  [[nodiscard]] SphericalOutcome outcome(double radius_m) const;

 private:
  [[nodiscard]] bool told() const { return counts_.pings + counts_.ranges + counts_.swaths > 0; }
  [[nodiscard]] Pose without_jumps(const Pose& X_WB) const;
  void note(Time time, const Pose& X_WB);
  void compare(const SonarResolution& sonar);

  SphericalModelConfig config_;
  SphericalGrid grid_;
  SphericalMapper mapper_;
  GridSnapshots snapshots_;
  SphericalOutcome counts_;
  Eigen::Vector3d jumped_ = Eigen::Vector3d::Zero();
  Time scan_began_{}, last_{};
  Pose X_WB_;                                                   ///< of the last reading
  bool scanning_ = false;                                       ///< readings came since the last scan
  std::unordered_map<std::uint32_t, const Sounding*> nearest_;  ///< of a swath, by direction
  std::vector<const Sounding*> chosen_;                         ///< the same, in the order of the swath
};

}  // namespace isobath
