// A voxel's rectangle. Its cube spans, along any unit vector d of W, half a voxel times |d_x| + |d_y| + |d_z| on either
// side of its centre: exactly, along the line of sight for the bins and along the horizontal tangent of S for the
// beams. So the voxel that holds a point hears the cell that holds it.
//
// Directions are compared by a pseudo-angle p = y / (|x| + |y|), continued behind the sensor; it grows with the angle
// over the whole circle, [-2, 2], and costs one division. It changes with the angle by between 1/2 and 1, t = flat^2 /
// (|x| + |y|)^2, and t itself by at most 2 t: so q radians are no more than about q t (1 + q) <= q t (1 + 2 q t) of it.
// A voxel wider than half its distance is met by all beams.
//
// Only operations that IEEE 754 rounds exactly, in one order, and no fused ones: every instruction set gives the same.
#include <algorithm>
#include <cmath>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "isobath/perception/fan_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once an instruction set.
#include <hwy/highway.h>
#include <isobath/perception/fan_kernel.hpp>

HWY_BEFORE_NAMESPACE();
namespace isobath::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kSide = VoxelBlocks::kSide;
using Floats = hn::CappedTag<float, kSide>;
using Ints = hn::RebindToSigned<Floats>;
using Shorts = hn::Rebind<LogOdds16, Ints>;
using F = hn::Vec<Floats>;
using I = hn::Vec<Ints>;

HWY_INLINE HWY_ATTR F absolute(F v) { return hn::Abs(v); }

/// Where a pseudo-angle stands in the table of directions; what lies beyond its ends is at its ends.
HWY_INLINE HWY_ATTR I direction_of(F pseudo) {
  const Floats d;
  const F index = hn::Mul(hn::Add(pseudo, hn::Set(d, 2.0f)), hn::Set(d, FanView::kDirections / 4.0f));
  const F most = hn::Set(d, FanView::kDirections - 1.0f);
  return hn::ConvertTo(Ints(), hn::Min(hn::Max(index, hn::Zero(d)), most));
}

