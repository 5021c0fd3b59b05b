#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/studies/sample_statistics.hpp>
#include <numeric>

namespace isobath {
namespace {

constexpr int kRangeGroups = 120;
constexpr int kKeptScans = 16;
constexpr double kCutShare = 0.4;  // of zeros

double decibels(double ratio) { return ratio > 0 ? 20 * std::log10(ratio) : 0; }

double middle_of(const EchoLevels& levels, int level) { return (levels.edge(level) + levels.edge(level + 1)) / 2; }

}  // namespace

const char* law_name(NoiseLaw law) {
  return law == NoiseLaw::kGaussian ? "Gaussian" : law == NoiseLaw::kRayleigh ? "Rayleigh" : "K";
}

RangeLevels levels_of(const EchoLevels& levels, const std::vector<std::uint64_t>& counts) {
  RangeLevels out;
  const EchoDistribution distribution(levels, counts);
  out.samples = distribution.samples();
  if (out.samples <= 0) return out;
  out.mean = distribution.mean();
  out.deviation = distribution.deviation();
  // Quantiles of integers reach half a count below the lowest one.
  const auto quantile = [&](double p) { return std::max(0.0, distribution.quantile(p)); };
  out.low = quantile(0.16);
  out.median = quantile(0.5);
  out.high = quantile(0.84);
  out.top = quantile(0.99);
  out.zeros = static_cast<double>(counts[0]) / out.samples;
  // If a threshold cuts much of the water to 0, the lower half tells nothing about the spread.
  const double spread = out.zeros < kCutShare ? out.median - out.low : out.high - out.median;
  out.background_limit = out.median + std::max(2.0, 3 * spread);
  return out;
}

// Collecting ---------------------------------------------------------------------------------------------------------

void SampleCollector::begin(const Ping& ping) {
  begun_ = true;
  window_ = ping.window;
  beams_ = ping.fan->beams();
  scanning_ = beams_ == 1;
  width_ = ping.fan->width[0];
  blanking_m_ = std::max(blanking_m_, ping.blanking_m);
  const bool bytes = ping.intensity.type() == SampleType::kU8;
  scale_ = bytes ? 1 : static_cast<float>(kFullCounts) / ping.full_scale;
  histogram_ = EchoHistogram(EchoLevels(ping.intensity.type(), static_cast<float>(kFullCounts)), window_.bins);
  beam_.resize(static_cast<std::size_t>(window_.bins));
}

int SampleCollector::first_bin() const {
  int first = 0;
  while (first < window_.bins && window_.edge(first) < blanking_m_ - 1e-9) ++first;
  return first;
}

void SampleCollector::add(const Ping& ping) {
  if (!begun_) begin(ping);
  if (!(ping.window == window_) || ping.fan->beams() != beams_) {
    ++left_out_;
    return;
  }
  ++pings_;
  const auto scan = sweeps_.add(ping);
  const bool turned_back = scan && !scan->full_turn && scanning_;
  if (turned_back) end_scan();  // this ping already belongs to the next scan
  for (int b = 0; b < beams_; ++b) {
    ping.intensity.copy_beam(b, beam_.data());
    for (float& v : beam_) v *= scale_;
    const Angle azimuth = ping.fan->azimuth[static_cast<std::size_t>(b)];
    add_beam(scanning_ ? static_cast<int>(std::lround(azimuth.wrapped_positive().degrees() * 4)) % 1440 : b, azimuth);
  }
  if (scan && !turned_back) end_scan();
}

void SampleCollector::add_beam(int key, Angle azimuth) {
  Row& row = rows_[key];
  if (row.pings++ == 0) {
    row.azimuth = azimuth;
    row.sum.assign(beam_.size(), 0);
    row.squares.assign(beam_.size(), 0);
  }
  for (std::size_t k = 0; k < beam_.size(); ++k) {
    const auto v = static_cast<double>(beam_[k]);
    row.sum[k] += v;
    row.squares[k] += v * v;
    histogram_.add(static_cast<int>(k), beam_[k]);
  }
  current_[key] = beam_;
}

namespace {

using ScanBeams = std::map<int, std::vector<float>>;

struct StrongestSample {
  int key = -1, bin = -1;  // -1: there is none
  double level = 0;
};

StrongestSample strongest_sample(const ScanBeams& scan, int first_bin) {
  StrongestSample best;
  for (const auto& [key, beam] : scan) {
    for (int k = first_bin; k < static_cast<int>(beam.size()); ++k) {
      const auto level = static_cast<double>(beam[static_cast<std::size_t>(k)]);
      if (best.key >= 0 && level <= best.level) continue;
      best = {key, k, level};
    }
  }
  return best;
}

/// Number of neighbouring bins that reach the level, `bin` included.
int bins_reaching(float level, const std::vector<float>& beam, int bin) {
  const auto bins = static_cast<int>(beam.size());
  int near = bin, far = bin;
  while (near > 0 && beam[static_cast<std::size_t>(near - 1)] >= level) --near;
  while (far + 1 < bins && beam[static_cast<std::size_t>(far) + 1] >= level) ++far;
  return far - near + 1;
}

/// Number of neighbouring beams that reach the level in a bin, `key` included. `closed`: the last adjoins the first.
std::size_t beams_reaching(float level, const ScanBeams& scan, int key, int bin, bool closed) {
  std::vector<const std::vector<float>*> beams;
  for (const auto& [each, beam] : scan) beams.push_back(&beam);
  const std::size_t n = beams.size();
  const auto at = static_cast<std::size_t>(std::distance(scan.begin(), scan.find(key)));
  const auto reaches = [&](std::size_t i) { return (*beams[i % n])[static_cast<std::size_t>(bin)] >= level; };
  std::size_t run = 1;
  for (std::size_t i = at + 1; run < n && (closed || i < n) && reaches(i); ++i) ++run;
  for (std::size_t i = at + n - 1; run < n && (closed || i >= n) && reaches(i); --i) ++run;
  return run;
}

}  // namespace

void SampleCollector::end_scan() {
  if (current_.empty()) return;
  ++scans_;
  const int first = first_bin();
  const StrongestSample best = strongest_sample(current_, first);
  if (best.key >= 0 && best.level > 0) {
    const auto half = static_cast<float>(best.level / 2);
    const int first_key = current_.begin()->first, last_key = current_.rbegin()->first;
    const bool closed = scanning_ && last_key - first_key > 1300;  // a full turn: the last row adjoins the first
    const std::size_t n = current_.size();
    const double span = n < 2    ? width_.degrees()
                        : closed ? 360.0 / static_cast<double>(n)
                                 : std::abs((rows_[last_key].azimuth - rows_[first_key].azimuth).degrees()) /
                                       static_cast<double>(n - 1);
    const int bins = bins_reaching(half, current_[best.key], best.bin);
    const auto beams = static_cast<double>(beams_reaching(half, current_, best.key, best.bin, closed));
    strongest_.push_back({best.level, window_.centre(best.bin), rows_[best.key].azimuth, bins * window_.bin_m,
                          Angle::degrees(span * beams)});
  }
  sorted_.clear();
  for (const auto& [key, beam] : current_) sorted_.insert(sorted_.end(), beam.begin() + first, beam.end());
  if (!sorted_.empty()) {
    const auto many =
        static_cast<std::ptrdiff_t>(std::max(1.0, std::round(kBrightestShare * static_cast<double>(sorted_.size()))));
    std::nth_element(sorted_.begin(), sorted_.begin() + many - 1, sorted_.end(), std::greater<>());
    brightest_sum_ += std::accumulate(sorted_.begin(), sorted_.begin() + many, 0.0);
    others_sum_ += std::accumulate(sorted_.begin() + many, sorted_.end(), 0.0);
    brightest_count_ += static_cast<double>(many);
    others_count_ += static_cast<double>(sorted_.size()) - static_cast<double>(many);
  }
  if ((scans_ - 1) % keep_every_ == 0) kept_.push_back(current_);
  if (kept_.size() > static_cast<std::size_t>(kKeptScans)) {
    for (std::size_t i = 0; 2 * i < kept_.size(); ++i) kept_[i] = std::move(kept_[2 * i]);
    kept_.resize((kept_.size() + 1) / 2);
    keep_every_ *= 2;
  }
  current_.clear();
}

// Statistics ---------------------------------------------------------------------------------------------------------

void SampleCollector::levels(SampleStatistics& out) const {
  const EchoLevels& levels = histogram_.levels();
  const auto count = static_cast<std::size_t>(levels.count());
  out.levels = levels;
  out.counts.assign(count, 0);
  out.background.assign(count, 0);
  const int first = first_bin(), group = std::max(1, (window_.bins + kRangeGroups - 1) / kRangeGroups);
  double bright = 0, bright_sum = 0, bright_background = 0;
  for (int k = 0; k < window_.bins;) {
    int end = std::min(window_.bins, k + group);
    if (k < first && end > first) end = first;  // a group lies inside or outside the blind zone, never across its edge
    const std::vector<std::uint64_t> counts = histogram_.pooled(k, end);
    RangeLevels range = levels_of(levels, counts);
    range.near_m = window_.edge(k);
    range.far_m = window_.edge(end);
    double background = 0, sum = 0;
    for (std::size_t l = 0; l < count; ++l) {
      const double value = middle_of(levels, static_cast<int>(l));
      if (counts[l] == 0 || value > range.background_limit) continue;
      background += static_cast<double>(counts[l]);
      sum += value * static_cast<double>(counts[l]);
      if (k >= first) out.background[l] += counts[l];
    }
    range.background = background > 0 ? std::max(0.0, sum / background) : 0;
    const double limit = std::max(kBrightLeast, kBrightRatio * range.background);
    for (std::size_t l = 0; l < count && k >= first; ++l) {
      out.counts[l] += counts[l];
      const double value = middle_of(levels, static_cast<int>(l)), n = static_cast<double>(counts[l]);
      if (value < limit) continue;
      bright += n;
      bright_sum += n * value;
      bright_background += n * range.background;
    }
    range.counts = counts;
    out.ranges.push_back(range);
    k = end;
  }
  out.all = levels_of(levels, out.counts);
  out.all.near_m = window_.edge(first);
  out.all.far_m = window_.end_m();
  const RangeLevels quiet = levels_of(levels, out.background);
  out.background_share = quiet.samples / std::max(out.all.samples, 1.0);
  out.background_mean = quiet.mean;
  out.background_deviation = quiet.deviation;
  out.bright_share = bright / std::max(out.all.samples, 1.0);
  // Black water counts as half a count: smaller values cannot be resolved.
  if (bright > 0) out.bright_over_db = decibels(bright_sum / std::max(bright_background, 0.5 * bright));
}

namespace {

std::vector<NoiseFit> background_fits(const SampleStatistics& samples) {
  std::vector<NoiseFit> fits;
  for (const NoiseLaw law : {NoiseLaw::kGaussian, NoiseLaw::kRayleigh, NoiseLaw::kK}) {
    NoiseFitConfig config;
    config.bootstraps = 0;  // neighbouring samples are dependent, so a p-value would be meaningless
    fits.push_back(fit_noise(samples.levels, samples.background, law, config));
  }
  return fits;
}

/// Pointers to the rows and their keys.
template <class Row>
std::vector<const std::pair<const int, Row>*> rows_by_azimuth(const std::map<int, Row>& rows) {
  std::vector<const std::pair<const int, Row>*> sorted;
  for (const auto& row : rows) sorted.push_back(&row);
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto* a, const auto* b) {
    return a->second.azimuth.wrapped().radians() < b->second.azimuth.wrapped().radians();
  });
  return sorted;
}

