#include <algorithm>
#include <bit>
#include <cstdlib>
#include <isobath/stereo/disparity_kernel.hpp>

namespace isobath {

PathRow::PathRow(int width, int disparities)
    : stride(static_cast<std::size_t>(disparities + kMargin)),
      costs(static_cast<std::size_t>(width + 2) * stride + kMargin, 255),
      least(static_cast<std::size_t>(width + 2), 0) {
  for (int x = -1; x <= width; ++x) std::fill_n(at(x), disparities, std::uint8_t{0});
}

namespace {

void plain_census(const std::uint8_t* const* first, const std::uint8_t* const* second, int pairs, int width,
                  std::uint8_t* out) {
  for (int x = 0; x < width; ++x) {
    unsigned bits = 0;
    for (int k = 0; k < pairs; ++k) bits |= static_cast<unsigned>(first[k][x] < second[k][x]) << k;
    out[x] = static_cast<std::uint8_t>(bits);
  }
}

void plain_costs(const MatchingCosts& c, const std::uint8_t* left, std::size_t left_stride, const std::uint8_t* right,
                 std::size_t right_stride, std::uint8_t* out) {
  for (int x = 0; x < c.width; ++x) {
    for (int d = 0; d < c.disparities; ++d) {
      int sum = 0, plane = 0;
      for (int channel = 0; channel < c.channels; ++channel) {
        const auto both = [&] {
          const std::uint8_t l = left[static_cast<std::size_t>(plane) * left_stride + static_cast<std::size_t>(x)];
          const std::uint8_t r =
              right[static_cast<std::size_t>(plane) * right_stride + static_cast<std::size_t>(c.width - 1 - x + d)];
          ++plane;
          return std::pair(l, r);
        };
        for (int byte = 0; byte < c.bit_planes; ++byte) {
          const auto [l, r] = both();
          sum += c.bit[channel] * std::popcount(static_cast<unsigned>(l ^ r));
        }
        const auto [l, r] = both();
        sum += std::min<int>(std::abs(l - r), c.cap[channel]);
      }
      *out++ = static_cast<std::uint8_t>(std::min(sum, 255));
    }
  }
}

void plain_columns(std::uint16_t* columns, const std::uint8_t* enters, const std::uint8_t* leaves, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    columns[i] = static_cast<std::uint16_t>(columns[i] + enters[i] - (leaves ? leaves[i] : 0));
  }
}

void plain_means(const MatchingCosts& c, const std::uint16_t* columns, int radius, std::uint16_t scale,
                 std::uint8_t* out) {
  for (int x = 0; x < c.width; ++x) {
    for (int d = 0; d < c.disparities; ++d) {
      unsigned sum = 0;
      for (int k = x - radius; k <= x + radius; ++k) {
        sum +=
            columns[static_cast<std::size_t>(std::clamp(k, 0, c.width - 1)) * static_cast<std::size_t>(c.disparities) +
                    static_cast<std::size_t>(d)];
      }
      *out++ = static_cast<std::uint8_t>(sum * scale >> 16);
    }
  }
}

/// One pixel of one direction.
void plain_path(int disparities, const std::uint8_t* costs, const std::uint8_t* from, std::uint8_t least_from,
                std::uint8_t step, std::uint8_t jump, std::uint8_t* to, std::uint8_t& least_to) {
  int least = 255;
  for (int d = 0; d < disparities; ++d) {
    const int before = d > 0 ? from[d - 1] : 255, after = d + 1 < disparities ? from[d + 1] : 255;
    const int best = std::min({int{from[d]}, before + step, after + step, least_from + jump});
    to[d] = static_cast<std::uint8_t>(std::min(costs[d] + best - least_from, 255));
    least = std::min<int>(least, to[d]);
  }
  least_to = static_cast<std::uint8_t>(least);
}

void plain_sides(const MatchingCosts& c, const SideSweep* rows, int count, std::uint8_t step) {
  const auto disparities = static_cast<std::size_t>(c.disparities);
  for (int k = 0; k < count; ++k) {
    const SideSweep& s = rows[k];
    for (int x = 0; x < c.width; ++x) {
      const auto at = static_cast<std::size_t>(x);
      plain_path(c.disparities, s.costs + at * disparities, s.west->at(x - 1), s.west->least[at], step, s.jump_west[x],
                 s.west->at(x), s.west->least[at + 1]);
    }
    for (int x = c.width - 1; x >= 0; --x) {
      const auto at = static_cast<std::size_t>(x);
      plain_path(c.disparities, s.costs + at * disparities, s.east->at(x + 1), s.east->least[at + 2], step,
                 s.jump_east[x], s.east->at(x), s.east->least[at + 1]);
    }
  }
}

void plain_down(const MatchingCosts& c, const DownSweep& s, std::uint8_t step) {
  for (int x = 0; x < c.width; ++x) {
    const auto at = static_cast<std::size_t>(x);
    for (int r = 0; r < 3; ++r) {
      const int from = x + r - 1, place = from + 1;
      plain_path(c.disparities, s.costs + at * static_cast<std::size_t>(c.disparities), s.above[r]->at(from),
                 s.above[r]->least[static_cast<std::size_t>(place)], step, s.jump[r][x], s.here[r]->at(x),
                 s.here[r]->least[at + 1]);
    }
    std::uint16_t* const sums = s.sums;
    for (int d = 0; d < c.disparities; ++d) {
      sums[d] = static_cast<std::uint16_t>(s.west->at(x)[d] + s.east->at(x)[d] + s.here[0]->at(x)[d] +
                                           s.here[1]->at(x)[d] + s.here[2]->at(x)[d]);
      const int mirrored = c.width - 1 - x + d;
      const auto m = static_cast<std::size_t>(mirrored);
      if (sums[d] < s.right_cost[m]) {
        s.right_cost[m] = sums[d];
        s.right_place[m] = static_cast<std::uint16_t>(d);
      }
    }
    const int best = static_cast<int>(std::min_element(sums, sums + c.disparities) - sums);
    std::uint16_t second = 0xFFFF;
    for (int d = 0; d < c.disparities; ++d) {
      if (std::abs(d - best) > 1) second = std::min(second, sums[d]);
    }
    s.winners[x] = {static_cast<std::uint16_t>(best), sums[best], best > 0 ? sums[best - 1] : sums[best],
                    best + 1 < c.disparities ? sums[best + 1] : sums[best], second};
  }
}

}  // namespace

const DisparityKernel& plain_kernel() {
  static constexpr DisparityKernel kPlain{plain_census, plain_costs, plain_columns,
                                          plain_means,  plain_sides, plain_down};
  return kPlain;
}

}  // namespace isobath
