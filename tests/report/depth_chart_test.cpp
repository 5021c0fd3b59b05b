// The charts: what is measured, interpolated and unknown must be told apart, and lie where it lies.
#include <cairo/cairo.h>
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/map/depth/depth_pixel.hpp>
#include <isobath/report/plot/chart_field.hpp>
#include <isobath/report/plot/depth_chart.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;

DepthChart empty_chart(int width, int height) {
  DepthChart chart;
  chart.grid = {{100, -40}, 0.5};
  chart.window = {0, 0, width, height};
  const auto pixels = static_cast<std::size_t>(width * height);
  chart.depth_m.assign(pixels, NAN);
  chart.confidence.assign(pixels, 255);
  chart.flags.assign(pixels, 0);
  return chart;
}

/// A bottom that falls to the east: 2 m at the west side, 1 m more every 10 m.
double slope(double east) { return 2 + (east + 40) / 10; }

/// Two sounding lines of one pixel from west to east, 20 m apart, over 60 x 40 m.
DepthChart two_lines() {
  DepthChart chart = empty_chart(120, 80);
  for (const int row : {20, 60}) {
    for (int column = 0; column < 120; ++column) {
      const auto i = static_cast<std::size_t>(row * 120 + column);
      chart.depth_m[i] = static_cast<float>(slope(chart.grid.centre({column, row}).y()));
      chart.confidence[i] = 14;
      chart.flags[i] = kSensed | kSeenByDepth;
    }
  }
  chart.surface = [](double, double east) -> std::optional<double> { return slope(east); };
  chart.reach_m = 6;
  return chart;
}

TEST(ChartField, TellsMeasuredFromCharted) {
  DepthChart chart = two_lines();
  chart.depth_m[0] = 7;  // charted: no sensor has spoken of it
  const ChartField field = chart_field(chart, 120, 80, 0.5);
  EXPECT_EQ(field.charted[0], 7.f);
  EXPECT_TRUE(std::isnan(field.measured[0]));
  EXPECT_FLOAT_EQ(field.measured[field.index(50, 20)], static_cast<float>(slope(-40 + 25.25)));
  EXPECT_NEAR(field.distance_m[field.index(50, 30)], 5, 1e-5);
  EXPECT_EQ(field.reach_m, 6);
  chart.flags.clear();  // of unknown origin: taken as measured
  EXPECT_EQ(chart_field(chart, 120, 80, 0.5).measured[0], 7.f);
}

TEST(ChartField, MeansOverTheMapPixelsUnderAPicturePixel) {
  DepthChart chart = empty_chart(4, 4);
  for (const int i : {0, 1, 4}) {
    chart.depth_m[static_cast<std::size_t>(i)] = static_cast<float>(1 + i);
    chart.flags[static_cast<std::size_t>(i)] = kSensed;
    chart.confidence[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(i == 4 ? 20 : 5);
  }
  const ChartField coarse = chart_field(chart, 2, 2, 1.0);
  EXPECT_FLOAT_EQ(coarse.measured[0], (1 + 2 + 5) / 3.f);
  EXPECT_TRUE(std::isnan(coarse.measured[1]));
  EXPECT_EQ(confidence_cells(chart, coarse), (std::vector<int>{10, -1, -1, -1}));
  const ChartField fine = chart_field(chart, 12, 12, 0.5 / 3);
  EXPECT_FLOAT_EQ(fine.measured[fine.index(5, 2)], 2.f);
  EXPECT_TRUE(std::isnan(fine.measured[fine.index(6, 2)]));
}

TEST(ChartField, ReachIsTheWidestSpacingOfTheStandard) {
  DepthChart chart = two_lines();
  chart.reach_m = 0;
  EXPECT_EQ(chart_field(chart, 120, 80, 0.5).reach_m, 25) << "shallow water: 25 m";
  for (float& d : chart.depth_m) d += 95;
  EXPECT_NEAR(chart_field(chart, 120, 80, 0.5).reach_m, 300, 1e-3) << "three times the mean depth";
}

TEST(ChartField, DistancesAreThoseOfBruteForce) {
  constexpr int kColumns = 23, kRows = 17;
  std::vector<std::uint8_t> set(kColumns * kRows, 0);
  EXPECT_TRUE(std::isinf(distance_to_set(set, kColumns, kRows)[5])) << "nothing is set";
  const std::vector<std::pair<int, int>> places = {{0, 0}, {5, 11}, {22, 3}, {6, 12}, {14, 16}};
  for (const auto& [c, r] : places) set[static_cast<std::size_t>(r * kColumns + c)] = 1;
  const auto distance = distance_to_set(set, kColumns, kRows);
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      double best = INFINITY;
      for (const auto& p : places) best = std::min(best, std::hypot(c - p.first, r - p.second));
      EXPECT_NEAR(distance[static_cast<std::size_t>(r * kColumns + c)], best, 1e-5);
    }
  }
}

