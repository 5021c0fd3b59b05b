// Delaunay triangulations against their definition, and the predicates under them against exact integers.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/geometry/exact_predicates.hpp>
#include <isobath/geometry/triangulation.hpp>
#include <rapidcheck/gtest.h>
#include <set>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Points = std::vector<Vector2d>;

Points random_points(int count, double extent, std::uint64_t seed) {
  Random random(seed);
  Points points;
  for (int i = 0; i < count; ++i) points.emplace_back(random.uniform(0, extent), random.uniform(0, extent));
  return points;
}

int sign(double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

/// By the definition: every triangle turns in the positive sense, neighbours agree, no circle holds a point, and the
/// triangles fill the hull.
void expect_delaunay(const Triangulation& t) {
  double filled = 0;
  std::set<int> used;
  for (std::size_t i = 0; i < t.triangles().size(); ++i) {
    const auto& [corner, neighbour] = t.triangles()[i];
    const Vector2d &a = t.points()[corner[0]], &b = t.points()[corner[1]], &c = t.points()[corner[2]];
    ASSERT_GT(orientation(a, b, c), 0);
    filled += cross(b - a, c - a) / 2;
    for (int k = 0; k < 3; ++k) {
      used.insert(corner[k]);
      if (neighbour[k] == Triangulation::kNone) continue;
      const auto& other = t.triangles()[neighbour[k]];
      int shared = 0, back = 0;
      for (int j = 0; j < 3; ++j) {
        shared += other.corner[j] == corner[(k + 1) % 3] || other.corner[j] == corner[(k + 2) % 3];
        back += other.neighbour[j] == static_cast<int>(i);
      }
      ASSERT_EQ(shared, 2);
      ASSERT_EQ(back, 1);
    }
    for (const Vector2d& p : t.points()) ASSERT_LE(in_circle(a, b, c, p), 0);
  }
  EXPECT_NEAR(filled, area(convex_hull(t.points())), 1e-9 * filled);
  const auto less = [](const Vector2d& a, const Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  };
  const std::set<Vector2d, decltype(less)> places(t.points().begin(), t.points().end(), less);
  EXPECT_EQ(used.size(), places.size());
  EXPECT_EQ(t.triangles().size(), 2 * used.size() - 2 - t.hull().size()) << "Euler";
}

__extension__ using Wide = __int128;

int sign(Wide x) { return (x > 0) - (x < 0); }

// Whole numbers up to 2^53 in magnitude, nearly in a row: their differences and products do not fit doubles.
RC_GTEST_PROP(ExactPredicates, TurnLikeExactIntegers, ()) {
  const auto step = [] { return *rc::gen::inRange<std::int64_t>(-3, 4); };
  const std::int64_t far = std::int64_t{1} << 52;
  const std::int64_t x[3] = {far + step(), step(), -far + step()}, y[3] = {far - 9 + step(), step(), -far + step()};
  const Wide turn = Wide(x[0] - x[2]) * (y[1] - y[2]) - Wide(y[0] - y[2]) * (x[1] - x[2]);
  Vector2d p[3];
  for (int i = 0; i < 3; ++i) p[i] = {static_cast<double>(x[i]), static_cast<double>(y[i])};
  RC_ASSERT(sign(orientation(p[0], p[1], p[2])) == sign(turn));
}

// Steps of 2^-26 beside 1.
RC_GTEST_PROP(ExactPredicates, TellInsideFromOutsideLikeExactIntegers, ()) {
  const auto step = [] { return *rc::gen::inRange<std::int64_t>(-4, 5); };
  std::int64_t x[4], y[4];
  Vector2d p[4];
  for (int i = 0; i < 4; ++i) {
    x[i] = (std::int64_t{1} << 26) + step();
    y[i] = (std::int64_t{1} << 26) + step();
    p[i] = std::exp2(-26) * Vector2d(static_cast<double>(x[i]), static_cast<double>(y[i]));
  }
  const auto turn = [&](int a, int b) { return (x[a] - x[3]) * (y[b] - y[3]) - (y[a] - y[3]) * (x[b] - x[3]); };
  const auto lift = [&](int a) { return (x[a] - x[3]) * (x[a] - x[3]) + (y[a] - y[3]) * (y[a] - y[3]); };
  const Wide inside = lift(0) * turn(1, 2) + lift(1) * turn(2, 0) + lift(2) * turn(0, 1);
  RC_ASSERT(sign(in_circle(p[0], p[1], p[2], p[3])) == sign(inside));
}

// The corners of any rectangle lie on one circle, whatever the doubles; one last bit less does not.
RC_GTEST_PROP(ExactPredicates, FindTheFourthCornerOfAnyRectangleOnItsCircle, ()) {
  const auto any = [] {
    return std::ldexp(*rc::gen::inRange<std::int64_t>(1, std::int64_t{1} << 53), *rc::gen::inRange(-70, -30));
  };
  const double x0 = -any(), x1 = any(), y0 = -any(), y1 = any();
  const Vector2d a(x0, y0), b(x1, y0), c(x1, y1);
  RC_ASSERT(in_circle(a, b, c, {x0, y1}) == 0.0);
  RC_ASSERT(in_circle(a, b, c, {x0, std::nextafter(y1, 0)}) > 0);
  RC_ASSERT(in_circle(a, b, c, {x0, std::nextafter(y1, 1e9)}) < 0);
}

// Shewchuk's own picture: a plain determinant draws noise along the diagonal, an exact one a straight line. The points
// (0.5, 0.5) + (i, j) 2^-53 are on the left of the line through (12, 12) and (24, 24), right of it, or on it as j - i.
TEST(ExactPredicates, SeparatePointsOneLastBitFromALine) {
  const double bit = std::exp2(-53);
  for (int i = 0; i < 64; ++i) {
    for (int j = 0; j < 64; ++j) {
      const Vector2d p(0.5 + i * bit, 0.5 + j * bit);
      const int side = sign((p.y() - 0.5) - (p.x() - 0.5));
      ASSERT_EQ(sign(orientation(Vector2d(12, 12), Vector2d(24, 24), p)), side);
    }
  }
}

// ledger: S1-14
TEST(Triangulation, OfRandomPointsIsDelaunay) { expect_delaunay(Triangulation(random_points(400, 1000, 1))); }

TEST(Triangulation, OfAGridIsDelaunay) {
  Points grid;
  for (int i = 0; i < 18; ++i) {
    for (int j = 0; j < 18; ++j) grid.emplace_back(0.1 * i, 500 + 0.1 * j);  // no multiple of 0.1 is exact
  }
  expect_delaunay(Triangulation(grid));
}

TEST(Triangulation, OfSurveyLinesIsDelaunay) {
  Points lines;
  for (int line = 0; line < 5; ++line) {
    for (int i = 0; i < 60; ++i) lines.emplace_back(i * 0.7, line * 25.0);
  }
  expect_delaunay(Triangulation(lines));
}

// Few places, so that rows, squares, and points twice abound.
RC_GTEST_PROP(Triangulation, OfAnyPointsIsDelaunayOrRefused, ()) {
  const auto raw = *rc::gen::container<std::vector<std::pair<int, int>>>(
      rc::gen::pair(rc::gen::inRange(0, 7), rc::gen::inRange(0, 7)));
  Points points;
  for (const auto& [x, y] : raw) points.emplace_back(x / 3.0, y / 3.0);
  bool spans = false;
  for (const Vector2d& a : points) {
    for (const Vector2d& b : points) spans = spans || orientation(points[0], a, b) != 0;
  }
  if (!spans) {
    RC_ASSERT_THROWS_AS((void)Triangulation{points}, Error);
    return;
  }
  const Triangulation t(points);
  expect_delaunay(t);
  RC_ASSERT(!testing::Test::HasFailure());
}

TEST(Triangulation, RefusesPointsOnOneLine) {
  Points row;
  for (int i = 0; i < 20; ++i) row.emplace_back(i, 2 * i);
  EXPECT_THROW(Triangulation{row}, Error);
  EXPECT_THROW(Triangulation({{0, 0}, {1, 1}}), Error);
  EXPECT_THROW(Triangulation({{1, 2}, {1, 2}, {1, 2}, {1, 2}}), Error);
}

TEST(Triangulation, FindsTrianglesAndNearestPointsLikeBruteForce) {
  Points points = random_points(300, 100, 2);
  for (const Vector2d& p : random_points(300, 5, 3)) points.push_back(p);  // one corner is much denser
  const Triangulation t(points);
  Random random(4);
  for (int i = 0; i < 1000; ++i) {
    const Vector2d p(random.uniform(-20, 120), random.uniform(-20, 120));
    const int found = t.triangle_at(p);
    int holding = Triangulation::kNone;
    for (std::size_t k = 0; k < t.triangles().size(); ++k) {
      const auto& c = t.triangles()[k].corner;
      const bool in = orientation(points[c[0]], points[c[1]], p) >= 0 &&
                      orientation(points[c[1]], points[c[2]], p) >= 0 &&
                      orientation(points[c[2]], points[c[0]], p) >= 0;
      if (in) holding = static_cast<int>(k);
    }
    ASSERT_EQ(found, holding);
    double nearest = 1e9;
    for (const Vector2d& q : points) nearest = std::min(nearest, (q - p).norm());
    ASSERT_EQ((points[t.nearest_point(p)] - p).norm(), nearest);
    if (found == Triangulation::kNone) continue;
    const Eigen::Vector3d w = t.barycentric(found, p);
    Vector2d back = Vector2d::Zero();
    for (int k = 0; k < 3; ++k) back += w[k] * points[t.triangles()[found].corner[k]];
    ASSERT_LT((back - p).norm(), 1e-9);
  }
  EXPECT_EQ(t.triangle_at({NAN, 0}), Triangulation::kNone);
  for (const Vector2d& p : points) ASSERT_NE(t.triangle_at(p), Triangulation::kNone);
}

TEST(Triangulation, ListsThePointsAroundAPoint) {
  const Triangulation t({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {1, 2}});
  EXPECT_EQ(t.around(4).size(), 4u);
  EXPECT_EQ(t.around(0).size(), 3u);
  EXPECT_EQ(t.hull().size(), 4u);
  for (int i = 0; i < 5; ++i) {
    for (const int n : t.around(i)) {
      const auto back = t.around(n);
      EXPECT_EQ(std::count(back.begin(), back.end(), i), 1);
    }
  }
}

TEST(Triangulation, TakesAHundredThousandPoints) {
  const Points points = random_points(100000, 1000, 5);
  const Triangulation t(points);
  EXPECT_EQ(t.triangles().size(), 2 * points.size() - 2 - t.hull().size());
  EXPECT_EQ(t.hull().size(), convex_hull(points).size());
}

}  // namespace
}  // namespace isobath
