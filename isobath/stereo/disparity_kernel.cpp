#include <algorithm>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "isobath/stereo/disparity_kernel.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once an instruction set.
#include <hwy/highway.h>
#include <isobath/stereo/disparity_kernel.hpp>

HWY_BEFORE_NAMESPACE();
namespace isobath::HWY_NAMESPACE {
#if HWY_TARGET == HWY_SCALAR  // no vectors: the plain loops

void census_of(const std::uint8_t* const* first, const std::uint8_t* const* second, int pairs, int width,
               std::uint8_t* out) {
  plain_kernel().census_byte(first, second, pairs, width, out);
}
void costs_of_row(const MatchingCosts& c, const std::uint8_t* left, std::size_t left_stride, const std::uint8_t* right,
                  std::size_t right_stride, std::uint8_t* out) {
  plain_kernel().candidate_costs(c, left, left_stride, right, right_stride, out);
}
void columns_moved(std::uint16_t* columns, const std::uint8_t* enters, const std::uint8_t* leaves, std::size_t count) {
  plain_kernel().move_columns(columns, enters, leaves, count);
}
void means_of_row(const MatchingCosts& c, const std::uint16_t* columns, int radius, std::uint16_t scale,
                  std::uint8_t* out) {
  plain_kernel().window_means(c, columns, radius, scale, out);
}
void sides_swept(const MatchingCosts& c, const SideSweep* rows, int count, std::uint8_t step) {
  plain_kernel().sweep_sides(c, rows, count, step);
}
void down_swept(const MatchingCosts& c, const DownSweep& s, std::uint8_t step) {
  plain_kernel().sweep_down(c, s, step);
}

#else
namespace hn = hwy::HWY_NAMESPACE;

using Bytes = hn::CappedTag<std::uint8_t, MatchingCosts::kLanes>;
using Words = hn::RepartitionToWide<Bytes>;
using HalfBytes = hn::Half<Bytes>;
using B = hn::Vec<Bytes>;
using W = hn::Vec<Words>;

/// The least lane, by halves down to 128 bits.
template <class D>
HWY_INLINE HWY_ATTR std::uint16_t least_word(D d, hn::Vec<D> v) {
  if constexpr (hn::MaxLanes(D()) > 8) {
    const hn::Half<D> half;
    return least_word(half, hn::Min(hn::LowerHalf(half, v), hn::UpperHalf(half, v)));
  } else {
    return hn::GetLane(hn::MinOfLanes(d, v));
  }
}
template <class D>
HWY_INLINE HWY_ATTR std::uint8_t least_byte(D /*d*/, hn::Vec<D> v) {
  if constexpr (hn::MaxLanes(D()) > 16) {
    const hn::Half<D> half;
    return least_byte(half, hn::Min(hn::LowerHalf(half, v), hn::UpperHalf(half, v)));
  } else {
    const hn::RepartitionToWide<D> dw;
    const auto pairs = hn::BitCast(dw, v);
    const auto least = hn::Min(hn::And(pairs, hn::Set(dw, 0xFF)), hn::ShiftRight<8>(pairs));
    return static_cast<std::uint8_t>(least_word(dw, least));
  }
}
HWY_INLINE HWY_ATTR W lower_words(B v) { return hn::PromoteTo(Words(), hn::LowerHalf(HalfBytes(), v)); }
HWY_INLINE HWY_ATTR W upper_words(B v) { return hn::PromoteTo(Words(), hn::UpperHalf(HalfBytes(), v)); }

HWY_ATTR void census_of(const std::uint8_t* const* first, const std::uint8_t* const* second, int pairs, int width,
                        std::uint8_t* out) {
  const Bytes d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  for (int x = 0; x < width; x += lanes) {
    B bits = hn::Zero(d);
    for (int k = 0; k < pairs; ++k) {
      const auto less = hn::Lt(hn::LoadU(d, first[k] + x), hn::LoadU(d, second[k] + x));
      bits = hn::Or(bits, hn::IfThenElseZero(less, hn::Set(d, static_cast<std::uint8_t>(1 << k))));
    }
    hn::StoreU(bits, d, out + x);
  }
}

HWY_ATTR void costs_of_row(const MatchingCosts& c, const std::uint8_t* left, std::size_t left_stride,
                           const std::uint8_t* right, std::size_t right_stride, std::uint8_t* out) {
  const Bytes d;
  const std::size_t lanes = hn::Lanes(d);
  const auto disparities = static_cast<std::size_t>(c.disparities);
  HWY_ALIGN static constexpr std::uint8_t kBits[16] = {0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4};
  const B low = hn::Set(d, 15);
  B bit_cost[3], cap[3];
  for (int channel = 0; channel < c.channels; ++channel) {
    HWY_ALIGN std::uint8_t table[16];
    for (int i = 0; i < 16; ++i) table[i] = static_cast<std::uint8_t>(kBits[i] * c.bit[channel]);
    bit_cost[channel] = hn::LoadDup128(d, table);
    cap[channel] = hn::Set(d, c.cap[channel]);
  }
  for (int x = 0; x < c.width; ++x) {
    const std::uint8_t* const candidates = right + (c.width - 1 - x);
    for (std::size_t k = 0; k < disparities; k += lanes) {
      B sum = hn::Zero(d);
      const std::uint8_t* l = left + x;
      const std::uint8_t* r = candidates + k;
      for (int channel = 0; channel < c.channels; ++channel) {
        for (int byte = 0; byte < c.bit_planes; ++byte, l += left_stride, r += right_stride) {
          const B differ = hn::Xor(hn::Set(d, *l), hn::LoadU(d, r));
          const B high = hn::And(hn::BitCast(d, hn::ShiftRight<4>(hn::BitCast(Words(), differ))), low);
          sum = hn::SaturatedAdd(sum, hn::TableLookupBytes(bit_cost[channel], hn::And(differ, low)));
          sum = hn::SaturatedAdd(sum, hn::TableLookupBytes(bit_cost[channel], high));
        }
        const B a = hn::Set(d, *l), b = hn::LoadU(d, r);
        const B apart = hn::Or(hn::SaturatedSub(a, b), hn::SaturatedSub(b, a));
        sum = hn::SaturatedAdd(sum, hn::Min(apart, cap[channel]));
        l += left_stride;
        r += right_stride;
      }
      hn::StoreU(sum, d, out + static_cast<std::size_t>(x) * disparities + k);
    }
  }
}

HWY_ATTR void columns_moved(std::uint16_t* columns, const std::uint8_t* enters, const std::uint8_t* leaves,
                            std::size_t count) {
  const Words dw;
  const HalfBytes dh;
  const std::size_t lanes = hn::Lanes(dw);
  for (std::size_t i = 0; i < count; i += lanes) {
    W sum = hn::Add(hn::LoadU(dw, columns + i), hn::PromoteTo(dw, hn::LoadU(dh, enters + i)));
    if (leaves) sum = hn::Sub(sum, hn::PromoteTo(dw, hn::LoadU(dh, leaves + i)));
    hn::StoreU(sum, dw, columns + i);
  }
}

HWY_ATTR void means_of_row(const MatchingCosts& c, const std::uint16_t* columns, int radius, std::uint16_t scale,
                           std::uint8_t* out) {
  const Words dw;
  const HalfBytes dh;
  const auto lanes = static_cast<int>(hn::Lanes(dw));
  const W by = hn::Set(dw, scale);
  const auto column = [&](int x, int k) {
    const int inside = std::min(std::max(x, 0), c.width - 1);
    return hn::LoadU(dw, columns + static_cast<std::size_t>(inside) * static_cast<std::size_t>(c.disparities) +
                             static_cast<std::size_t>(k));
  };
  for (int k = 0; k < c.disparities; k += lanes) {
    W sum = hn::Zero(dw);
    for (int x = -radius - 1; x < radius; ++x) sum = hn::Add(sum, column(x, k));
    for (int x = 0; x < c.width; ++x) {
      sum = hn::Add(hn::Sub(sum, column(x - radius - 1, k)), column(x + radius, k));
      hn::StoreU(
          hn::DemoteTo(dh, hn::BitCast(hn::RebindToSigned<Words>(), hn::MulHigh(sum, by))), dh,
          out + static_cast<std::size_t>(x) * static_cast<std::size_t>(c.disparities) + static_cast<std::size_t>(k));
    }
  }
}

/// Candidates k .. of one pixel of one direction.
HWY_INLINE HWY_ATTR B path_costs(B costs, const std::uint8_t* from, B least_from, B far, B step) {
  const Bytes d;
  const B beside = hn::Min(hn::LoadU(d, from - 1), hn::LoadU(d, from + 1));
  const B best = hn::Min(hn::Min(hn::LoadU(d, from), hn::SaturatedAdd(beside, step)), far);
  return hn::SaturatedAdd(costs, hn::Sub(best, least_from));
}

/// All candidates of one pixel of one direction; returns the least of them in every lane.
HWY_INLINE HWY_ATTR B path_of_pixel(int disparities, const std::uint8_t* costs, const std::uint8_t* from, B least_from,
                                    std::uint8_t jump, B step, std::uint8_t* to) {
  const Bytes d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const B far = hn::SaturatedAdd(least_from, hn::Set(d, jump));
  B least = hn::Set(d, 255);
  for (int k = 0; k < disparities; k += lanes) {
    const B path = path_costs(hn::LoadU(d, costs + k), from + k, least_from, far, step);
    hn::StoreU(path, d, to + k);
    least = hn::Min(least, path);
  }
  return hn::Set(d, least_byte(d, least));
}

HWY_ATTR void sides_swept(const MatchingCosts& c, const SideSweep* rows, int count, std::uint8_t step_cost) {
  const Bytes d;
  const B step = hn::Set(d, step_cost), zero = hn::Zero(d);
  const auto disparities = static_cast<std::size_t>(c.disparities);
  const SideSweep &a = rows[0], &b = rows[count - 1];  // the same row twice where there is one
  B least_a_west = zero, least_a_east = zero, least_b_west = zero, least_b_east = zero;
  for (int i = 0; i < c.width; ++i) {
    const int j = c.width - 1 - i;
    const std::size_t at_i = static_cast<std::size_t>(i) * disparities,
                      at_j = static_cast<std::size_t>(j) * disparities;
    least_a_west = path_of_pixel(c.disparities, a.costs + at_i, a.west->at(i - 1), least_a_west, a.jump_west[i], step,
                                 a.west->at(i));
    least_a_east = path_of_pixel(c.disparities, a.costs + at_j, a.east->at(j + 1), least_a_east, a.jump_east[j], step,
                                 a.east->at(j));
    if (count == 1) continue;
    least_b_west = path_of_pixel(c.disparities, b.costs + at_i, b.west->at(i - 1), least_b_west, b.jump_west[i], step,
                                 b.west->at(i));
    least_b_east = path_of_pixel(c.disparities, b.costs + at_j, b.east->at(j + 1), least_b_east, b.jump_east[j], step,
                                 b.east->at(j));
  }
}

/// The least of a pixel's sums, its neighbours, and the least that is no neighbour.
HWY_INLINE HWY_ATTR Winner winner_of(const std::uint16_t* sums, int disparities, std::uint16_t cost) {
  const Words dw;
  const auto lanes = static_cast<int>(hn::Lanes(dw));
  int best = 0;
  for (int k = 0; k < disparities; k += lanes) {
    const auto place = hn::FindFirstTrue(dw, hn::Eq(hn::LoadU(dw, sums + k), hn::Set(dw, cost)));
    if (place >= 0) {
      best = k + static_cast<int>(place);
      break;
    }
  }
  const W first = hn::Set(dw, static_cast<std::uint16_t>(best - 1)), most = hn::Set(dw, 0xFFFF);
  W second = most;
  for (int k = 0; k < disparities; k += lanes) {
    const W places = hn::Add(hn::Iota(dw, 0), hn::Set(dw, static_cast<std::uint16_t>(k)));
    const auto beside = hn::Lt(hn::Sub(places, first), hn::Set(dw, 3));
    second = hn::Min(second, hn::IfThenElse(beside, most, hn::LoadU(dw, sums + k)));
  }
  return {static_cast<std::uint16_t>(best), cost, best > 0 ? sums[best - 1] : cost,
          best + 1 < disparities ? sums[best + 1] : cost, least_word(dw, second)};
}

HWY_ATTR void down_swept(const MatchingCosts& c, const DownSweep& s, std::uint8_t step_cost) {
  const Bytes d;
  const Words dw;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const int half = lanes / 2;
  const B step = hn::Set(d, step_cost);
  for (int x = 0; x < c.width; ++x) {
    const auto at = static_cast<std::size_t>(x);
    const std::uint8_t* const costs = s.costs + at * static_cast<std::size_t>(c.disparities);
    const std::uint8_t *const west = s.west->at(x), *const east = s.east->at(x);
    B least_from[3], far[3], least[3];
    for (int r = 0; r < 3; ++r) {
      least_from[r] = hn::Set(d, s.above[r]->least[at + static_cast<std::size_t>(r)]);
      far[r] = hn::SaturatedAdd(least_from[r], hn::Set(d, s.jump[r][x]));
      least[r] = hn::Set(d, 255);
    }
    std::uint16_t* const right_cost = s.right_cost + (c.width - 1 - x);
    std::uint16_t* const right_place = s.right_place + (c.width - 1 - x);
    W least_sum = hn::Set(dw, 0xFFFF);
    const auto take = [&](int k, W sum) {
      hn::StoreU(sum, dw, s.sums + k);
      least_sum = hn::Min(least_sum, sum);
      const W known = hn::LoadU(dw, right_cost + k);
      const auto better = hn::Lt(sum, known);
      const W places = hn::Add(hn::Iota(dw, 0), hn::Set(dw, static_cast<std::uint16_t>(k)));
      hn::StoreU(hn::Min(sum, known), dw, right_cost + k);
      hn::StoreU(hn::IfThenElse(better, places, hn::LoadU(dw, right_place + k)), dw, right_place + k);
    };
    for (int k = 0; k < c.disparities; k += lanes) {
      const B cost = hn::LoadU(d, costs + k), w = hn::LoadU(d, west + k), e = hn::LoadU(d, east + k);
      W lower = hn::Add(lower_words(w), lower_words(e)), upper = hn::Add(upper_words(w), upper_words(e));
      for (int r = 0; r < 3; ++r) {
        const B path = path_costs(cost, s.above[r]->at(x + r - 1) + k, least_from[r], far[r], step);
        hn::StoreU(path, d, s.here[r]->at(x) + k);
        least[r] = hn::Min(least[r], path);
        lower = hn::Add(lower, lower_words(path));
        upper = hn::Add(upper, upper_words(path));
      }
      take(k, lower);
      take(k + half, upper);
    }
    for (int r = 0; r < 3; ++r) s.here[r]->least[at + 1] = least_byte(d, least[r]);
    s.winners[x] = winner_of(s.sums, c.disparities, least_word(dw, least_sum));
  }
}

#endif
}  // namespace isobath::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace isobath {
namespace {

HWY_EXPORT(census_of);
HWY_EXPORT(costs_of_row);
HWY_EXPORT(columns_moved);
HWY_EXPORT(means_of_row);
HWY_EXPORT(sides_swept);
HWY_EXPORT(down_swept);

}  // namespace

