// GridSnapshots: one writer's spherical grid for any number of readers in threads of their own: a navigator, the
// control of the scan, modelling, positioning (Auran, Silven 1995, 2 and figure 1; ledger S4-48).
//
// The writer publishes a copy when it has one to show, at the end of a scan; readers take the newest and keep it as
// long as they like: it never changes. No reader holds up the writer or another reader. Copies that nobody holds any
// more are used again, so there are never more than readers hold, and two; their arrays keep their room.
//
// publish() from one thread, newest() from any. Snapshots outlive this object. Cost: a copy of 8,000 cells takes 0.2
// ms.
#pragma once

#include <isobath/geometry/pose.hpp>
#include <isobath/map/spherical_grid.hpp>
#include <memory>
#include <mutex>
#include <vector>

namespace isobath {

struct GridSnapshot {
  explicit GridSnapshot(const SphericalGridConfig& config) : grid(config) {}
  std::uint64_t version = 0;  ///< from 1, one more each time
  Time time{};
  Pose X_WB;  ///< where the vehicle was: the grid's origin
  SphericalGrid grid;
};

class GridSnapshots {
 public:
  explicit GridSnapshots(const SphericalGridConfig& config);

  /// `grid` has the same configuration.
  void publish(const SphericalGrid& grid, Time time, const Pose& X_WB);
  /// Null before the first.
  [[nodiscard]] std::shared_ptr<const GridSnapshot> newest() const;
  /// Copies that exist, in use or not.
  [[nodiscard]] std::size_t copies() const;

 private:
  /// Copies that nobody holds. Shared with what gives them back, which may be later than the end of this object.
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
