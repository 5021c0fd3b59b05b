// Worlds that rays meet: against brute force, closed forms, and files of other makers.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/io/gdal/geotiff.hpp>
#include <isobath/sim/triangle_mesh.hpp>
#include <tests/sim/worlds.hpp>
#include <tests/support/data.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

using namespace test;
using Eigen::Vector3d;

Vector3d random_direction(Random& random) {
  return Vector3d(random.normal(), random.normal(), random.normal()).normalized();
}
Vector3d random_point(Random& random, double reach, double top, double bottom) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(top, bottom)};
}

std::optional<double> range_of(const Tank& tank, const Vector3d& p, const Vector3d& u, double most = 1000) {
  const auto hit = tank.world->cast(p, u.normalized(), most);
  if (!hit) return std::nullopt;
  return hit->range;
}

/// Bodies stand in the world by kind, in the order of the kinds' names: their own names say which is which.
int body_of(const Tank& tank, const std::string& name) {
  const auto all = tank.world->bodies();
  return static_cast<int>(std::find_if(all.begin(), all.end(), [&](const WorldBody& b) { return b.name == name; }) -
                          all.begin());
}

// Brute force -------------------------------------------------------------------------------------------------------

struct Triangle {
  Vector3d a, b, c;
  std::string body;
};

/// Moeller and Trumbore 1997.
std::optional<double> meet(const Triangle& t, const Vector3d& p, const Vector3d& u) {
  const Vector3d e1 = t.b - t.a, e2 = t.c - t.a, h = u.cross(e2);
  const double det = e1.dot(h);
  if (std::abs(det) < 1e-12) return std::nullopt;
  const Vector3d s = p - t.a, q = s.cross(e1);
  const double v = s.dot(h) / det, w = u.dot(q) / det, range = e2.dot(q) / det;
  if (v < 0 || w < 0 || v + w > 1 || range < 1e-4) return std::nullopt;
  return range;
}

void add_quad(std::vector<Triangle>& all, const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d,
              const std::string& body) {
  all.push_back({a, b, c, body});
  all.push_back({a, c, d, body});
}

/// A random scene of boxes, walls and prisms over a terrain, as a file and, made apart from it, as triangles.
struct RandomScene {
  std::string toml;
  std::vector<Triangle> triangles;

  explicit RandomScene(std::uint64_t seed) {
    Random random(seed);
    for (int i = 0; i < 3; ++i) {
      const Vector3d centre = random_point(random, 30, 5, 20);
      const Vector3d half(random.uniform(0.5, 5), random.uniform(0.5, 5), random.uniform(0.5, 5));
      const double heading = random.uniform(-180, 180), pitch = random.uniform(-60, 60), roll = random.uniform(-90, 90);
      toml += fmt::format(
          "[[box]]\ncentre = [{}, {}, {}]\nsize = [{}, {}, {}]\nheading_deg = {}\npitch_deg = {}\n"
          "roll_deg = {}\n",
          centre.x(), centre.y(), centre.z(), 2 * half.x(), 2 * half.y(), 2 * half.z(), heading, pitch, roll);
      const Eigen::Matrix3d R =
          (Eigen::AngleAxisd(heading * kDegree, Vector3d::UnitZ()) *
           Eigen::AngleAxisd(pitch * kDegree, Vector3d::UnitY()) * Eigen::AngleAxisd(roll * kDegree, Vector3d::UnitX()))
              .toRotationMatrix();
      for (int axis = 0; axis < 3; ++axis) {
        const Vector3d n = R.col(axis) * half[axis], s = R.col((axis + 1) % 3) * half[(axis + 1) % 3],
                       t = R.col((axis + 2) % 3) * half[(axis + 2) % 3];
        for (const double side : {-1.0, 1.0}) {
          const Vector3d m = centre + side * n;
          add_quad(triangles, m - s - t, m + s - t, m + s + t, m - s + t, fmt::format("box {}", i + 1));
        }
      }
    }
    for (int i = 0; i < 2; ++i) {
      const Vector3d a = random_point(random, 40, 0, 0), b = random_point(random, 40, 0, 0);
      const double top = random.uniform(0, 5), bottom = random.uniform(10, 25);
      toml += fmt::format("[[wall]]\nline = [[{}, {}], [{}, {}]]\ntop = {}\nbottom = {}\n", a.x(), a.y(), b.x(), b.y(),
                          top, bottom);
      const auto at = [](const Vector3d& p, double z) { return Vector3d(p.x(), p.y(), z); };
      add_quad(triangles, at(a, top), at(b, top), at(b, bottom), at(a, bottom), fmt::format("wall {}", i + 1));
    }
    const Vector3d a = random_point(random, 40, 0, 0), b = random_point(random, 40, 0, 0);
    toml += fmt::format("[[prism]]\nlines = [[{}, {}, {}, {}]]\ntop = 1\nbottom = 20\nbottom_scale = 2\n", a.x(), a.y(),
                        b.x(), b.y());
    const Vector3d m = (a + b) / 2, z0(0, 0, 1), z1(0, 0, 20);
    add_quad(triangles, a + z0, b + z0, m + 2 * (b - m) + z1, m + 2 * (a - m) + z1, "prism 1");
    toml += "[bottom]\nkind = \"terrain\"\ndepth = 22\nextent_m = 60\ncell_m = 4\nrelief_m = 1\nseed = 5\n";
  }
};

