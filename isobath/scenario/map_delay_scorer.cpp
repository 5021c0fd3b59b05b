#include <algorithm>
#include <cmath>
#include <isobath/geometry/polygon_parts.hpp>
#include <isobath/scenario/map_delay_scorer.hpp>
#include <isobath/world/depth_model.hpp>

namespace isobath {
namespace {

constexpr double kSlack_m = 1, kBelowVehicle_m = 1;

}  // namespace

MapDelayScorer::MapDelayScorer(const Simulator& simulator, double range_cap_m)
    : simulator_(simulator), range_cap_m_(range_cap_m) {
  for (const WorldBody& body : simulator.world().bodies()) watches_.push_back({{body.name}, body.moves, 0});
}

void MapDelayScorer::on_event(const Event& event) {
  if (const auto* fix = std::get_if<Navigation>(&event)) {
    error_ = fix->X_WB.translation.head<2>() - X_WB_.translation.head<2>();
  }
  if (const auto* reading = std::get_if<RangeReading>(&event)) hear(*reading);
}

void MapDelayScorer::hear(const RangeReading& reading) {
  if (!reading.range_m || *reading.range_m > range_cap_m_) return;
  const Eigen::Vector3d ray = X_WB_.rotation * (reading.X_BS.rotation * Eigen::Vector3d::UnitX());
  if (ray.z() > std::sqrt(0.5)) return;  // it looks down
  const Eigen::Vector3d end = X_WB_ * (reading.X_BS * Eigen::Vector3d(*reading.range_m, 0, 0));
  const double tolerance_m = kSlack_m + *reading.range_m * std::tan(reading.width.radians() / 2);
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    Watch& watch = watches_[i];
    const WorldBody& body = simulator_.world().bodies()[i];
    if (watch.heard || body.moves || distance_from(body.plan, end.head<2>()) > tolerance_m) continue;
    watch.heard = true;
    watch.tolerance_m = tolerance_m;
    watch.body.first_echo_s = to_seconds(reading.time);
    watch.body.first_echo_m = *reading.range_m;
  }
}

void MapDelayScorer::on_mapped(Time time, const Pipeline&, const DepthModel& depths, const VoxelModel&) {
  if (to_seconds(time) < next_look_s_) return;
  next_look_s_ = to_seconds(time) + kLook_s;
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    Watch& watch = watches_[i];
    const bool waits = watch.heard && watch.body.in_map_s < 0 && watch.body.first_echo_m > 0;
    if (waits && stands(depths, i, watch.tolerance_m)) watch.body.in_map_s = to_seconds(time);
  }
}

bool MapDelayScorer::stands(const DepthModel& depths, std::size_t body, double tolerance_m) const {
  const auto map = depths.snapshot();
  if (!map) return false;
  const WorldBody& truth = simulator_.world().bodies()[body];
  const Eigen::Vector2d half = Eigen::Vector2d::Constant(tolerance_m);
  const Pixel a = map->grid().at(truth.box.min().head<2>() + error_ - half);
  const Pixel b = map->grid().at(truth.box.max().head<2>() + error_ + half);
  const double shallow_m = X_WB_.translation.z() + kBelowVehicle_m;
  for (int row = std::min(a.row, b.row); row <= std::max(a.row, b.row); ++row) {
    for (int column = std::min(a.column, b.column); column <= std::max(a.column, b.column); ++column) {
      const DepthPixel pixel = map->at({column, row});
      if (!pixel.known() || !pixel.has(kSeenByObstacle) || pixel.depth_m() > shallow_m) continue;
      if (distance_from(truth.plan, map->grid().centre({column, row}) - error_) <= tolerance_m) return true;
    }
  }
  return false;
}

std::vector<MappedBody> MapDelayScorer::bodies() const {
  std::vector<MappedBody> heard;
  for (const Watch& watch : watches_) {
    if (watch.heard && watch.body.first_echo_m > 0) heard.push_back(watch.body);
  }
  return heard;
}

}  // namespace isobath
