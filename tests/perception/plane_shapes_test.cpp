// Runs, lines, arcs and corners of level scans: plain geometry, brute force, and statistics over many draws.
#include <algorithm>
#include <cmath>
#include <Eigen/LU>
#include <gmock/gmock.h>
#include <isobath/perception/scan_shapes.hpp>
#include <numeric>
#include <tests/support/plane_rays.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using test::PlanRoom, test::plan_scan;

std::vector<std::size_t> all_of(const PlaneScan& scan) {
  std::vector<std::size_t> all(scan.echoes.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}
double degrees_between(Angle a, Angle b) { return std::abs((a - b).wrapped().degrees()); }

// ledger: S4-43
TEST(RangeRuns, ACylinderHasOneRunAboutItsBearingAndAPlaneOneAboutItsNormal) {
  Random random(1);
  for (const double bearing : {0.0, 90.0, 212.5, 359.0}) {
    const Vector2d from(3, -2), u = plan_direction(Angle::degrees(bearing));
    const PlanRoom cylinder{{}, {{from + 14 * u, 3}}};
    const auto round = constant_range_runs(plan_scan(cylinder, from, random, 0));
    ASSERT_EQ(round.size(), 1u) << bearing;
    EXPECT_LT(degrees_between(round[0].middle(), Angle::degrees(bearing)), 1.3) << bearing;
    EXPECT_NEAR(round[0].range_m, 11, 0.4);
    const Vector2d across(-u.y(), u.x());
    const PlanRoom wall{{{from + 10 * u - 60 * across, from + 10 * u + 60 * across}}, {}};
    const auto flat = constant_range_runs(plan_scan(wall, from, random, 0));
    ASSERT_EQ(flat.size(), 1u) << bearing;
    EXPECT_LT(degrees_between(flat[0].middle(), Angle::degrees(bearing)), 1.3) << bearing;
    // d R / d alpha = R tan(alpha) passes 0.3 m in 2.5 degrees at 31 degrees, and a beam's half is nearer
    EXPECT_NEAR((flat[0].end - flat[0].begin).degrees(), 2 * 31, 5) << bearing;
  }
}

// ledger: S4-43
TEST(RangeRuns, PartTwoBodiesAndAreAllThatThereAre) {
  Random random(2);
  const PlanRoom two{{}, {{{12, 0}, 2}, {{14, 8}, 2}}};
  EXPECT_EQ(constant_range_runs(plan_scan(two, {0, 0}, random, 0)).size(), 2u);
  for (int draw = 0; draw < 50; ++draw) {  // against all pairs of ends
    PlaneScan scan;
    for (int i = 0; i < 60; ++i) {
      const double bearing = random.uniform(0, 360);
      const double range = random.uniform(10, 10.8);
      scan.echoes.emplace_back(Angle::degrees(bearing), range);
    }
    scan.sort();
    const std::size_t n = scan.echoes.size();
    const auto linked = [&](std::size_t i) {
      const PlaneEcho &a = scan.echoes[i % n], &b = scan.echoes[(i + 1) % n];
      return std::abs(a.range_m - b.range_m) <= 0.3 && (b.bearing - a.bearing).wrapped_positive().degrees() <= 5;
    };
    std::size_t expected = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (linked(i + n - 1) || !linked(i)) continue;  // begins here
      std::size_t last = i;
      while (linked(last)) ++last;
      const Angle wide = (scan.echoes[last % n].bearing - scan.echoes[i].bearing).wrapped_positive();
      if (wide < Angle::degrees(2.5)) continue;
      ++expected;
      const auto runs = constant_range_runs(scan);
      EXPECT_TRUE(std::any_of(runs.begin(), runs.end(), [&](const RangeRun& r) {
        return r.first == i && r.count == last - i + 1;
      })) << draw;
    }
    EXPECT_EQ(constant_range_runs(scan).size(), expected) << draw;
  }
}