const DisparityKernel& vector_kernel() {
  static constexpr DisparityKernel kVectors{
      [](const std::uint8_t* const* first, const std::uint8_t* const* second, int pairs, int width, std::uint8_t* out) {
        HWY_DYNAMIC_DISPATCH(census_of)(first, second, pairs, width, out);
      },
      [](const MatchingCosts& c, const std::uint8_t* left, std::size_t left_stride, const std::uint8_t* right,
         std::size_t right_stride, std::uint8_t* out) {
        HWY_DYNAMIC_DISPATCH(costs_of_row)(c, left, left_stride, right, right_stride, out);
      },
      [](std::uint16_t* columns, const std::uint8_t* enters, const std::uint8_t* leaves, std::size_t count) {
        HWY_DYNAMIC_DISPATCH(columns_moved)(columns, enters, leaves, count);
      },
      [](const MatchingCosts& c, const std::uint16_t* columns, int radius, std::uint16_t scale, std::uint8_t* out) {
        HWY_DYNAMIC_DISPATCH(means_of_row)(c, columns, radius, scale, out);
      },
      [](const MatchingCosts& c, const SideSweep* rows, int count, std::uint8_t step) {
        HWY_DYNAMIC_DISPATCH(sides_swept)(c, rows, count, step);
      },
      [](const MatchingCosts& c, const DownSweep& s, std::uint8_t step) {
        HWY_DYNAMIC_DISPATCH(down_swept)(c, s, step);
      }};
  return kVectors;
}

}  // namespace isobath
#endif
