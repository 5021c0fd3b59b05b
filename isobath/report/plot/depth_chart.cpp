#include <algorithm>
#include <cmath>
#include <Eigen/Geometry>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/depth_pixel.hpp>
#include <isobath/report/plot/chart_field.hpp>
#include <isobath/report/plot/chart_layout.hpp>
#include <isobath/report/plot/depth_chart.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr Colour kLand{0.96, 0.90, 0.74, 1}, kDrying{0.72, 0.80, 0.55, 1};
constexpr Colour kShoreLine{0.30, 0.24, 0.12, 1}, kTrackLine{0.10, 0.10, 0.14, 0.55};
constexpr Colour kUnknown{0.86, 0.86, 0.86, 1};
constexpr int kNodePx = 3;           // picture pixels between the nodes of contours
constexpr int kFigurePx = 74;        // side of the squares that have one sounding each
constexpr float kMeasuredPx = 1.2f;  // radius of picture pixels that a measured one colours
constexpr double kChartedPaleness = 0.35, kNearPaleness = 0.36, kFarPaleness = 0.80;

struct ConfidenceClass {
  int low, high;
  Colour colour;
  const char* name;
};
constexpr std::array<ConfidenceClass, 5> kClasses{{{0, 4, {0.70, 0.22, 0.02, 1}, "0 - 4  (below 25 %)"},
                                                   {5, 9, {0.97, 0.58, 0.25, 1}, "5 - 9  (25 - 45 %)"},
                                                   {10, 14, {0.99, 0.87, 0.55, 1}, "10 - 14  (50 - 70 %)"},
                                                   {15, 19, {0.40, 0.66, 0.85, 1}, "15 - 19  (75 - 95 %)"},
                                                   {20, 20, {0.02, 0.22, 0.48, 1}, "20  (full)"}}};

Colour paler(const Colour& c, double share) {
  const auto mixed = [share](double v) { return v + share * (1 - v); };
  return {mixed(c.red), mixed(c.green), mixed(c.blue), 1};
}

/// Hatching of depths that no sensor has confirmed.
bool hatched(int column, int row) { return (column + row) % 8 == 0; }

