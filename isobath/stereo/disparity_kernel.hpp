// Disparity kernel: the inner loops of dense matching (dense_matcher.hpp), row by row, twice: as vectors (the
// instruction set is chosen at run time) and as plain loops that state what the vectors compute. All integers; both
// give the same bits. (Stereo fragment 1990; ledger S8-01 S8-03 S8-06.)
//
// A candidate is a pair (x, d): pixel x of the left row against pixel x - min_disparity - d of the right row. Right
// rows are mirrored, so that the candidates of a pixel lie side by side. Costs are 8 bits, `disparities` of a pixel
// side by side. The law of smoothing is Hirschmueller's (2008, eq. 13), for each direction r:
//   L(p, d) = C(p, d) + min(L(q, d), L(q, d - 1) + P1, L(q, d + 1) + P1, min L(q) + P2(p)) - min L(q), q = p - r
// and a sum of L never exceeds 255 a direction, because C + P2 does not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <vector>

namespace isobath {

struct MatchingCosts {
  static constexpr int kLanes = 64;  ///< `disparities` is a multiple of it
  int disparities = 64;
  int width = 0;
  int channels = 1;
  int bit_planes = 4;     ///< bytes of census bits, a channel
  std::uint8_t bit[3]{};  ///< cost of a census bit that differs, by channel
  std::uint8_t cap[3]{};  ///< largest cost of a difference of brightness, by channel
};

/// Memory that begins on a cache line: a vector of 64 bytes then lies in one line, not in two.
template <class T>
struct LineAllocator {
  using value_type = T;
  LineAllocator() = default;
  template <class U>
  explicit LineAllocator(const LineAllocator<U>&) {}
  T* allocate(std::size_t count) {
    return static_cast<T*>(::operator new (count * sizeof(T), std::align_val_t{MatchingCosts::kLanes}));
  }
  void deallocate(T* memory, std::size_t) { ::operator delete (memory, std::align_val_t{MatchingCosts::kLanes}); }
  bool operator==(const LineAllocator&) const { return true; }
};
template <class T>
using LineVector = std::vector<T, LineAllocator<T>>;

/// Row buffer of one direction of smoothing: L and min L of each pixel, with a margin of one pixel on both sides.
struct PathRow {
  static constexpr int kMargin = 64;  ///< bytes of 255 between the costs of pixels
  PathRow(int width, int disparities);
  [[nodiscard]] std::uint8_t* at(int x) { return costs.data() + static_cast<std::size_t>(x + 1) * stride + kMargin; }
  [[nodiscard]] const std::uint8_t* at(int x) const {
    return costs.data() + static_cast<std::size_t>(x + 1) * stride + kMargin;
  }
  std::size_t stride;
  LineVector<std::uint8_t> costs;
  std::vector<std::uint8_t> least;  ///< of pixel x at x + 1
};

/// The directions from the west and from the east, along one row. Two rows at a time hide each other's waiting.
struct SideSweep {
  const std::uint8_t* costs;
  PathRow *west, *east;
  const std::uint8_t *jump_west, *jump_east;  ///< P2 of each pixel
};

/// What a pixel's sums say: the least, its neighbours, the least that is no neighbour.
struct Winner {
  std::uint16_t place, cost, before, after, second;
};

/// The directions from the north-west, the north and the north-east, the sum of all five, and its winners in both eyes.
struct DownSweep {
  const std::uint8_t* costs;
  const PathRow *west, *east;
  const PathRow* above[3];
  PathRow* here[3];
  const std::uint8_t* jump[3];
  std::uint16_t* sums;         ///< room for `disparities`
  Winner* winners;             ///< of the left eye
  std::uint16_t* right_cost;   ///< of the right eye, mirrored: candidate (x, d) is of pixel width - 1 - x + d;
  std::uint16_t* right_place;  ///< width + disparities each, set to 0xFFFF by the caller
};

struct DisparityKernel {
  /// Bit k of out[x]: first[k][x] < second[k][x], for up to eight pairs; `width` is rounded up to kLanes.
  void (*census_byte)(const std::uint8_t* const* first, const std::uint8_t* const* second, int pairs, int width,
                      std::uint8_t* out);
  /// Costs of all candidates of a row: census bits that differ, times their cost, and differences of brightness up to
  /// their cap, over all channels; at most 255. `left`: planes of the left row, `left_stride` apart: for each channel
  /// its bytes of bits, then its brightness; `right` likewise, mirrored: the candidates of x begin at width - 1 - x.
  void (*candidate_costs)(const MatchingCosts& costs, const std::uint8_t* left, std::size_t left_stride,
                          const std::uint8_t* right, std::size_t right_stride, std::uint8_t* out);
  /// columns += enters - leaves; `leaves` may be null.
  void (*move_columns)(std::uint16_t* columns, const std::uint8_t* enters, const std::uint8_t* leaves,
                       std::size_t count);
  /// Mean over the columns x - radius .. x + radius (the outermost repeated at the edges): sum * scale >> 16.
  void (*window_means)(const MatchingCosts& costs, const std::uint16_t* columns, int radius, std::uint16_t scale,
                       std::uint8_t* out);
  void (*sweep_sides)(const MatchingCosts& costs, const SideSweep* rows, int count, std::uint8_t step);
  void (*sweep_down)(const MatchingCosts& costs, const DownSweep& sweep, std::uint8_t step);
};

const DisparityKernel& vector_kernel();
const DisparityKernel& plain_kernel();

}  // namespace isobath
