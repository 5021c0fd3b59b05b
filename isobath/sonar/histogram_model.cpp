#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <isobath/base/error.hpp>
#include <isobath/sonar/histogram_model.hpp>
#include <numeric>

namespace isobath {
namespace {

constexpr int kMaxPings = 65535;         // so that no count overflows
constexpr double kPooledSamples = 1000;  // samples per pixel with automatic pooling
constexpr double kHighestEvidence = 15;  // largest value that 16 bits hold in units of kUnit
constexpr double kSameBearing = 0.25, kSameRange = 0.25;

std::size_t cells_of(const HistogramModel& model) {
  return static_cast<std::size_t>(model.beams()) * static_cast<std::size_t>(model.window.bins) *
         static_cast<std::size_t>(model.config.levels);
}

bool same_bearings(const std::vector<Angle>& a, const std::vector<Angle>& b) {
  const double span = a.size() > 1 ? (a.back() - a.front()).radians() / static_cast<double>(a.size() - 1) : 1;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::abs((a[i] - b[i]).radians()) > kSameBearing * span) return false;
  }
  return true;
}

bool same_range(const RangeWindow& a, const RangeWindow& b) {
  const double slack = kSameRange * a.bin_m;
  return std::abs(a.start_m - b.start_m) <= slack && std::abs(a.end_m() - b.end_m()) <= slack;
}

std::optional<HistogramMismatch> compared(const HistogramModel& model, const std::vector<Angle>& azimuth,
                                          const RangeWindow& window, double full_scale) {
  if (model.azimuth.size() != azimuth.size() || model.window.bins != window.bins) return HistogramMismatch::kImageSize;
  if (!same_bearings(model.azimuth, azimuth)) return HistogramMismatch::kBearings;
  if (!same_range(model.window, window)) return HistogramMismatch::kRange;
  if (model.full_scale != full_scale) return HistogramMismatch::kLevels;
  return std::nullopt;
}

void require_histogram(bool good, const std::string& file, const char* key, const char* allowed) {
  if (!good) throw Error("out of range", {file, {}, {}, {}, key}, allowed);
}

/// Removes `amount` of the brightest samples.
void drop_brightest(std::vector<double>& counts, double amount) {
  for (std::size_t i = counts.size(); i-- > 0 && amount > 0;) {
    const double taken = std::min(counts[i], amount);
    counts[i] -= taken;
    amount -= taken;
  }
}

void smooth_counts(std::vector<double>& counts, double k) {
  const double all = std::accumulate(counts.begin(), counts.end(), 0.0) + k * static_cast<double>(counts.size());
  for (double& c : counts) c = (c + k) / all;
}

/// Converts counts of noise to probabilities.
void to_shares(std::vector<double>& counts, const HistogramConfig& config) {
  drop_brightest(counts, config.drop_share * std::accumulate(counts.begin(), counts.end(), 0.0));
  smooth_counts(counts, config.smoothing);
}

/// Calls visit(beam, bin, level) for each sample.
template <class Visit>
void each_sample(const Ping& ping, const HistogramModel& model, const Visit& visit) {
  std::vector<float> beam(static_cast<std::size_t>(ping.window.bins));
  for (int b = 0; b < ping.intensity.beams(); ++b) {
    ping.intensity.copy_beam(b, beam.data());
    for (int k = 0; k < ping.window.bins; ++k) visit(b, k, model.level(beam[static_cast<std::size_t>(k)]));
  }
}

}  // namespace

std::vector<Field> fields(HistogramConfig& c) {
  return {
      Field::integer("levels", &c.levels, {2, 256}, "1", "Number of levels of intensity."),
      Field::real("level_width", &c.level_width, {0, 1e9}, "counts",
                  "Width of a level, the last one open above; 0: fitted to the background."),
      Field::real("smoothing", &c.smoothing, {1e-3, 100}, "samples",
                  "Pseudo-count added to each level, so that a level without samples is unlikely, not impossible."),
      Field::real(
          "drop_share", &c.drop_share, {0, 0.5}, "1",
          "Share of the brightest background samples of a pixel that is left out, as objects in the background."),
      Field::integer("pool_bins", &c.pool_bins, {-1, 1000}, "bins",
                     "Neighbours in range on each side whose background is pooled; -1: up to 1000 samples per pixel."),
      Field::integer("pool_beams", &c.pool_beams, {0, 1000}, "beams",
                     "Neighbours in bearing on each side whose background is pooled."),
      Field::real("max_log_odds", &c.max_log_odds, {0.1, kHighestEvidence}, "1",
                  "Maximum log-odds of one look at one pixel.")
          .was("most_evidence"),
  };
}

