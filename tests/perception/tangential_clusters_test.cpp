// Planes and edges of echoes in three dimensions, against the walls that they were cast on.
#include <cmath>
#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/perception/spherical_mapper.hpp>
#include <isobath/perception/tangential_clusters.hpp>
#include <tests/support/directions.hpp>
#include <tests/support/plane_rays.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;
using test::towards;

double degrees_off(const Vector3d& a, const Vector3d& b) {
  return std::acos(std::min(1.0, std::abs(a.normalized().dot(b.normalized())))) * 180 / std::numbers::pi;
}
/// Echoes of the nearest of some walls n.p = -d, at 2.5 degrees, with an error of 1 % of the range.
std::vector<Vector3d> echoes_of_walls(const std::vector<std::pair<Vector3d, double>>& walls, double half_az,
                                      double half_el, Random& random, bool nearest = true) {
  std::vector<Vector3d> echoes;
  for (double a = -half_az; a <= half_az; a += 2.5) {
    for (double e = -half_el; e <= half_el; e += 2.5) {
      const Vector3d u = towards(a, e);
      double range = nearest ? 1e9 : 0;
      for (const auto& wall : walls) {
        const double r = -wall.second / wall.first.dot(u);
        if (r > 0) range = nearest ? std::min(range, r) : std::max(range, r);
      }
      const double error = 0.01 * random.normal();
      if (range < 60) echoes.push_back(range * (1 + error) * u);
    }
  }
  return echoes;
}
TangentialConfig of_one_percent() {
  TangentialConfig config;
  config.sigma_m = 0.01;
  config.sigma_share = 0.01;
  return config;
}

// ledger: S4-44
TEST(TangentialClusters, TellTheNormalOfAPlaneWithinTwoDegreesAtOnePercentOfRange) {
  Random random(1);
  double worst = 0;
  for (int draw = 0; draw < 40; ++draw) {
    const Vector3d n = -towards(random.uniform(-35, 35), random.uniform(-35, 35));
    const double distance = random.uniform(5, 20);
    const auto echoes = echoes_of_walls({{n, distance}}, 25, 15, random);
    const TangentialClusters told = tangential_clusters(echoes, of_one_percent());
    ASSERT_EQ(told.planes.size(), 1u) << draw;
    worst = std::max(worst, degrees_off(told.planes[0].normal, n));
    EXPECT_LT(told.planes[0].normal.dot(told.planes[0].centre), 0) << "towards the sonar";
    EXPECT_NEAR(told.planes[0].distance_m, distance, 0.02 * distance);
    EXPECT_GT(told.planes[0].support, 0.9 * static_cast<double>(echoes.size()));
    EXPECT_TRUE(told.edges.empty());
  }
  EXPECT_LT(worst, 2);
}

// ledger: S4-44
TEST(TangentialClusters, ACornerGivesTwoClustersAndTheEdgeBetweenThem) {
  Random random(2);
  for (const bool convex : {true, false}) {
    for (int draw = 0; draw < 10; ++draw) {
      // two walls that meet in a slanting edge, 12 m off
      const Vector3d tilt = Vector3d(0.1, 0.2, 1).normalized(), at = 12 * towards(0, 0);
      const double turn = random.uniform(-10, 10);
      const auto wall = [&](double azimuth) {
        const Vector3d raw = towards(azimuth + turn, 0);
        const Vector3d n = (raw - raw.dot(tilt) * tilt).normalized();
        return std::make_pair(n, -n.dot(at));
      };
      // a body shows both faces before the edge behind which none is; a room is what is nearer of its walls
      const auto echoes = echoes_of_walls({wall(135), wall(225)}, 30, 15, random, !convex);
      const TangentialClusters told = tangential_clusters(echoes, of_one_percent());
      ASSERT_EQ(told.planes.size(), 2u) << draw << convex;
      const bool swap = degrees_off(told.planes[0].normal, wall(135).first) > 45;
      EXPECT_LT(degrees_off(told.planes[swap ? 1 : 0].normal, wall(135).first), 2);
      EXPECT_LT(degrees_off(told.planes[swap ? 0 : 1].normal, wall(225).first), 2);
      ASSERT_EQ(told.edges.size(), 1u);
      const TangentEdge& edge = told.edges[0];
      EXPECT_LT(degrees_off(edge.along, tilt), 2);
      EXPECT_LT((edge.at - at).cross(tilt).norm(), 0.15) << "off the edge, m";
      EXPECT_GT(edge.support, 10);
      EXPECT_GT(told.planes[0].support + told.planes[1].support, 0.97 * static_cast<double>(echoes.size()));
    }
  }
}

