// VoxelTruth: a map in three dimensions held against the scene that it was made of.
//
// A voxel is truly occupied where a surface of the scene (bottom or body, where they stand now) crosses one of the
// three axes through its centre, within its cube. What lies wholly below the bottom is left out: no sonar looks there.
// All other voxels that any sensor has looked at are judged; the inside of a body, which sonar does not reach either,
// counts as empty where something was said of it.
//
// Cost: about a microsecond a voxel. One thread.
#pragma once

#include <array>
#include <cstdint>
#include <isobath/map/voxel_map.hpp>
#include <isobath/sim/world.hpp>

namespace isobath {

struct VoxelTruth {
  std::uint64_t judged = 0;
  std::uint64_t surface = 0;   ///< of these, truly occupied
  std::uint64_t found = 0;     ///< of these, with an occupied voxel of the map within one voxel
  std::uint64_t occupied = 0;  ///< said to be
  std::uint64_t right = 0;     ///< of these, with a surface within one voxel
  double log_loss = 0;         ///< mean of -ln P(what is true), nats a voxel; P within [1e-4, 1 - 1e-4]
  struct Said {
    std::uint64_t voxels = 0, surface = 0;
    double probability = 0;  ///< mean of what was said
  };
  std::array<Said, 10> by_probability{};  ///< [0, 0.1), [0.1, 0.2) ...

  [[nodiscard]] double precision() const;  ///< 0 where nothing is said to be occupied
  [[nodiscard]] double recall() const;     ///< 0 where there is no surface
};

/// Of every so many of the seen voxels, in the order of the map.
VoxelTruth judge(const VoxelMap& map, const World& world, std::uint64_t every = 1);

}  // namespace isobath
