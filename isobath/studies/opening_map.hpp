// OpeningMap: the voxel map of the water before an opening, as a pair of fans makes it on an approach (ledger S5-40,
// S5-47, S5-58).
//
// An image is one look of each fan at each voxel that both fans see, within their range, and that no rock hides. A look
// at a voxel with a rock in it gives an echo with probability p_detect, at one without with probability false_alarm: a
// look can miss, and it can be wrong. The two fans are independent and have one layer each; the evidence of a look is
// the logarithm of the likelihood ratio, for an echo at most 1.9, so that one image alone makes no voxel occupied.
// Voxels have one metre. The same seed gives the same map.
//
// The sea has no other echoes: surface, bed and pylons bound the water and are not in it.
#pragma once

#include <isobath/base/random.hpp>
#include <isobath/planning/awareness.hpp>
#include <isobath/planning/opening_view.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct FanEchoes {
  double p_detect = 0.35;  ///< of a look at a rock; the rest shows another face, or is too faint (FanMapperConfig)
  double false_alarm = 0;  ///< of a look at water
  int seed = 1;
};
std::vector<Field> fields(FanEchoes& echoes);

/// A ball in the water.
struct Rock {
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  double radius_m = 0;
};

class OpeningMap {
 public:
  /// The water from start_W to the opening, as wide and high as the opening.
  OpeningMap(const Opening& opening, const Eigen::Vector3d& start_W, const FanPair& fans, const FanEchoes& echoes,
             const std::optional<Rock>& rock);

  /// Adds an image from a pose of the vehicle.
  void look(const Pose& X_WB);
  /// Share of the opening's voxels that the map holds free.
  [[nodiscard]] double free_share() const { return awareness(map_, face_).free_share; }
  /// Entropy of the water.
  [[nodiscard]] double bits_a_voxel() const { return awareness(map_, water_).bits_a_voxel(); }
  [[nodiscard]] const VoxelMap& map() const { return map_; }

 private:
  [[nodiscard]] bool is_hidden(const Eigen::Vector3d& sonar_W, const Eigen::Vector3d& p_W) const;

  FanPair fans_;
  FanEchoes echoes_;
  std::optional<Rock> rock_;
  WaterBox water_, face_;
  VoxelMap map_;
  Random random_;
};

}  // namespace isobath
