#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/map/occupancy/obstacle_memory.hpp>
#include <isobath/perception/grid_mapper.hpp>
#include <isobath/perception/obstacle_detector.hpp>
#include <sstream>
#include <tests/support/data.hpp>

namespace isobath::obstacle_detector_test {
namespace {

using Eigen::Vector2d;

BodyGridConfig plane(int cells, double cell_m) {
  BodyGridConfig c;
  c.cells_x = c.cells_y = cells;
  c.cell_m = cell_m;
  return c;
}

Detection detect(const BodyGrid& grid) { return ObstacleDetector().detect(grid, {}, {}); }

// Occupies all cells whose centre, in the level body frame, satisfies a condition; frees the others.
template <class Condition>
void fill(BodyGrid& grid, Condition condition) {
  for (std::size_t i = 0; i < grid.cells().size(); ++i) {
    const Cell c = grid.cells().cell(i);
    grid.set_probability(c, condition(grid.to_level_body(grid.cells().centre(c))) ? 0.95 : 0.001);
  }
}

int detected(const Detection& d) { return static_cast<int>(std::count(d.detected.begin(), d.detected.end(), 1)); }

// ledger: S6-28 S6-E19
TEST(ObstacleDetector, SumsTheNeighbourhoodAndCountsTheThresholdIn) {
  BodyGridConfig c = plane(9, 1);
  c.prior = 1e-4;
  c.p_min = 1e-5;
  BodyGrid grid(c);
  for (double& l : grid.log_odds()) l = -60;  // nothing else in the sum
  EXPECT_TRUE(detect(grid).obstacles.empty());
  grid.log_odds()[grid.cells().index({4, 4})] = log_odds_of(0.8);
  EXPECT_EQ(detected(detect(grid)), 9);
  grid.log_odds()[grid.cells().index({4, 4})] = log_odds_of(0.8 - 1e-6);
  EXPECT_EQ(detected(detect(grid)), 0);
  grid.log_odds()[grid.cells().index({4, 4})] = log_odds_of(0.4);
  grid.log_odds()[grid.cells().index({4, 5})] = log_odds_of(0.4);
  EXPECT_EQ(detected(detect(grid)), 6) << "where both are in the block";
  EXPECT_EQ(detect(grid).obstacles.size(), 1u);
}

// ledger: S6-28 S6-24
TEST(ObstacleDetector, UnseenWaterIsNoObstacleAndTheBorderUsesWhatExists) {
  BodyGridConfig c = plane(20, 1);
  c.prior = 0.0888;
  BodyGrid grid(c);
  EXPECT_TRUE(detect(grid).obstacles.empty());
  BodyGrid low(plane(20, 1));
  low.set_probability({0, 0}, 0.95);
  const Detection d = detect(low);
  EXPECT_EQ(detected(d), 4);
  ASSERT_EQ(d.obstacles.size(), 1u);
  EXPECT_NEAR(area(d.obstacles[0].outline), 1, 1e-12);
}

// ledger: S6-29
TEST(ObstacleDetector, TheMapCarriesItsTimeAndPose) {
  BodyGrid grid(plane(10, 0.5));
  grid.move({0.1, 0}, Angle::degrees(30), Eigen::Matrix2d::Zero());
  const Pose pose{Rotation::from_heading(Angle::degrees(30)), {7, 8, 9}};
  const Detection d = ObstacleDetector().detect(grid, Time(seconds(5)), pose);
  EXPECT_EQ(d.time, Time(seconds(5)));
  EXPECT_EQ(d.X_WB.translation, pose.translation);
  EXPECT_EQ(d.detected.size(), 100u);
  EXPECT_NEAR(d.heading.degrees(), 30, 1e-12);
  EXPECT_TRUE(d.position.isApprox(grid.position()));
}

// What the memory of obstacles asks of a sweep: its outlines, and which water is free. ledger: S6-66
TEST(ObstacleDetector, SaysWhichWaterIsFreeForTheMemoryOfObstacles) {
  BodyGrid grid(plane(60, 1));
  grid.move({0, 0}, Angle::degrees(20), Eigen::Matrix2d::Zero());
  const Pose X_WL{Rotation::from_heading(Angle::degrees(-70)), {300, -200, 0}};
  ObstacleMemory memory;
  const auto look = [&](int second, bool rock) {
    for (double& l : grid.log_odds()) l = grid.log_odds_prior();
    fill(grid, [rock](const Vector2d& p) { return rock && (p - Vector2d(12, 5)).norm() < 2; });
    const Detection d = ObstacleDetector().detect(grid, Time(seconds(second)), X_WL);
    for (std::size_t i = 0; i < d.free.size(); ++i) EXPECT_EQ(d.free[i] != 0, grid.is_free(grid.cells().cell(i)));
    EXPECT_TRUE(memory.add({d.time, X_WL, 0.0, d.obstacles, {d.cells, d.position, d.heading, d.free}}));
  };
  for (int i = 0; i < 4; ++i) look(i, true);
  ASSERT_EQ(memory.size(), 1u);
  ASSERT_EQ(memory.known({300, -200}, 50).size(), 1u);
  EXPECT_TRUE(memory.known({300, -200}, 50)[0].whole);  // all of it is in view
  const Eigen::Vector3d rock_W = X_WL * Eigen::Vector3d(12, 5, 0);
  EXPECT_TRUE(contains(memory.known({300, -200}, 50)[0].outline_W, rock_W.head<2>()));
  look(4, false);
  ASSERT_EQ(memory.known({300, -200}, 50).size(), 1u);
  EXPECT_FALSE(memory.known({300, -200}, 50)[0].whole);
  for (int i = 5; i < 10; ++i) look(i, false);
  EXPECT_EQ(memory.size(), 0u);
}

TEST(ObstacleDetector, DescribesABoxInTheLevelBodyFrame) {
  BodyGrid grid(plane(200, 0.1));
  grid.move({0, 0}, Angle::degrees(-90), Eigen::Matrix2d::Zero());
  fill(grid, [](const Vector2d& p) { return std::abs(p.x() + 4) < 0.55 && std::abs(p.y() - 3) < 1.05; });
  const Detection d = detect(grid);
  ASSERT_EQ(d.obstacles.size(), 1u);
  const Obstacle& o = d.obstacles[0];
  EXPECT_NEAR(area(o.outline), 1.1 * 2.1, 1e-9);
  EXPECT_LT((o.nearest - Vector2d(-3.45, 1.95)).norm(), 1e-9);
  EXPECT_NEAR(o.range_m, std::hypot(3.45, 1.95), 1e-9);
  EXPECT_NEAR(o.bearing.degrees(), 180 - std::atan2(1.95, 3.45) * 180 / M_PI, 1e-6);
  EXPECT_LT((o.centre - Vector2d(-4, 3)).norm(), 1e-9);
  EXPECT_NEAR(o.covariance(0, 0), 1.1 * 1.1 / 12, 1e-9);
  EXPECT_NEAR(o.covariance(1, 1), 2.1 * 2.1 / 12, 1e-9);
  EXPECT_GT(o.existence, 0.99);
  EXPECT_LT(o.existence, 1 + 1e-15);
  EXPECT_FALSE(o.behind);
}

TEST(ObstacleDetector, AnOutlineHugsItsEvidence) {
  BodyGrid grid(plane(60, 1));
  grid.set_probability({40, 30}, 0.9);
  const Detection d = detect(grid);
  EXPECT_EQ(detected(d), 9);
  ASSERT_EQ(d.obstacles.size(), 1u);
  EXPECT_NEAR(area(d.obstacles[0].outline), 1, 1e-12) << "not the nine cells of the neighbourhood sum";
}

TEST(ObstacleDetector, FreeWaterInsideARingOrAnLIsNotSwallowed) {
  const auto ring = [](const Vector2d& p) { return std::abs(p.norm() - 4) < 0.15; };
  const auto corner = [](const Vector2d& p) {
    return (std::abs(p.x() - 5) < 0.2 && p.y() < 5.2 && p.y() > -4) ||
           (std::abs(p.y() - 5) < 0.2 && p.x() < 5.2 && p.x() > -4);
  };
  for (int shape = 0; shape < 2; ++shape) {
    BodyGrid grid(plane(140, 0.1));
    shape == 0 ? fill(grid, ring) : fill(grid, corner);
    const Detection d = detect(grid);
    for (std::size_t i = 0; i < grid.cells().size(); ++i) {
      const Cell c = grid.cells().cell(i);
      const Vector2d p = grid.to_level_body(grid.cells().centre(c));
      bool covered = false;
      for (const Obstacle& o : d.obstacles) covered = covered || contains(o.outline, p);
      EXPECT_TRUE(covered || grid.probability(c) < 0.5) << p.transpose();
      if (!covered) continue;
      double nearest = 9;
      for (int x = std::max(0, c.x - 3); x <= std::min(139, c.x + 3); ++x) {
        for (int y = std::max(0, c.y - 3); y <= std::min(139, c.y + 3); ++y) {
          if (grid.probability({x, y}) > 0.5)
            nearest = std::min<double>(nearest, std::max(std::abs(x - c.x), std::abs(y - c.y)));
        }
      }
      EXPECT_LE(nearest, 1) << p.transpose();
    }
    EXPECT_LT(d.obstacles.size(), 40u);
    EXPECT_NEAR(d.obstacles.front().range_m, shape == 0 ? 3.85 : 4.8, 0.1);
  }
}

// A ring and a square beyond it, each of many or of one convex piece.
TEST(ObstacleDetector, NumbersConnectedPiecesAsOneObstacleTheNearestFirst) {
  BodyGrid grid(plane(200, 0.1));
  fill(grid, [](const Vector2d& p) {
    return std::abs(p.norm() - 4) < 0.15 || (std::abs(p.x() - 8) < 0.3 && std::abs(p.y()) < 0.3);
  });
  const Detection d = detect(grid);
  ASSERT_GT(d.obstacles.size(), 3u);
  for (const Obstacle& o : d.obstacles) EXPECT_EQ(o.number, o.range_m < 6 ? 1 : 2) << o.range_m;
  EXPECT_EQ(d.obstacles.back().number, 2);
}

TEST(ObstacleDetector, KnowsWhatHidesBehindANearerObstacleAndWhatMayBeAMultiple) {
  BodyGrid grid(plane(200, 0.1));
  fill(grid, [](const Vector2d& p) {
    const bool wall = std::abs(p.x() - 3) < 0.1 && std::abs(p.y()) < 2;
    const bool second = std::abs(p.x() - 6) < 0.1 && std::abs(p.y()) < 2;
    const bool beside = std::abs(p.x() - 5) < 0.3 && std::abs(p.y() + 6) < 0.3;
    return wall || second || beside;
  });
  const Detection d = detect(grid);
  ASSERT_EQ(d.obstacles.size(), 3u);
  EXPECT_FALSE(d.obstacles[0].behind);
  EXPECT_FALSE(d.obstacles[0].possible_multiple);
  EXPECT_TRUE(d.obstacles[1].behind);
  EXPECT_TRUE(d.obstacles[1].possible_multiple);
  EXPECT_FALSE(d.obstacles[2].behind) << "in the open, to port";
  EXPECT_FALSE(d.obstacles[2].possible_multiple);
}

TEST(ObstacleDetector, GivesTheSameAnswerTwice) {
  BodyGrid grid(plane(80, 0.5));
  Random random(21);
  for (double& l : grid.log_odds()) l = random.normal() * 3 - 4;
  const Detection a = detect(grid);
  ObstacleDetector used;
  (void)used.detect(BodyGrid(plane(30, 1)), {}, {});
  const Detection b = used.detect(grid, {}, {});
  ASSERT_GT(a.obstacles.size(), 10u);
  ASSERT_EQ(a.obstacles.size(), b.obstacles.size());
  for (std::size_t i = 0; i < a.obstacles.size(); ++i) {
    EXPECT_EQ(a.obstacles[i].outline, b.obstacles[i].outline);
    EXPECT_EQ(a.obstacles[i].behind, b.obstacles[i].behind);
  }
}

// ledger: S6-29 S6-28
TEST(ObstacleDetector, FindsTheWallsOfARealTank) {
  ISOBATH_NEEDS_DATA(folder, "msis-tank");
  std::ifstream file(folder / "msis-tank-rev00-20.csv");
  std::string line;
  std::getline(file, line);
  auto fan = std::make_shared<BeamFan>();
  fan->azimuth = {Angle{}};
  fan->width = {Angle::degrees(3)};
  Ping ping;
  ping.fan = fan;
  EchoDecisions decisions;
  GridMapper mapper(plane(220, 0.05), {});
  for (int n = 0; n < 1100 && std::getline(file, line); ++n) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream in(line);
    double t = 0;
    double bearing = 0;
    in >> t >> bearing >> ping.window.bin_m >> ping.window.bins;
    ping.time = Time(seconds(t));
    ping.X_BS.rotation = Rotation::from_heading(Angle::degrees(bearing));
    decisions.reset(1, ping.window.bins);
    std::vector<int> value(static_cast<std::size_t>(ping.window.bins));
    for (int& v : value) in >> v;
    for (int k = 0; k < ping.window.bins; ++k) {
      if (k < 45) decisions.set_unusable(k);  // ring-down
      // The walls have a broad foot: an echo is what comes near the largest within 0.2 m.
      const auto first = value.begin() + std::max(0, k - 16);
      const int largest = *std::max_element(first, value.begin() + std::min(k + 17, ping.window.bins));
      if (value[k] >= 80 && value[k] >= 0.8 * largest) decisions.set_hit(0, k);
    }
    std::ranges::fill(decisions.p_detect, 0.8f);
    mapper.update(ping, decisions, {});
  }
  const Detection d = ObstacleDetector().detect(mapper.grid(), {}, {});
  const auto range_at = [&](double bearing_deg) {
    double best = 99;
    const Vector2d u(std::cos(bearing_deg * M_PI / 180), std::sin(bearing_deg * M_PI / 180));
    for (const Obstacle& o : d.obstacles) {
      const auto hit = ray_hit(o.outline, Vector2d::Zero(), u);
      if (hit && *hit > 0.6) best = std::min(best, *hit);
    }
    return best;
  };
  EXPECT_NEAR(range_at(0), 2.12, 0.10);
  EXPECT_NEAR(range_at(90), 1.79, 0.10);
  EXPECT_NEAR(range_at(180), 2.31, 0.10);
  // Second returns: behind the wall, at about twice its range.
  for (const auto& [bearing, range] : {std::pair(90.0, 3.51), std::pair(180.0, 4.56)}) {
    const Vector2d there = range * Vector2d(std::cos(bearing * M_PI / 180), std::sin(bearing * M_PI / 180));
    bool marked = false;
    for (const Obstacle& o : d.obstacles) {
      if ((nearest_point(o.outline, there) - there).norm() < 0.1) marked = marked || (o.behind && o.possible_multiple);
    }
    EXPECT_TRUE(marked) << bearing;
  }
}

}  // namespace
}  // namespace isobath::obstacle_detector_test