const char* to_text(HistogramMismatch mismatch) {
  switch (mismatch) {
    case HistogramMismatch::kImageSize: return "the histogram model has another number of beams or range bins";
    case HistogramMismatch::kBearings: return "the histogram model was learnt at other bearings";
    case HistogramMismatch::kRange: return "the histogram model was learnt at another range setting";
    case HistogramMismatch::kLevels: return "the histogram model has other intensity levels";
  }
  return "unknown";
}

std::optional<HistogramMismatch> mismatch(const HistogramModel& model, const Ping& ping) {
  return compared(model, ping.fan->azimuth, ping.window, static_cast<double>(ping.full_scale));
}

// The model -----------------------------------------------------------------------------------------------------------

std::vector<double> HistogramModel::noise_shares(int beam, int bin) const {
  std::vector<double> sum(static_cast<std::size_t>(config.levels), 0);
  const int across = std::max(0, config.pool_beams), along = std::max(0, config.pool_bins);
  for (int b = std::max(0, beam - across); b <= std::min(beams() - 1, beam + across); ++b) {
    for (int k = std::max(0, bin - along); k <= std::min(window.bins - 1, bin + along); ++k) {
      const auto pixel = counts(b, k);
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += pixel[i];
    }
  }
  to_shares(sum, config);
  return sum;
}

std::vector<double> HistogramModel::object_shares() const {
  std::vector<double> shares(object.begin(), object.end());
  smooth_counts(shares, config.smoothing);
  return shares;
}

void HistogramModel::check(const std::string& file) const {
  const auto require = [&](bool good, const char* key, const char* allowed) {
    require_histogram(good, file, key, allowed);
  };
  require(config.levels >= 2 && config.levels <= 256, "levels", "2 .. 256");
  require(std::isfinite(config.level_width) && config.level_width > 0, "level_width", "above 0");
  require(config.smoothing > 0 && config.smoothing <= 100, "smoothing", "above 0, up to 100");
  require(config.drop_share >= 0 && config.drop_share <= 0.5, "drop_share", "0 .. 0.5");
  require(config.pool_bins >= 0 && config.pool_bins <= 1000, "pool_bins", "0 .. 1000");
  require(config.pool_beams >= 0 && config.pool_beams <= 1000, "pool_beams", "0 .. 1000");
  require(config.max_log_odds > 0 && config.max_log_odds <= kHighestEvidence, "max_log_odds", "above 0, up to 15");
  require(window.bins > 0 && window.start_m >= 0 && window.bin_m > 0 && std::isfinite(window.end_m()), "window",
          "start_m >= 0, bin_m > 0, bins > 0");
  require(!azimuth.empty() && std::is_sorted(azimuth.begin(), azimuth.end()), "azimuth_deg", "one or more, rising");
  require(std::isfinite(full_scale) && full_scale > 0, "full_scale", "above 0");
  require(background_pings > 0 && background_pings <= kMaxPings && marked_pings >= 0, "background_pings", "1 .. 65535");
  require(azimuth.size() <= kMaxCells / static_cast<std::size_t>(config.levels) / static_cast<std::size_t>(window.bins),
          "beams x bins x levels", "up to 268435456");
  require(noise.size() == cells_of(*this), "noise", "a count for each level of each pixel");
  require(object.size() == static_cast<std::size_t>(config.levels), "object", "a count for each level");
}

// Learning ------------------------------------------------------------------------------------------------------------

HistogramLearner::HistogramLearner(const HistogramConfig& config) { model_.config = config; }

void HistogramLearner::prepare(const Ping& ping) {
  if (model_.azimuth.empty()) {
    model_.window = ping.window;
    model_.azimuth = ping.fan->azimuth;
    model_.full_scale = static_cast<double>(ping.full_scale);
    if (model_.config.level_width <= 0) model_.config.level_width = model_.full_scale / model_.config.levels;
    const std::size_t most =
        HistogramModel::kMaxCells / static_cast<std::size_t>(model_.config.levels) / model_.azimuth.size();
    if (static_cast<std::size_t>(ping.window.bins) > most) {
      throw Error("the image is too large for histograms of each pixel", {}, "up to " + std::to_string(most) + " bins",
                  "use fewer levels");
    }
    model_.noise.assign(cells_of(model_), 0);
    model_.object.assign(static_cast<std::size_t>(model_.config.levels), 0);
  } else if (const auto other = mismatch(model_, ping)) {
    throw Error(to_text(*other), {}, "pings of one sonar at one setting", "learn one model for each");
  }
}

void HistogramLearner::add_background(const Ping& ping, std::span<const std::uint8_t> masked) {
  prepare(ping);
  const auto bins = static_cast<std::size_t>(model_.window.bins);
  ISOBATH_ASSERT(masked.empty() || masked.size() == model_.azimuth.size() * bins);
  if (model_.background_pings == kMaxPings) throw Error("too many pings of background", {}, "up to 65535");
  ++model_.background_pings;
  each_sample(ping, model_, [&](int beam, int bin, int level) {
    const std::size_t pixel = static_cast<std::size_t>(beam) * bins + static_cast<std::size_t>(bin);
    if (masked.empty() || !masked[pixel])
      ++model_.noise[pixel * static_cast<std::size_t>(model_.config.levels) + level];
  });
}