TEST(Cast, AgreesWithBruteForceOverAllTriangles) {
  ISOBATH_NOT_SANITIZED();
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    RandomScene made(seed);
    const Tank tank(made.toml);
    const TriangleMesh terrain = terrain_mesh(tank.scene.bottom);
    const auto at = [&](int i) -> Vector3d { return terrain.vertices[static_cast<std::size_t>(i)].cast<double>(); };
    for (const Eigen::Vector3i& t : terrain.triangles)
      made.triangles.push_back({at(t[0]), at(t[1]), at(t[2]), "bottom"});
    Random random(seed + 100);
    int met = 0, bodies = 0;
    for (int i = 0; i < 1500; ++i) {
      const Vector3d p = random_point(random, 40, 1, 18), u = random_direction(random);
      const double most = random.uniform(5, 80);
      double nearest = most;
      const Triangle* which = nullptr;
      for (const Triangle& t : made.triangles) {
        const auto range = meet(t, p, u);
        if (range && *range < nearest) {
          nearest = *range;
          which = &t;
        }
      }
      const auto hit = tank.world->cast(p, u, most);
      ASSERT_EQ(hit.has_value(), which != nullptr) << "seed " << seed << " ray " << i;
      ASSERT_EQ(tank.world->blocked(p, u, most), which != nullptr);
      if (!hit) continue;
      ++met;
      bodies += hit->target >= kFirstBody;
      ASSERT_NEAR(hit->range, nearest, 1e-4 * (1 + nearest)) << "seed " << seed << " ray " << i;
      ASSERT_EQ(tank.world->name(hit->target), which->body);
      const Vector3d n = (which->b - which->a).cross(which->c - which->a).normalized();
      ASSERT_NEAR(std::abs(hit->normal.dot(n)), 1, 1e-4);
      ASSERT_LE(hit->normal.dot(u), 0);
      ASSERT_EQ(hit->curvature, 0);
    }
    EXPECT_GT(met, 500);
    EXPECT_GT(bodies, 100);
  }
}

// Spheres and cylinders from their equations, found by marching along the ray and bisecting.
TEST(Cast, MeetsSpheresAndCylindersWhereTheirEquationsSay) {
  ISOBATH_NOT_SANITIZED();
  const Tank tank(
      "[[sphere]]\ncentre = [10, 2, 8]\nradius = 3\n"
      "[[cylinder]]\ncentre = [-6, 4, 9]\naxis = [0.3, -0.5, 1]\nradius = 1.5\nlength = 7\n");
  const Vector3d axis = Vector3d(0.3, -0.5, 1).normalized(), c0(10, 2, 8), c1(-6, 4, 9);
  const auto depth_in = [&](int body, const Vector3d& q) {  // positive inside
    if (body == 0) return 3 - (q - c0).norm();
    const double along = (q - c1).dot(axis);
    return std::min(3.5 - std::abs(along), 1.5 - (q - c1 - along * axis).norm());
  };
  Random random(3);
  int met = 0;
  for (int i = 0; i < 1200; ++i) {
    const Vector3d p = random_point(random, 15, 0, 20), u = random_direction(random);
    if (depth_in(0, p) > -0.1 || depth_in(1, p) > -0.1) continue;
    double expected = -1;
    int which = -1;
    for (double t = 0; t < 40 && expected < 0; t += 0.02) {
      for (const int body : {0, 1}) {
        if (depth_in(body, p + t * u) <= 0) continue;
        double low = t - 0.02, high = t;
        for (int k = 0; k < 40; ++k) (depth_in(body, p + 0.5 * (low + high) * u) > 0 ? high : low) = 0.5 * (low + high);
        expected = high;
        which = body;
      }
    }
    const auto hit = tank.world->cast(p, u, 40);
    if (expected < 0) {
      // A graze shorter than a step is not seen by marching.
      if (hit) {
        EXPECT_LT(std::max(depth_in(0, p + (hit->range + 0.01) * u), depth_in(1, p + (hit->range + 0.01) * u)), 0.01);
      }
      continue;
    }
    ASSERT_TRUE(hit) << i;
    ++met;
    ASSERT_EQ(tank.world->name(hit->target), which == 0 ? "sphere 1" : "cylinder 1");
    ASSERT_NEAR(hit->range, expected, 2e-5 * (1 + expected)) << i;
    const Vector3d q = p + hit->range * u;
    if (which == 0) {
      ASSERT_TRUE(hit->normal.isApprox((q - c0).normalized(), 1e-4));
      ASSERT_DOUBLE_EQ(hit->curvature, 1 / 3.0);
    } else if (std::abs((q - c1).dot(axis)) < 3.49) {
      ASSERT_NEAR(hit->normal.dot(axis), 0, 1e-4);
      ASSERT_DOUBLE_EQ(hit->curvature, 1 / 1.5);
      ASSERT_TRUE(hit->straight.isApprox(axis));
    } else if (std::abs(hit->normal.dot(axis)) > 0.999) {
      ASSERT_EQ(hit->curvature, 0);
    }
  }
  EXPECT_GT(met, 30);
}

