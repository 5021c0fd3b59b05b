#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/base/split_work.hpp>
#include <isobath/stereo/dense_matcher.hpp>
#include <isobath/stereo/disparity_kernel.hpp>
#include <isobath/stereo/match_features.hpp>
#include <limits>

namespace isobath {
namespace {

constexpr int kBandRows = 240;
constexpr int kContrastRadius = 4;
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

std::uint8_t byte_of(double value) { return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L)); }

/// P2 of a row: the penalty of a jump, less where the brightness changes from the pixel before, but at least `edge`.
void jumps(const std::uint8_t* here, const std::uint8_t* before, int width, int shift, std::uint8_t far,
           std::uint8_t edge, std::uint8_t* out) {
  const int first = std::max(0, -shift), last = std::min(width, width - shift);
  std::fill_n(out, width, far);
  for (int x = first; x < last; ++x) {
    const int change = std::abs(here[x] - before[x + shift]);
    out[x] = static_cast<std::uint8_t>(std::max(far - change, int{edge}));
  }
}

}  // namespace

struct DenseMatcher::Buffers {
  /// Of one band of rows, which one thread works on.
  struct Band {
    LineVector<std::uint8_t> ring;  ///< costs of the rows of the window, and one more
    LineVector<std::uint16_t> columns;
    LineVector<std::uint8_t> means[2];  ///< of a pair of rows
    LineVector<std::uint16_t> sums;
    std::vector<PathRow> side[2];  ///< of a pair of rows: west, east
    std::vector<PathRow> down[2];  ///< of the row above and this one, in turn
    int parity = 0;                ///< of a row within its pair
    std::vector<std::uint8_t> jump[2][2], jump_down[3];
    std::vector<Winner> winners;
    std::vector<std::uint16_t> right_cost, right_place;
  };
  MatchingCosts costs;
  MatchFeatures left, right;
  CameraImage grey;
  std::vector<std::uint8_t> textured;
  std::vector<Band> bands;
};

DenseMatcher::DenseMatcher(const StereoConfig& config, bool plain)
    : config_(config), plain_(plain), buffers_(std::make_unique<Buffers>()) {}
DenseMatcher::~DenseMatcher() = default;

const char* name_of(PixelState state) {
  static constexpr const char* kNames[] = {
      "valid", "outside of the right picture", "too little contrast", "ambiguous", "occluded", "speckle"};
  return kNames[static_cast<int>(state)];
}

double DisparityMap::share_of(PixelState wanted) const {
  return static_cast<double>(std::ranges::count(state, wanted)) /
         static_cast<double>(std::max<std::size_t>(1, state.size()));
}

DisparityMap DenseMatcher::match(const CameraImage& left, const CameraImage& right) {
  DisparityMap map;
  match(left, right, map);
  return map;
}

namespace {

/// Whether the mean slope of brightness along the row, in the window around each pixel, reaches the bound in any
/// channel. A slope is the difference of two means of three rows and two columns, three columns apart, so that noise
/// counts little.
class TextureFinder {
 public:
  TextureFinder(const CameraImage& image, double min_contrast, std::vector<std::uint8_t>& textured)
      : image_(image),
        w_(image.width),
        h_(image.height),
        bound_(static_cast<int>(std::ceil(6 * min_contrast * kSide * kSide))),
        textured_(textured) {}

  void find() {
    textured_.assign(static_cast<std::size_t>(w_) * static_cast<std::size_t>(h_), 0);
    for (int channel = 0; channel < image_.channels; ++channel) find_in(channel);
  }

 private:
  static constexpr int kSide = 2 * kContrastRadius + 1;

  void find_in(int channel) {
    constexpr int r = kContrastRadius;
    sums_.assign(static_cast<std::size_t>(w_), 0);
    columns_.assign(static_cast<std::size_t>(w_), 0);
    for (int y = -r; y < r; ++y) add_row(channel, y, 1);
    for (int y = 0; y < h_; ++y) {
      add_row(channel, y + r, 1);
      int sum = 0;
      const auto column = [&](int x) { return columns_[static_cast<std::size_t>(std::clamp(x, 1, w_ - 3))]; };
      for (int x = -r; x < r; ++x) sum += column(x);
      std::uint8_t* const out = textured_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(w_);
      for (int x = 0; x < w_; ++x) {
        sum += column(x + r);
        out[x] = static_cast<std::uint8_t>(out[x] | (sum >= bound_ ? 1 : 0));
        sum -= column(x - r);
      }
      add_row(channel, y - r, -1);
    }
  }
  /// Adds the slopes of a row to the columns, or takes them off.
  void add_row(int channel, int y, int sign) {
    const auto row = [&](int k) {
      return image_.samples.data() + image_.index(0, std::clamp(y + k, 0, h_ - 1)) + channel;
    };
    const std::uint8_t *const a = row(-1), *const b = row(0), *const c = row(1);
    const int step = image_.channels;
    for (int x = 0; x < w_; ++x) sums_[static_cast<std::size_t>(x)] = a[x * step] + b[x * step] + c[x * step];
    for (std::size_t x = 1; x + 2 < sums_.size(); ++x) {
      columns_[x] += sign * std::abs(sums_[x + 1] + sums_[x + 2] - sums_[x - 1] - sums_[x]);
    }
  }

