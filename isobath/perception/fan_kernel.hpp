// Fan kernel: the vectorised part of FanMapper, one block of voxels against one ping. The instruction set is chosen at
// run time; all give the same bits.
#pragma once

#include <cstdint>
#include <isobath/map/voxel/voxel_blocks.hpp>
#include <vector>

namespace isobath {

/// A ping prepared for look-ups by voxels, in metres about the sensor. Counts over a rectangle of (beam, bin) cells
/// take four look-ups in a summed-area table.
struct FanView {
  // Frames: p_S = R_SW (p_W - p_WS); a step of one voxel along an axis of W moves p_S by a column of `step`.
  float step[3][3];  ///< [axis of W][component in S], m
  float voxel_m;
  float ceiling_m;  ///< m down from the sensor: voxels whose centre is above this are not water
  float slab_m;     ///< half-height of the fan where the cone is thinner than a voxel, m
  float sine;       ///< sine of half the fan's height
  float start_m, bins_per_m;
  std::int32_t beams, bins;
  float looks_per_beam;  ///< spacing over width: independent looks per additional beam, at most 1
  float max_looks;
  /// Counts of beams at a direction, by its pseudo-angle (see fan_kernel.cpp): the number of beams wholly to its left,
  /// plus 65536 times the number of beams that begin to its left.
  static constexpr int kDirections = 8192;
  const std::int32_t* beams_at;
  /// (beams + 1) x (bins + 1): over all cells before it in both axes, the number of hits, plus 65536 times the number
  /// of informative cells.
  const std::int32_t* sums;
  const float* clear;   ///< by bin: evidence of a look without an echo, units of LogOdds16
  float uniform_clear;  ///< the same if it is equal for all bins, else 0
  /// The share of `clear` that counts, by the voxel's present evidence: 2^kStepLog2 units per entry from kMinStep.
  /// Null: all of it.
  static constexpr int kStepLog2 = 4, kSteps = 1024, kMinStep = -512;
  const float* saturation;
};

/// A voxel for the scalar code: some cells of its rectangle [bin, bin_end) x [beam, beam_end) hold echoes or are not
/// informative.
struct MixedVoxel {
  std::int32_t offset;  ///< index in the block
  std::int32_t bin, bin_end, beam, beam_end;
  std::int32_t own = 0;  ///< its own share in the explanation of an echo in one of its cells (FanMapper)
};

/// Adds the evidence of those voxels of a block whose cells are all clear, and lists the others. `corner`: centre of
/// the block's first voxel relative to the sensor, along W, m.
void look_at_block(const FanView& view, const float (&corner)[3], const EvidenceBounds& bounds, LogOdds16* block,
                   std::vector<MixedVoxel>& mixed);

/// Index in `beams_at` of a direction vector of any length but zero.
int direction_index(float x, float y);

}  // namespace isobath
