// The page of a crosscheck: tables and three pictures.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/geometry/contours.hpp>
#include <isobath/map/depth/depth_pixel.hpp>
#include <isobath/report/plot/picture.hpp>
#include <isobath/studies/crosscheck.hpp>
#include <iterator>
#include <numbers>

namespace isobath {
namespace {

constexpr Colour kBars{0.35, 0.60, 0.80, 0.9}, kDots{0.10, 0.35, 0.60, 0.25};
constexpr std::size_t kMaxDots = 4000;

/// Half the width of the pictures, which covers most differences without the outliers.
double shown_width(const CrosscheckResult& r) {
  const double width = std::max({0.1, 1.5 * r.all.p95_m, 4 * r.all.robust_sd_m + std::abs(r.all.median_m)});
  const double step = nice_step(0, width, 5);
  return step * std::ceil(width / step);
}

std::string histogram(const std::vector<CrosscheckSample>& samples, const CrosscheckResult& r) {
  const double width = shown_width(r);
  constexpr int kBins = 60;
  std::vector<double> count(kBins, 0);
  for (const CrosscheckSample& s : samples) {
    const double at = (difference(s) + width) / (2 * width) * kBins;
    if (at >= 0 && at < kBins) ++count[static_cast<std::size_t>(at)];
  }
  const double bin = 2 * width / kBins;
  const double top = *std::max_element(count.begin(), count.end());
  ChartPicture chart(640, 380, "Differences, sounding minus map", {"difference (m)", -width, width},
                     {"soundings", 0, std::max(1.0, 1.1 * top)});
  std::vector<double> x, y, zero;
  for (int i = 0; i < kBins; ++i) {
    for (const int end : {0, 1}) {
      x.push_back(-width + (i + end) * bin);
      y.push_back(count[static_cast<std::size_t>(i)]);
      zero.push_back(0);
    }
  }
  chart.band(x, zero, y, kBars);
  if (r.all.robust_sd_m > 0) {
    std::vector<double> nx, ny;
    for (int i = 0; i <= 200; ++i) {
      const double v = -width + 2 * width * i / 200, z = (v - r.all.median_m) / r.all.robust_sd_m;
      nx.push_back(v);
      ny.push_back(static_cast<double>(r.all.n) * bin / (r.all.robust_sd_m * std::sqrt(2 * std::numbers::pi)) *
                   std::exp(-z * z / 2));
    }
    chart.curve(nx, ny, {palette::kObstacle, 1.5, true}, "");
  }
  chart.finish();
  return chart.png();
}

std::string against_depth(const std::vector<CrosscheckSample>& samples, const CrosscheckResult& r) {
  const double width = shown_width(r);
  const double low = r.by_depth.front().from_m, high = r.by_depth.back().to_m;
  ChartPicture chart(640, 380, "Differences against depth", {"sounded depth (m)", low, high},
                     {"difference (m)", -width, width});
  std::vector<double> x, y;
  const std::size_t every = samples.size() / kMaxDots + 1;
  for (std::size_t i = 0; i < samples.size(); i += every) {
    x.push_back(samples[i].observed_m);
    y.push_back(std::clamp(difference(samples[i]), -width, width));
  }
  chart.points(x, y, kDots, every == 1 ? "soundings" : fmt::format("one of {} soundings", every));
  for (const auto& order : r.s44) {
    const std::string name = order.name;
    if (name != "Special" && name != "1a") continue;
    const Stroke stroke{name == "1a" ? palette::kObstacle : palette::kTruth, 1.4, true};
    for (const double sign : {-1.0, 1.0}) {
      std::vector<double> dx, dy;
      for (int i = 0; i <= 60; ++i) {
        dx.push_back(low + (high - low) * i / 60);
        dy.push_back(sign * total_vertical_uncertainty(order.a_m, order.b, dx.back()));
      }
      if (std::abs(dy.back()) < width) chart.curve(dx, dy, stroke, sign > 0 ? "S-44 order " + name : "");
    }
  }
  std::vector<double> middle, median;
  for (const auto& c : r.by_depth) {
    middle.push_back((c.from_m + c.to_m) / 2);
    median.push_back(c.differences.median_m);
  }
  chart.curve(middle, median, {palette::kInk, 2, false}, "median");
  chart.finish();
  return chart.png();
}

std::string calibration_plot(const CrosscheckResult& r) {
  ChartPicture chart(640, 380, "Calibration of the confidence", {"confidence of the map", 0, kFullConfidence},
                     {"soundings that agree (%)", 0, 100});
  std::vector<double> x, y, from, promised;
  for (const auto& p : r.calibration) {
    from.insert(from.end(), {p.confidence - 0.5, std::min(p.confidence + 0.5, double{kFullConfidence})});
    promised.insert(promised.end(), 2, 100 * p.promised);
  }
  chart.curve(from, promised, {palette::kObstacle, 1.5, true}, "");
  for (const auto& p : r.calibration) {
    x.push_back(p.confidence);
    y.push_back(100 * p.share);
    chart.curve(std::vector<double>(2, p.confidence), std::vector<double>{100 * p.interval.low, 100 * p.interval.high},
                {palette::kTrack, 1.5, false}, "");
  }
  chart.points(x, y, palette::kTrack, "");
  chart.finish();
  return chart.png();
}

std::string metres(double v) { return std::isnan(v) ? "-" : fmt::format("{:.3f}", v); }
HtmlReport::Row difference_row(const std::string& name, const DifferenceStatistics& s) {
  return {name, std::to_string(s.n), metres(s.median_m), metres(s.robust_sd_m), metres(s.p95_m)};
}

void tables(const CrosscheckInput& input, const CrosscheckResult& r, HtmlReport& page) {
  const auto header = [](const std::string& first) {
    return HtmlReport::Row{first, "soundings", "median (m)", "robust sd (m)", "95 % of |difference| (m)"};
  };
  std::vector<HtmlReport::Row> rows;
  for (const auto& c : r.by_depth)
    rows.push_back(difference_row(fmt::format("{:g} to {:g}", c.from_m, c.to_m), c.differences));
  page.heading("By depth");
  page.table(header("sounded depth (m)"), rows);
  rows.clear();
  for (const auto& c : r.by_confidence) {
    rows.push_back(difference_row(c.low == c.high ? std::to_string(c.low) : fmt::format("{} to {}", c.low, c.high),
                                  c.differences));
  }
  page.heading("By confidence of the map");
  page.table(header("confidence"), rows);

  if (r.offset) {
    page.heading("Position");
    page.paragraph("Judged by its depths where the bottom slopes, " + to_text(*r.offset) +
                   ". This is a diagnosis; nothing was corrected.");
  }
  page.heading("Against the orders of IHO S-44");
  rows.clear();
  for (const auto& o : r.s44) {
    rows.push_back({o.name, fmt::format("sqrt({:g}² + ({:g} d)²)", o.a_m, o.b), fmt::format("{:.1f} %", 100 * o.share),
                    o.met ? "yes" : "no"});
  }
  page.table({"order", "allowed at 95 % (m)", "soundings within", "95 % within"}, rows);
  page.paragraph(
      "Edition 6, vertical uncertainty only: an order also requires coverage, detection of features and positioning. "
      "The errors of the soundings themselves count against the map.");

  page.heading("Confidence");
  rows.clear();
  for (const auto& p : r.calibration) {
    rows.push_back({std::to_string(p.confidence), std::to_string(p.n), fmt::format("{:.1f} %", 100 * p.share),
                    std::isnan(p.aligned) ? "-" : fmt::format("{:.1f} %", 100 * p.aligned),
                    fmt::format("{:.0f} %{}", 100 * p.promised, p.learnt ? "" : " (5 % a step)"),
                    fmt::format("{:.1f} to {:.1f} %", 100 * p.interval.low, 100 * p.interval.high)});
  }
  page.table({"confidence", "soundings", "agree", "agree once aligned", "promised", "95 % interval (Wilson)"}, rows);
  page.paragraph(fmt::format(
      "A sounding agrees if it differs from the map by at most {:g} m or {:g} % of the depth, whichever is larger. The "
      "measured and the promised share differ by {:.1f} % on average. The map promises what its own later passes "
      "found; "
      "where they were too few, 5 % a step. The intervals count one sounding a footprint; what all soundings of this "
      "log "
      "share, such as an offset of their positions, is not in them; how many would agree once the log is moved by its "
      "offset stands beside.",
      input.margin_floor_m, 100 * input.margin_share, 100 * r.calibration_error));
  if (!r.uncertainty) return;
  page.heading("Uncertainty of the depths");
  rows.clear();
  for (const auto& w : r.within) {
    rows.push_back({slope_class(w), std::to_string(w.n),
                    fmt::format("{:.1f} %", 100 * static_cast<double>(w.within) / static_cast<double>(w.n)),
                    fmt::format("{:.1f} to {:.1f} %", 100 * w.interval.low, 100 * w.interval.high)});
  }
  page.table({"slope of the bottom", "soundings", "within the uncertainty", "95 % interval (Wilson)"}, rows);
  const std::string learnt_from = to_text(*r.uncertainty, input.margin_floor_m);
  page.paragraph("The map states an uncertainty at 95 % that it has " + learnt_from +
                 ". On a slope an error of position is an error of depth. 95 % of the soundings should lie within.");
}

}  // namespace

HtmlReport crosscheck_page(const CrosscheckInput& input, const CrosscheckResult& r) {
  HtmlReport page("Isobath: a depth map checked against independent soundings",
                  fmt::format("Map: {}. Soundings: {}. Differences are the sounding minus the map: negative where the "
                              "bottom is shoaler than the map says.",
                              input.map, input.log));
  if (r.all.n == 0) {
    page.warning(fmt::format("None of the {} soundings could be compared with the map.", r.offered));
  } else {
    page.paragraph(fmt::format(
        "{1} of {0} soundings ({2:.1f} %) fell on known parts of the map. Median {3:.3f} m, robust standard deviation "
        "{4:.3f} m, 95 % within {5:.3f} m.",
        r.offered, r.all.n, 100 * r.covered, r.all.median_m, r.all.robust_sd_m, r.all.p95_m));
    if (r.shoaler > 0) {
      page.warning(
          fmt::format("{:.2f} % of the soundings found the bottom shoaler than the map by more than {:g} m or "
                      "{:g} % of the depth.",
                      100 * r.shoaler, input.margin_floor_m, 100 * input.margin_share));
    }
  }
  std::vector<HtmlReport::Row> reasons;
  for (const auto& [reason, count] : r.left_out) reasons.push_back({reason, std::to_string(count)});
  if (!reasons.empty()) page.table({"left out", "soundings"}, reasons);
  if (r.all.n == 0) return page;
  std::vector<CrosscheckSample> samples;
  std::copy_if(input.samples.begin(), input.samples.end(), std::back_inserter(samples), comparable);
  page.begin_row();
  page.figure(histogram(samples, r),
              "Histogram of the differences. Dashed: a normal law of the same median and spread.");
  page.figure(against_depth(samples, r), "Differences beyond the picture are drawn at its edge.");
  page.end_row();
  page.figure(
      calibration_plot(r),
      "Dots: the share that agrees, with its 95 % interval. Dashed: what the map promises. Above the line the map is "
      "better than it says; below it, worse.");
  tables(input, r, page);
  return page;
}

}  // namespace isobath