  const CameraImage& image_;
  int w_, h_, bound_;
  std::vector<std::uint8_t>& textured_;
  std::vector<int> sums_, columns_;
};

}  // namespace

void DenseMatcher::match(const CameraImage& left, const CameraImage& right, DisparityMap& map) {
  ISOBATH_ASSERT(left.width == right.width && left.height == right.height && left.channels == right.channels);
  ISOBATH_ASSERT(left.width >= 16 && left.height >= 16);
  Buffers& b = *buffers_;
  const DisparityKernel& kernel = plain_ ? plain_kernel() : vector_kernel();
  const double weights[3] = {config_.red, config_.green, config_.blue};
  b.costs.disparities = config_.disparities;
  b.costs.width = left.width;
  b.costs.channels = left.channels;
  for (int c = 0; c < 3; ++c) {
    const double weight = left.channels == 1 ? 1 : weights[c] / (weights[0] + weights[1] + weights[2]);
    b.costs.bit[c] = byte_of(config_.bit * weight * (left.channels == 1 ? 1 : 2));
    b.costs.cap[c] = byte_of(config_.difference_cap * weight * (left.channels == 1 ? 1 : 2));
  }
  // The candidates of x begin at width - 1 - x + min_disparity of the mirrored row.
  const int before = std::max(0, -config_.min_disparity), after = std::max(0, config_.min_disparity);
  b.left.compute(kernel, left, weights, false, 0, 0);
  b.right.compute(kernel, right, weights, true, before, after + config_.disparities);
  b.grey = grey_of(left);
  TextureFinder(left, config_.min_contrast, b.textured).find();

  map.width = left.width;
  map.height = left.height;
  const std::size_t pixels = b.grey.samples.size();
  map.disparity.resize(pixels);
  map.confidence.resize(pixels);
  map.state.resize(pixels);
  const int bands = 2 * std::max(1, (left.height + kBandRows) / (2 * kBandRows));
  b.bands.resize(static_cast<std::size_t>(bands));
  split_work(bands, config_.threads, [&](int first, int last) { match_bands(first, last, map); });
  remove_speckles(config_.speckle_pixels, map);
}

void DenseMatcher::match_bands(int first, int last, DisparityMap& map) {
  Buffers& b = *buffers_;
  const DisparityKernel& kernel = plain_ ? plain_kernel() : vector_kernel();
  const MatchingCosts& costs = b.costs;
  const auto width = static_cast<std::size_t>(costs.width), disparities = static_cast<std::size_t>(costs.disparities);
  const std::size_t row = width * disparities;
  const int radius = config_.window / 2, height = map.height, bands = static_cast<int>(b.bands.size());
  const auto scale =
      static_cast<std::uint16_t>((65536 + config_.window * config_.window - 1) / (config_.window * config_.window));
  const auto step = byte_of(config_.step_penalty), far = byte_of(config_.jump_penalty);
  const auto edge = byte_of(std::min(config_.jump_at_edge, config_.jump_penalty));
  for (int index = first; index < last; ++index) {
    Buffers::Band& band = b.bands[static_cast<std::size_t>(index)];
    const int begin = height * index / bands, end = height * (index + 1) / bands;
    const int top = std::max(0, begin - kWarmUp), ring_rows = config_.window + 1;
    band.ring.resize(row * static_cast<std::size_t>(ring_rows));
    band.columns.assign(row, 0);
    band.sums.resize(disparities);
    band.parity = 0;
    for (int k = 0; k < 2; ++k) {
      band.means[k].resize(row);
      band.side[k].assign(2, PathRow(costs.width, costs.disparities));
      band.down[k].assign(3, PathRow(costs.width, costs.disparities));
      for (auto& jump : band.jump[k]) jump.resize(width);
    }
    for (auto& jump : band.jump_down) jump.resize(width);
    band.winners.resize(width);
    const auto ring = [&](int y) {  // rows beyond the edge repeat it; they are counted anew
      const int place = ((y - top) % ring_rows + ring_rows) % ring_rows;
      return band.ring.data() + row * static_cast<std::size_t>(place);
    };
    const auto enter = [&](int y) {
      const int inside = std::clamp(y, 0, height - 1);
      kernel.candidate_costs(costs, b.left.row(inside), b.left.stride(),
                             b.right.row(inside) + (config_.min_disparity > 0 ? config_.min_disparity : 0),
                             b.right.stride(), ring(y));
    };
    for (int y = top - radius; y < top + radius; ++y) {
      enter(y);
      kernel.move_columns(band.columns.data(), ring(y), nullptr, row);
    }
    for (int y = top; y < end; y += 2) {
      const int rows = std::min(2, end - y);
      SideSweep sides[2]{};
      const std::uint8_t* means[2]{};
      for (int k = 0; k < rows; ++k) {
        const int at = y + k;
        enter(at + radius);
        means[k] = ring(at);
        if (radius > 0) {
          kernel.move_columns(band.columns.data(), ring(at + radius), at > top ? ring(at - radius - 1) : nullptr, row);
          kernel.window_means(costs, band.columns.data(), radius, scale, band.means[k].data());
          means[k] = band.means[k].data();
        }
        const std::uint8_t* const here = b.grey.samples.data() + b.grey.index(0, at);
        jumps(here, here, costs.width, -1, far, edge, band.jump[k][0].data());
        jumps(here, here, costs.width, 1, far, edge, band.jump[k][1].data());
        sides[k] = {means[k], &band.side[k][0], &band.side[k][1], band.jump[k][0].data(), band.jump[k][1].data()};
      }
      kernel.sweep_sides(costs, sides, rows, step);
      for (int k = 0; k < rows; ++k) sweep_down(y + k, index, means[k], y + k >= begin, map);
    }
  }
}