/// Squared errors over their variances, which are 1 on average where the variances are true.
struct Honesty {
  double sum = 0;
  int n = 0, beyond = 0;
  void add(double error, double variance) {
    sum += error * error / variance;
    beyond += error * error > 9 * variance ? 1 : 0;
    ++n;
  }
};

// ledger: S4-45
TEST(PlaneFits, ALineIsWithinThreeOfItsStandardDeviations) {
  Random random(3);
  Honesty bearing, place;
  for (int draw = 0; draw < 400; ++draw) {
    const double slant = random.uniform(-60, 60);
    const double distance = random.uniform(4, 15);
    const Vector2d n = plan_direction(Angle::degrees(180 + slant)), along(-n.y(), n.x());
    const Vector2d foot = -distance * n;
    const double begin = random.uniform(-12, 8);
    const PlanRoom wall{{{foot + begin * along, foot + (begin + 8) * along}}, {}};
    const PlaneScan scan = plan_scan(wall, {0, 0}, random);
    if (scan.echoes.size() < 6) continue;
    const auto line = fit_line(scan, all_of(scan));
    ASSERT_TRUE(line);
    EXPECT_EQ(line->support, static_cast<int>(scan.echoes.size()));
    EXPECT_GT(line->height_of({0, 0}), 0);
    bearing.add((plan_bearing(line->normal) - plan_bearing(n)).wrapped().radians(), line->bearing_variance());
    place.add(n.dot(line->centre - foot), 1 / line->weight);
  }
  EXPECT_GT(bearing.n, 350);
  for (const Honesty& honesty : {bearing, place}) {
    EXPECT_NEAR(honesty.sum / honesty.n, 1, 0.25);
    EXPECT_LT(honesty.beyond, 0.01 * honesty.n);
  }
}

// ledger: S4-45
TEST(PlaneFits, AnArcIsWithinThreeOfItsStandardDeviationsFromOutsideAndInside) {
  for (const bool inside : {false, true}) {
    Random random(4);
    Honesty radius, centre;
    for (int draw = 0; draw < 300; ++draw) {
      const double r = inside ? random.uniform(8, 12) : random.uniform(2, 4);
      const double away = inside ? random.uniform(0, 5) : random.uniform(7, 12);
      const Vector2d c = away * plan_direction(Angle::degrees(random.uniform(0, 360)));
      PlaneScan scan = plan_scan({{}, {{c, r}}}, {0, 0}, random);
      if (inside) scan.echoes.erase(scan.echoes.begin() + 60, scan.echoes.end());  // less than half of it
      const auto arc = fit_arc(scan, all_of(scan));
      ASSERT_TRUE(arc) << draw;
      EXPECT_EQ(arc->hollow, inside);
      radius.add(arc->radius - r, arc->covariance(2, 2));
      const Vector2d u = c.normalized();
      centre.add(u.dot(arc->centre - c), u.dot(arc->covariance.topLeftCorner<2, 2>() * u));
    }
    for (const Honesty& honesty : {radius, centre}) {
      EXPECT_NEAR(honesty.sum / honesty.n, 1, 0.3) << inside;
      EXPECT_LT(honesty.beyond, 0.02 * honesty.n) << inside;
    }
  }
}

// ledger: S4-45
TEST(PlaneFits, TwoScansOfOneEdgeMergeToTheFitOfAllTheirEchoes) {
  Random random(5);
  const PlanRoom wall{{{{10, -15}, {10, 15}}}, {}};
  PlaneScan scan = plan_scan(wall, {0, 0}, random);
  scan.beam_width =
      BeamWidth(Angle{});  // points are where they are told, whatever the line: so that the sums can be compared
  std::vector<std::size_t> low, high;
  for (std::size_t i = 0; i < scan.echoes.size(); ++i) (scan.point(scan.echoes[i]).y() < 0 ? low : high).push_back(i);
  const PlaneLine both = merged(*fit_line(scan, low), *fit_line(scan, high));
  const PlaneLine all = *fit_line(scan, all_of(scan));
  EXPECT_EQ(both.support, all.support);
  EXPECT_LT(degrees_between(plan_bearing(both.normal), plan_bearing(all.normal)), 0.1);
  EXPECT_NEAR(all.height_of(both.centre), 0, 0.01);
  EXPECT_NEAR(both.weight / all.weight, 1, 0.03) << "weights follow the bearing of the line, which the parts have not";
  EXPECT_NEAR(both.spread / all.spread, 1, 0.03);
  EXPECT_NEAR(both.length(), all.length(), 0.05);
}

