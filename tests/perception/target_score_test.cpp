// A pole, a fish and false echoes, told apart by how often and where they are heard.
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/perception/spherical_mapper.hpp>
#include <isobath/perception/target_score.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;

/// Of the cluster that holds most echoes within `radius_m` of a point; 0 where there is none.
double best_score(const SphericalGrid& grid, const Vector3d& at_G, double radius_m) {
  double best = 0;
  for (const SphericalCluster& cluster : clusters(grid, 0.3)) {
    if ((cluster.centroid - at_G).norm() < radius_m) best = std::max(best, target_score(grid, cluster).value());
  }
  return best;
}

// ledger: S4-46
TEST(TargetScore, OfAPoleIsAboveThatOfAFishAndOfFalseEchoes) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    SphericalGrid grid;
    SphericalMapper mapper({}, grid);
    const Vector3d pole(12, 14, 0);  // east, north of the start
    Vector3d fish(-14, 6, 0);
    Pose X_WB;
    for (int i = 0; i < 15; ++i) {
      const Time now = Time{} + seconds(5.0 * i);
      X_WB.translation = {0.6 * i, 0, 10};  // to the north
      mapper.move_to(X_WB, now);
      mapper.begin_scan();
      const Vector3d from(0, 0.6 * i, 0);
      const auto hear = [&](const Vector3d& at) {
        const Vector3d v = at - from;
        const double error = 0.1 * random.normal();
        mapper.add({Vector3d::Zero(), v.normalized(), Angle::degrees(2.5), v.norm() + error, 40, now});
      };
      hear(pole);
      hear(pole + Vector3d(0.1, 0.1, 0.01));
      fish += Vector3d(random.uniform(-0.5, 2), random.uniform(0.5, 2), 0);  // at about half a knot
      hear(fish);
      hear(fish + Vector3d(0.1, 0.1, 0.01));
      for (int k = 0; k < 2; ++k) {
        const double a = random.uniform(-3.1, -0.2);  // to the south of it all
        const double r = random.uniform(8, 38);
        hear(from + r * Vector3d(std::cos(a), std::sin(a), 0.01));
      }
    }
    const Vector3d now(0, 0.6 * 14, 0);
    const double of_pole = best_score(grid, pole - now, 2);
    double of_rest = 0;
    for (const SphericalCluster& cluster : clusters(grid, 0.3)) {
      if ((cluster.centroid - (pole - now)).norm() < 3) continue;
      of_rest = std::max(of_rest, target_score(grid, cluster).value());
    }
    EXPECT_GT(of_pole, 0.6) << seed;
    EXPECT_LT(of_rest, 0.5 * of_pole) << seed;
    EXPECT_LT(best_score(grid, fish - now, 6), 0.5 * of_pole) << seed;
  }
}

// ledger: S4-46
TEST(TargetScore, GrowsWithEchoesScansAndWhatIsHeardInOnePlace) {
  EXPECT_EQ(TargetScore{}.value(), 0);
  EXPECT_EQ((TargetScore{1, 1, 0}.value()), 0);
  EXPECT_LT((TargetScore{4, 2, 1}.value()), (TargetScore{8, 2, 1}.value()));
  EXPECT_LT((TargetScore{8, 2, 1}.value()), (TargetScore{8, 3, 1}.value()));
  EXPECT_LT((TargetScore{8, 3, 0.5}.value()), (TargetScore{8, 3, 1}.value()));
  EXPECT_LT((TargetScore{1'000'000, 1'000'000, 1}.value()), 1);
  // by hand: three echoes, of which two in a cell that two scans heard
  SphericalGrid grid;
  const Vector3d p(10, 0.2, 0.2), q(10.6, 0.2, 0.2);
  grid.begin_scan();
  grid.add_echo(p, 0.1, Time{});
  grid.begin_scan();
  grid.add_echo(p, 0.1, Time{});
  grid.add_echo(q, 0.1, Time{});
  SphericalCluster cluster;
  cluster.cells = {*grid.place_at(p), *grid.place_at(q)};
  const TargetScore score = target_score(grid, cluster);
  EXPECT_EQ(score.echoes, 3u);
  EXPECT_EQ(score.scans, 2u);
  EXPECT_NEAR(score.stationary, 2.0 / 3, 1e-12);
  EXPECT_NEAR(score.value(), 0.5 * 0.5 * 2 / 3, 1e-12);
}

}  // namespace
}  // namespace isobath