// Arcs and lines ----------------------------------------------------------------------------------------------------

// ledger: S4-31
TEST(ArcsAndLines, ASquareIsMetAtItsAnalyticDistancesFromInside) {
  const Tank tank("[[prism]]\nlines = [[-5, -5, 5, -5], [5, -5, 5, 5], [5, 5, -5, 5], [-5, 5, -5, -5]]\n");
  const Vector3d p(1, 2, 5);
  for (double a = 0.5; a < 360; a += 1) {
    const Vector3d u(std::cos(a * kDegree), std::sin(a * kDegree), 0);
    const double to_x = ((u.x() > 0 ? 5 : -5) - p.x()) / u.x(), to_y = ((u.y() > 0 ? 5 : -5) - p.y()) / u.y();
    ASSERT_NEAR(range_of(tank, p, u).value_or(-1), std::min(to_x, to_y), 1e-5) << a;
  }
}

// ledger: S4-31
TEST(ArcsAndLines, ACircleIsMetFromInsideAndOutsideWithinTheTwoMillimetresOfItsChords) {
  const Tank tank("[[prism]]\narcs = [[0, 0, 4, 0, 360]]\n");
  for (const double start : {1.5, 10.0}) {
    const Vector3d m(start, 0.5, 5);
    for (double a = 0; a < 360; a += 0.7) {
      const Vector3d u(std::cos(a * kDegree), std::sin(a * kDegree), 0);
      const double b = u.head<2>().dot(m.head<2>()), d = b * b - m.head<2>().squaredNorm() + 16;
      if (std::abs(d) < 0.5) continue;  // nearly tangent: below
      const double expected = d < 0 ? -1 : -b - std::sqrt(d) > 0 ? -b - std::sqrt(d) : -b + std::sqrt(d);
      const double found = range_of(tank, m, u).value_or(-1);
      ASSERT_NEAR(found, expected > 0 ? expected : -1, 0.002 / 0.17) << start << " " << a;
    }
  }
}

// ledger: S4-31
TEST(ArcsAndLines, AnArcIsMetWithinItsAnglesOnlyOnEitherSide) {
  const Tank tank("[[prism]]\narcs = [[0, 0, 5, -30, 30]]\n");
  for (const double a : {-40.0, -29.5, -10.0, 0.0, 29.5, 31.0, 90.0, 180.0}) {
    const Vector3d u(std::cos(a * kDegree), std::sin(a * kDegree), 0);
    const bool on = std::abs(a) < 30;
    EXPECT_NEAR(range_of(tank, {0, 0, 5}, u).value_or(-1), on ? 5 : -1, 0.003) << a;  // hollow side
    EXPECT_NEAR(range_of(tank, 12 * u + Vector3d(0, 0, 5), -u, 11.9).value_or(-1), on ? 7 : -1, 0.003)
        << a;  // round side
  }
}

