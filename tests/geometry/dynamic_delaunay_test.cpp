// Triangulations that change, against the definition of Delaunay: exact predicates at every edge, Euler's formula and
// the area of the hull, and all points against all circles on small sets.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/geometry/dynamic_delaunay.hpp>
#include <isobath/geometry/exact_predicates.hpp>
#include <isobath/geometry/kinetic_delaunay.hpp>
#include <isobath/geometry/polygon.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <tests/support/count_allocations.hpp>
#include <vector>

namespace isobath::dynamic_delaunay_test {
namespace {

using Eigen::Vector2d;
using Points = std::vector<Vector2d>;
using Place = std::pair<double, double>;
using Edge = std::pair<Place, Place>;

Place place(const Vector2d& p) { return {p.x(), p.y()}; }

/// The edges that every Delaunay triangulation of the points has: those without four corners on one circle.
std::set<Edge> strict_edges(const DynamicDelaunay& d) {
  std::set<Edge> edges;
  for (const auto& t : d.triangles()) {
    if (!DynamicDelaunay::is_finite(t)) continue;
    for (int k = 0; k < 3; ++k) {
      const auto& n = d.triangles()[static_cast<std::size_t>(t.neighbour[k])];
      const int a = t.corner[(k + 1) % 3], b = t.corner[(k + 2) % 3];
      bool strict = true;
      for (const int c : n.corner) {
        if (c < 0 || c == a || c == b || !DynamicDelaunay::is_finite(n)) continue;
        strict = in_circle(d.at(t.corner[0]), d.at(t.corner[1]), d.at(t.corner[2]), d.at(c)) < 0;
      }
      if (strict) edges.insert(std::minmax(place(d.at(a)), place(d.at(b))));
    }
  }
  return edges;
}

/// Every triangle turns in the positive sense, neighbours agree, no edge is illegal, and the triangles fill the hull:
/// by Delaunay's lemma no circle then holds a point.
void expect_delaunay(const DynamicDelaunay& d, const Points& points) {
  std::set<Place> places;
  for (const Vector2d& p : points) places.insert(place(p));
  std::set<int> used;
  double filled = 0;
  std::size_t finite = 0, ghosts = 0;
  for (std::size_t i = 0; i < d.triangles().size(); ++i) {
    const auto& t = d.triangles()[i];
    if (t.corner[0] < DynamicDelaunay::kNone) continue;
    for (int k = 0; k < 3; ++k) {
      const auto& n = d.triangles()[static_cast<std::size_t>(t.neighbour[k])];
      const auto back = std::find(n.neighbour.begin(), n.neighbour.end(), static_cast<int>(i));
      ASSERT_NE(back, n.neighbour.end());
      const auto j = static_cast<int>(back - n.neighbour.begin());
      ASSERT_EQ(n.corner[(j + 1) % 3], t.corner[(k + 2) % 3]);
      ASSERT_EQ(n.corner[(j + 2) % 3], t.corner[(k + 1) % 3]);
    }
    if (!DynamicDelaunay::is_finite(t)) {
      ++ghosts;
      continue;
    }
    ++finite;
    const Vector2d &a = d.at(t.corner[0]), &b = d.at(t.corner[1]), &c = d.at(t.corner[2]);
    ASSERT_GT(orientation(a, b, c), 0);
    filled += cross(b - a, c - a) / 2;
    used.insert(t.corner.begin(), t.corner.end());
    for (int k = 0; k < 3; ++k) {
      for (const int other : d.triangles()[static_cast<std::size_t>(t.neighbour[k])].corner) {
        if (other < 0) continue;
        ASSERT_LE(in_circle(a, b, c, d.at(other)), 0);
      }
    }
  }
  if (finite == 0) {
    for (const Vector2d& p : points) ASSERT_EQ(orientation(points.front(), points.back(), p), 0);
    return;
  }
  ASSERT_EQ(used.size(), places.size());
  ASSERT_EQ(finite, 2 * used.size() - 2 - ghosts) << "Euler";
  ASSERT_NEAR(filled, area(convex_hull(points)), 1e-9 * filled);
}

void expect_no_point_in_any_circle(const DynamicDelaunay& d, const Points& points) {
  for (const auto& t : d.triangles()) {
    if (!DynamicDelaunay::is_finite(t)) continue;
    for (const Vector2d& p : points) {
      ASSERT_LE(in_circle(d.at(t.corner[0]), d.at(t.corner[1]), d.at(t.corner[2]), p), 0);
    }
  }
}

/// A triangulation beside a plain list of its points.
struct Twin {
  explicit Twin(int most) : delaunay(most) {}
  void insert(const Vector2d& p) {
    const int id = delaunay.insert(p, 0);
    ASSERT_TRUE(points.emplace(id, p).second);
  }
  void remove(int id) {
    delaunay.remove(id);
    points.erase(id);
  }
  void move(int id, const Vector2d& to) {
    delaunay.move(id, to);
    points[id] = to;
  }
  [[nodiscard]] int any(Random& random) const {
    auto at = points.begin();
    std::advance(at, static_cast<std::ptrdiff_t>(random.index(points.size())));
    return at->first;
  }
  [[nodiscard]] Points list() const {
    Points all;
    for (const auto& [id, p] : points) all.push_back(p);
    return all;
  }
  DynamicDelaunay delaunay;
  std::map<int, Vector2d> points;
};

void expect_like_fresh(const Twin& twin) {
  const Points all = twin.list();
  expect_delaunay(twin.delaunay, all);
  DynamicDelaunay fresh(static_cast<int>(all.size()) + 1);
  for (auto p = all.rbegin(); p != all.rend(); ++p) fresh.insert(*p, 0);
  ASSERT_EQ(strict_edges(twin.delaunay), strict_edges(fresh));
}

// ledger: S3-06
TEST(DynamicDelaunay, StaysDelaunayOverAHundredThousandRandomOperations) {
  Twin twin(400);
  Random random(1);
  const auto anywhere = [&] { return Vector2d(random.uniform(-50, 50), random.uniform(-50, 50)); };
  for (int i = 0; i < 100'000; ++i) {
    const double kind = random.uniform();
    const auto count = static_cast<double>(twin.points.size());
    if (twin.points.empty() || (kind < 0.3 && count < 395)) {
      twin.insert(anywhere());
    } else if (kind < 0.3 + 0.2 * std::min(1.0, count / 150)) {
      twin.remove(twin.any(random));
    } else {
      const int id = twin.any(random);
      const bool near = random.uniform() < 0.9;
      twin.move(id, near ? Vector2d(twin.points[id] + 0.02 * anywhere()) : anywhere());
    }
    if (i % 5000 == 0) expect_like_fresh(twin);
    if (testing::Test::HasFailure()) FAIL() << "operation " << i;
  }
  expect_like_fresh(twin);
}

// Places of a small grid: rows, squares, points that coincide, and sets that lie on one line abound.
// ledger: S3-06
TEST(DynamicDelaunay, StaysDelaunayOnGridsOfCocircularAndCollinearPoints) {
  for (const int width : {1, 2, 3, 7}) {
    Twin twin(60);
    Random random(static_cast<std::uint64_t>(width));
    const auto anywhere = [&] {
      return Vector2d(0.1 * static_cast<double>(random.index(7)), 0.1 * static_cast<double>(random.index(width)));
    };
    for (int i = 0; i < 1500; ++i) {
      const double kind = random.uniform();
      if (twin.points.size() < 3 || (kind < 0.35 && twin.points.size() < 60)) {
        twin.insert(anywhere());
      } else if (kind < 0.66) {
        twin.remove(twin.any(random));
      } else {
        twin.move(twin.any(random), anywhere());
      }
      if (i % 10 != 0) continue;
      expect_no_point_in_any_circle(twin.delaunay, twin.list());
      expect_like_fresh(twin);
      if (testing::Test::HasFailure()) FAIL() << "width " << width << ", operation " << i;
    }
    while (!twin.points.empty()) twin.remove(twin.points.begin()->first);
    EXPECT_EQ(twin.delaunay.size(), 0);
  }
}

// A hub with many neighbours: the hole of a deletion has 200 corners on one circle.
TEST(DynamicDelaunay, FillsALargeHoleOfCocircularCorners) {
  Twin twin(500);
  twin.insert({0, 0});
  for (int i = 0; i < 200; ++i) {
    const double angle = i * std::numbers::pi / 100;
    twin.insert({10 * std::cos(angle), 10 * std::sin(angle)});
  }
  EXPECT_EQ(twin.delaunay.around(0).size(), 200u);
  twin.remove(0);
  expect_like_fresh(twin);
}

TEST(DynamicDelaunay, APointCanHaveSeveralLabels) {
  DynamicDelaunay d(10);
  const int a = d.insert({0, 0}, 7), b = d.insert({0, 0}, 8);
  const int c = d.insert({1, 0}, 7), e = d.insert({0, 1}, 9);
  const auto labels_at = [&](int corner) {
    std::set<int> labels;
    for (int p = corner; p != DynamicDelaunay::kNone; p = d.twin(p)) labels.insert(d.label(p));
    return labels;
  };
  EXPECT_EQ(labels_at(a), (std::set<int>{7, 8}));
  EXPECT_TRUE(d.around(b).empty());
  d.remove(a);
  EXPECT_EQ(labels_at(b), (std::set<int>{8}));
  EXPECT_EQ(d.around(b).size(), 3u);
  d.move(b, {1, 0});
  EXPECT_EQ(labels_at(c), (std::set<int>{7, 8}));
  EXPECT_TRUE(d.around(e).empty()) << "two places are left: no triangles";
}

TEST(DynamicDelaunay, FindsTheNearestCorner) {
  Random random(3);
  Twin twin(600);
  for (int i = 0; i < 600; ++i) twin.insert({random.uniform(0, 10), random.uniform(0, 10)});
  for (int i = 0; i < 500; ++i) {
    const Vector2d p(random.uniform(-5, 15), random.uniform(-5, 15));
    double least = INFINITY;
    for (const auto& [id, q] : twin.points) least = std::min(least, (q - p).norm());
    ASSERT_EQ((twin.delaunay.at(twin.delaunay.nearest(p)) - p).norm(), least);
  }
}

TEST(DynamicDelaunay, RefusesWhatIsNotFiniteAndAPointTooMany) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  DynamicDelaunay d(3);
  EXPECT_THROW(d.insert({nan, 0}, 0), Error);
  EXPECT_THROW(d.insert({0, INFINITY}, 0), Error);
  EXPECT_THROW(d.insert({0, 1e10}, 0), Error);
  const int a = d.insert({0, 0}, 0);
  EXPECT_THROW(d.move(a, {nan, 0}), Error);
  d.insert({1, 0}, 0);
  d.insert({0, 1}, 0);
  EXPECT_THROW(d.insert({2, 2}, 0), Error);
  EXPECT_THROW(DynamicDelaunay(0), Error);
  expect_delaunay(d, {{0, 0}, {1, 0}, {0, 1}});
}

TEST(DynamicDelaunay, AllocatesNothingOnceItIsWarm) {
  Random random(4);
  DynamicDelaunay d(300);
  for (int i = 0; i < 300; ++i) d.insert({random.uniform(0, 10), random.uniform(0, 10)}, i);
  const auto stir = [&](int count) {
    for (int i = 0; i < count; ++i) {
      const int id = static_cast<int>(random.index(300));
      d.move(id, d.at(id) + 0.1 * Vector2d(random.normal(), random.normal()));
    }
  };
  stir(3000);
  const auto before = test::allocations();
  stir(3000);
  EXPECT_EQ(test::allocations(), before);
}

struct Mover {
  Vector2d at, velocity;
};

/// Advances to sample times and compares with points that are moved one by one.
KineticDelaunay compare_movements(const std::vector<Mover>& movers, double step_s, int steps, std::size_t& flips) {
  const int count = static_cast<int>(movers.size());
  KineticDelaunay kinetic(count);
  Twin stepwise(count);
  for (const Mover& m : movers) {
    kinetic.insert(m.at, m.velocity, 0);
    stepwise.insert(m.at);
  }
  for (int i = 1; i <= steps; ++i) {
    kinetic.advance(i * step_s);
    double last = (i - 1) * step_s;
    for (const DelaunayFlip& flip : kinetic.flips()) {
      EXPECT_GE(flip.time_s, last);
      EXPECT_LE(flip.time_s, i * step_s);
      last = flip.time_s;
    }
    flips += kinetic.flips().size();
    for (int p = 0; p < count; ++p) {
      const auto& m = movers[static_cast<std::size_t>(p)];
      stepwise.move(p, m.at + i * step_s * m.velocity);
    }
    expect_delaunay(kinetic.triangulation(), stepwise.list());
    expect_delaunay(stepwise.delaunay, stepwise.list());
    EXPECT_EQ(strict_edges(kinetic.triangulation()), strict_edges(stepwise.delaunay)) << "step " << i;
    if (testing::Test::HasFailure()) break;
  }
  return kinetic;
}

// ledger: S3-07
TEST(KineticDelaunay, AgreesWithStepwiseMovementAtSampleTimes) {
  Random random(5);
  std::vector<Mover> movers;
  for (int i = 0; i < 120; ++i) {
    movers.push_back({{random.uniform(0, 100), random.uniform(0, 100)}, {random.normal(), random.normal()}});
  }
  std::size_t flips = 0;
  const KineticDelaunay kinetic = compare_movements(movers, 2, 20, flips);
  EXPECT_GT(flips, 1000u);
  EXPECT_EQ(kinetic.repairs(), 0) << "the flips alone keep the triangulation valid";
}

// Where d crosses the circle of a, b, c is known in closed form.
// ledger: S3-07
TEST(KineticDelaunay, FlipsWhenAPointEntersACircle) {
  KineticDelaunay kinetic(4);
  const int a = kinetic.insert({-5, 0}, {0, 0}, 0), b = kinetic.insert({5, 0}, {0, 0}, 0);
  const int c = kinetic.insert({0, 5}, {0, 0}, 0), d = kinetic.insert({0, -9}, {0, 1.0}, 0);
  kinetic.advance(3.9);
  EXPECT_TRUE(kinetic.flips().empty());
  kinetic.advance(5);
  ASSERT_EQ(kinetic.flips().size(), 1u);
  const DelaunayFlip flip = kinetic.flips()[0];
  EXPECT_NEAR(flip.time_s, 4, 1e-9);
  EXPECT_EQ((std::set<int>{flip.a, flip.b}), (std::set<int>{a, b}));
  EXPECT_EQ((std::set<int>{flip.c, flip.d}), (std::set<int>{c, d}));
}

// ledger: S3-07
TEST(KineticDelaunay, SurvivesPointsThatMeetAndGridsInMotion) {
  std::vector<Mover> meeting;  // all pass through the centre at 5 s
  for (int i = 0; i < 12; ++i) {
    const double angle = i * std::numbers::pi / 6;
    const Vector2d out(std::cos(angle), std::sin(angle));
    meeting.push_back({10 * out, -2 * out});
  }
  std::size_t flips = 0;
  compare_movements(meeting, 1, 12, flips);

  std::vector<Mover> crossing;  // grids that move through each other, point through point
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) {
      crossing.push_back({{1.0 * i, 1.0 * j}, {1, 0}});
      crossing.push_back({{8.0 + i, 1.0 * j}, {-1, 0}});
    }
  }
  compare_movements(crossing, 0.25, 40, flips);

  std::vector<Mover> row;  // all on one line, for ever
  for (int i = 0; i < 6; ++i) row.push_back({{1.0 * i, 2.0 * i}, {0.5 * (i - 3), 1.0 * (i - 3)}});
  compare_movements(row, 0.5, 12, flips);

  std::vector<Mover> triangle{{{0, 0}, {0, 0}}, {{4, 0}, {0, 0}}, {{2, 3}, {0, -1}}};  // turns inside out
  compare_movements(triangle, 0.5, 12, flips);
}

