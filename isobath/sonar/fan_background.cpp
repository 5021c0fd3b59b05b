#include <algorithm>
#include <cmath>
#include <isobath/sonar/fan_background.hpp>
#include <limits>
#include <numbers>

namespace isobath {
namespace {

constexpr double kQuantile = 0.3;
constexpr double kStraightQuantile =
    0.7;  // at the range of altitude and depth, whose echo fills part of a fan that rolls
constexpr double kStraightFrom = 0.97, kStraightTo = 1.08;
constexpr int kAcross = 5;         // beams that are averaged
constexpr int kBlock = 4;          // cells
constexpr double kPatch_m = 1.5;   // of the window of a patch, to each side
constexpr int kMaxAcross = 6;      // blocks across that a patch is taken from, beside its middle
constexpr int kColumn = 8;         // blocks along a beam, to each side
constexpr float kLoudBeam = 1.3f;  // mean ratio of its power to its background
constexpr double kRingMemory = 1;  // s
constexpr int kNarrow = 13;        // cells along the range
constexpr float kUneven = 4;    // of its median over the fan, in power: no part of a ring from below or above is louder
constexpr float kAbove = 1.3f;  // a narrow ring stands out by this much
constexpr double kSteady = 10;  // s
constexpr double kWideFan = 80 * std::numbers::pi / 180;
constexpr float kStep = 1.4f;       // of the power of most of the fan, within one ping
constexpr float kMin = 0.8f;        // of the ring: no cell is taken to be fainter
constexpr float kOfTargets = 0.1f;  // how much a cell learns while a target stands in it
constexpr int kOfRelief = 8;        // pings that a relief that was learnt before weighs
constexpr float kAtOnce = 3;        // times its level: a cell learns no more from one ping

double share_of(double dt_s, double memory_s) { return memory_s > 0 ? -std::expm1(-dt_s / memory_s) : 1; }

float quantile_of(std::vector<float>& values, std::size_t count, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(count - 1));
  std::nth_element(values.begin(), at, values.begin() + static_cast<std::ptrdiff_t>(count));
  return *at;
}

}  // namespace

std::vector<Field> fields(FanBackgroundConfig& c) {
  return {
      Field::degrees("window_deg", &c.window, {2, 180},
                     "Directions to each side from which the background at a range is taken."),
      Field::real("memory_s", &c.memory_s, {0, 1000}, "s", "How slowly a cell's own background follows what it hears."),
      Field::real("max_background_ratio", &c.max_ratio, {1, 1000}, "1",
                  "A cell's own background is at most this many times that of its range, in power.")
          .was("spread")};
}

