#include <isobath/map/spherical/grid_snapshots.hpp>
#include <utility>

namespace isobath {

GridSnapshots::GridSnapshots(const SphericalGridConfig& config)
    : config_(config), unused_(std::make_shared<Unused>()) {}

void GridSnapshots::publish(const SphericalGrid& grid, Time time, const Pose& X_WB) {
  std::unique_ptr<GridSnapshot> copy;
  {
    const std::lock_guard lock(unused_->mutex);
    if (!unused_->all.empty()) {
      copy = std::move(unused_->all.back());
      unused_->all.pop_back();
    } else {
      ++unused_->made;
    }
  }
  if (!copy) copy = std::make_unique<GridSnapshot>(config_);
  copy->version = ++version_;
  copy->time = time;
  copy->X_WB = X_WB;
  copy->grid.copy_from(grid);
  const auto give_back = [unused = unused_](GridSnapshot* last) {
    std::unique_ptr<GridSnapshot> owner(last);
    const std::lock_guard lock(unused->mutex);
    unused->all.push_back(std::move(owner));
  };
  std::shared_ptr<const GridSnapshot> shown(copy.release(), give_back);
  {
    const std::lock_guard lock(newest_mutex_);
    newest_.swap(shown);
  }
}  // the previous snapshot is given back here, outside the lock, unless a reader holds it

std::shared_ptr<const GridSnapshot> GridSnapshots::newest() const {
  const std::lock_guard lock(newest_mutex_);
  return newest_;
}

std::size_t GridSnapshots::copies() const {
  const std::lock_guard lock(unused_->mutex);
  return unused_->made;
}

}  // namespace isobath
