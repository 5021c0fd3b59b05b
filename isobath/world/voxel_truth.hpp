// VoxelTruth: how well the voxel map of a simulated run agrees with the scene. Figures only: what makes them
// (voxel_scorer.hpp) knows the scene, a vehicle does not.
#pragma once

#include <array>
#include <cstdint>

namespace isobath {

struct VoxelTruth {
  std::uint64_t judged = 0;
  std::uint64_t surface = 0;   ///< truly occupied voxels
  std::uint64_t found = 0;     ///< truly occupied voxels with an occupied voxel of the map within one voxel
  std::uint64_t occupied = 0;  ///< voxels that the map calls occupied
  std::uint64_t right = 0;     ///< voxels that the map calls occupied, with a surface within one voxel
  double log_loss = 0;         ///< mean of -ln P(true state), nats per voxel; P within [1e-4, 1 - 1e-4]
  struct Said {
    std::uint64_t voxels = 0, surface = 0;
    double probability = 0;  ///< mean probability in the map
  };
  std::array<Said, 10> by_probability{};  ///< [0, 0.1), [0.1, 0.2) ...

  [[nodiscard]] double precision() const;  ///< 0 if the map has no occupied voxel
  [[nodiscard]] double recall() const;     ///< 0 if there is no surface
};

}  // namespace isobath