TEST(KineticDelaunay, TakesNewMotionsInsertionsAndRemovals) {
  Random random(6);
  KineticDelaunay kinetic(80);
  std::map<int, Mover> movers;
  const auto draw = [&](double spread) { return Vector2d(random.uniform(0, spread), random.uniform(0, spread)); };
  for (int i = 0; i < 300; ++i) {
    const double kind = random.uniform();
    if (movers.size() < 5 || (kind < 0.4 && movers.size() < 80)) {
      const Mover m{draw(20), draw(2) - Vector2d(1, 1)};
      movers[kinetic.insert(m.at, m.velocity, 0)] = m;
    } else if (kind < 0.6) {
      kinetic.remove(movers.begin()->first);
      movers.erase(movers.begin());
    } else {
      auto& [id, m] = *movers.rbegin();
      m.velocity = draw(2) - Vector2d(1, 1);
      kinetic.set_motion(id, m.at, m.velocity);
    }
    kinetic.advance(kinetic.now_s() + 0.1);
    Points places;
    for (auto& [id, m] : movers) {
      m.at = kinetic.triangulation().at(id);
      places.push_back(m.at);
    }
    expect_delaunay(kinetic.triangulation(), places);
    if (testing::Test::HasFailure()) FAIL() << "operation " << i;
  }
  EXPECT_THROW(kinetic.insert({0, 0}, {NAN, 0}, 0), Error);
  EXPECT_THROW(kinetic.advance(NAN), Error);
  EXPECT_THROW(kinetic.advance(0), Error);
}

}  // namespace
}  // namespace isobath::dynamic_delaunay_test