// ledger: S4-31
TEST(ArcsAndLines, TangentRaysAndEndpointsAreDecidedWithinTheChordsTolerance) {
  const Tank circle("[[prism]]\narcs = [[0, 0, 4, 0, 360]]\n");
  EXPECT_FALSE(range_of(circle, {-10, 4.001, 5}, {1, 0, 0}));
  EXPECT_TRUE(range_of(circle, {-10, 3.997, 5}, {1, 0, 0}));
  const Tank ball("[[sphere]]\ncentre = [0, 0, 5]\nradius = 4\n");
  EXPECT_FALSE(range_of(ball, {-10, 4.0001, 5}, {1, 0, 0}));
  EXPECT_NEAR(range_of(ball, {-10, 3.9999, 5}, {1, 0, 0}).value_or(-1), 10 - std::sqrt(16 - 3.9999 * 3.9999), 1e-3);
  const Tank line("[[prism]]\nlines = [[10, -2, 10, 3]]\n");
  const auto towards = [](double east) { return Vector3d(10, east, 0); };
  EXPECT_TRUE(range_of(line, {0, 0, 5}, towards(2.9999)));
  EXPECT_FALSE(range_of(line, {0, 0, 5}, towards(3.0001)));
  EXPECT_TRUE(range_of(line, {0, 0, 5}, towards(-1.9999)));
  EXPECT_FALSE(range_of(line, {0, 0, 5}, towards(-2.0001)));
  EXPECT_FALSE(range_of(line, {10, -10, 5}, {1e-6, 1, 0}));  // edge on, a hair beside it
}

// ledger: S4-34
TEST(ArcsAndLines, APrismIsTheSameAtAllDepthsAndAConeScalesWithDepth) {
  const Tank tube("[[prism]]\narcs = [[0, 0, 4, 0, 360]]\ntop = 2\nbottom = 12\n");
  const Tank cone("[[prism]]\narcs = [[0, 0, 4, 0, 360]]\ntop = 2\nbottom = 12\nbottom_scale = 3\n");
  for (const double z : {2.01, 5.0, 7.0, 11.99}) {
    for (const double a : {10.0, 100.0, 250.0}) {
      const Vector3d u(std::cos(a * kDegree), std::sin(a * kDegree), 0);
      EXPECT_NEAR(range_of(tube, {0, 0, z}, u).value_or(-1), 4, 0.003);
      EXPECT_NEAR(range_of(cone, {0, 0, z}, u).value_or(-1), 4 * (1 + 2 * (z - 2) / 10), 0.01) << z;
    }
  }
  EXPECT_FALSE(range_of(tube, {0, 0, 1.99}, {1, 0, 0}));
  EXPECT_FALSE(range_of(tube, {0, 0, 12.01}, {1, 0, 0}));
  const auto hit = cone.world->cast({0, 0, 7}, {1, 0, 0}, 100);
  EXPECT_NEAR(std::atan2(std::abs(hit->normal.z()), std::abs(hit->normal.x())), std::atan(0.8),
              0.01);  // 8 m out over 10
}

// Walls, pylons, bodies that move -----------------------------------------------------------------------------------

TEST(Wall, WithABatterStandsOutToTheRightAtItsFoot) {
  // Seen along the line, north to south at 20 m east, the right is west: towards the sonar.
  const Tank tank("[[wall]]\nline = [[30, 20], [-30, 20]]\ntop = 0\nbottom = 10\nbatter_deg = 30\n");
  for (const double z : {0.5, 5.0, 9.5}) {
    EXPECT_NEAR(range_of(tank, {0, 0, z}, {0, 1, 0}).value_or(-1), 20 - z * std::tan(30 * kDegree), 1e-4) << z;
  }
  EXPECT_NEAR(tank.world->cast({0, 0, 5}, {0, 1, 0}, 50)->normal.z(), -std::sin(30 * kDegree), 1e-4);  // faces up
}

TEST(Wall, RoundACornerKeepsItsBatterOnBothSides) {
  const Tank tank("[[wall]]\nline = [[20, -40], [20, 20], [-40, 20]]\ntop = 0\nbottom = 10\nbatter_deg = 45\n");
  EXPECT_NEAR(range_of(tank, {0, 0, 6}, {1, 0, 0}).value_or(-1), 14, 1e-3);
  EXPECT_NEAR(range_of(tank, {0, 0, 6}, {0, 1, 0}).value_or(-1), 14, 1e-3);
  EXPECT_NEAR(range_of(tank, {0, 0, 6}, Vector3d(1, 1, 0)).value_or(-1), 14 * std::sqrt(2.0), 1e-3);
}

