#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/report/plot/picture.hpp>
#include <isobath/studies/comparison_pictures.hpp>
#include <limits>
#include <numbers>
#include <numeric>

namespace isobath {
namespace {

const Colour kColourA = palette::kTrack, kColourB = palette::kObstacle;

Colour faint(Colour c) { return {c.red, c.green, c.blue, 0.16}; }

/// Counts to brightness: a square root, so that both background and echoes are visible.
double brightness(double counts, double top) { return std::sqrt(std::clamp(counts / top, 0.0, 1.0)); }

bool whole_turn(const PolarImage& image) {
  return image.azimuth.size() > 2 &&
         abs(image.azimuth.back().wrapped() - image.azimuth.front().wrapped()).degrees() > 300;
}

}  // namespace

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
                     {"share of the background samples per count", 1e-7, 1, true});
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
    // Some devices skip values (two of three, for example): the steps are wide enough to show the law and not the gaps.
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
                fmt::format("{}; best fit: {} law", name, law_name(best->law)));
    chart.curve(at, in_steps(law), {colour, 1.2, true}, "");
  }
  chart.finish();
  return chart.png();
}

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
    // Few shades keep the PNG of a noisy image small.
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

double top_of(const CompareOutcome& c) {
  double top = 32;
  for (const SampleStatistics* s : {&c.a, &c.b})
    top = std::max(top, EchoDistribution(s->levels, s->counts).quantile(0.999));
  return std::min(255.0, 16 * std::ceil(top / 16));
}

}  // namespace isobath