/// Fills the mean image, and computes its spreads beyond the blind zone, which ends at `first_bin`.
template <class Rows>
void add_mean_image(const Rows& rows, int first_bin, SampleStatistics& out) {
  double variance = 0, cells = 0, sum = 0, squares = 0, mean_cells = 0;
  for (const auto* keyed : rows) {
    const auto& row = keyed->second;
    const auto n = static_cast<double>(row.pings);
    out.mean.azimuth.push_back(row.azimuth);
    for (int k = 0; k < out.mean.window.bins; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const double mean = row.sum[i] / n;
      out.mean.values.push_back(static_cast<float>(mean));
      if (k < first_bin) continue;
      sum += mean;
      squares += mean * mean;
      ++mean_cells;
      if (row.pings < 2) continue;
      variance += std::max(0.0, (row.squares[i] - n * mean * mean) / (n - 1));
      ++cells;
    }
  }
  if (cells > 0) out.spread_over_scans = std::sqrt(variance / cells);
  if (mean_cells > 0)
    out.spread_over_cells = std::sqrt(std::max(0.0, squares / mean_cells - std::pow(sum / mean_cells, 2)));
}

template <class Rows>
void add_scan_image(const Rows& rows, const ScanBeams& scan, SampleStatistics& out) {
  for (const auto* keyed : rows) {
    const auto found = scan.find(keyed->first);
    if (found == scan.end()) continue;
    out.scan.azimuth.push_back(keyed->second.azimuth);
    out.scan.values.insert(out.scan.values.end(), found->second.begin(), found->second.end());
  }
}

}  // namespace

