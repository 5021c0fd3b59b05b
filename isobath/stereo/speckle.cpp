#include <algorithm>
#include <cmath>
#include <isobath/stereo/dense_matcher.hpp>
#include <limits>
#include <numeric>

namespace isobath {
namespace {

/// Islands as trees: each pixel points at one of its island, the root at itself (union-find, with halving of paths).
class Islands {
 public:
  explicit Islands(std::size_t count) : parent_(count), pixels_(count, 1) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    if (a == b) return;
    if (pixels_[a] < pixels_[b]) std::swap(a, b);
    parent_[b] = a;
    pixels_[a] += pixels_[b];
  }

 private:
  std::vector<std::uint32_t> parent_, pixels_;
};

}  // namespace

void remove_speckles(int pixels, DisparityMap& map) {
  if (pixels <= 1) return;
  // Runs of pixels along a row are joined, not single pixels: there are ten times fewer of them.
  struct Run {
    int begin, end;
  };
  std::vector<Run> runs;
  std::vector<std::size_t> first_of_row(static_cast<std::size_t>(map.height) + 1, 0);
  const auto together = [&](std::size_t a, std::size_t b) {
    return std::abs(map.disparity[a] - map.disparity[b]) <= 1;  // false where one is not valid
  };
  for (int y = 0; y < map.height; ++y) {
    const std::size_t row = map.index(0, y);
    for (int x = 0; x < map.width; ++x) {
      const std::size_t at = row + static_cast<std::size_t>(x);
      if (map.state[at] != PixelState::kValid) continue;
      if (x > 0 && together(at - 1, at)) {
        runs.back().end = x + 1;
      } else {
        runs.push_back({x, x + 1});
      }
    }
    first_of_row[static_cast<std::size_t>(y) + 1] = runs.size();
  }
  Islands islands(runs.size());
  std::vector<std::uint32_t> size(runs.size(), 0);
  for (int y = 1; y < map.height; ++y) {
    std::size_t above = first_of_row[static_cast<std::size_t>(y) - 1];
    const std::size_t here_begin = first_of_row[static_cast<std::size_t>(y)];
    const std::size_t here_end = first_of_row[static_cast<std::size_t>(y) + 1];
    for (std::size_t here = here_begin; here < here_end; ++here) {
      while (above < here_begin && runs[above].end <= runs[here].begin) ++above;
      for (std::size_t k = above; k < here_begin && runs[k].begin < runs[here].end; ++k) {
        const int from = std::max(runs[k].begin, runs[here].begin), to = std::min(runs[k].end, runs[here].end);
        for (int x = from; x < to; ++x) {
          if (!together(map.index(x, y), map.index(x, y - 1))) continue;
          islands.join(static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(here));
          break;
        }
      }
    }
  }
  for (std::size_t i = 0; i < runs.size(); ++i) {
    size[islands.root(static_cast<std::uint32_t>(i))] += static_cast<std::uint32_t>(runs[i].end - runs[i].begin);
  }
  for (int y = 0; y < map.height; ++y) {
    const std::size_t end = first_of_row[static_cast<std::size_t>(y) + 1];
    for (std::size_t i = first_of_row[static_cast<std::size_t>(y)]; i < end; ++i) {
      if (size[islands.root(static_cast<std::uint32_t>(i))] >= static_cast<std::uint32_t>(pixels)) continue;
      for (int x = runs[i].begin; x < runs[i].end; ++x) {
        const std::size_t at = map.index(x, y);
        map.state[at] = PixelState::kSpeckle;
        map.disparity[at] = std::numeric_limits<float>::quiet_NaN();
      }
    }
  }
}

}  // namespace isobath