HWY_ATTR void look(const FanView& view, const float* corner, const EvidenceBounds& bounds, LogOdds16* block,
                   std::vector<MixedVoxel>& mixed) {
  const Floats d;
  const Ints di;
  const Shorts ds;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const F zero = hn::Zero(d), one = hn::Set(d, 1.0f), half_voxel = hn::Set(d, 0.5f * view.voxel_m);
  const F start = hn::Set(d, view.start_m), bins_per_m = hn::Set(d, view.bins_per_m);
  const F bins_f = hn::Set(d, static_cast<float>(view.bins)), sine2 = hn::Set(d, view.sine * view.sine);
  const F half = hn::Set(d, 0.5f), uniform = hn::Set(d, view.uniform_clear);
  const float reach = view.start_m + static_cast<float>(view.bins) / view.bins_per_m + 2 * view.voxel_m;
  const auto stride = static_cast<std::size_t>(view.bins) + 1;
  const F ceiling = hn::Set(d, view.ceiling_m);
  const F farthest2 = hn::Set(d, reach * reach);
  const F slab = hn::Set(d, view.slab_m), looks_per_beam = hn::Set(d, view.looks_per_beam);
  const F max_looks = hn::Set(d, view.max_looks);
  const I all_beams = hn::Set(di, view.beams), row = hn::Set(di, view.bins + 1);
  const I last_bin = hn::Set(di, view.bins - 1), low_bits = hn::Set(di, 0xFFFF);
  const I least = hn::Set(di, bounds.least), most = hn::Set(di, bounds.most);
  const float(&step)[3][3] = view.step;
  HWY_ALIGN std::int32_t at[5][kSide];

  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      // The column's first voxel in S, and its distance along W.
      const float fi = static_cast<float>(i), fj = static_cast<float>(j);
      const float wx = corner[0] + fi * view.voxel_m, wy = corner[1] + fj * view.voxel_m;
      float first[3];
      for (int c = 0; c < 3; ++c) {
        first[c] = (wx * step[0][c] + wy * step[1][c] + corner[2] * step[2][c]) / view.voxel_m;
      }
      const F across = hn::Set(d, std::abs(wx) + std::abs(wy));
      for (int k = 0; k < kSide; k += lanes) {
        const F height = hn::Iota(d, static_cast<float>(k));
        const F x = hn::Add(hn::Set(d, first[0]), hn::Mul(height, hn::Set(d, step[2][0])));
        const F y = hn::Add(hn::Set(d, first[1]), hn::Mul(height, hn::Set(d, step[2][1])));
        const F z = hn::Add(hn::Set(d, first[2]), hn::Mul(height, hn::Set(d, step[2][2])));
        const F flat2 = hn::Add(hn::Mul(x, x), hn::Mul(y, y)), z2 = hn::Mul(z, z);
        const F range2 = hn::Max(hn::Add(flat2, z2), hn::Set(d, 1e-6f));
        auto in = hn::Or(hn::Le(z2, hn::Mul(range2, sine2)), hn::Le(absolute(z), slab));
        const F wz = hn::Add(hn::Set(d, corner[2]), hn::Mul(height, hn::Set(d, view.voxel_m)));
        in = hn::And(in, hn::And(hn::Lt(range2, farthest2), hn::Ge(wz, ceiling)));
        if (hn::AllFalse(d, in)) continue;

        const F range = hn::Sqrt(range2);
        const F half_r = hn::Div(hn::Mul(half_voxel, hn::Add(across, absolute(wz))), range);
        const F bin_f = hn::Floor(hn::Mul(hn::Sub(hn::Sub(range, half_r), start), bins_per_m));
        const F end_f = hn::Add(hn::Floor(hn::Mul(hn::Sub(hn::Add(range, half_r), start), bins_per_m)), one);
        in = hn::And(in, hn::And(hn::Lt(bin_f, bins_f), hn::Gt(end_f, zero)));
        const I bin = hn::ConvertTo(di, hn::Max(bin_f, zero)), end = hn::ConvertTo(di, hn::Min(end_f, bins_f));

        // The tangent (-y, x, 0) of S, summed over the axes of W.
        F width = zero;
        for (int axis = 0; axis < 3; ++axis) {
          const F part = hn::Sub(hn::Mul(x, hn::Set(d, step[axis][1])), hn::Mul(y, hn::Set(d, step[axis][0])));
          width = hn::Add(width, absolute(part));
        }
        width = hn::Mul(width, half);  // times the distance in the plane; steps are voxels long
        const auto around = hn::Gt(hn::Add(width, width), flat2);
        const F spread = hn::Add(hn::Add(absolute(x), absolute(y)), hn::Set(d, 1e-6f));
        const F over = hn::Div(one, spread);
        const F turn = hn::Mul(hn::Mul(width, over), over), more_turn = hn::Add(turn, turn);
        const F to_edge = hn::Mul(turn, hn::Add(one, more_turn));
        const F slope = hn::Mul(y, over);
        const F behind = hn::Sub(hn::CopySign(hn::Set(d, 2.0f), y), slope);
        const F pseudo = hn::IfThenElse(hn::Lt(x, zero), behind, slope);
        const I left = hn::GatherIndex(di, view.beams_at, direction_of(hn::Sub(pseudo, to_edge)));
        const I right = hn::GatherIndex(di, view.beams_at, direction_of(hn::Add(pseudo, to_edge)));
        const auto around_i = hn::RebindMask(di, around);
        const I beam = hn::IfThenZeroElse(around_i, hn::And(left, low_bits));
        const I beam_end = hn::IfThenElse(around_i, all_beams, hn::ShiftRight<16>(right));
        const auto in_i = hn::And(hn::RebindMask(di, in), hn::Lt(beam, beam_end));
        if (hn::AllFalse(di, in_i)) continue;

        // Most columns are clear all through: four look-ups for their common rectangle then do for all lanes.
        const I cells = hn::Mul(hn::Sub(end, bin), hn::Sub(beam_end, beam));
        const I none = hn::Zero(di), many = hn::Set(di, 1 << 20);
        const int bin_min = hn::GetLane(hn::MinOfLanes(di, hn::IfThenElse(in_i, bin, many)));
        const int bin_max = hn::GetLane(hn::MaxOfLanes(di, hn::IfThenElse(in_i, end, none)));
        const int beam_min = hn::GetLane(hn::MinOfLanes(di, hn::IfThenElse(in_i, beam, many)));
        const int beam_max = hn::GetLane(hn::MaxOfLanes(di, hn::IfThenElse(in_i, beam_end, none)));
        const auto before = [&](int row_before, int bin_before) {
          return static_cast<std::uint32_t>(
              view.sums[static_cast<std::size_t>(row_before) * stride + static_cast<std::size_t>(bin_before)]);
        };
        const std::uint32_t common = before(beam_max, bin_max) - before(beam_min, bin_max) - before(beam_max, bin_min) +
                                     before(beam_min, bin_min);
        const std::uint32_t area =
            static_cast<std::uint32_t>(bin_max - bin_min) * static_cast<std::uint32_t>(beam_max - beam_min);
        I total = hn::ShiftLeft<16>(cells);
        if (area >= 0x10000 || common != area << 16) {
          const I begin_row = hn::Mul(hn::IfThenElseZero(in_i, beam), row);
          const I end_row = hn::Mul(hn::IfThenElseZero(in_i, beam_end), row);
          total = hn::Sub(hn::Add(hn::GatherIndex(di, view.sums, hn::Add(end_row, end)),
                                  hn::GatherIndex(di, view.sums, hn::Add(begin_row, bin))),
                          hn::Add(hn::GatherIndex(di, view.sums, hn::Add(end_row, bin)),
                                  hn::GatherIndex(di, view.sums, hn::Add(begin_row, end))));
        }
        const auto tells = hn::And(in_i, hn::Ne(hn::ShiftRight<16>(total), hn::Zero(di)));
        const auto clear = hn::And(tells, hn::Eq(total, hn::ShiftLeft<16>(cells)));
        const auto rest = hn::AndNot(clear, tells);

        if (!hn::AllFalse(di, clear)) {
          F clear_evidence = uniform;
          if (view.uniform_clear == 0) {
            const F middle = hn::Mul(hn::Sub(range, start), bins_per_m);
            const I centre = hn::Min(hn::ConvertTo(di, hn::Max(middle, zero)), last_bin);
            clear_evidence = hn::GatherIndex(d, view.clear, centre);
          }
          const F looks =
              hn::Min(max_looks, hn::Max(one, hn::Mul(hn::ConvertTo(d, hn::Sub(beam_end, beam)), looks_per_beam)));
          LogOdds16* here = block + ((i << 2 * VoxelBlocks::kSideLog2) | (j << VoxelBlocks::kSideLog2) | k);
          const I old = hn::PromoteTo(di, hn::LoadU(ds, here));
          const I known = hn::IfThenZeroElse(hn::Eq(old, hn::Set(di, kUnseen)), old);
          F counted = hn::Mul(looks, clear_evidence);
          if (view.saturation) {
            const I place = hn::Sub(hn::ShiftRight<FanView::kStepLog2>(known), hn::Set(di, FanView::kMinStep));
            const I entry = hn::Min(hn::Max(place, hn::Zero(di)), hn::Set(di, FanView::kSteps - 1));
            counted = hn::Mul(counted, hn::GatherIndex(d, view.saturation, entry));
          }
          const I more = hn::NearestInt(counted);
          const I now = hn::Min(hn::Max(hn::Add(known, more), least), most);
          hn::StoreU(hn::DemoteTo(ds, hn::IfThenElse(clear, now, old)), ds, here);
        }
        if (!hn::AllFalse(di, rest)) {
          hn::Store(hn::IfThenElseZero(rest, hn::Set(di, 1)), di, at[0]);
          hn::Store(bin, di, at[1]);
          hn::Store(end, di, at[2]);
          hn::Store(beam, di, at[3]);
          hn::Store(beam_end, di, at[4]);
          for (int lane = 0; lane < lanes; ++lane) {
            if (at[0][lane] == 0) continue;
            const int offset = (i << 2 * VoxelBlocks::kSideLog2) | (j << VoxelBlocks::kSideLog2) | (k + lane);
            mixed.push_back({offset, at[1][lane], at[2][lane], at[3][lane], at[4][lane], 0});
          }
        }
      }
    }
  }
}

}  // namespace isobath::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace isobath {

HWY_EXPORT(look);

void look_at_block(const FanView& view, const float (&corner)[3], const EvidenceBounds& bounds, LogOdds16* block,
                   std::vector<MixedVoxel>& mixed) {
  HWY_DYNAMIC_DISPATCH(look)(view, corner, bounds, block, mixed);
}

int direction_index(float x, float y) {
  const float slope = y / (std::abs(x) + std::abs(y));
  const float pseudo = x < 0 ? std::copysign(2.0f, y) - slope : slope;
  const float index = (pseudo + 2.0f) * (FanView::kDirections / 4.0f);
  return static_cast<int>(std::min(std::max(index, 0.0f), FanView::kDirections - 1.0f));
}

}  // namespace isobath
#endif