PlanRoom room_with_things() {
  PlanRoom room;
  room.segments = {{{-22, -20}, {20, -20}}, {{20, -20}, {20, 22}}, {{20, 22}, {-22, 22}}, {{-22, 22}, {-22, -20}},
                   {{-6, 2}, {0, 4}},       {{0, 4}, {-2, 10}},    {{-2, 10}, {-8, 8}},   {{-8, 8}, {-6, 2}}};
  room.circles = {{{12, -10}, 3}};
  return room;
}

// ledger: S4-45 S4-47
TEST(ScanShapes, TellARoomAsItsWallsABodyAndATankAndTheirCountsAddUp) {
  ISOBATH_NOT_SANITIZED();
  int walls = 0, tanks = 0, corners = 0, scans = 0, unassigned = 0, echoes = 0, invented = 0;
  const PlanRoom room = room_with_things();
  const auto off_walls = [&](const Vector2d& p) {
    double least = 1e9;
    for (const auto& s : room.segments) {
      const Vector2d v = s.b - s.a;
      const double t = std::clamp((p - s.a).dot(v) / v.squaredNorm(), 0.0, 1.0);
      least = std::min(least, (s.a + t * v - p).norm());
    }
    return least;
  };
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Random random(seed);
    const PlaneScan scan = plan_scan(room, {5, -2}, random);
    const ScanShapes told = shapes_of(scan);
    std::vector<int> owners(scan.echoes.size(), 0);
    for (const ScanShape& shape : told.shapes) {
      const int support = shape.line() ? shape.line()->support : shape.arc()->support;
      EXPECT_EQ(support, static_cast<int>(shape.echoes.size()));
      for (const std::size_t i : shape.echoes) ++owners[i];
      if (const PlaneLine* line = shape.line()) {
        ++walls;
        const double worst = std::max(off_walls(line->at(line->begin_m)), off_walls(line->at(line->end_m)));
        invented += worst > 1.5 ? 1 : 0;
      } else {
        const PlaneArc& arc = *shape.arc();
        tanks += (arc.centre - Vector2d(12, -10)).norm() < 1.2 && std::abs(arc.radius - 3) < 1.2 ? 1 : 0;
      }
    }
    for (const std::size_t i : told.unassigned) ++owners[i];
    EXPECT_THAT(owners, testing::Each(1)) << "every echo is of one shape or of none";
    for (const ScanCorner& corner : told.corners) {
      if (corner.convex && (corner.at - Vector2d(0, 4)).norm() < 0.6) ++corners;
    }
    unassigned += static_cast<int>(told.unassigned.size());
    echoes += static_cast<int>(scan.echoes.size());
    ++scans;
  }
  EXPECT_EQ(tanks, scans);
  EXPECT_GE(walls, 6 * scans) << "four walls and two faces";
  EXPECT_LE(walls, 8 * scans);
  EXPECT_GE(corners, scans - 1) << "of the body, where its two faces meet";
  EXPECT_LE(invented, 1);
  EXPECT_LT(unassigned, 0.03 * echoes);
}

// ledger: S4-45
TEST(ScanShapes, HaveNoneForEchoesAtRandom) {
  Random random(7);
  PlaneScan scan;
  for (int i = 0; i < 100; ++i) {
    const double range = random.uniform(2, 30);
    scan.echoes.emplace_back(Angle::degrees(3.6 * i), range);
  }
  scan.sort();
  const ScanShapes told = shapes_of(scan);
  EXPECT_GT(told.unassigned.size(), 90u);
  EXPECT_TRUE(told.corners.empty());
  EXPECT_TRUE(shapes_of(PlaneScan{}).shapes.empty());
}