TEST(Pylons, AreARowOfBodiesWithNamesAndPlacesOfTheirOwn) {
  const Tank tank(
      "[[pylons]]\nname = \"pier\"\nfirst = [20, -10]\nstep = [0, 10]\ncount = 3\nradius = 1\n"
      "top = 1\nbottom = 9\n");
  ASSERT_EQ(tank.world->bodies().size(), 3u);
  for (int i = 0; i < 3; ++i) {
    const Vector3d p(0, -10 + 10 * i, 5);
    const auto hit = tank.world->cast(p, {1, 0, 0}, 50);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->range, 19, 1e-4);
    EXPECT_EQ(hit->target, kFirstBody + i);
    EXPECT_EQ(tank.world->name(hit->target), fmt::format("pier.{}", i + 1));
  }
  EXPECT_FALSE(range_of(tank, {0, 0, 9.5}, {1, 0, 0}));
}

TEST(Bodies, ThatMoveAreMetWhereTheyAre) {
  const Tank tank(
      "[[sphere]]\ncentre = [20, 0, 5]\nradius = 1\npath = [[10, 0, 0, 5], [20, 10, 0, 5], [30, 10, 20, 7]]\n"
      "[[box]]\ncentre = [0, 30, 5]\nsize = [2, 2, 2]\npath = [[0, 0, 30, 5], [10, 0, 20, 5]]\n"
      "[[box]]\ncentre = [-20, 0, 5]\nsize = [2, 2, 2]\n");
  World& world = *tank.world;
  EXPECT_NEAR(range_of(tank, {0, 0, 5}, {1, 0, 0}).value_or(-1), 19, 1e-4);
  world.move_to(15);  // half way on its first leg; the box has arrived
  EXPECT_NEAR(range_of(tank, {0, 0, 5}, {1, 0, 0}).value_or(-1), 24, 1e-4);
  EXPECT_NEAR(range_of(tank, {0, 0, 5}, {0, 1, 0}).value_or(-1), 19, 1e-4);
  EXPECT_NEAR(range_of(tank, {0, 0, 5}, {-1, 0, 0}).value_or(-1), 19, 1e-4);
  EXPECT_NEAR(world.distance(body_of(tank, "sphere 1"), {0, 0, 5}), 24, 1e-6);
  EXPECT_NEAR(world.distance(body_of(tank, "box 1"), {0, 0, 5}), 19, 1e-6);
  EXPECT_EQ(world.name(world.cast({0, 0, 5}, {1, 0, 0}, 50)->target), "sphere 1");
  EXPECT_EQ(world.name(world.cast({0, 0, 5}, {0, 1, 0}, 50)->target), "box 1");
  EXPECT_DOUBLE_EQ(world.cast({0, 0, 5}, {1, 0, 0}, 50)->curvature, 1);
  world.move_to(1000);
  EXPECT_NEAR(range_of(tank, {30, 0, 7}, {0, 1, 0}).value_or(-1), 19, 1e-4);
  const auto moves = [&](const char* name) {
    return world.bodies()[static_cast<std::size_t>(body_of(tank, name))].moves;
  };
  EXPECT_TRUE(moves("sphere 1"));
  EXPECT_FALSE(moves("box 2"));
  world.move_to(0);
  EXPECT_NEAR(range_of(tank, {0, 0, 5}, {1, 0, 0}).value_or(-1), 19, 1e-4);
}

// Bottom ------------------------------------------------------------------------------------------------------------

TEST(BottomDepth, OfAFlatBottomIsItsDepthBelowBodiesToo) {
  const Tank tank(
      "[bottom]\nkind = \"flat\"\ndepth = 12\nextent_m = 100\n"
      "[[box]]\ncentre = [0, 0, 6]\nsize = [4, 4, 4]\n[[sphere]]\ncentre = [20, 0, 6]\nradius = 2\n");
  for (const auto& [n, e] : {std::pair(0.0, 0.0), {20.0, 0.0}, {-99.0, 99.0}, {50.0, 3.0}}) {
    EXPECT_NEAR(tank.world->bottom_depth(n, e).value_or(-1), 12, 2e-3) << n << " " << e;
  }
  EXPECT_FALSE(tank.world->bottom_depth(101, 0));
  EXPECT_FALSE(Tank("").world->bottom_depth(0, 0));
}