SampleStatistics SampleCollector::finish(const std::string& name) {
  if (!begun_)
    throw Error("holds no ping of an imaging sonar", {name, {}, {}, {}, {}}, {}, "isobath info lists its streams");
  if (first_bin() >= window_.bins) {
    throw Error(fmt::format("blind over its whole range of {:g} m", window_.end_m()), {name, {}, {}, {}, {}}, {},
                "set calibration.blanking_m");
  }
  // An incomplete turn counts as a scan only if there is no other.
  if (scans_ == 0) end_scan();
  SampleStatistics out;
  out.name = name;
  out.pings = pings_;
  out.left_out = left_out_;
  out.scans = scans_;
  out.blanking_m = blanking_m_;
  levels(out);
  out.fits = background_fits(out);
  if (brightest_count_ > 0) out.brightest_mean = brightest_sum_ / brightest_count_;
  if (others_count_ > 0) out.brightest_others = others_sum_ / others_count_;
  out.strongest = strongest_;

  out.mean.window = out.scan.window = window_;
  out.mean.width = out.scan.width = width_;
  const auto rows = rows_by_azimuth(rows_);
  add_mean_image(rows, first_bin(), out);
  if (!kept_.empty()) add_scan_image(rows, kept_[kept_.size() / 2], out);
  return out;
}

}  // namespace isobath