void DenseMatcher::sweep_down(int y, int band_index, const std::uint8_t* means, bool keep, DisparityMap& map) {
  Buffers& b = *buffers_;
  Buffers::Band& band = b.bands[static_cast<std::size_t>(band_index)];
  const auto far = byte_of(config_.jump_penalty);
  const auto edge = byte_of(std::min(config_.jump_at_edge, config_.jump_penalty));
  const std::uint8_t* const here = b.grey.samples.data() + b.grey.index(0, y);
  const std::uint8_t* const up = b.grey.samples.data() + b.grey.index(0, std::max(0, y - 1));
  for (int r = 0; r < 3; ++r) {
    jumps(here, up, map.width, r - 1, far, edge, band.jump_down[static_cast<std::size_t>(r)].data());
  }
  const auto right = static_cast<std::size_t>(map.width) + static_cast<std::size_t>(config_.disparities);
  band.right_cost.assign(right, 0xFFFF);
  band.right_place.assign(right, 0);
  const auto side = static_cast<std::size_t>(band.parity);  // of the row within its pair
  band.parity = 1 - band.parity;
  std::vector<PathRow>&above = band.down[side], &below = band.down[1 - side];
  (plain_ ? plain_kernel() : vector_kernel())
      .sweep_down(b.costs,
                  {means,
                   &band.side[side][0],
                   &band.side[side][1],
                   {&above[0], &above[1], &above[2]},
                   {&below[0], &below[1], &below[2]},
                   {band.jump_down[0].data(), band.jump_down[1].data(), band.jump_down[2].data()},
                   band.sums.data(),
                   band.winners.data(),
                   band.right_cost.data(),
                   band.right_place.data()},
                  byte_of(config_.step_penalty));
  if (keep) finish_row(y, band_index, map);
}

namespace {

/// Windows blur the edge of what hides the background: the pixels to the right of an occlusion are often part of it.
void widen_occlusions(int y, int margin, DisparityMap& map) {
  int left = 0, run = 0;
  for (int x = 0; x < map.width; ++x) {
    const std::size_t at = map.index(x, y);
    if (map.state[at] == PixelState::kOccluded) {
      if (++run >= 2) left = margin;
      continue;
    }
    run = 0;
    if (left-- <= 0 || map.state[at] != PixelState::kValid) continue;
    map.state[at] = PixelState::kOccluded;
    map.disparity[at] = kNone;
  }
}

}  // namespace

void DenseMatcher::finish_row(int y, int band_index, DisparityMap& map) const {
  const Buffers& b = *buffers_;
  const Buffers::Band& band = b.bands[static_cast<std::size_t>(band_index)];
  const int width = map.width, most = config_.disparities - 1;
  const auto left_right = static_cast<float>(config_.left_right);
  const auto worse = static_cast<float>(1 - config_.uniqueness);
  for (int x = 0; x < width; ++x) {
    const Winner& w = band.winners[static_cast<std::size_t>(x)];
    const std::size_t at = map.index(x, y);
    const int place = w.place, right_x = x - config_.min_disparity - place;
    const float second = w.second, cost = w.cost;
    PixelState state = PixelState::kValid;
    if (right_x < 0 || right_x >= width) {
      state = PixelState::kOutside;
    } else if (!b.textured[at]) {
      state = PixelState::kUntextured;
    } else if (cost > worse * second) {
      state = PixelState::kAmbiguous;
    } else {
      const int mirrored = width - 1 - x + place;
      const int other = band.right_place[static_cast<std::size_t>(mirrored)];
      if (static_cast<float>(std::abs(other - place)) > left_right) state = PixelState::kOccluded;
    }
    float offset = 0;
    const int bend = w.before - 2 * w.cost + w.after;
    if (place > 0 && place < most && bend > 0) {
      offset = static_cast<float>(w.before - w.after) / static_cast<float>(2 * bend);
    }
    map.state[at] = state;
    map.disparity[at] =
        state == PixelState::kValid ? static_cast<float>(config_.min_disparity + place) + offset : kNone;
    map.confidence[at] = second > 0 ? 1 - cost / second : 0;
  }
  widen_occlusions(y, config_.occlusion_margin, map);
}

}  // namespace isobath