void FanBackground::begin(const FanCells& cells, int first_bin, float faintest) {
  beams_ = cells.beams();
  bins_ = cells.bins();
  first_bin_ = first_bin;
  faintest_ = faintest;
  bin_m_ = cells.window().bin_m;
  start_m_ = cells.window().start_m;
  const BeamFan& fan = *cells.fan();
  span_ = (fan.azimuth.back() - fan.azimuth.front()).radians();
  const double spacing = beams_ > 1 ? span_ / (beams_ - 1) : 1;
  half_ = std::clamp(static_cast<int>(std::lround(config_.window.radians() / spacing)), 2, std::max(2, beams_));
  sectors_.clear();
  const int count = std::max(1, static_cast<int>(std::lround(2.0 * beams_ / half_)));
  for (int s = 0; s < count; ++s) sectors_.push_back(count == 1 ? beams_ / 2 : s * (beams_ - 1) / (count - 1));
  const auto size = static_cast<std::size_t>(beams_) * static_cast<std::size_t>(bins_);
  const auto rings = sectors_.size() * static_cast<std::size_t>(bins_);
  around_.assign(size, 0);
  level_.assign(size, 1);
  local_.assign(size, 0);
  base_.assign(size, 1);
  known_relief_.clear();
  ring_.assign(rings, 0);
  rings_.assign(rings, 0);
  wide_.assign(rings, 0);
  blocks_across_ = (beams_ + kBlock - 1) / kBlock;
  blocks_along_ = (bins_ + kBlock - 1) / kBlock;
  const auto blocks = static_cast<std::size_t>(blocks_across_) * static_cast<std::size_t>(blocks_along_);
  block_.assign(blocks, 0);
  patch_.assign(blocks, 0);
  eroded_.assign(blocks, 0);
  const auto blocks_in = [](double metres) {  // more than a fan has, for bins however small, and still a number
    return static_cast<int>(std::lround(std::clamp(kPatch_m / metres, 1.0, 10'000.0)));
  };
  half_along_ = blocks_in(kBlock * bin_m_);
  half_across_.clear();
  for (int j = 0; j < blocks_along_; ++j) {
    const double range = start_m_ + (j + 0.5) * kBlock * bin_m_;
    half_across_.push_back(std::min(blocks_across_, blocks_in(std::max(0.01, kBlock * spacing * range))));
  }
  steady_s_.assign(static_cast<std::size_t>(bins_), 0);
  scratch_.resize(std::max({rings, static_cast<std::size_t>((kMaxAcross + 2) * (2 * half_along_ + 1)), std::size_t{64},
                            static_cast<std::size_t>(beams_), static_cast<std::size_t>(bins_)}));
  scratch2_.resize(scratch_.size());
  begun_ = false;
  pings_ = 0;
}

/// Means over kAcross beams, of those that were heard; -1 where none was. Not along the range: there levels have edges.
void FanBackground::average(const std::vector<float>& power) {
  const int n = bins_;
  float *sum = scratch_.data(), *count = scratch2_.data();
  for (int b = 0; b < beams_; ++b) {
    const int from = std::max(0, b - kAcross / 2), end = std::min(beams_, b + kAcross / 2 + 1);
    float* out = around_.data() + static_cast<std::ptrdiff_t>(b) * n;
    std::fill_n(sum, n, 0.f);
    std::fill_n(count, n, 0.f);
    for (int c = from; c < end; ++c) {
      const float* row = power.data() + static_cast<std::ptrdiff_t>(c) * n;
      for (int k = 0; k < n; ++k) {
        const float heard = row[k] >= 0 ? 1.f : 0.f;
        sum[k] += heard * row[k];
        count[k] += heard;
      }
    }
    for (int k = 0; k < n; ++k) out[k] = count[k] > 0 ? sum[k] / count[k] : -1.f;
  }
}

void FanBackground::find_rings(const WaterColumn& water) {
  const auto straight = [&](const std::optional<double>& distance, double range) {
    return distance && range > kStraightFrom * *distance - bin_m_ && range < kStraightTo * *distance + bin_m_;
  };
  for (std::size_t s = 0; s < sectors_.size(); ++s) {
    const int from = std::max(0, sectors_[s] - half_), end = std::min(beams_, sectors_[s] + half_ + 1);
    const int step = end - from > 48 ? 3 : end - from > 24 ? 2 : 1;  // neighbours share their averages
    float* row = ring_.data() + static_cast<std::ptrdiff_t>(s) * bins_;
    for (int k = 0; k < bins_; ++k) {
      const double range = start_m_ + (k + 0.5) * bin_m_;
      const bool below = straight(water.above_bottom_m, range) || straight(water.below_surface_m, range);
      std::size_t count = 0;
      for (int b = from; b < end; b += step) {
        const float value =
            around_[static_cast<std::size_t>(b) * static_cast<std::size_t>(bins_) + static_cast<std::size_t>(k)];
        if (value >= 0) scratch_[count++] = value;
      }
      row[k] =
          std::max(faintest_, count > 0 ? quantile_of(scratch_, count, below ? kStraightQuantile : kQuantile) : 0.f);
    }
  }
}

void FanBackground::follow_gain() {
  std::size_t count = 0;
  for (std::size_t s = 0; s < sectors_.size(); ++s) {
    for (int k = first_bin_; k < bins_; k += 2) {
      const auto at = s * static_cast<std::size_t>(bins_) + static_cast<std::size_t>(k);
      scratch_[count++] = ring_[at] / rings_[at];
    }
  }
  if (count == 0) return;
  const float ratio = quantile_of(scratch_, count, 0.5);
  if (ratio < kStep && ratio > 1 / kStep) return;
  for (float& r : rings_) r = std::max(faintest_, r * ratio);
  for (float& l : local_) l *= ratio;
  for (float& p : patch_) p *= ratio;
}

/// Erosion, then dilation: what is narrower than kNarrow cells is gone, edges stay where they are.
void FanBackground::open_row(const float* in, float* out) {
  constexpr int kHalf = kNarrow / 2;
  float* eroded = scratch_.data();
  for (int k = 0; k < bins_; ++k) {
    const int from = std::max(first_bin_, k - kHalf), end = std::min(bins_, k + kHalf + 1);
    eroded[k] = from < end ? *std::min_element(in + from, in + end) : in[k];
  }
  for (int k = 0; k < bins_; ++k) {
    const int from = std::max(0, k - kHalf), end = std::min(bins_, k + kHalf + 1);
    out[k] = *std::max_element(eroded + from, eroded + end);
  }
}

void FanBackground::settle_rings(double dt_s, const WaterColumn& water) {
  const auto a = static_cast<float>(std::max(share_of(dt_s, kRingMemory), 1.0 / (pings_ + 1)));
  for (std::size_t i = 0; i < rings_.size(); ++i) rings_[i] += a * (ring_[i] - rings_[i]);
  for (std::size_t s = 0; s < sectors_.size(); ++s) {
    const auto row = static_cast<std::ptrdiff_t>(s) * bins_;
    open_row(rings_.data() + row, wide_.data() + row);
  }
  const auto beside = [&](const std::optional<double>& distance, double range) {
    return distance && range > 0.9 * *distance - bin_m_ && range < 1.3 * *distance + bin_m_;
  };
  for (int k = 0; k < bins_; ++k) {
    bool fills = span_ >= kWideFan;
    for (std::size_t s = 0; s < sectors_.size(); ++s) {
      const auto at = s * static_cast<std::size_t>(bins_) + static_cast<std::size_t>(k);
      fills = fills && rings_[at] > kAbove * wide_[at];
    }
    float& steady = steady_s_[static_cast<std::size_t>(k)];
    steady = fills ? steady + static_cast<float>(dt_s) : 0;
    const double range = start_m_ + (k + 0.5) * bin_m_;
    const bool known = beside(water.above_bottom_m, range) || beside(water.below_surface_m, range);
    const float even = known ? kUneven * lower_median_of_rings(k) : 0.f;
    for (std::size_t s = 0; s < sectors_.size(); ++s) {
      const auto at = s * static_cast<std::size_t>(bins_) + static_cast<std::size_t>(k);
      if (steady > kSteady) {
        wide_[at] = rings_[at];
      } else {
        wide_[at] = std::min(rings_[at], std::max(even, kAbove * wide_[at]));
      }
    }
  }
}

/// Over the sectors, at one range.
float FanBackground::lower_median_of_rings(int bin) {
  for (std::size_t s = 0; s < sectors_.size(); ++s)
    scratch_[s] = rings_[s * static_cast<std::size_t>(bins_) + static_cast<std::size_t>(bin)];
  return quantile_of(scratch_, sectors_.size(), 0.5);
}

/// Of blocks of kBlock x kBlock cells: the same low quantile over a neighbourhood wide in both directions, in which no
/// wall is wide.
void FanBackground::find_patches() {
  const auto a = static_cast<float>(std::max(share_of(dt_s_, kRingMemory), 1.0 / (pings_ + 1)));
  for (int i = 0; i < blocks_across_; ++i) {
    for (int j = 0; j < blocks_along_; ++j) {
      float sum = 0, count = 0;
      for (int b = i * kBlock; b < std::min(beams_, (i + 1) * kBlock); ++b) {
        const float* row = around_.data() + static_cast<std::ptrdiff_t>(b) * bins_;
        for (int k = std::max(first_bin_, j * kBlock); k < std::min(bins_, (j + 1) * kBlock); ++k) {
          const float heard = row[k] >= 0 ? 1.f : 0.f;
          sum += heard * row[k];
          count += heard;
        }
      }
      block_[block_at(i, j)] = count > 0 ? sum / count : -1.f;
    }
  }
  for (int j = 0; j < blocks_along_; ++j) {
    const int along = half_along_, across = half_across_[static_cast<std::size_t>(j)];
    const int step = 1 + (2 * across) / kMaxAcross;
    for (int i = 0; i < blocks_across_; ++i) {
      std::size_t count = 0;
      for (int m = i - across; m <= i + across; m += step) {
        if (m < 0 || m >= blocks_across_) continue;
        for (int n = std::max(0, j - along); n <= std::min(blocks_along_ - 1, j + along); ++n) {
          const float value = block_[block_at(m, n)];
          if (value >= 0) scratch_[count++] = value;
        }
      }
      eroded_[block_at(i, j)] = count > 0 ? quantile_of(scratch_, count, kQuantile) : 0.f;
    }
  }
  // Dilated, along the range first: only as far as the quantile has shifted a level that falls with the range.
  const int reach = std::max(1, static_cast<int>(std::lround((1 - 2 * kQuantile) * half_along_)));
  for (int i = 0; i < blocks_across_; ++i) {
    for (int j = 0; j < blocks_along_; ++j) {
      const auto at = [&](int along) { return eroded_.begin() + static_cast<std::ptrdiff_t>(block_at(i, along)); };
      const auto from = at(std::max(0, j - reach)), end = at(std::min(blocks_along_ - 1, j + reach)) + 1;
      block_[block_at(i, j)] = *std::max_element(from, end);
    }
  }
  for (int i = 0; i < blocks_across_; ++i) {
    for (int j = 0; j < blocks_along_; ++j) {
      const int across = half_across_[static_cast<std::size_t>(j)];
      float now = 0;
      for (int m = std::max(0, i - across); m <= std::min(blocks_across_ - 1, i + across); ++m)
        now = std::max(now, block_[block_at(m, j)]);
      float& patch = patch_[block_at(i, j)];
      patch += a * (now - patch);
    }
  }
}

void FanBackground::set_levels() {
  std::size_t next = 0;
  for (int b = 0; b < beams_; ++b) {
    while (next + 2 < sectors_.size() && sectors_[next + 1] <= b) ++next;
    const bool one = sectors_.size() == 1;
    const int left = sectors_[next], right = one ? left + 1 : sectors_[next + 1];
    const float share =
        one ? 0.f : std::clamp(static_cast<float>(b - left) / static_cast<float>(right - left), 0.f, 1.f);
    const float* low = wide_.data() + static_cast<std::ptrdiff_t>(next) * bins_;
    const float* high = one ? low : low + bins_;
    const auto row = static_cast<std::ptrdiff_t>(b) * bins_;
    float *local = local_.data() + row, *level = level_.data() + row;
    const float* patch = patch_.data() + static_cast<std::ptrdiff_t>(b / kBlock) * blocks_along_;
    const auto most = static_cast<float>(config_.max_ratio);
    const float relief = known_relief_.empty() ? 1.f : known_relief_[static_cast<std::size_t>(b)];
    float* base = base_.data() + row;
    for (int k = 0; k < bins_; ++k) {
      const float ring = std::max(low[k] + share * (high[k] - low[k]), patch[k / kBlock]);
      base[k] = ring;
      if (!begun_) local[k] = relief * ring;
      level[k] = std::clamp(local[k], kMin * ring, most * ring);
    }
  }
}

/// A beam that is loud over much of its range hears what a wall sends round by bottom and surface, or interference:
/// along the beam too, a low quantile is background. Only of beams that need it.
void FanBackground::raise_columns(const std::vector<float>& power) {
  for (int b = 0; b < beams_; ++b) {
    const auto row = static_cast<std::ptrdiff_t>(b) * bins_;
    const float* heard = power.data() + row;
    float* level = level_.data() + row;
    float ratio = 0;
    for (int k = first_bin_; k < bins_; ++k) ratio += std::min(heard[k] / level[k], kAtOnce);
    if (!(ratio > kLoudBeam * static_cast<float>(bins_ - first_bin_))) continue;
    float* block = block_.data();  // its use for patches is over
    for (int j = 0; j < blocks_along_; ++j) {
      float sum = 0;
      const int from = std::max(first_bin_, j * kBlock), end = std::min(bins_, (j + 1) * kBlock);
      for (int k = from; k < end; ++k) sum += std::max(heard[k], 0.f);
      block[j] = end > from ? sum / static_cast<float>(end - from) : 0.f;
    }
    for (int j = 0; j < blocks_along_; ++j) {
      std::size_t count = 0;
      for (int n = std::max(0, j - kColumn); n <= std::min(blocks_along_ - 1, j + kColumn); ++n)
        scratch_[count++] = block[n];
      const float column = quantile_of(scratch_, count, kQuantile);
      for (int k = j * kBlock; k < std::min(bins_, (j + 1) * kBlock); ++k) level[k] = std::max(level[k], column);
    }
  }
}

std::vector<double> FanBackground::relief() const {
  std::vector<double> all;
  std::vector<float> beside;
  for (int b = 0; b < beams_; ++b) {
    beside.clear();
    for (int k = first_bin_; k < bins_; ++k) {
      const auto at = static_cast<std::size_t>(b) * static_cast<std::size_t>(bins_) + static_cast<std::size_t>(k);
      beside.push_back(level_[at] / base_[at]);
    }
    all.push_back(beside.empty() ? 1 : double{quantile_of(beside, beside.size(), 0.5)});
  }
  return all;
}

void FanBackground::update(Time time, const std::vector<float>& power, const WaterColumn& water) {
  average(power);
  find_rings(water);
  if (begun_) {
    dt_s_ = std::clamp(to_seconds(time - time_), 0.0, 10.0);
    follow_gain();
  } else {
    dt_s_ = 0;
    rings_ = ring_;
  }
  time_ = time;
  settle_rings(dt_s_, water);
  find_patches();
  set_levels();
  raise_columns(power);
  begun_ = true;
  std::size_t count = 0;
  const auto middle = (sectors_.size() / 2) * static_cast<std::size_t>(bins_);
  for (int k = first_bin_; k < bins_; ++k) scratch_[count++] = wide_[middle + static_cast<std::size_t>(k)];
  quiet_ = count > 0 ? quantile_of(scratch_, count, 0.5) : faintest_;
}

void FanBackground::learn(const std::vector<std::uint8_t>& target) {
  const int before = pings_ + (known_relief_.empty() ? 0 : kOfRelief);
  const auto a = static_cast<float>(std::max(share_of(dt_s_, config_.memory_s), 1.0 / (before + 1)));
  ++pings_;
  for (std::size_t i = 0; i < local_.size(); ++i) {
    const float share = target[i] ? kOfTargets * a : a;
    if (around_[i] >= 0) local_[i] += share * (std::min(around_[i], kAtOnce * level_[i]) - local_[i]);
  }
}

}  // namespace isobath