/// Björn Ottosson's Oklab (2020), lightness, chroma and hue, to sRGB.
Colour from_oklch(double lightness, double chroma, double hue_rad) {
  const double a = chroma * std::cos(hue_rad), b = chroma * std::sin(hue_rad);
  const auto cubed = [](double v) { return v * v * v; };
  const double l = cubed(lightness + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cubed(lightness - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cubed(lightness - 0.0894841775 * a - 1.2914855480 * b);
  const auto encode = [](double v) {
    v = std::clamp(v, 0.0, 1.0);
    return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
  };
  return {encode(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          encode(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          encode(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s), 1};
}

/// The depths that a chart shows, and the colours that it gives them.
struct DepthScale {
  double low = 0, high = 1;
  std::vector<double> levels;

  DepthScale(const ChartField& field, const ChartNodes& nodes) {
    double least = INFINITY, most = -INFINITY;
    for (const std::vector<float>* depths : {&field.measured, &field.charted, &nodes.surface_m}) {
      for (const float d : *depths) {
        if (std::isnan(d)) continue;
        least = std::min(least, static_cast<double>(d));
        most = std::max(most, static_cast<double>(d));
      }
    }
    if (!(least <= most)) return;
    levels = contour_levels(least, most);
    const double step = nice_step(least, most);
    low = least > 0 && least < most / 2 ? 0 : step * std::floor(least / step);
    high = std::max(low + step, most);
  }
  [[nodiscard]] Colour colour(double depth) const {
    if (depth < 0) return kDrying;
    const double from = std::max(0.0, low);
    return depth_colour((depth - from) / (high - from));
  }
};

PlanExtent chart_extent(const DepthChart& chart) {
  const PixelGrid& g = chart.grid;
  const double north = g.corner_m.x() - chart.window.row * g.pixel_m;
  const double west = g.corner_m.y() + chart.window.column * g.pixel_m;
  return {north - chart.window.height * g.pixel_m, north, west, west + chart.window.width * g.pixel_m};
}

std::vector<Colour> depth_colours(const ChartField& field, const ChartNodes& nodes, const DepthScale& scale) {
  std::vector<Colour> colours(field.measured.size(), palette::kPaper);
  // A measured cell colours its neighbours, so that a sounding line is visible at any scale.
  const auto measured_near = [&](int column, int row) {
    float sum = 0;
    int count = 0;
    for (int y = std::max(0, row - 1); y <= std::min(field.rows - 1, row + 1); ++y) {
      for (int x = std::max(0, column - 1); x <= std::min(field.columns - 1, column + 1); ++x) {
        const float d = field.measured[field.index(x, y)];
        if (std::isnan(d)) continue;
        sum += d;
        ++count;
      }
    }
    return sum / static_cast<float>(count);
  };
  for (int row = 0; row < field.rows; ++row) {
    for (int column = 0; column < field.columns; ++column) {
      const std::size_t i = field.index(column, row);
      if (!std::isnan(field.measured[i])) {
        colours[i] = scale.colour(field.measured[i]);
      } else if (field.distance_m[i] <= kMeasuredPx * field.cell_m) {
        colours[i] = scale.colour(measured_near(column, row));
      } else if (field.land[i] != 0) {
        colours[i] = kLand;
      } else if (!std::isnan(field.charted[i])) {
        colours[i] = hatched(column, row) ? palette::kPaper : paler(scale.colour(field.charted[i]), kChartedPaleness);
      } else if (const float d = nodes.surface_at(column, row);
                 !std::isnan(d) && field.distance_m[i] <= field.reach_m) {
        const double share = field.distance_m[i] / field.reach_m;  // slow at first, so that depths stay readable
        colours[i] = paler(scale.colour(d), kNearPaleness + (kFarPaleness - kNearPaleness) * share * share);
      }
    }
  }
  return colours;
}

/// The shoalest measured pixel of each square of the sheet, shoalest first: where only one fits, the shoaler is drawn.
struct Figure {
  Vector2d north_east;
  double depth_m;
};
std::vector<Figure> figures(const DepthChart& chart, double square_m) {
  const double pixel = chart.grid.pixel_m;
  const int across = static_cast<int>(chart.window.width * pixel / square_m) + 1;
  const int down = static_cast<int>(chart.window.height * pixel / square_m) + 1;
  std::vector<std::optional<Figure>> shoalest(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
  std::size_t i = 0;
  for (int row = 0; row < chart.window.height; ++row) {
    for (int column = 0; column < chart.window.width; ++column, ++i) {
      const float depth = chart.depth_m[i];
      if (!measured_at(chart, i)) continue;
      const auto x = static_cast<std::size_t>((column + 0.5) * pixel / square_m);
      const auto y = static_cast<std::size_t>((row + 0.5) * pixel / square_m);
      auto& best = shoalest[y * static_cast<std::size_t>(across) + x];
      if (best && best->depth_m <= depth) continue;
      best = Figure{chart.grid.centre({chart.window.column + column, chart.window.row + row}), depth};
    }
  }
  std::vector<Figure> all;
  for (const auto& f : shoalest) {
    if (f) all.push_back(*f);
  }
  std::stable_sort(all.begin(), all.end(), [](const Figure& a, const Figure& b) { return a.depth_m < b.depth_m; });
  return all;
}

bool shows_charted(const ChartField& field) {
  for (std::size_t i = 0; i < field.charted.size(); ++i) {
    if (!std::isnan(field.charted[i]) && field.charted[i] != 0 && field.land[i] == 0) return true;  // 0 is land
  }
  return false;
}

void draw_shore_and_tracks(const DepthChart& chart, ChartLayout& layout) {
  for (const auto& ring : chart.shore) layout.polyline(ring, true, {kShoreLine, 2, false});
  for (const auto& track : chart.tracks) layout.polyline(track, false, {kTrackLine, 0.8, false});
}

/// Whether any track is longer than some picture pixels: others are not seen.
bool shows_tracks(const DepthChart& chart, double metres_per_px) {
  return std::any_of(chart.tracks.begin(), chart.tracks.end(), [&](const std::vector<Vector2d>& track) {
    Eigen::AlignedBox2d box;
    for (const Vector2d& p : track) box.extend(p);
    return !box.isEmpty() && box.diagonal().norm() > 4 * metres_per_px;
  });
}

void finish(const DepthChart& chart, ChartLayout& layout) {
  if (!chart.shore.empty()) {
    layout.legend_fill(kLand, "land");
    layout.legend_line({kShoreLine, 2, false}, "shore line");
  }
  if (shows_tracks(chart, layout.metres_per_px())) {
    layout.legend_line({kTrackLine, 1.2, false}, "track of the vehicle");
  }
  if (!chart.obstructions.empty()) layout.legend_danger("obstruction");
  layout.note("");
  if (!chart.datum.empty()) layout.note(chart.datum);
  layout.about({chart.survey, chart.date, chart.grid.pixel_m},
               "No geographic position: the frame shows metres of the map.");
  layout.note("NOT FOR NAVIGATION", true);
  layout.finish();
}

}  // namespace

Colour depth_colour(double share) {
  const double s = std::clamp(share, 0.0, 1.0);
  // Lightness falls evenly; hue turns from cyan to blue; chroma stays within what a screen can show.
  constexpr double kDegree = 0.017453292519943295;
  return from_oklch(0.955 - 0.645 * s, 0.030 + 0.36 * s * (1 - s) * 0.75 + 0.055 * s, (212 + 46 * s) * kDegree);
}

std::vector<ContourLine> depth_contours(const DepthChart& chart, double node_m) {
  ISOBATH_ASSERT(node_m > 0);
  const double pixel = chart.grid.pixel_m;
  const auto cells = [&](int pixels) { return std::max(1, static_cast<int>(std::ceil(pixels * pixel / node_m))); };
  const ChartField field = chart_field(chart, cells(chart.window.width), cells(chart.window.height), node_m);
  const ChartNodes nodes = chart_nodes(chart, field, 1);
  return contour_lines(nodes.frame, nodes.depth_m, DepthScale(field, nodes).levels);
}

std::string depth_chart_png(const DepthChart& chart, const ChartLook& look) {
  ChartLayout layout(chart_extent(chart), look.plot_px, chart.title, chart.origin);
  const ChartField field = chart_field(chart, layout.columns(), layout.rows(), layout.metres_per_px());
  const ChartNodes nodes = chart_nodes(chart, field, kNodePx);
  const DepthScale scale(field, nodes);
  layout.raster(depth_colours(field, nodes, scale));
  draw_shore_and_tracks(chart, layout);
  for (const DepthChart::Point& p : chart.obstructions) layout.danger(p.north_east, p.label);
  const auto approximate = [&](const Vector2d& p) { return nodes.approximate_at(p); };
  for (const ContourLine& line : contour_lines(nodes.frame, nodes.depth_m, scale.levels)) {
    layout.contour(line.points, line.closed, {{0.05, 0.16, 0.36, 0.9}, 1.1, false}, fmt::format("{:g}", line.level),
                   approximate);
  }
  if (look.soundings) {
    for (const Figure& f : figures(chart, kFigurePx * layout.metres_per_px())) layout.sounding(f.north_east, f.depth_m);
  }

  layout.north_arrow_and_scale();
  const bool any_charted = shows_charted(field);
  std::vector<ChartLayout::Bar> bars = {{"measured", [&](double d) { return scale.colour(d); }}};
  if (any_charted) bars.push_back({"charted", [&](double d) { return paler(scale.colour(d), kChartedPaleness); }});
  if (chart.surface) {
    bars.push_back(
        {"interpolated", [&](double d) { return paler(scale.colour(d), (kNearPaleness + kFarPaleness) / 2); }});
  }
  layout.colour_bars("Depth, metres", scale.low, scale.high, scale.levels, bars);
  layout.legend_line({{0.05, 0.16, 0.36, 0.9}, 1.1, false}, "depth contour, metres");
  if (chart.surface) layout.legend_line({{0.05, 0.16, 0.36, 0.9}, 1.1, true}, "approximate contour");
  if (any_charted) layout.legend_fill(paler(depth_colour(0.5), kChartedPaleness), "charted, not confirmed", true);
  if (scale.low < 0) layout.legend_fill(kDrying, "dries");
  if (chart.surface) {
    layout.legend_fill(palette::kPaper, fmt::format("no sounding within {:.0f} m", field.reach_m));
  } else {
    layout.legend_fill(palette::kPaper, "not surveyed");
  }
  finish(chart, layout);
  return layout.png();
}

std::string confidence_chart_png(const DepthChart& chart, const ChartLook& look) {
  ChartLayout layout(chart_extent(chart), look.plot_px, chart.title, chart.origin);
  const ChartField field = chart_field(chart, layout.columns(), layout.rows(), layout.metres_per_px());
  const std::vector<int> confidence = confidence_cells(chart, field);
  const auto class_of = [](int c) {
    return *std::find_if(kClasses.begin(), kClasses.end(), [c](const ConfidenceClass& k) { return c <= k.high; });
  };
  std::vector<Colour> colours(confidence.size(), kUnknown);
  for (int row = 0; row < field.rows; ++row) {
    for (int column = 0; column < field.columns; ++column) {
      const std::size_t i = field.index(column, row);
      int shown = confidence[i];
      bool sounded = !std::isnan(field.measured[i]);
      // An unknown cell shows the least confidence around it: lines stay visible, and no cell looks better than it is.
      for (int y = std::max(0, row - 1); confidence[i] < 0 && y <= std::min(field.rows - 1, row + 1); ++y) {
        for (int x = std::max(0, column - 1); x <= std::min(field.columns - 1, column + 1); ++x) {
          const std::size_t neighbour = field.index(x, y);
          const int c = confidence[neighbour];
          const bool heard = !std::isnan(field.measured[neighbour]);
          sounded = sounded || heard;
          if (c < 0 || (!heard && field.charted[neighbour] == 0)) continue;  // not from land
          shown = shown < 0 ? c : std::min(shown, c);
        }
      }
      const bool charted = std::isnan(field.measured[i]) && !std::isnan(field.charted[i]);
      if (!sounded && (field.land[i] != 0 || (charted && field.charted[i] == 0))) {
        colours[i] = kLand;
      } else if (shown >= 0) {
        colours[i] = charted && hatched(column, row) ? palette::kPaper : class_of(shown).colour;
      }
    }
  }
  layout.raster(colours);
  draw_shore_and_tracks(chart, layout);
  for (const DepthChart::Point& p : chart.obstructions) layout.danger(p.north_east, p.label);

  std::array<std::size_t, kClasses.size()> count{};
  std::size_t known = 0;
  for (std::size_t i = 0; i < chart.confidence.size(); ++i) {
    const std::uint8_t c = chart.confidence[i];
    const bool land = chart.depth_m[i] == 0 && !chart.flags.empty() && (chart.flags[i] & kSensed) == 0;
    if (c > kFullConfidence || land) continue;
    ++known;
    for (std::size_t k = 0; k < kClasses.size(); ++k) count[k] += c >= kClasses[k].low && c <= kClasses[k].high ? 1 : 0;
  }
  layout.north_arrow_and_scale();
  layout.note("Confidence (of 20), and its share of the pixels with a depth, without land");
  for (std::size_t k = 0; k < kClasses.size(); ++k) {
    const double share = known > 0 ? 100.0 * static_cast<double>(count[k]) / static_cast<double>(known) : 0;
    layout.legend_fill(kClasses[k].colour, fmt::format("{}: {:.1f} %", kClasses[k].name, share));
  }
  if (shows_charted(field)) layout.legend_fill(kClasses[1].colour, "hatched: charted, not confirmed", true);
  layout.legend_fill(kUnknown, "unknown");
  finish(chart, layout);
  return layout.png();
}

}  // namespace isobath