TEST(ChartField, LandIsTheSideWithoutSoundings) {
  DepthChart chart = two_lines();
  const auto box = [](double s, double n, double w, double e) {
    return std::vector<Vector2d>{{s, w}, {n, w}, {n, e}, {s, e}};
  };
  chart.shore = {box(62, 98, -39, 19), box(76, 84, -20, 0)};  // a lake with an island
  const ChartField lake = chart_field(chart, 120, 80, 0.5);
  EXPECT_EQ(lake.land[0], 1) << "outside of the lake";
  EXPECT_EQ(lake.land[lake.index(10, 10)], 0);
  EXPECT_EQ(lake.land[lake.index(60, 40)], 1) << "the island";
  chart.shore = {box(76, 84, -20, 0)};  // an island in the sea
  const ChartField sea = chart_field(chart, 120, 80, 0.5);
  EXPECT_EQ(sea.land[0], 0);
  EXPECT_EQ(sea.land[sea.index(60, 40)], 1);
}

TEST(ChartField, NothingIsInterpolatedBeyondReachOrOnLand) {
  DepthChart chart = two_lines();
  chart.shore = {{{50, -20}, {110, -20}, {110, 30}, {50, 30}}};  // the east is water
  const ChartField field = chart_field(chart, 120, 80, 0.5);
  const ChartNodes nodes = chart_nodes(chart, field, 2);
  int drawn = 0, approximate = 0;
  for (int r = 0; r < nodes.frame.rows; ++r) {
    for (int c = 0; c < nodes.frame.columns; ++c) {
      const auto node = static_cast<std::size_t>(r * nodes.frame.columns + c);
      const Vector2d p = nodes.frame.first + c * nodes.frame.per_column + r * nodes.frame.per_row;
      const double away = std::min(std::abs(p.x() - 89.75), std::abs(p.x() - 69.75));
      if (std::isnan(nodes.depth_m[node])) continue;
      ++drawn;
      approximate += nodes.approximate[node];
      EXPECT_LE(away, 6.8);
      EXPECT_TRUE(away <= 1 || p.y() >= -20.8) << "but soundings are shown wherever they are";
      EXPECT_TRUE(nodes.approximate[node] == 0 || away > 2.2);
    }
  }
  EXPECT_GT(drawn, 500);
  EXPECT_GT(approximate, 100);
}

TEST(DepthChart, ContoursLieWhereTheDepthIs) {
  const DepthChart chart = two_lines();
  const auto lines = depth_contours(chart, 0.5);
  ASSERT_FALSE(lines.empty());
  for (const ContourLine& line : lines) {
    for (const Vector2d& p : line.points) {
      EXPECT_NEAR(p.y(), -40 + 10 * (line.level - 2), 0.02) << line.level;
      EXPECT_LE(std::min(std::abs(p.x() - 89.75), std::abs(p.x() - 69.75)), 6.6);
    }
  }
  DepthChart bare = chart;
  bare.surface = nullptr;
  EXPECT_TRUE(depth_contours(bare, 0.5).empty()) << "a line of single pixels has no slope across";
}

TEST(DepthChart, ColoursFallEvenlyInLightness) {
  // CIE L* from sRGB, a measure of its own.
  const auto lightness = [](const Colour& c) {
    const auto linear = [](double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); };
    const double y = 0.2126 * linear(c.red) + 0.7152 * linear(c.green) + 0.0722 * linear(c.blue);
    return 116 * std::cbrt(y) - 16;
  };
  const double top = lightness(depth_colour(0)), bottom = lightness(depth_colour(1));
  EXPECT_GT(top, 90);
  EXPECT_LT(bottom, 25);
  for (int i = 1; i <= 20; ++i) {
    const double step = lightness(depth_colour((i - 1) / 20.0)) - lightness(depth_colour(i / 20.0));
    EXPECT_GT(step, 0.6 * (top - bottom) / 20) << i;
    EXPECT_LT(step, 1.5 * (top - bottom) / 20) << i;
    EXPECT_GE(depth_colour(i / 20.0).blue, depth_colour(i / 20.0).red) << "blue throughout";
  }
}

