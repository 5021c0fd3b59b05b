// GridSnapshots: one writer's spherical grid for any number of reader threads: a navigator, the control of the scan,
// modelling, positioning (Auran, Silven 1995, 2 and figure 1; ledger S4-48).
//
// The writer publishes a copy of its grid at the end of a scan. Readers take the newest copy and keep it as long as
// they like: it never changes. No reader blocks the writer or another reader. Copies that no reader holds are used
// again, so at most two more exist than readers hold; their arrays keep their capacity.
//
// publish() from one thread, newest() from any. Snapshots may outlive this object. Cost: a copy of 8,000 cells takes
// 0.2 ms.
#pragma once

#include <isobath/geometry/pose.hpp>
#include <isobath/map/spherical/spherical_grid.hpp>
#include <memory>
#include <mutex>
#include <vector>

namespace isobath {

struct GridSnapshot {
  explicit GridSnapshot(const SphericalGridConfig& config) : grid(config) {}
  std::uint64_t version = 0;  ///< from 1, increases by one with each snapshot
  Time time{};
  Pose X_WB;  ///< the vehicle's pose: the grid's origin
  SphericalGrid grid;
};

class GridSnapshots {
 public:
  explicit GridSnapshots(const SphericalGridConfig& config);

  /// `grid` has the configuration that the constructor got.
  void publish(const SphericalGrid& grid, Time time, const Pose& X_WB);
  /// Null before the first snapshot.
  [[nodiscard]] std::shared_ptr<const GridSnapshot> newest() const;
  /// Copies that exist, in use or not.
  [[nodiscard]] std::size_t copies() const;

 private:
  /// Copies that no reader holds. Snapshots share it, because a reader may give one back after this object has ended.
  struct Unused {
    std::mutex mutex;
    std::vector<std::unique_ptr<GridSnapshot>> all;
    std::size_t made = 0;
  };

  SphericalGridConfig config_;
  std::shared_ptr<Unused> unused_;
  std::uint64_t version_ = 0;
  mutable std::mutex newest_mutex_;
  std::shared_ptr<const GridSnapshot> newest_;
};

}  // namespace isobath