/// A right angle at the origin, its tip towards the sonar but for a turn; mean errors over many draws.
struct CornerErrors {
  double by_edges = 0, by_nearest = 0, by_all_alike = 0, normalised = 0;
  int n = 0;
};
CornerErrors corner_errors(double min_turn, double max_turn, double range) {
  CornerErrors errors;
  for (std::uint64_t seed = 1; seed <= 80; ++seed) {
    Random random(seed);
    const double turn = random.uniform(min_turn, max_turn);
    const Vector2d a = plan_direction(Angle::degrees(135 + turn)), b = plan_direction(Angle::degrees(225 + turn));
    const PlanRoom body{{{{0, 0}, 8 * a}, {{0, 0}, 8 * b}}, {}};
    const PlaneScan scan = plan_scan(body, {range, 0}, random);
    const ScanShapes told = shapes_of(scan);
    if (told.corners.size() != 1) continue;
    const ScanCorner& found = told.corners[0];
    EXPECT_TRUE(found.convex);
    const auto nearest = std::min_element(scan.echoes.begin(), scan.echoes.end(),
                                          [](const auto& p, const auto& q) { return p.range_m < q.range_m; });
    ++errors.n;
    errors.by_edges += found.at.norm();
    errors.by_nearest += scan.point(*nearest).norm();
    errors.by_all_alike += corner_of(*told.shapes[found.first].line(), *told.shapes[found.second].line())->at.norm();
    errors.normalised += found.at.dot(found.covariance.inverse() * found.at);
  }
  return errors;
}

// ledger: S4-47
TEST(ScanShapes, FindACornerWhereItsEdgesMeetNearerToTheTruthThanItsNearestEcho) {
  ISOBATH_NOT_SANITIZED();
  const CornerErrors facing = corner_errors(-25, 25, 9), aslant = corner_errors(28, 36, 9),
                     far = corner_errors(-25, 25, 18);
  for (const CornerErrors& errors : {facing, aslant, far}) {
    ASSERT_GT(errors.n, 30);
    EXPECT_LT(errors.by_edges, 0.85 * errors.by_nearest);
  }
  EXPECT_LT(aslant.by_edges, 0.95 * aslant.by_all_alike) << "echoes near the corner count less";
  EXPECT_LT(facing.by_edges, 1.1 * facing.by_all_alike) << "which costs little where there was nothing to mend";
  EXPECT_LT(far.by_edges, 1.1 * far.by_all_alike);
  // two degrees of freedom: covariances are honest, those of what is seen aslant too small by half
  EXPECT_NEAR(facing.normalised / facing.n, 2, 0.7);
  EXPECT_NEAR(far.normalised / far.n, 2, 0.7);
  EXPECT_NEAR(aslant.normalised / aslant.n, 2, 3);
}

// ledger: S4-47
TEST(ScanShapes, CountAnEchoTheLessTheNearerItsBeamIsToTheCorner) {
  Random random(9);
  const PlanRoom wall{{{{10, -10}, {10, 10}}}, {}};
  const PlaneScan scan = plan_scan(wall, {0, 0}, random, 0);
  const auto all = all_of(scan);
  const PlaneLine line = *fit_line(scan, all);
  const auto factors = factors_near(scan, all, line, {10, 3});
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double off = std::abs(scan.point(scan.echoes[i]).y() - 3);
    const double sigma = scan.echoes[i].range_m * scan.sigma.radians() / std::cos(std::atan2(3, 10));
    EXPECT_NEAR(factors[i], std::min(1.0, off / sigma), off < 2 ? 0.1 + 0.2 / sigma * 0.25 : 1e-9) << off;
  }
}

}  // namespace
}  // namespace isobath
