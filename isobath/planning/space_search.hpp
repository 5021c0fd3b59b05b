// SpaceSearch: A* in the clearance field of a box of water, for a path in three dimensions (space_route.hpp): 26
// neighbours, cells as wide as the vehicle's steepest climb requires. It also states what holds for any leg of such a
// path: the room that it keeps, its price, its climb. Internal to space_route.cpp.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/planning/clearance_field.hpp>
#include <isobath/planning/route_planner.hpp>
#include <isobath/planning/space_route_task.hpp>
#include <limits>
#include <vector>

namespace isobath {

using SpaceWay = std::vector<Eigen::Vector3d>;

class SpaceSearch {
 public:
  static constexpr double kLittle = 0.1;  ///< m that a start that is hemmed in may lose between centres of voxels

  SpaceSearch(const ClearanceField& room, const SpaceRouteTask& task, const SpaceRouteConfig& config);

  /// Aims at the farthest place on the straight line to the goal that is within reach and clear; false if there is
  /// none.
  bool aim();
  [[nodiscard]] const Eigen::Vector3d& target() const { return target_; }
  /// From a place to the target.
  Result<SpaceWay, RouteRefusal> search(const Eigen::Vector3d& from);
  [[nodiscard]] int expanded() const { return expanded_; }

  [[nodiscard]] double room_at_start() const { return at_start_; }
  /// For a start that is hemmed in, the required distance grows by half a metre per metre travelled.
  [[nodiscard]] double need_at(const Eigen::Vector3d& p) const;
  /// Whether a leg keeps the required distance.
  [[nodiscard]] bool keeps(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;
  [[nodiscard]] double leg_price(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;
  [[nodiscard]] bool can_climb(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;

 private:
  struct Node {
    float cost = std::numeric_limits<float>::infinity();
    std::int16_t came_by = -1;
    bool closed = false;
  };
  [[nodiscard]] std::size_t node_of(const VoxelIndex& cell) const;
  [[nodiscard]] VoxelIndex voxel_of(std::size_t node) const;
  [[nodiscard]] double price(const Eigen::Vector3d& p) const;
  [[nodiscard]] bool is_allowed(const Eigen::Vector3d& p) const;
  [[nodiscard]] bool is_open(const VoxelIndex& voxel) const;
  [[nodiscard]] bool can_be_reached(const VoxelIndex& last) const;
  [[nodiscard]] SpaceWay way_to(std::size_t node, const Eigen::Vector3d& from) const;

  const ClearanceField& room_;
  const SpaceRouteTask& task_;
  const SpaceRouteConfig& config_;
  double band_, need_, at_start_;
  Eigen::Vector3d target_ = Eigen::Vector3d::Zero();
  int wide_ = 1;  ///< voxels per cell along north and east; one along depth
  VoxelIndex origin_ = VoxelIndex::Zero(), cells_ = VoxelIndex::Zero();
  std::vector<Node> nodes_;
  int expanded_ = 0;
};

}  // namespace isobath