void HistogramLearner::add_marked(const Ping& ping, std::span<const std::uint8_t> marked) {
  prepare(ping);
  const auto bins = static_cast<std::size_t>(model_.window.bins);
  ISOBATH_ASSERT(marked.size() == model_.azimuth.size() * bins);
  ++model_.marked_pings;
  each_sample(ping, model_, [&](int beam, int bin, int level) {
    if (marked[static_cast<std::size_t>(beam) * bins + static_cast<std::size_t>(bin)])
      ++model_.object[static_cast<std::size_t>(level)];
  });
}

void HistogramLearner::add(const HistogramModel& other) {
  if (model_.azimuth.empty()) {
    const HistogramConfig asked = model_.config;
    model_ = other;
    model_.config = asked;
    model_.config.levels = other.config.levels;
    model_.config.level_width = other.config.level_width;
    return;
  }
  auto differs = compared(model_, other.azimuth, other.window, other.full_scale);
  const bool edges =
      other.config.levels == model_.config.levels && other.config.level_width == model_.config.level_width;
  if (!differs && !edges) differs = HistogramMismatch::kLevels;
  if (differs) throw Error(to_text(*differs), {}, "models of one sonar at one setting");
  if (model_.background_pings + other.background_pings > kMaxPings) {
    throw Error("too many pings of background", {}, "up to 65535");
  }
  model_.background_pings += other.background_pings;
  model_.marked_pings += other.marked_pings;
  for (std::size_t i = 0; i < model_.noise.size(); ++i) {
    model_.noise[i] = static_cast<std::uint16_t>(model_.noise[i] + other.noise[i]);
  }
  for (std::size_t i = 0; i < model_.object.size(); ++i) model_.object[i] += other.object[i];
}

void HistogramLearner::add_objects(const HistogramModel& other) {
  if (!has_noise()) throw Error("no background to learn from", {}, {}, "add frames of water without targets");
  if (other.full_scale != model_.full_scale || other.config.levels != model_.config.levels ||
      other.config.level_width != model_.config.level_width) {
    throw Error(to_text(HistogramMismatch::kLevels), {}, "objects of the same sonar in the same levels");
  }
  model_.marked_pings += other.marked_pings;
  for (std::size_t i = 0; i < model_.object.size(); ++i) model_.object[i] += other.object[i];
}

HistogramModel HistogramLearner::model(const std::string& source) const {
  if (!has_noise()) throw Error("no background to learn from", {}, {}, "add frames of water without targets");
  HistogramModel made = model_;
  made.source = source;
  if (made.config.pool_bins < 0) {
    const double images = made.background_pings * (2.0 * made.config.pool_beams + 1);
    const int wanted = static_cast<int>(std::ceil((kPooledSamples / images - 1) / 2));
    made.config.pool_bins = std::clamp(wanted, 0, made.window.bins / 32);
  }
  made.check();
  return made;
}

// The table -----------------------------------------------------------------------------------------------------------

LikelihoodRatios::LikelihoodRatios(std::shared_ptr<const HistogramModel> model) : model_(std::move(model)) {
  const HistogramModel& m = *model_;
  if (std::all_of(m.object.begin(), m.object.end(), [](std::uint64_t n) { return n == 0; })) {
    throw Error("the histogram model has no object samples", {}, {}, "learn it from frames with marks as well");
  }
  const std::vector<double> object = m.object_shares();
  const auto levels = static_cast<std::size_t>(m.config.levels);
  const int bins = m.window.bins, along = m.config.pool_bins;
  table_.reserve(m.noise.size());
  std::vector<double> across, pool(levels), shares;
  for (int beam = 0; beam < m.beams(); ++beam) {
    pool_beams(beam, across);
    const auto add = [&](int bin, double sign) {
      if (bin < 0 || bin >= bins) return;
      for (std::size_t i = 0; i < levels; ++i) pool[i] += sign * across[static_cast<std::size_t>(bin) * levels + i];
    };
    std::fill(pool.begin(), pool.end(), 0.0);
    for (int bin = 0; bin < std::min(along, bins); ++bin) add(bin, 1);
    for (int bin = 0; bin < bins; ++bin) {
      add(bin + along, 1);
      shares = pool;
      to_shares(shares, m.config);
      for (std::size_t i = 0; i < levels; ++i) {
        const double most = m.config.max_log_odds;
        const double increment = std::clamp(std::log(object[i] / shares[i]), -most, most);
        table_.push_back(static_cast<std::int16_t>(std::lround(increment / kUnit)));
      }
      add(bin - along, -1);
    }
  }
}

