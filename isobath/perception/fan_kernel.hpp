// The vector part of FanMapper: one block of voxels against one ping. Instruction set chosen at run time; the same bits
// from each.
#pragma once

#include <cstdint>
#include <isobath/map/voxel_blocks.hpp>
#include <vector>

namespace isobath {

/// A ping as seen from the voxels, in metres about the sensor. Counts of a rectangle of (beam, bin) cells are four
/// look-ups in a summed-area table.
struct FanView {
  // Frames: p_S = R_SW (p_W - p_WS); a step of one voxel along an axis of W moves p_S by a column of `step`.
  float step[3][3];  ///< [axis of W][component in S], m
  float voxel_m;
  float ceiling_m;  ///< voxels whose centre is above this, down from the sensor, are no water
  float slab_m;     ///< half of the fan's height where the cone is thinner than a voxel, m
  float sine;       ///< of half the fan's height
  float start_m, bins_per_m;
  std::int32_t beams, bins;
  float looks_per_beam;  ///< spacing over width: independent looks that one more beam is worth, at most 1
  float most_looks;
  /// Beams at a direction, by its pseudo-angle (see fan_kernel.cpp): those wholly to its left, and 65536 times the
  /// number of those that begin to its left.
  static constexpr int kDirections = 8192;
  const std::int32_t* beams_at;
  /// (beams + 1) x (bins + 1): of the cells before it in both, the hits, and 65536 times those that tell anything.
  const std::int32_t* sums;
  const float* clear;   ///< of each bin: evidence of a voxel that was looked at and gave no echo, units of LogOdds16
  float uniform_clear;  ///< the same where it is that of all bins, else 0
  /// By what the voxel holds already, 2^kStepLog2 units an entry from kLeastStep: the share of `clear` that counts.
  /// Null: all of it.
  static constexpr int kStepLog2 = 4, kSteps = 1024, kLeastStep = -512;
  const float* saturation;
};

/// A voxel that needs a second look: some cells of its rectangle [bin, bin_end) x [beam, beam_end) hold echoes, or tell
/// nothing.
struct MixedVoxel {
  std::int32_t offset;  ///< in the block
  std::int32_t bin, bin_end, beam, beam_end;
  std::int32_t own = 0;  ///< what it explains itself of an echo in one of its cells (FanMapper)
};

/// Adds the evidence of all voxels of a block whose cells are clear, and lists those that are not. `corner`: centre of
/// the block's first voxel relative to the sensor, along W, m.
void look_at_block(const FanView& view, const float (&corner)[3], const EvidenceBounds& bounds, LogOdds16* block,
                   std::vector<MixedVoxel>& mixed);

/// Where the beams of a direction stand in `beams_at`, of any length but zero.
int direction_index(float x, float y);

/// For tests: names of the instruction sets that this processor has, the best first; and the use of one alone.
std::vector<const char*> fan_kernel_targets();
/// Throws Error where there is none of that name; empty: the best.
void use_fan_kernel_target(const char* name);

}  // namespace isobath