// ledger: S4-44
TEST(TangentialClusters, TakesWallsOfALevelScanForUpright) {
  Random random(3);
  const test::PlanRoom body{{{{10, 0}, {14, 6}}, {{10, 0}, {14, -6}}}, {}};
  const PlaneScan scan = test::plan_scan(body, {0, 0}, random, 0.3);
  std::vector<Vector3d> echoes;
  for (const PlaneEcho& echo : scan.echoes) {
    const Eigen::Vector2d p = scan.point(echo);
    echoes.emplace_back(p.x(), p.y(), 0);
  }
  TangentialConfig config;
  config.vertical = true;
  config.least = 4;
  config.turned = Angle::degrees(45);
  const TangentialClusters told = tangential_clusters(echoes, config);
  ASSERT_EQ(told.planes.size(), 2u);
  for (const TangentPlane& plane : told.planes) EXPECT_NEAR(plane.normal.z(), 0, 1e-9);
  ASSERT_EQ(told.edges.size(), 1u);
  EXPECT_LT(degrees_off(told.edges[0].along, Vector3d::UnitZ()), 1e-6);
  EXPECT_LT((told.edges[0].at - Vector3d(10, 0, 0)).head<2>().norm(), 0.4);
}

// ledger: S4-44
TEST(TangentialClusters, HaveNoPlaneForARoundBodyNorForEchoesAtRandom) {
  Random random(4);
  std::vector<Vector3d> ball, nothing;
  for (double a = -20; a <= 20; a += 2.5) {
    for (double e = -20; e <= 20; e += 2.5) {
      const Vector3d u = towards(a, e), c(8, 0, 0);
      const double b = u.dot(c), root = b * b - 64 + 2.5 * 2.5;
      if (root > 0) ball.push_back((b - std::sqrt(root)) * u);
      nothing.push_back(random.uniform(3, 30) * u);
    }
  }
  TangentialConfig config;
  config.sigma_m = 0.02;
  config.sigma_share = 0;
  const TangentialClusters round = tangential_clusters(ball, config);
  for (const TangentPlane& plane : round.planes) {
    EXPECT_LT(plane.support, 0.25 * static_cast<double>(ball.size())) << "facets, no face";
  }
  EXPECT_TRUE(tangential_clusters(nothing, config).planes.empty());
  EXPECT_TRUE(tangential_clusters({}, config).planes.empty());
}

// ledger: S4-44
TEST(TangentialClusters, AreFoundInTheGrid) {
  SphericalGrid grid;
  SphericalMapper mapper({}, grid);
  Random random(5);
  for (int scan = 0; scan < 3; ++scan) {
    for (double a = -40; a <= 40; a += 2.5) {
      for (double e = -20; e <= 20; e += 2.5) {
        const Vector3d u = towards(a + 1.25, e + 1.25);
        const double range = 15 / u.x() + 0.1 * random.normal();  // the plane x' = 15
        mapper.add({Vector3d::Zero(), u, Angle::degrees(2.5), range, 40, Time{}});
      }
    }
  }
  const auto echoes = echoes_of(grid, 0.3);
  EXPECT_GT(echoes.size(), 300u);
  const TangentialClusters told = tangential_clusters(echoes);
  ASSERT_FALSE(told.planes.empty());
  EXPECT_LT(degrees_off(told.planes[0].normal, Vector3d::UnitX()), 2);
  EXPECT_NEAR(told.planes[0].distance_m, 15, 0.1);
  EXPECT_GT(told.planes[0].support, 0.8 * static_cast<double>(echoes.size()));
}

}  // namespace
}  // namespace isobath