struct Decoded {
  explicit Decoded(const std::string& png) {
    struct Reader {
      const std::string& bytes;
      std::size_t at = 0;
    } reader{png};
    const auto read = [](void* from, unsigned char* to, unsigned length) {
      auto* r = static_cast<Reader*>(from);
      if (r->at + length > r->bytes.size()) return CAIRO_STATUS_READ_ERROR;
      std::copy_n(r->bytes.data() + r->at, length, reinterpret_cast<char*>(to));
      r->at += length;
      return CAIRO_STATUS_SUCCESS;
    };
    surface = cairo_image_surface_create_from_png_stream(read, &reader);
    width = cairo_image_surface_get_width(surface);
    height = cairo_image_surface_get_height(surface);
  }
  ~Decoded() { cairo_surface_destroy(surface); }
  std::uint32_t at(int x, int y) const {
    const unsigned char* row = cairo_image_surface_get_data(surface) + y * cairo_image_surface_get_stride(surface);
    return reinterpret_cast<const std::uint32_t*>(row)[x] & 0xffffffU;
  }
  cairo_surface_t* surface;
  int width = 0, height = 0;
};

TEST(DepthChart, MeasuredInterpolatedAndUnknownLookDifferent) {
  DepthChart chart = two_lines();
  const ChartLook look{240, false};  // two picture pixels a map pixel; the plot begins at (96, 84)
  const std::string png = depth_chart_png(chart, look);
  EXPECT_EQ(png, depth_chart_png(chart, look)) << "the same input, the same bytes";
  const Decoded picture(png);
  const auto at = [&](double column, double row) {  // of the map
    return picture.at(96 + static_cast<int>(2 * column), 84 + static_cast<int>(2 * row));
  };
  EXPECT_EQ(at(64.5, 40.5), 0xffffffU) << "10 m from the soundings: nothing";
  const auto brightness = [](std::uint32_t c) { return (c >> 16 & 255) + (c >> 8 & 255) + (c & 255); };
  EXPECT_LT(brightness(at(64, 20)), brightness(at(64, 23))) << "interpolated is paler than measured";
  EXPECT_LT(brightness(at(64, 23)), brightness(at(64, 30))) << "and fades with the distance";
  EXPECT_LT(brightness(at(64, 30)), brightness(0xffffff));
  EXPECT_GT(brightness(at(4, 60)), brightness(at(114, 60))) << "deep is dark";

  const Decoded confidence(confidence_chart_png(chart, look));
  EXPECT_EQ(confidence.at(96 + 128, 84 + 41), 0xfcde8cU) << "10 to 14";
  EXPECT_EQ(confidence.at(96 + 128, 84 + 42), 0xfcde8cU) << "a pixel wider, so that lines are seen";
  EXPECT_EQ(confidence.at(96 + 128, 84 + 80), 0xdbdbdbU) << "nothing known";
}

TEST(DepthChart, ChartedIsHatchedAndLandIsNotWater) {
  DepthChart chart = two_lines();
  for (std::size_t i = 0; i < chart.depth_m.size(); ++i) {
    if (!std::isnan(chart.depth_m[i])) continue;
    chart.depth_m[i] = 4;
    chart.confidence[i] = 5;
  }
  chart.shore = {{{76, -20}, {84, -20}, {84, 0}, {76, 0}}};
  const Decoded depth(depth_chart_png(chart, {240, false})), confidence(confidence_chart_png(chart, {240, false}));
  for (const Decoded* picture : {&depth, &confidence}) {
    EXPECT_EQ(picture->at(96 + 120, 84 + 80), 0xf5e6bdU) << "the island, although a depth is charted there";
    int white = 0;
    for (int x = 0; x < 80; ++x) white += picture->at(96 + 4 + x, 84 + 20) == 0xffffffU ? 1 : 0;
    EXPECT_EQ(white, 10) << "every eighth picture pixel of charted water";
    white = 0;
    for (int x = 0; x < 80; ++x) white += picture->at(96 + 4 + x, 84 + 41) == 0xffffffU ? 1 : 0;
    EXPECT_EQ(white, 0) << "none where it is measured";
  }
}

TEST(DepthChart, NothingKnownStillGivesASheet) {
  DepthChart chart = empty_chart(20, 10);
  chart.origin = GeoOrigin{-33.9, 179.9999};  // the date line runs through
  chart.tracks = {{}, {{1, 2}}};
  chart.shore = {{}, {{90, -30}, {95, -30}}};
  chart.obstructions = {{{95, -35}, ""}, {{1000, 1000}, "outside"}};
  EXPECT_GT(depth_chart_png(chart, {300, true}).size(), 1000u);
  EXPECT_GT(confidence_chart_png(chart, {300, true}).size(), 1000u);
  chart.depth_m[7] = 3;  // one depth has no range
  chart.flags[7] = kSensed;
  EXPECT_GT(depth_chart_png(chart, {300, true}).size(), 1000u);
  EXPECT_TRUE(depth_contours(chart, 1).empty());
}

}  // namespace
}  // namespace isobath
