// Contour lines: exact where the surface is linear, within h^2 where it is smooth, and never crossing.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/geometry/contours.hpp>
#include <isobath/geometry/polygon.hpp>
#include <numbers>
#include <rapidcheck/gtest.h>

namespace isobath {
namespace {

using Eigen::Vector2d;

struct Sheet {
  GridFrame frame;
  std::vector<float> values;
};

/// `value(x, y)` at the nodes of the square [-1, 1]^2.
template <class Value>
Sheet parameters_of(int nodes, Value value) {
  const double h = 2.0 / (nodes - 1);
  Sheet s{{nodes, nodes, {-1, -1}, {h, 0}, {0, h}}, {}};
  for (int row = 0; row < nodes; ++row) {
    for (int column = 0; column < nodes; ++column) {
      s.values.push_back(static_cast<float>(value(-1 + column * h, -1 + row * h)));
    }
  }
  return s;
}

std::vector<ContourLine> lines_of(const Sheet& s, std::vector<double> levels) {
  return contour_lines(s.frame, s.values, levels);
}

double side(const Vector2d& a, const Vector2d& b, const Vector2d& p) { return cross(b - a, p - a); }

/// Whether two pieces pass through each other at a point that is inside both.
bool cross_each_other(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  constexpr double kOn = 1e-9;
  const double ac = side(a, b, c), ad = side(a, b, d), ca = side(c, d, a), cb = side(c, d, b);
  return ((ac > kOn && ad < -kOn) || (ac < -kOn && ad > kOn)) && ((ca > kOn && cb < -kOn) || (ca < -kOn && cb > kOn));
}

TEST(Contours, PlaneGivesStraightLinesAtTheirPlaces) {
  const Sheet s = parameters_of(21, [](double x, double y) { return 3 * x + 2 * y; });
  const auto lines = lines_of(s, {-2, 0, 0.77, 3});
  ASSERT_EQ(lines.size(), 4u);
  for (const ContourLine& line : lines) {
    EXPECT_FALSE(line.closed);
    for (const Vector2d& p : line.points) EXPECT_NEAR(3 * p.x() + 2 * p.y(), line.level, 1e-6);
    for (const Vector2d& end : {line.points.front(), line.points.back()}) {
      EXPECT_NEAR(end.cwiseAbs().maxCoeff(), 1, 1e-6) << "runs from border to border";
    }
  }
}

TEST(Contours, ConeGivesCirclesToTheSquareOfTheStep) {
  for (const int nodes : {21, 41, 81}) {
    const Sheet s = parameters_of(nodes, [](double x, double y) { return std::hypot(x, y); });
    const auto lines = lines_of(s, {0.5});
    ASSERT_EQ(lines.size(), 1u);
    ASSERT_TRUE(lines[0].closed);
    double worst = 0, area_sum = 0;
    for (std::size_t i = 0; i < lines[0].points.size(); ++i) {
      const Vector2d& p = lines[0].points[i];
      worst = std::max(worst, std::abs(p.norm() - 0.5));
      area_sum += cross(p, lines[0].points[(i + 1) % lines[0].points.size()]) / 2;
    }
    const double h = 2.0 / (nodes - 1);
    EXPECT_LT(worst, h * h / (8 * 0.5) * 1.01) << "linear interpolation of a surface of curvature 1/r";
    EXPECT_NEAR(std::abs(area_sum), std::numbers::pi / 4, 3 * h * h);
    // Rows run down the page, so that y grows downwards: high on the left means clockwise on the page about a pit.
    EXPECT_GT(area_sum, 0);
  }
}

TEST(Contours, SaddleIsCutAsItsMeanSays) {
  // corners high, low / low, high
  GridFrame frame{2, 2, {0, 0}, {1, 0}, {0, 1}};
  const std::vector<float> high_centre = {4, 0, 0, 4}, low_centre = {4, -4, -4, 4};
  const std::vector<double> level = {1};
  const auto joined = contour_lines(frame, high_centre, level), parted = contour_lines(frame, low_centre, level);
  ASSERT_EQ(joined.size(), 2u);
  ASSERT_EQ(parted.size(), 2u);
  // With a high centre (mean 2) each line cuts off a low corner: (1, 0) or (0, 1).
  for (const ContourLine& line : joined) {
    const Vector2d middle = (line.points.front() + line.points.back()) / 2;
    EXPECT_LT(std::min((middle - Vector2d(1, 0)).norm(), (middle - Vector2d(0, 1)).norm()), 0.5);
  }
  for (const ContourLine& line : parted) {
    const Vector2d middle = (line.points.front() + line.points.back()) / 2;
    EXPECT_LT(std::min(middle.norm(), (middle - Vector2d(1, 1)).norm()), 0.5);
  }
  // A hyperbola: two branches, whatever the sign of the level.
  const Sheet hyperbola = parameters_of(42, [](double x, double y) { return x * y; });
  for (const double l : {-0.2, 0.2}) EXPECT_EQ(lines_of(hyperbola, {l}).size(), 2u);
}

TEST(Contours, HolesGiveNothingAndEndTheLines) {
  Sheet s = parameters_of(21, [](double x, double y) { return x + 0 * y; });
  s.values[10 * 21 + 10] = NAN;  // the middle
  const auto lines = lines_of(s, {0.02});
  ASSERT_EQ(lines.size(), 2u) << "north and south of the hole";
  for (const ContourLine& line : lines) {
    EXPECT_FALSE(line.closed);
    for (const Vector2d& p : line.points) EXPECT_GE(std::abs(p.y()), 0.1 - 1e-6);
  }
  std::fill(s.values.begin(), s.values.end(), NAN);
  EXPECT_TRUE(lines_of(s, {0}).empty());
  EXPECT_TRUE(contour_lines({1, 1, {}, {1, 0}, {0, 1}}, std::vector<float>{3}, std::vector<double>{1}).empty());
  EXPECT_TRUE(contour_lines({}, {}, std::vector<double>{1}).empty());
}

TEST(Contours, NodesAtTheLevelMakeNoLitter) {
  // One node of the level among lower ones is a ring of no size: nothing is drawn.
  std::vector<float> values(25, 0.f);
  values[12] = 1;
  const GridFrame frame{5, 5, {0, 0}, {1, 0}, {0, 1}};
  EXPECT_TRUE(contour_lines(frame, values, std::vector<double>{1}).empty());
  // A terrace of the level: its rim is drawn, once.
  for (const int i : {6, 7, 8, 11, 12, 13, 16, 17, 18}) values[static_cast<std::size_t>(i)] = 1;
  const auto rim = contour_lines(frame, values, std::vector<double>{1});
  ASSERT_EQ(rim.size(), 1u);
  EXPECT_TRUE(rim[0].closed);
  EXPECT_EQ(rim[0].points.size(), 8u) << "the outer nodes of the terrace";
}

/// Random roughness, with whole numbers among the values so that levels are met exactly, and with holes.
Sheet rough(std::uint64_t seed, int nodes) {
  Random random(seed);
  Sheet s{{nodes, nodes, {0, 0}, {1, 0}, {0, 1}}, {}};
  for (int i = 0; i < nodes * nodes; ++i) {
    const double v = random.uniform(0, 5);
    s.values.push_back(random.uniform() < 0.05 ? NAN : static_cast<float>(random.uniform() < 0.3 ? std::floor(v) : v));
  }
  return s;
}

RC_GTEST_PROP(Contours, LinesNeverCross, (std::uint64_t seed)) {
  const auto lines = lines_of(rough(seed, 7), {1, 1.3, 2, 2.6, 3.9});
  struct Segment {
    Vector2d a, b;
  };
  std::vector<Segment> segments;
  for (const ContourLine& line : lines) {
    for (std::size_t i = 0; i + 1 < line.points.size() + (line.closed ? 1 : 0); ++i) {
      segments.push_back({line.points[i], line.points[(i + 1) % line.points.size()]});
    }
  }
  for (std::size_t i = 0; i < segments.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      RC_ASSERT(!cross_each_other(segments[i].a, segments[i].b, segments[j].a, segments[j].b));
    }
  }
}

/// Round each cell, the border changes sides an even number of times: each change is an end of one piece. So the number
/// of pieces is known without tracing, and rings are closed and open lines end at the border or at a hole.
RC_GTEST_PROP(Contours, EveryChangeOfSideIsCrossedOnce, (std::uint64_t seed)) {
  constexpr int kNodes = 9;
  constexpr double kLevel = 2.25;  // no node has it
  const Sheet s = rough(seed, kNodes);
  const auto at = [&](int c, int r) { return s.values[static_cast<std::size_t>(r * kNodes + c)]; };
  const auto whole = [&](int c, int r) {
    return c >= 0 && r >= 0 && c + 1 < kNodes && r + 1 < kNodes &&
           !std::isnan(at(c, r) + at(c + 1, r) + at(c, r + 1) + at(c + 1, r + 1));
  };
  std::size_t points = 0, open_ends = 0;
  for (int r = 0; r < kNodes; ++r) {
    for (int c = 0; c < kNodes; ++c) {
      if (c + 1 < kNodes && (at(c, r) >= kLevel) != (at(c + 1, r) >= kLevel)) {
        const int cells = (whole(c, r) ? 1 : 0) + (whole(c, r - 1) ? 1 : 0);
        points += cells > 0 ? 1 : 0;
        open_ends += cells == 1 ? 1 : 0;
      }
      if (r + 1 < kNodes && (at(c, r) >= kLevel) != (at(c, r + 1) >= kLevel)) {
        const int cells = (whole(c, r) ? 1 : 0) + (whole(c - 1, r) ? 1 : 0);
        points += cells > 0 ? 1 : 0;
        open_ends += cells == 1 ? 1 : 0;
      }
    }
  }
  std::size_t traced = 0, ends = 0;
  for (const ContourLine& line : lines_of(s, {kLevel})) {
    traced += line.points.size();
    ends += line.closed ? 0 : 2;
  }
  RC_ASSERT(traced == points);
  RC_ASSERT(ends == open_ends);
}

TEST(Contours, LevelsAreRound) {
  EXPECT_EQ(contour_levels(0.8, 9.3), (std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(contour_levels(0, 1), (std::vector<double>{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9}));
  EXPECT_EQ(contour_levels(-1.2, 2.4), (std::vector<double>{-1, -0.5, 0, 0.5, 1, 1.5, 2}));
  EXPECT_EQ(nice_step(0, 200), 20);
  EXPECT_EQ(nice_step(0, 11000), 1000);
  EXPECT_EQ(nice_step(3, 3.05), 0.1) << "no finer";
  EXPECT_TRUE(contour_levels(4, 4).empty());
  EXPECT_TRUE(contour_levels(NAN, 4).empty());
  EXPECT_TRUE(contour_levels(0, INFINITY).empty());
  for (double range = 2; range < 9000; range *= 1.07) {
    const std::size_t count = contour_levels(0.01, range).size();
    EXPECT_GE(count, 6u) << range;
    EXPECT_LE(count, 16u) << range;
  }
}

}  // namespace
}  // namespace isobath
