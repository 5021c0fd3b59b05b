// VoxelTruth: the score of a voxel map against the scene.
//
// A voxel is truly occupied if a surface of the scene (the bottom, or a body at its current position) crosses one of
// the three axes through its centre, within its cube. Voxels entirely below the bottom are left out, because no sonar
// looks there. All other voxels that any sensor has observed are scored. The inside of a body, which sonar does not
// reach either, counts as empty if the map holds evidence there.
//
// Cost: about a microsecond per voxel. One thread.
#pragma once

#include <array>
#include <cstdint>
#include <isobath/map/voxel_map.hpp>
#include <isobath/sim/world.hpp>

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

/// Scores every n-th observed voxel (n = `every`), in the order of the map.
VoxelTruth judge(const VoxelMap& map, const World& world, std::uint64_t every = 1);

}  // namespace isobath