TEST(BottomDepth, OfATerrainFollowsItsSlopeAndHasItsRelief) {
  const Tank plain("[bottom]\nkind = \"terrain\"\ndepth = 30\nrelief_m = 0\nslope = [0.1, -0.05]\nextent_m = 100\n");
  EXPECT_NEAR(plain.world->bottom_depth(50, 20).value_or(-1), 30 + 5 - 1, 2e-3);
  const Tank rough("[bottom]\nkind = \"terrain\"\ndepth = 40\nrelief_m = 1.5\nwavelength_m = 40\nextent_m = 300\n");
  double sum = 0, squares = 0;
  int count = 0;
  for (double n = -290; n < 290; n += 11) {
    for (double e = -290; e < 290; e += 11) {
      const double z = rough.world->bottom_depth(n, e).value() - 40;
      sum += z;
      squares += z * z;
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 0, 0.2);
  EXPECT_NEAR(std::sqrt(squares / count), 1.5, 0.25);
}

// Distance ----------------------------------------------------------------------------------------------------------

/// The least distance to points where rays from all sides meet the world's only body.
double sampled_distance(const Tank& tank, const Vector3d& p, const Vector3d& middle, double reach) {
  double least = 1e9;
  Random random(11);
  for (int i = 0; i < 20000; ++i) {
    const Vector3d from = middle + reach * random_direction(random);
    const Vector3d to = middle + 0.35 * reach * random_direction(random) * random.uniform();
    const auto hit = tank.world->cast(from, (to - from).normalized(), 3 * reach);
    if (hit) least = std::min(least, (from + hit->range * (to - from).normalized() - p).norm());
  }
  return least;
}

TEST(Distance, IsThatOfTheNearestSampledPointOfTheSurface) {
  for (const char* body : {"[[sphere]]\ncentre = [0, 0, 10]\nradius = 2\n",
                           "[[cylinder]]\ncentre = [0, 0, 10]\naxis = [1, 1, 0.5]\nradius = 1\nlength = 4\n",
                           "[[box]]\ncentre = [0, 0, 10]\nsize = [2, 4, 3]\nheading_deg = 30\npitch_deg = 20\n",
                           "[[wall]]\nline = [[-2, -1], [2, 0], [1, 2]]\ntop = 8\nbottom = 12\nbatter_deg = 10\n",
                           "[[prism]]\narcs = [[0, 0, 2, 0, 120]]\nlines = [[2, 0, 0, -2]]\ntop = 9\nbottom = 11\n"}) {
    const Tank tank(body);
    for (const Vector3d& p : {Vector3d(6, 1, 9), Vector3d(-3, -4, 12), Vector3d(0.3, 5, 6), Vector3d(2, 2, 15)}) {
      const double sampled = sampled_distance(tank, p, {0, 0, 10}, 12), found = tank.world->distance(0, p);
      EXPECT_LE(found, sampled + 1e-4) << body;
      EXPECT_NEAR(found, sampled, 0.08) << body;
    }
  }
}

TEST(Distance, IsNegativeInsideBodiesThatHaveAnInside) {
  const Tank tank(
      "[[sphere]]\ncentre = [0, 0, 10]\nradius = 2\n"
      "[[cylinder]]\ncentre = [0, 0, 10]\nradius = 1\nlength = 4\n"
      "[[box]]\ncentre = [0, 0, 10]\nsize = [2, 4, 3]\n");
  EXPECT_NEAR(tank.world->distance(body_of(tank, "sphere 1"), {0.5, 0, 10}), -1.5, 1e-9);
  EXPECT_NEAR(tank.world->distance(body_of(tank, "cylinder 1"), {0.5, 0, 10}), -0.5, 1e-9);
  EXPECT_NEAR(tank.world->distance(body_of(tank, "box 1"), {0.5, 0, 10}), -0.5, 1e-9);
}

// Files -------------------------------------------------------------------------------------------------------------

struct MeshFile {
  const char* name;
  double east, north, low, high;  ///< extents in m; low and high: heights
  std::size_t triangles;
};

// Sizes after the data's README: placed by the file's own matrices, z up, metres. That of Mangalia lowers ground and
// land, 132 triangles more, by 1.99 m.
TEST(Files, EveryMeshOfTheWorldsLoadsWithTheExtentsThatItsReadmeStates) {
  ISOBATH_NEEDS_DATA(folder, "mesh-worlds");
  for (const MeshFile& m : {MeshFile{"lake__LakeBottom.dae", 1000, 1000, NAN, NAN, 12020},
                            MeshFile{"munkholmen_seabed__seabed.dae", 2386, 1479, -64, 0, 2115},
                            MeshFile{"mangalia__170427_Seabed8_textured.dae", 4124, 2850, -23.02, 6.26, 2214 + 132},
                            MeshFile{"herkules_seabed__herkules_seabed.dae", 100, 100, NAN, NAN, 0},
                            MeshFile{"munkholmen__munkholmen.dae", NAN, NAN, NAN, NAN, 0}}) {
    const TriangleMesh mesh = load_mesh((folder / m.name).string(), 1, {});
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& v : mesh.vertices) box.extend(v);
    const Eigen::Vector3f size = box.sizes();
    EXPECT_FALSE(mesh.triangles.empty());
    if (m.triangles > 0) {
      EXPECT_NEAR(static_cast<double>(mesh.triangles.size()), static_cast<double>(m.triangles), 0) << m.name;
    }
    if (!std::isnan(m.east)) {
      const double longer = std::max(m.east, m.north), shorter = std::min(m.east, m.north);
      EXPECT_NEAR(std::max(size.x(), size.y()) / longer, 1, 0.02) << m.name << " " << size.transpose();
      EXPECT_NEAR(std::min(size.x(), size.y()) / shorter, 1, 0.02) << m.name << " " << size.transpose();
    }
    if (!std::isnan(m.low)) {
      EXPECT_NEAR(box.min().z(), m.low, 1.0) << m.name;
      EXPECT_NEAR(box.max().z(), m.high, 1.0) << m.name;
    }
  }
}