/// Pools the noise of a beam and its neighbours, bins x levels.
void LikelihoodRatios::pool_beams(int beam, std::vector<double>& sum) const {
  const HistogramModel& m = *model_;
  const auto row = static_cast<std::size_t>(m.window.bins) * static_cast<std::size_t>(m.config.levels);
  sum.assign(row, 0);
  const int first = std::max(0, beam - m.config.pool_beams), last = std::min(m.beams() - 1, beam + m.config.pool_beams);
  for (int b = first; b <= last; ++b) {
    const std::uint16_t* from = m.noise.data() + static_cast<std::size_t>(b) * row;
    for (std::size_t i = 0; i < row; ++i) sum[i] += from[i];
  }
}

void LikelihoodRatios::look_up(const Ping& ping, std::span<std::int16_t> out) const {
  const HistogramModel& m = *model_;
  const Intensities& z = ping.intensity;
  const auto levels = static_cast<std::size_t>(m.config.levels), bins = static_cast<std::size_t>(m.window.bins);
  ISOBATH_ASSERT(z.beams() == m.beams() && z.bins() == m.window.bins && out.size() == z.beams() * bins);
  if (z.type() == SampleType::kU8) {
    std::array<std::uint8_t, 256> level_of;
    for (int v = 0; v < 256; ++v)
      level_of[static_cast<std::size_t>(v)] = static_cast<std::uint8_t>(m.level(static_cast<float>(v)));
    for (int b = 0; b < z.beams(); ++b) {
      const std::byte* at = z.data() + b * z.beam_stride();
      const std::int16_t* pixel = table_.data() + static_cast<std::size_t>(b) * bins * levels;
      std::int16_t* to = out.data() + static_cast<std::size_t>(b) * bins;
      for (std::size_t k = 0; k < bins; ++k, at += z.bin_stride(), pixel += levels) {
        to[k] = pixel[level_of[static_cast<std::uint8_t>(*at)]];
      }
    }
    return;
  }
  for (int b = 0; b < z.beams(); ++b) {
    for (std::size_t k = 0; k < bins; ++k) {
      const std::size_t pixel = static_cast<std::size_t>(b) * bins + k;
      out[pixel] = table_[pixel * levels + static_cast<std::size_t>(m.level(z(b, static_cast<int>(k))))];
    }
  }
}

LikelihoodRatios::OperatingPoint LikelihoodRatios::operating_point(double false_alarm, int first_bin) const {
  const HistogramModel& m = *model_;
  const auto levels = static_cast<std::size_t>(m.config.levels);
  constexpr int kZero = 32768;
  std::vector<std::uint64_t> seen(2 * kZero, 0);  // counts of noise samples by ratio
  std::uint64_t all = 0;
  const auto each = [&](const auto& visit) {
    for (int beam = 0; beam < m.beams(); ++beam) {
      for (int bin = std::max(0, first_bin); bin < m.window.bins; ++bin) {
        const std::size_t pixel = static_cast<std::size_t>(beam) * m.window.bins + bin;
        for (std::size_t i = 0; i < levels; ++i) visit(bin, i, table_[pixel * levels + i], m.noise[pixel * levels + i]);
      }
    }
  };
  each([&](int, std::size_t, std::int16_t ratio, std::uint16_t count) {
    seen[static_cast<std::size_t>(std::ptrdiff_t{ratio} + kZero)] += count;
    all += count;
  });
  OperatingPoint point;
  point.p_detect.assign(static_cast<std::size_t>(m.window.bins), 0);
  std::uint64_t above = 0;
  int threshold = 2 * kZero - 1;  // the lowest with at most the requested share at or above it
  while (threshold > 0 && static_cast<double>(above + seen[static_cast<std::size_t>(threshold)]) <=
                              false_alarm * static_cast<double>(all)) {
    above += seen[static_cast<std::size_t>(threshold--)];
  }
  point.threshold = static_cast<std::int16_t>(std::min(threshold + 1, 2 * kZero - 1) - kZero);
  point.false_alarm = all > 0 ? static_cast<double>(above) / static_cast<double>(all) : 0;
  const double objects = static_cast<double>(std::accumulate(m.object.begin(), m.object.end(), std::uint64_t{0}));
  std::vector<double> detected(static_cast<std::size_t>(m.window.bins), 0);
  each([&](int bin, std::size_t level, std::int16_t ratio, std::uint16_t) {
    if (ratio >= point.threshold) detected[static_cast<std::size_t>(bin)] += static_cast<double>(m.object[level]);
  });
  for (std::size_t k = 0; k < detected.size(); ++k) {
    point.p_detect[k] = static_cast<float>(detected[k] / (objects * m.beams()));
  }
  return point;
}

}  // namespace isobath
