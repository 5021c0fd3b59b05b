#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/io/open.hpp>
#include <isobath/runtime/comparison.hpp>
#include <isobath/runtime/html_report.hpp>
#include <isobath/runtime/picture.hpp>
#include <isobath/runtime/scenario.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

namespace isobath {
namespace {

using nlohmann::ordered_json;

constexpr double kFullScale = 255;
constexpr int kRangeGroups = 120;
constexpr int kKeptScans = 16;
constexpr double kBrightRatio = 4, kBrightLeast = 16;  // counts
constexpr double kBrightestShare = 0.002;
constexpr double kCutShare = 0.4;  // of zeros

const char* law_name(NoiseLaw law) {
  return law == NoiseLaw::kGaussian ? "Gaussian" : law == NoiseLaw::kRayleigh ? "Rayleigh" : "K";
}

double decibels(double ratio) { return ratio > 0 ? 20 * std::log10(ratio) : 0; }

RangeLevels summed_up(const EchoLevels& levels, const std::vector<std::uint64_t>& counts) {
  RangeLevels out;
  const EchoDistribution distribution(levels, counts);
  out.samples = distribution.samples();
  if (out.samples <= 0) return out;
  out.mean = distribution.mean();
  out.deviation = distribution.deviation();
  // Quantiles of whole numbers reach half a count below the lowest one.
  const auto quantile = [&](double p) { return std::max(0.0, distribution.quantile(p)); };
  out.low = quantile(0.16);
  out.median = quantile(0.5);
  out.high = quantile(0.84);
  out.top = quantile(0.99);
  out.zeros = static_cast<double>(counts[0]) / out.samples;
  // Where a threshold cuts much of the water to 0, the lower half says nothing about its spread.
  const double spread = out.zeros < kCutShare ? out.median - out.low : out.high - out.median;
  out.background_limit = out.median + std::max(2.0, 3 * spread);
  return out;
}

double middle_of(const EchoLevels& levels, int level) { return (levels.edge(level) + levels.edge(level + 1)) / 2; }

struct Quantiles {
  double low = 0, median = 0, high = 0;
};
template <class Value>
Quantiles quantiles(const std::vector<StrongestEcho>& echoes, Value value) {
  if (echoes.empty()) return {};
  std::vector<double> v;
  for (const StrongestEcho& e : echoes) v.push_back(value(e));
  std::sort(v.begin(), v.end());
  const auto at = [&](double p) {
    return v[static_cast<std::size_t>(std::lround(p * static_cast<double>(v.size() - 1)))];
  };
  return {at(0.16), at(0.5), at(0.84)};
}

}  // namespace

// Collecting ---------------------------------------------------------------------------------------------------------

void SampleCollector::begin(const Ping& ping) {
  begun_ = true;
  window_ = ping.window;
  beams_ = ping.fan->beams();
  scanning_ = beams_ == 1;
  width_ = ping.fan->width[0];
  blind_m_ = std::max(blind_m_, ping.blind_m);
  const bool bytes = ping.intensity.type() == SampleType::kU8;
  scale_ = bytes ? 1 : static_cast<float>(kFullScale) / ping.full_scale;
  histogram_ = EchoHistogram(EchoLevels(ping.intensity.type(), static_cast<float>(kFullScale)), window_.bins);
  beam_.resize(static_cast<std::size_t>(window_.bins));
}

int SampleCollector::first_bin() const {
  int first = 0;
  while (first < window_.bins && window_.edge(first) < blind_m_ - 1e-9) ++first;
  return first;
}

void SampleCollector::take(const Ping& ping) {
  if (!begun_) begin(ping);
  if (!(ping.window == window_) || ping.fan->beams() != beams_) {
    ++left_out_;
    return;
  }
  ++pings_;
  const auto scan = sweeps_.add(ping);
  const bool turned_back = scan && !scan->full_turn && scanning_;
  if (turned_back) end_scan();  // known from the ping that is already of the next scan
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

void SampleCollector::end_scan() {
  if (current_.empty()) return;
  ++scans_;
  const int first = first_bin();
  sorted_.clear();
  StrongestEcho best;
  int best_key = -1, best_bin = -1;
  for (const auto& [key, beam] : current_) {
    for (int k = first; k < window_.bins; ++k) {
      const float v = beam[static_cast<std::size_t>(k)];
      sorted_.push_back(v);
      if (best_key >= 0 && static_cast<double>(v) <= best.level) continue;
      best.level = static_cast<double>(v);
      best_key = key;
      best_bin = k;
    }
  }
  if (best_key >= 0 && best.level > 0) {
    const auto half = static_cast<float>(best.level / 2);
    const std::vector<float>& beam = current_[best_key];
    int near = best_bin, far = best_bin;
    while (near > 0 && beam[static_cast<std::size_t>(near - 1)] >= half) --near;
    while (far + 1 < window_.bins && beam[static_cast<std::size_t>(far) + 1] >= half) ++far;
    std::vector<int> keys;
    for (const auto& [key, row] : current_) keys.push_back(key);
    const std::size_t n = keys.size();
    const auto at = static_cast<std::size_t>(std::find(keys.begin(), keys.end(), best_key) - keys.begin());
    const auto reaches = [&](std::size_t i) {
      return current_[keys[i % n]][static_cast<std::size_t>(best_bin)] >= half;
    };
    std::size_t run = 1;
    const bool closed = scanning_ && keys.back() - keys.front() > 1300;  // a whole turn: the last is beside the first
    for (std::size_t i = at + 1; run < n && (closed || i < n) && reaches(i); ++i) ++run;
    for (std::size_t i = at + n - 1; run < n && (closed || i >= n) && reaches(i); --i) ++run;
    const double span = n < 2    ? width_.degrees()
                        : closed ? 360.0 / static_cast<double>(n)
                                 : std::abs((rows_[keys.back()].azimuth - rows_[keys.front()].azimuth).degrees()) /
                                       static_cast<double>(n - 1);
    best.range_m = window_.centre(best_bin);
    best.azimuth = rows_[best_key].azimuth;
    best.length_m = (far - near + 1) * window_.bin_m;
    best.width = Angle::degrees(span * static_cast<double>(run));
    strongest_.push_back(best);
  }
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
    if (k < first && end > first) end = first;  // a group is blind or not
    const std::vector<std::uint64_t> counts = histogram_.pooled(k, end);
    RangeLevels range = summed_up(levels, counts);
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
  out.all = summed_up(levels, out.counts);
  out.all.near_m = window_.edge(first);
  out.all.far_m = window_.end_m();
  const RangeLevels quiet = summed_up(levels, out.background);
  out.background_share = quiet.samples / std::max(out.all.samples, 1.0);
  out.background_mean = quiet.mean;
  out.background_deviation = quiet.deviation;
  out.bright_share = bright / std::max(out.all.samples, 1.0);
  // Where the water is black, half a count stands for it: less cannot be told apart.
  if (bright > 0) out.bright_over_db = decibels(bright_sum / std::max(bright_background, 0.5 * bright));
}

SampleStatistics SampleCollector::finish(const std::string& name) {
  if (!begun_) throw Error("no image of a sonar in it", {name, {}, {}, {}, {}}, {}, "isobath info says what is");
  if (first_bin() >= window_.bins) {
    throw Error(fmt::format("blind over its whole range of {:g} m", window_.end_m()), {name, {}, {}, {}, {}}, {},
                "set calibration.blind_m");
  }
  // A turn that was broken off is no scan, unless there is no other.
  if (scans_ == 0) end_scan();
  SampleStatistics out;
  out.name = name;
  out.pings = pings_;
  out.left_out = left_out_;
  out.scans = scans_;
  out.blind_m = blind_m_;
  levels(out);
  for (const NoiseLaw law : {NoiseLaw::kGaussian, NoiseLaw::kRayleigh, NoiseLaw::kK}) {
    NoiseFitConfig config;
    config.bootstraps = 0;  // samples of neighbours depend on each other: a p-value would say nothing
    out.fits.push_back(fit_noise(out.levels, out.background, law, config));
  }
  if (brightest_count_ > 0) out.brightest_mean = brightest_sum_ / brightest_count_;
  if (others_count_ > 0) out.brightest_others = others_sum_ / others_count_;
  out.strongest = strongest_;

  std::vector<const Row*> rows;
  for (const auto& [key, row] : rows_) rows.push_back(&row);
  std::stable_sort(rows.begin(), rows.end(), [](const Row* a, const Row* b) {
    return a->azimuth.wrapped().radians() < b->azimuth.wrapped().radians();
  });
  out.mean.window = out.scan.window = window_;
  out.mean.width = out.scan.width = width_;
  double variance = 0, cells = 0, sum = 0, squares = 0, mean_cells = 0;
  for (const Row* row : rows) {
    const auto n = static_cast<double>(row->pings);
    out.mean.azimuth.push_back(row->azimuth);
    for (int k = 0; k < window_.bins; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const double mean = row->sum[i] / n;
      out.mean.values.push_back(static_cast<float>(mean));
      if (k < first_bin()) continue;
      sum += mean;
      squares += mean * mean;
      ++mean_cells;
      if (row->pings < 2) continue;
      variance += std::max(0.0, (row->squares[i] - n * mean * mean) / (n - 1));
      ++cells;
    }
  }
  if (cells > 0) out.spread_over_scans = std::sqrt(variance / cells);
  if (mean_cells > 0)
    out.spread_over_cells = std::sqrt(std::max(0.0, squares / mean_cells - std::pow(sum / mean_cells, 2)));
  if (!kept_.empty()) {
    const auto& middle = kept_[kept_.size() / 2];
    for (const Row* row : rows) {
      const auto key = std::find_if(rows_.begin(), rows_.end(), [row](const auto& r) { return &r.second == row; });
      const auto found = middle.find(key->first);
      if (found == middle.end()) continue;
      out.scan.azimuth.push_back(row->azimuth);
      out.scan.values.insert(out.scan.values.end(), found->second.begin(), found->second.end());
    }
  }
  return out;
}

// Reading ------------------------------------------------------------------------------------------------------------

namespace {

SampleStatistics collect(const std::filesystem::path& input, const CompareRequest& request) {
  std::unique_ptr<Source> source;
  if (is_scene(input)) {
    source = std::make_unique<SimulatedSource>(open_scene(input), request.configuration.simulation, request.threads);
  } else {
    source = open_source(input, request.configuration.input);
  }
  SampleCollector collector(request.configuration.calibration.blind_m);
  std::uint64_t pings = 0;
  while (const auto event = source->next()) {
    const auto* ping = std::get_if<Ping>(&*event);
    if (!ping || check(*ping) != PingFault::kNone) continue;
    collector.take(*ping);
    if (request.progress) request.progress(source->report(), ++pings);
  }
  SampleStatistics out = collector.finish(input.string());
  out.format = source->report().format;
  return out;
}

double distance(const SampleStatistics& a, const SampleStatistics& b) {
  const EchoDistribution da(a.levels, a.background), db(b.levels, b.background);
  double most = 0;
  for (double x = 0.5; x < kFullScale; ++x)
    most = std::max(most, std::abs(da.rate_at_or_above(x) - db.rate_at_or_above(x)));
  return most;
}

// Pictures -----------------------------------------------------------------------------------------------------------

const Colour kColourA = palette::kTrack, kColourB = palette::kObstacle;

Colour faint(Colour c) { return {c.red, c.green, c.blue, 0.16}; }

/// Counts to brightness: a square root, so that background and echoes are both seen.
double brightness(double counts, double top) { return std::sqrt(std::clamp(counts / top, 0.0, 1.0)); }

std::string level_chart(const CompareOutcome& c, const std::string& a, const std::string& b) {
  double near = 1e9, far = 0, top = 1;
  for (const SampleStatistics* s : {&c.a, &c.b}) {
    near = std::min(near, s->ranges.front().near_m);
    far = std::max(far, s->ranges.back().far_m);
    for (const RangeLevels& r : s->ranges) top = std::max(top, r.top);
  }
  ChartPicture chart(760, 420, "Level by range: median (thick), 16 to 84 % (band), 99 % (dashed)",
                     {"range (m)", near, far}, {"level (counts of 255)", 0, std::min(255.0, 1.05 * top)});
  for (const auto& [s, colour, name] : {std::tuple(&c.a, kColourA, a), {&c.b, kColourB, b}}) {
    std::vector<double> x, low, median, high, most;
    for (const RangeLevels& r : s->ranges) {
      x.push_back((r.near_m + r.far_m) / 2);
      low.push_back(r.low);
      median.push_back(r.median);
      high.push_back(r.high);
      most.push_back(r.top);
    }
    chart.band(x, low, high, faint(colour));
    chart.curve(x, median, {colour, 2.5, false}, name);
    chart.curve(x, most, {colour, 1.2, true}, "");
  }
  chart.finish();
  return chart.png();
}

/// Share of the samples by value, in steps of a count; the law that is nearest beside it.
std::string background_chart(const CompareOutcome& c, const std::string& a, const std::string& b) {
  const auto shares_of = [](const SampleStatistics& s, int to) {
    const EchoDistribution d(s.levels, s.background);
    std::vector<double> shares;
    for (int v = 0; v <= to; ++v)
      shares.push_back((v == 0 ? 1 : d.rate_at_or_above(v - 0.5)) - d.rate_at_or_above(v + 0.5));
    return shares;
  };
  int to = 4;
  for (const SampleStatistics* s : {&c.a, &c.b}) {
    const std::vector<double> shares = shares_of(*s, 255);
    double above = 1;
    for (int v = 0; v < 255; ++v) {
      above -= shares[static_cast<std::size_t>(v)];
      if (above < 0.002) {
        to = std::max(to, v + 2);
        break;
      }
    }
  }
  ChartPicture chart(760, 420, "Background: share of the samples by value, and the law that fits best (dashed)",
                     {"value (counts of 255)", 0, static_cast<double>(to)},
                     {"share of the background samples, a count", 1e-7, 1, true});
  std::vector<double> x(static_cast<std::size_t>(to) + 1);
  std::iota(x.begin(), x.end(), 0.0);
  const int step = std::max(1, (to + 23) / 48);
  std::vector<double> at{0};
  for (int v = 1; v + step - 1 <= to; v += step) at.push_back(v + (step - 1) / 2.0);
  for (const auto& [s, colour, name] : {std::tuple(&c.a, kColourA, a), {&c.b, kColourB, b}}) {
    std::vector<double> shares = shares_of(*s, to), law;
    const auto best = std::min_element(s->fits.begin(), s->fits.end(),
                                       [](const NoiseFit& u, const NoiseFit& v) { return u.statistic < v.statistic; });
    for (const double v : x) law.push_back(cumulative(*best, v + 0.5) - (v > 0 ? cumulative(*best, v - 0.5) : 0));
    // Devices leave values out (two of three, say): steps wide enough to see the law and not the gaps.
    const auto in_steps = [&](const std::vector<double>& of) {
      std::vector<double> means{of[0]};
      for (int v = 1; v + step - 1 <= to; v += step) {
        const auto from = of.begin() + v;
        const double mean = std::accumulate(from, from + step, 0.0) / step;
        means.push_back(mean > 3e-6 ? mean : std::numeric_limits<double>::quiet_NaN());
      }
      return means;
    };
    chart.curve(at, in_steps(shares), {colour, 2.5, false},
                fmt::format("{}; nearest: {} law", name, law_name(best->law)));
    chart.curve(at, in_steps(law), {colour, 1.2, true}, "");
  }
  chart.finish();
  return chart.png();
}

/// How many samples reach a level: all of them, behind the blind zone.
std::string exceedance_chart(const CompareOutcome& c, const std::string& a, const std::string& b) {
  ChartPicture chart(760, 420, "All samples: share at or above a value", {"value (counts of 255)", 0, 255},
                     {"share of the samples", 1e-8, 1, true});
  for (const auto& [s, colour, name] : {std::tuple(&c.a, kColourA, a), {&c.b, kColourB, b}}) {
    const EchoDistribution d(s->levels, s->counts);
    std::vector<double> x, y;
    for (int v = 1; v <= 255; ++v) {
      const double share = d.rate_at_or_above(v - 0.5);
      if (share <= 0) break;
      x.push_back(v);
      y.push_back(share);
    }
    chart.curve(x, y, {colour, 2.5, false}, name);
  }
  chart.finish();
  return chart.png();
}

bool whole_turn(const PolarImage& image) {
  return image.azimuth.size() > 2 &&
         abs(image.azimuth.back().wrapped() - image.azimuth.front().wrapped()).degrees() > 300;
}

PlanExtent extent_of(const PolarImage& image) {
  const double far = image.window.end_m();
  if (whole_turn(image)) return {-far, far, -far, far};
  double x = 0, left = 0, right = 0;
  for (const Angle azimuth : image.azimuth) {
    x = std::min(x, far * cos(azimuth));
    left = std::min(left, far * sin(azimuth));
    right = std::max(right, far * sin(azimuth));
  }
  return {x, 1.02 * far, left - 0.03 * far, right + 0.03 * far};
}

std::string image_picture(const PolarImage& image, const PlanExtent& extent, double top, const std::string& title) {
  PlanPicture picture(extent, 430, {title, "forward (m)", "starboard (m)"});
  const std::size_t rows = image.azimuth.size();
  std::vector<double> azimuth;
  for (const Angle a : image.azimuth) azimuth.push_back(a.wrapped().radians());
  const double step = rows > 1 ? (azimuth.back() - azimuth.front()) / static_cast<double>(rows - 1) : 0;
  const double reach = std::max(0.75 * step, image.width.radians() / 2);
  picture.raster([&](double x, double y) -> Colour {
    constexpr Colour kNothing{0.93, 0.93, 0.93, 1};
    const double r = std::hypot(x, y), bearing = std::atan2(y, x);
    const int bin = static_cast<int>(std::floor((r - image.window.start_m) / image.window.bin_m));
    if (bin < 0 || bin >= image.window.bins || rows == 0) return kNothing;
    const auto next = std::lower_bound(azimuth.begin(), azimuth.end(), bearing);
    std::size_t best = 0;
    double off = 1e9;
    for (const std::ptrdiff_t i : {next - azimuth.begin() - 1, next - azimuth.begin()}) {
      const auto n = static_cast<std::ptrdiff_t>(rows);
      const auto row = static_cast<std::size_t>((i + n) % n);
      const double d = std::abs(std::remainder(azimuth[row] - bearing, 2 * std::numbers::pi));
      if (d < off) {
        off = d;
        best = row;
      }
    }
    if (off > reach) return kNothing;
    // Few shades: a picture of noise is large otherwise.
    return intensity_colour(std::round(24 * brightness(static_cast<double>(image(best, bin)), top)) / 24);
  });
  const double far = image.window.end_m();
  picture.range_rings({0, 0}, far > 25 ? 10 : far > 8 ? 2 : 1);
  picture.finish({{intensity_colour(0), "0"},
                  {intensity_colour(brightness(top / 16, top)), fmt::format("{:.0f}", top / 16)},
                  {intensity_colour(brightness(top / 4, top)), fmt::format("{:.0f}", top / 4)},
                  {intensity_colour(1), fmt::format("{:.0f}", top)}});
  return picture.png();
}

/// What 99.9 % of either recording's samples stay below, counts.
double top_of(const CompareOutcome& c) {
  double top = 32;
  for (const SampleStatistics* s : {&c.a, &c.b})
    top = std::max(top, EchoDistribution(s->levels, s->counts).quantile(0.999));
  return std::min(255.0, 16 * std::ceil(top / 16));
}

// Text ---------------------------------------------------------------------------------------------------------------

std::string short_name(const std::string& name) {
  std::filesystem::path path = name;
  if (!path.has_filename()) path = path.parent_path();
  return path.filename().string();
}

ordered_json to_json(const RangeLevels& r) {
  return {{"near_m", r.near_m},
          {"far_m", r.far_m},
          {"samples", r.samples},
          {"mean", r.mean},
          {"deviation", r.deviation},
          {"level_16", r.low},
          {"median", r.median},
          {"level_84", r.high},
          {"level_99", r.top},
          {"zeros", r.zeros},
          {"background_mean", r.background},
          {"background_limit", r.background_limit}};
}

ordered_json to_json(const SampleStatistics& s) {
  ordered_json ranges = ordered_json::array(), fits = ordered_json::array();
  for (const RangeLevels& r : s.ranges) ranges.push_back(to_json(r));
  for (const NoiseFit& f : s.fits) {
    fits.push_back({{"law", to_text(f.law)},
                    {"location", f.location},
                    {"scale", f.scale},
                    {"shape", f.shape},
                    {"statistic", f.statistic},
                    {"samples", f.samples}});
  }
  const auto spread = [&](auto value) {
    const Quantiles q = quantiles(s.strongest, value);
    return ordered_json{{"low_16", q.low}, {"median", q.median}, {"high_84", q.high}};
  };
  return {{"input", s.name},
          {"format", s.format},
          {"pings", s.pings},
          {"pings_left_out", s.left_out},
          {"scans", s.scans},
          {"blind_m", s.blind_m},
          {"all", to_json(s.all)},
          {"spread_over_scans", s.spread_over_scans},
          {"spread_over_cells", s.spread_over_cells},
          {"background",
           {{"share", s.background_share},
            {"mean", s.background_mean},
            {"deviation", s.background_deviation},
            {"fits", fits}}},
          {"bright", {{"share", s.bright_share}, {"over_background_db", s.bright_over_db}}},
          {"brightest", {{"share", kBrightestShare}, {"mean", s.brightest_mean}, {"others", s.brightest_others}}},
          {"strongest_echo",
           {{"level", spread([](const StrongestEcho& e) { return e.level; })},
            {"range_m", spread([](const StrongestEcho& e) { return e.range_m; })},
            {"length_m", spread([](const StrongestEcho& e) { return e.length_m; })},
            {"width_deg", spread([](const StrongestEcho& e) { return e.width.degrees(); })}}},
          {"ranges", ranges}};
}

/// Counts of both in eight stretches of the range that they share.
std::vector<HtmlReport::Row> range_rows(const CompareOutcome& c) {
  const double near = std::max(c.a.all.near_m, c.b.all.near_m), far = std::min(c.a.all.far_m, c.b.all.far_m);
  std::vector<HtmlReport::Row> rows;
  constexpr int kStretches = 8;
  for (int i = 0; i < kStretches && far > near; ++i) {
    const double from = near + (far - near) * i / kStretches, to = near + (far - near) * (i + 1) / kStretches;
    HtmlReport::Row row{fmt::format("{:.2f} to {:.2f}", from, to)};
    for (const SampleStatistics* s : {&c.a, &c.b}) {
      std::vector<std::uint64_t> counts(static_cast<std::size_t>(s->levels.count()), 0);
      for (const RangeLevels& r : s->ranges) {
        const double middle = (r.near_m + r.far_m) / 2;
        if (middle < from || middle >= to) continue;
        for (std::size_t l = 0; l < counts.size(); ++l) counts[l] += r.counts[l];
      }
      const RangeLevels r = summed_up(s->levels, counts);
      row.push_back(fmt::format("{:.1f}", r.mean));
      row.push_back(fmt::format("{:.1f} ({:.1f} to {:.1f})", r.median, r.low, r.high));
      row.push_back(fmt::format("{:.0f}", r.top));
      row.push_back(fmt::format("{:.0f} %", 100 * r.zeros));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

std::vector<ComparedValue> compared_values(const CompareOutcome& c) {
  std::vector<ComparedValue> rows;
  const auto add = [&](const std::string& what, auto text) { rows.push_back({what, text(c.a), text(c.b)}); };
  using S = SampleStatistics;
  const auto spread = [](const Quantiles& q, int digits) {
    return fmt::format("{:.{}f} ({:.{}f} to {:.{}f})", q.median, digits, q.low, digits, q.high, digits);
  };
  add("pings; scans", [](const S& s) { return fmt::format("{}; {}", s.pings, s.scans); });
  add("samples of value 0, %", [](const S& s) { return fmt::format("{:.1f}", 100 * s.all.zeros); });
  add("all samples: mean; standard deviation, counts",
      [](const S& s) { return fmt::format("{:.1f}; {:.1f}", s.all.mean, s.all.deviation); });
  add("median (16 to 84 %); 99 %, counts", [](const S& s) {
    return fmt::format("{:.1f} ({:.1f} to {:.1f}); {:.0f}", s.all.median, s.all.low, s.all.high, s.all.top);
  });
  add("spread of a cell from scan to scan (rms), counts",
      [](const S& s) { return s.scans > 1 ? fmt::format("{:.1f}", s.spread_over_scans) : std::string("one scan"); });
  add("spread of the mean image from cell to cell, counts",
      [](const S& s) { return fmt::format("{:.1f}", s.spread_over_cells); });
  add("background: share of the samples, %",
      [](const S& s) { return fmt::format("{:.1f}", 100 * s.background_share); });
  add("background: mean; standard deviation, counts",
      [](const S& s) { return fmt::format("{:.1f}; {:.1f}", s.background_mean, s.background_deviation); });
  for (std::size_t i = 0; i < c.a.fits.size(); ++i) {
    add(fmt::format("{} fitted to it (misfit a sample, x 1000)", law_name(c.a.fits[i].law)), [i](const S& s) {
      const NoiseFit& f = s.fits[i];
      if (!std::isfinite(f.statistic)) return std::string("cannot be it");
      const std::string misfit = fmt::format("{:.0f}", 1000 * f.statistic / static_cast<double>(f.samples));
      if (f.law == NoiseLaw::kGaussian)
        return fmt::format("mean {:.1f}, sigma {:.1f} ({})", f.location, f.scale, misfit);
      if (f.law == NoiseLaw::kRayleigh) return fmt::format("scale {:.1f} ({})", f.scale, misfit);
      return fmt::format("shape {:.3g}, scale {:.2g} ({})", f.shape, f.scale, misfit);
    });
  }
  add("bright samples: share, %", [](const S& s) { return fmt::format("{:.2f}", 100 * s.bright_share); });
  add("bright samples over the background, dB", [](const S& s) { return fmt::format("{:.1f}", s.bright_over_db); });
  add("brightest 0.2 % of a scan: mean; the others, counts",
      [](const S& s) { return fmt::format("{:.0f}; {:.1f}", s.brightest_mean, s.brightest_others); });
  add("strongest echo of a scan, counts",
      [&](const S& s) { return spread(quantiles(s.strongest, [](const StrongestEcho& e) { return e.level; }), 0); });
  add("its range, m",
      [&](const S& s) { return spread(quantiles(s.strongest, [](const StrongestEcho& e) { return e.range_m; }), 2); });
  add("its length along range at -6 dB, m",
      [&](const S& s) { return spread(quantiles(s.strongest, [](const StrongestEcho& e) { return e.length_m; }), 3); });
  add("its width across bearing at -6 dB, deg", [&](const S& s) {
    return spread(quantiles(s.strongest, [](const StrongestEcho& e) { return e.width.degrees(); }), 1);
  });
  return rows;
}

std::string to_json(const CompareOutcome& outcome) {
  const ordered_json json = {
      {"a", to_json(outcome.a)}, {"b", to_json(outcome.b)}, {"background_distance", outcome.background_distance}};
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

CompareOutcome compare(const CompareRequest& request) {
  CompareOutcome outcome;
  outcome.a = collect(request.a, request);
  outcome.b = collect(request.b, request);
  outcome.background_distance = distance(outcome.a, outcome.b);

  const std::string a = "A: " + short_name(outcome.a.name), b = "B: " + short_name(outcome.b.name);
  make_folder(request.out);
  const auto write = [&](const std::string& name, const std::string& bytes) {
    write_file(request.out / name, bytes);
    outcome.files.emplace_back(name);
  };
  const PlanExtent ea = extent_of(outcome.a.mean), eb = extent_of(outcome.b.mean);
  const PlanExtent extent{std::min(ea.x_min, eb.x_min), std::max(ea.x_max, eb.x_max), std::min(ea.y_min, eb.y_min),
                          std::max(ea.y_max, eb.y_max)};
  const double top = top_of(outcome);
  const std::string levels = level_chart(outcome, a, b), background = background_chart(outcome, a, b),
                    exceedance = exceedance_chart(outcome, a, b);
  const std::string scan_a = image_picture(outcome.a.scan, extent, top, a + ", one scan"),
                    scan_b = image_picture(outcome.b.scan, extent, top, b + ", one scan"),
                    mean_a = image_picture(outcome.a.mean, extent, top, a + ", mean"),
                    mean_b = image_picture(outcome.b.mean, extent, top, b + ", mean");
  write("comparison.json", to_json(outcome));
  write("levels.png", levels);
  write("background.png", background);
  write("exceedance.png", exceedance);
  write("scan_a.png", scan_a);
  write("scan_b.png", scan_b);
  write("mean_a.png", mean_a);
  write("mean_b.png", mean_b);

  HtmlReport page("Isobath: two recordings side by side",
                  fmt::format("A: {} ({}). B: {} ({}). Samples in counts of a full scale of 255; ranges nearer than "
                              "{:g} m (A) and {:g} m (B) are drawn but not counted.",
                              outcome.a.name, outcome.a.format, outcome.b.name, outcome.b.format, outcome.a.all.near_m,
                              outcome.b.all.near_m));
  if (outcome.a.left_out + outcome.b.left_out > 0) {
    page.warning(fmt::format("{} pings of A and {} of B have another range or other beams than the first: left out.",
                             outcome.a.left_out, outcome.b.left_out));
  }
  page.heading("What they look like");
  page.begin_row();
  page.figure(scan_a, "One scan of A. Brightness is the square root of the level, the same in all four pictures.");
  page.figure(scan_b, "One scan of B.");
  page.end_row();
  page.begin_row();
  page.figure(mean_a, "Mean of all scans of A.");
  page.figure(mean_b, "Mean of all scans of B.");
  page.end_row();
  page.heading("In numbers");
  std::vector<HtmlReport::Row> rows;
  for (const ComparedValue& v : compared_values(outcome)) rows.push_back({v.what, v.a, v.b});
  page.table({"", a, b}, rows);
  page.paragraph(fmt::format(
      "Background is what stays below the median of its range plus three times the distance from the 16 % level to the "
      "median (from the median to the 84 % level where 40 % and more of the samples are 0). Bright is what is 12 dB "
      "above the mean background of its range, and at least {:.0f} counts. In "
      "brackets: "
      "16 to 84 % of the scans. The misfit is the Anderson-Darling statistic: smaller is nearer. The backgrounds "
      "differ "
      "by {:.1f} % of the samples at most (Kolmogorov-Smirnov).",
      kBrightLeast, 100 * outcome.background_distance));
  page.heading("By range");
  page.figure(levels, "All bearings together, echoes included.");
  page.table({"range (m)", "A: mean", "A: median (16 to 84 %)", "A: 99 %", "A: zeros", "B: mean",
              "B: median (16 to 84 %)", "B: 99 %", "B: zeros"},
             range_rows(outcome));
  page.heading("By value");
  page.begin_row();
  page.figure(background, "The background: a logarithmic scale.");
  page.figure(exceedance, "All samples behind the blind zone.");
  page.end_row();
  Configuration configuration = request.configuration;
  page.folded("Configuration in force", write_toml(sections(configuration), true));
  write("report.html", page.html());
  return outcome;
}

}  // namespace isobath