// Depths straight below places against brute force over the file's triangles.
TEST(Files, MeshesServeAsBottomsWithTheirOwnDepths) {
  ISOBATH_NEEDS_DATA(folder, "mesh-worlds");
  for (const char* name : {"lake__LakeBottom.dae", "munkholmen_seabed__seabed.dae"}) {
    const std::string file = (folder / name).string();
    const Tank tank("[bottom]\nkind = \"mesh\"\ncentred = false\ndepth = 0\nfile = \"" + file + "\"\n");
    const TriangleMesh mesh = load_mesh(file, 1, {});
    std::vector<Triangle> all;
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector3i& t : mesh.triangles) {
      const auto at = [&](int i) -> Vector3d {
        const Vector3d v = mesh.vertices[static_cast<std::size_t>(i)].cast<double>();
        return {v.y(), v.x(), -v.z()};
      };
      all.push_back({at(t[0]), at(t[1]), at(t[2]), "bottom"});
      box.extend(Eigen::Vector2d(at(t[0]).head<2>()));
    }
    Random random(2);
    int met = 0;
    for (int i = 0; i < 100; ++i) {
      const double n = random.uniform(box.min().x(), box.max().x()), e = random.uniform(box.min().y(), box.max().y());
      double top = 1e9;
      for (const Triangle& t : all) {
        if (const auto range = meet(t, {n, e, -1000}, Vector3d::UnitZ())) top = std::min(top, *range - 1000);
      }
      const auto found = tank.world->bottom_depth(n, e);
      ASSERT_EQ(found.has_value(), top < 1e8) << name << " " << n << " " << e;
      met += found.has_value();
      if (found) {
        EXPECT_NEAR(*found, top, 0.02) << name << " " << n << " " << e;
      }
    }
    EXPECT_GT(met, 50) << name;
  }
}

// At the centres of cells, where nothing is interpolated; the extremes are those of the data's README.
TEST(Files, ABathymetricRasterServesAsABottomWithItsOwnDepths) {
  ISOBATH_NEEDS_DATA(folder, "bag-noaa");
  const std::string file = (folder / "F00788_SR_8m.bag").string();
  const Tank tank("[bottom]\nkind = \"raster\"\ndepth = 0\nallow_holes = true\nfile = \"" + file + "\"\n");
  const std::unique_ptr<GDALDataset> data(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
  ASSERT_TRUE(data);
  std::vector<float> cells(179 * 179);
  ASSERT_EQ(data->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, 179, 179, cells.data(), 179, 179, GDT_Float32, 0, 0),
            CE_None);
  for (const double edge : {-89 * 8 - 0.01, 89 * 8 + 0.01}) {
    for (int along = -89 * 8; along <= 89 * 8; along += 8) {
      EXPECT_FALSE(tank.world->bottom_depth(edge, along)) << "beyond the raster";
      EXPECT_FALSE(tank.world->bottom_depth(along, edge)) << "beyond the raster";
    }
  }
  int met = 0;
  double least = 1e9, most = -1e9;
  for (int r = 1; r < 178; r += 8) {
    for (int c = 1; c < 178; c += 8) {
      const double value = static_cast<double>(cells[static_cast<std::size_t>(r * 179 + c)]);
      const auto depth = tank.world->bottom_depth((89 - r) * 8 + 1e-3, (c - 89) * 8 + 1e-3);
      if (value > 1e5 || !depth) continue;
      ++met;
      EXPECT_NEAR(*depth, -value, 0.02) << r << " " << c;
      least = std::min(least, *depth);
      most = std::max(most, *depth);
    }
  }
  EXPECT_GT(met, 50);
  EXPECT_GT(least, 36.2 - 0.05);
  EXPECT_LT(most, 68.4 + 0.05);
}

