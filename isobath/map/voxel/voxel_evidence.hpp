// The value of a voxel and the size of a block: definitions that blocks in memory (voxel_blocks.hpp) and blocks in a
// file (voxel_file.hpp) share.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <limits>

namespace isobath {

/// Voxel (i, j, k) is the cube [i, i + 1) x [j, j + 1) x [k, k + 1) times its edge, in W: north, east, down.
using VoxelIndex = Eigen::Vector3i;
/// 1/1024 of a natural logarithm of odds.
using LogOdds16 = std::int16_t;

/// The voxel of a point given in voxel edges; each coordinate must fit an int. (std::floor is a function call if the
/// target processor may lack the instruction.)
inline VoxelIndex floor_of(const Eigen::Vector3d& p) {
  const auto floored = [](double c) {
    const int cut = static_cast<int>(c);
    return cut - static_cast<int>(c < cut);
  };
  return {floored(p.x()), floored(p.y()), floored(p.z())};
}

inline constexpr LogOdds16 kUnseen = std::numeric_limits<LogOdds16>::min();
inline constexpr double kEvidenceUnit = 1.0 / 1024;
/// Rounds to the nearest step; saturates.
LogOdds16 to_evidence(double log_odds);
inline double to_log_odds(LogOdds16 evidence) { return kEvidenceUnit * evidence; }

struct EvidenceBounds {
  LogOdds16 least = -7066, most = 7066;  ///< 6.9, p = 0.001 and 0.999 on even odds (S5-15)
};

/// A block is a cube of voxels.
inline constexpr int kBlockSideLog2 = 4, kBlockVolume = 1 << 3 * kBlockSideLog2;
/// The lowest voxel of the block with this key (VoxelBlocks::key_of).
inline VoxelIndex corner_of_block(std::uint64_t key) {
  const auto part = [&](int shift) {  // the sign is the highest of 20 bits
    return static_cast<int>(static_cast<std::uint32_t>(key >> shift) << 12) >> 12 << kBlockSideLog2;
  };
  return {part(40), part(20), part(0)};
}

}  // namespace isobath