/// A plane with a bump, written as a raster of elevations around W's origin.
std::filesystem::path write_raster(bool with_hole, double sign) {
  constexpr int kColumns = 60, kRows = 40;
  RasterFrame frame;
  frame.columns = kColumns;
  frame.rows = kRows;
  frame.cell_m = 5;
  frame.corner_m = {kRows * 5 / 2.0, -kColumns * 5 / 2.0};
  std::vector<float> cells;
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      const double north = 100 - (r + 0.5) * 5, east = -150 + (c + 0.5) * 5;
      cells.push_back(static_cast<float>(sign * (20 + 0.1 * north - 0.05 * east)));
    }
  }
  if (with_hole) cells[20 * kColumns + 30] = std::numeric_limits<float>::quiet_NaN();
  const auto file = scratch_folder() / "bottom.tif";
  write_geotiff(file, frame, {"elevation", "m"}, std::span<const float>(cells));
  return file;
}

TEST(Files, AGeoTiffServesAsABottomOfElevationsOrOfDepths) {
  for (const bool elevation : {true, false}) {
    const auto file = write_raster(false, elevation ? -1 : 1);
    const Tank tank(fmt::format("[bottom]\nkind = \"raster\"\ndepth = 1\nelevation = {}\nfile = \"{}\"\n", elevation,
                                file.string()));
    for (const auto& [n, e] : {std::pair(0.0, 0.0), {90.0, 140.0}, {-90.0, 100.0}, {33.0, -141.0}}) {
      EXPECT_NEAR(tank.world->bottom_depth(n, e).value_or(-1), 1 + 20 + 0.1 * n - 0.05 * e, 0.01) << n << " " << e;
    }
    EXPECT_FALSE(tank.world->bottom_depth(120, 0));
  }
}

TEST(Files, ARasterWithHolesIsRefusedUnlessHolesAreTaken) {
  const auto file = write_raster(true, -1);
  const std::string toml = "[bottom]\nkind = \"raster\"\ndepth = 0\nfile = \"" + file.string() + "\"\n";
  try {
    const Tank tank(toml);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("tank.toml:2:1: bottom.file: the bottom has holes: 1 of 2400 cells"),
              std::string::npos)
        << error.what();
  }
  const Tank tank(toml + "allow_holes = true\n");
  EXPECT_FALSE(tank.world->bottom_depth(100 - 20.5 * 5, -150 + 30.5 * 5));
  EXPECT_NEAR(tank.world->bottom_depth(50, 50).value_or(-1), 20 + 5 - 2.5, 0.01);
}

TEST(Files, AMeshStandsWhereItIsPutAndTurned) {
  const auto file = scratch_folder() / "post.obj";  // 2 m east, 1 m north, 4 m up
  std::ofstream(file) << "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nv 0 0 4\nv 2 0 4\nv 2 1 4\nv 0 1 4\n"
                         "f 1 2 3 4\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  const std::string mesh = "[[mesh]]\nfile = \"" + file.string() + "\"\nposition = [10, 20, 9]\n";
  const Tank tank(mesh);
  const Eigen::AlignedBox3d box = tank.world->bodies()[0].box;
  EXPECT_TRUE(box.min().isApprox(Vector3d(10, 20, 5), 1e-5)) << box.min().transpose();
  EXPECT_TRUE(box.max().isApprox(Vector3d(11, 22, 9), 1e-5)) << box.max().transpose();
  const Tank turned(mesh + "heading_deg = 90\nscale = 2\n");
  const Eigen::AlignedBox3d other = turned.world->bodies()[0].box;
  EXPECT_TRUE(other.min().isApprox(Vector3d(6, 20, 1), 1e-5)) << other.min().transpose();
  EXPECT_TRUE(other.max().isApprox(Vector3d(10, 22, 9), 1e-5)) << other.max().transpose();
  const Tank down(mesh + "z_up = false\n");
  EXPECT_TRUE(down.world->bodies()[0].box.max().isApprox(Vector3d(12, 21, 13), 1e-5));
}

}  // namespace
}  // namespace isobath
