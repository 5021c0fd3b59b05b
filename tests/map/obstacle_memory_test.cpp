// Obstacle memory against a small sea where truth is known: round rocks, a sonar that sees all within its range, and
// navigation that drifts.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/map/occupancy/obstacle_memory.hpp>
#include <isobath/map/occupancy/obstacle_outline.hpp>
#include <limits>
#include <set>
#include <tests/support/sanitized.hpp>
#include <vector>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kRange = 30;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Pose at(const Vector2d& p, double heading_deg = 0) {
  return {Rotation::from_heading(Angle::degrees(heading_deg)), {p.x(), p.y(), 0}};
}

Time t(double s) { return Time(seconds(s)); }

struct Rock {
  Vector2d centre;
  double radius = 1.5;
};

Polygon outline_of(const Rock& rock) {
  std::vector<Vector2d> corners;
  for (int i = 0; i < 8; ++i) {
    const double a = i * std::numbers::pi / 4;
    corners.emplace_back(rock.centre + rock.radius * Vector2d(std::cos(a), std::sin(a)));
  }
  return convex_hull(corners);
}

Obstacle obstacle_of(const Polygon& outline_L) {
  Obstacle o;
  o.outline = outline_L;
  o.existence = 0.97;
  return o;
}

Polygon box(double x, double y, double half_x, double half_y) {
  return {{x - half_x, y - half_y}, {x + half_x, y - half_y}, {x + half_x, y + half_y}, {x - half_x, y + half_y}};
}

/// One look from a true pose, noted at the pose that navigation believes in.
struct Look {
  std::vector<Obstacle> obstacles;
  std::vector<std::uint8_t> free;
  MemorySweep sweep;
  Look() = default;
  Look(const Look&) = delete;
  Look& operator=(const Look&) = delete;
};

constexpr CartesianGrid kCells{70, 70, 1};

// Outlines in L; everything else within the range is free, but for a rim of a metre about an outline.
void fill(Look& look, const std::vector<Polygon>& outlines_L, const Pose& X_WL, double now,
          const std::optional<double>& sigma, double range = kRange) {
  look.obstacles.clear();
  for (const Polygon& o : outlines_L) look.obstacles.push_back(obstacle_of(o));
  const Angle heading = Angle::degrees(25);  // of L in the grid
  const Vector2d position(35.3, 34.8);
  look.free.assign(kCells.size(), 0);
  for (std::size_t i = 0; i < kCells.size(); ++i) {
    const Vector2d d = kCells.centre(kCells.cell(i)) - position;
    const Vector2d p_L(cos(heading) * d.x() + sin(heading) * d.y(), cos(heading) * d.y() - sin(heading) * d.x());
    const bool clear = std::none_of(outlines_L.begin(), outlines_L.end(),
                                    [&](const Polygon& o) { return (nearest_point(o, p_L) - p_L).norm() < 1; });
    look.free[i] = clear && p_L.norm() <= range;
  }
  look.sweep = {t(now), X_WL, sigma, look.obstacles, {kCells, position, heading, look.free}, Vector2d::Zero()};
}

void fill(Look& look, const std::vector<Rock>& rocks, const Pose& X_TL, const Pose& X_WL, double now,
          const std::optional<double>& sigma) {
  std::vector<Polygon> seen;
  for (const Rock& r : rocks) {
    const Eigen::Vector3d p_L = X_TL.inverse() * Eigen::Vector3d(r.centre.x(), r.centre.y(), 0);
    if (p_L.head<2>().norm() < kRange - r.radius) seen.push_back(outline_of({p_L.head<2>(), r.radius}));
  }
  fill(look, seen, X_WL, now, sigma);
}

/// The known obstacles that the last sweep did not show whole.
std::vector<RememberedObstacle> not_in_view(const ObstacleMemory& memory, const Vector2d& north_east, double radius) {
  std::vector<RememberedObstacle> known = memory.known(north_east, radius);
  std::erase_if(known, [](const RememberedObstacle& o) { return o.whole; });
  return known;
}

std::vector<RememberedObstacle> all_known(const ObstacleMemory& memory) {
  return memory.known({0, 0}, std::numeric_limits<double>::infinity());
}

/// Every obstacle that is stored is known.
ObstacleMemoryConfig confirmed_at_once() {
  ObstacleMemoryConfig config;
  config.confirmations = 1;
  return config;
}

double reach_beyond(const RememberedObstacle& o, const Vector2d& p) {
  return (nearest_point(o.outline_W, p) - p).norm();
}

void see(ObstacleMemory& memory, const std::vector<Polygon>& outlines_L, const Pose& X_WL, double now,
         const std::optional<double>& sigma = 0.0, double range = kRange) {
  Look look;
  fill(look, outlines_L, X_WL, now, sigma, range);
  ASSERT_TRUE(memory.add(look.sweep));
}

// Lanes of 200 m, 25 m apart, over forty rocks; dead reckoning drifts as a random walk, of which navigation knows the
// variance. Whatever rock was seen twice must stay blocked wherever the vehicle then believes to be, until it is seen
// again; and drift must not multiply rocks. ledger: S6-66 S6-F04
TEST(ObstacleMemory, LosesNoRockBetweenLanesInSpiteOfDrift) {
  ISOBATH_NOT_SANITIZED();
  int checked = 0, covered = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    std::vector<Rock> rocks;
    while (rocks.size() < 40) {
      const double x = random.uniform(0, 200);
      const double y = random.uniform(0, 150);
      const double radius = random.uniform(0.8, 3);
      const bool apart = std::all_of(rocks.begin(), rocks.end(),
                                     [&](const Rock& r) { return (r.centre - Vector2d(x, y)).norm() > 14; });
      if (apart) rocks.push_back({{x, y}, radius});
    }
    ObstacleMemoryConfig config;
    config.confidence = 3;
    ObstacleMemory memory(config);
    std::vector<int> sightings(rocks.size());
    Vector2d drift = Vector2d::Zero();
    double variance = 0, now = 0;
    for (int lane = 0; lane < 6; ++lane) {
      for (int i = 0; i <= 50; ++i, now += 2.7) {
        const double x = 4.0 * i, y = 12.5 + 25.0 * lane;
        const Pose X_TL = at({lane % 2 == 0 ? x : 200 - x, y}, lane % 2 == 0 ? 0 : 180);
        const double dx = random.normal();
        const double dy = random.normal();
        drift += 0.15 * Vector2d(dx, dy);
        variance += 0.15 * 0.15;
        Pose X_WL = X_TL;
        X_WL.translation.head<2>() += drift;
        Look look;
        fill(look, rocks, X_TL, X_WL, now, std::sqrt(variance));
        ASSERT_TRUE(memory.add(look.sweep));

        const auto remembered = not_in_view(memory, X_WL.translation.head<2>(), 1000);
        for (std::size_t r = 0; r < rocks.size(); ++r) {
          const bool in_view = (rocks[r].centre - X_TL.translation.head<2>()).norm() < kRange - rocks[r].radius;
          sightings[r] += in_view;
          if (in_view || sightings[r] < 2) continue;
          ++checked;
          covered += std::any_of(remembered.begin(), remembered.end(), [&](const RememberedObstacle& o) {
            return reach_beyond(o, rocks[r].centre + drift) <= o.margin_m;
          });
        }
      }
    }
    const auto known = std::count_if(sightings.begin(), sightings.end(), [](int n) { return n > 0; });
    EXPECT_EQ(static_cast<long>(memory.size()), known) << seed;
  }
  EXPECT_GT(checked, 5000);
  EXPECT_GE(covered, 0.995 * checked);  // three standard deviations, in two dimensions: 0.989
}

// ledger: S6-66
TEST(ObstacleMemory, MarginGrowsWithTheVarianceSinceItWasSeen) {
  ObstacleMemoryConfig config;
  config.confidence = 2;
  config.detection_sigma = 0.5;
  ObstacleMemory memory(config);
  const std::vector<Polygon> rock = {box(10, 0, 1, 1)};
  see(memory, rock, at({0, 0}), 0, 1.0);
  see(memory, rock, at({0, 0}), 1, 1.0);
  EXPECT_TRUE(not_in_view(memory, {0, 0}, 100).empty());  // in view: the sweep itself shows it
  const auto margin = [&](double now, double sigma) {
    see(memory, {}, at({500, 0}), now, sigma);
    return not_in_view(memory, {0, 0}, 100).at(0).margin_m;
  };
  EXPECT_NEAR(margin(2, 1.0), 2 * 0.5, 1e-12);
  EXPECT_NEAR(margin(3, 1.5), 2 * std::sqrt(1.5 * 1.5 - 1 + 0.25), 1e-12);
  EXPECT_NEAR(margin(4, 2.0), 2 * std::sqrt(2.0 * 2.0 - 1 + 0.25), 1e-12);
  // A fix moves the estimate by what it takes away; but the errors of then and now bound the rest.
  EXPECT_NEAR(margin(5, 0.1), 2 * std::sqrt(1 + 0.01 + 0.25), 1e-12);
}

// ledger: S6-66
TEST(ObstacleMemory, MarginGrowsWithTheWayWhereNavigationStatesNoVariance) {
  ObstacleMemoryConfig config;
  config.drift_share = 0.02;
  ObstacleMemory memory(config);
  const std::vector<Polygon> rock = {box(10, 0, 1, 1)};
  see(memory, rock, at({0, 0}), 0, {});
  see(memory, rock, at({0, 0}), 1, {});
  for (int i = 1; i <= 20; ++i) see(memory, {}, at({10.0 * i, 0}), 1 + i, {});
  EXPECT_NEAR(not_in_view(memory, {0, 0}, 100).at(0).margin_m, 2 * std::sqrt(4 * 4 + 0.25), 1e-9);
  // In order of its way it is forgotten once the margin would block too much: 15 m / 2 = 7.5 m after 375 m.
  for (int i = 21; i <= 37; ++i) see(memory, {}, at({10.0 * i, 0}), 1 + i, {});
  EXPECT_EQ(memory.size(), 1u);
  for (int i = 38; i <= 39; ++i) see(memory, {}, at({10.0 * i, 0}), 1 + i, {});
  EXPECT_EQ(memory.size(), 0u);
}

// ledger: S6-66
TEST(ObstacleMemory, ForgetsByAge) {
  ObstacleMemoryConfig config;
  config.max_age = 100;
  ObstacleMemory memory(config);
  const std::vector<Polygon> rock = {box(10, 0, 1, 1)};
  see(memory, rock, at({0, 0}), 0);
  see(memory, rock, at({0, 0}), 1);
  see(memory, {}, at({500, 0}), 101);
  EXPECT_EQ(memory.size(), 1u);
  see(memory, {}, at({500, 0}), 101.1);
  EXPECT_EQ(memory.size(), 0u);
}

// Something that was taken away: the water where it stood is seen to be free, several times. What lies out of view, or
// in water that the sweep says nothing about, stays. ledger: S6-66
TEST(ObstacleMemory, LetsGoWhereTheWaterIsSeenToBeFree) {
  ObstacleMemory memory;
  const std::vector<Polygon> rock = {box(10, 0, 1, 1)};
  for (int i = 0; i < 5; ++i) see(memory, rock, at({0, 0}), i);
  for (int i = 5; i < 50; ++i) see(memory, {}, at({-100, 0}), i);
  ASSERT_EQ(memory.size(), 1u);
  for (int i = 50; i < 100; ++i) see(memory, {}, at({0, 0}), i, 0.0, 8);  // range 8 m: it would stand beyond
  ASSERT_EQ(not_in_view(memory, {0, 0}, 20).size(), 1u);
  see(memory, {}, at({0, 0}), 100);
  EXPECT_EQ(not_in_view(memory, {0, 0}, 20).size(), 1u);  // one look is not enough
  for (int i = 101; i < 106; ++i) see(memory, {}, at({0, 0}), i);
  EXPECT_EQ(memory.size(), 0u);
}

// Free water at the stored place says little where drift may have moved it: only all of the places together do.
// ledger: S6-66
TEST(ObstacleMemory, DoesNotLetGoOfWhatDriftMayHaveMovedOutOfView) {
  for (const bool all_in_view : {false, true}) {
    ObstacleMemory memory;
    const std::vector<Polygon> rock = {box(25, 0, 1, 1)};
    for (int i = 0; i < 5; ++i) see(memory, rock, at({0, 0}), i, 0.0);
    // Two sigma of 3 m: from x = 28 on it would stand outside a range of 29 m seen from the origin.
    for (int i = 5; i < 12; ++i) see(memory, {}, at({all_in_view ? 15.0 : 0.0, 0}), i, 3.0, 29);
    EXPECT_EQ(memory.size(), all_in_view ? 0u : 1u);
  }
}

// One that may move is not stored, and what was stored of it goes; its neighbour stays. ledger: S3-21
TEST(ObstacleMemory, KeepsNothingThatMayMove) {
  ObstacleMemory memory;
  Look look;
  for (int i = 0; i < 6; ++i) {
    fill(look, {box(10, 0, 1, 1), box(10, 8, 1, 1)}, at({0, 0}), i, 0.0);
    for (int k = 0; k < 2; ++k) {
      look.obstacles[k].number = k + 1;
      look.obstacles[k].centre = {10, 8.0 * k};
    }
    look.obstacles[0].may_move = i > 3;
    ASSERT_TRUE(memory.add(look.sweep));
    EXPECT_EQ(memory.size(), i > 3 ? 1u : 2u) << i;
  }
  EXPECT_EQ(all_known(memory)[0].number, 2);
  see(memory, {}, at({0, 0}), 6, 0.0, 5);
  EXPECT_EQ(memory.size(), 1u) << "out of view";
}

// Three rocks, 4 m of drift: the pattern tells which is which, though the nearest stored one of the first is another.
// Those seen take their new places; the one out of view keeps its own, and its margin. ledger: S6-66
TEST(ObstacleMemory, TakesDriftOffBeforeItAssociates) {
  const std::vector<Rock> rocks = {{{10, 0}, 1.2}, {{14.5, 0}, 1.2}, {{12, 9}, 1.2}, {{-28, 0}, 1.2}};
  ObstacleMemory memory;
  Look look;
  for (int i = 0; i < 3; ++i) {
    fill(look, rocks, at({0, 0}), at({0, 0}), i, 0.0);
    memory.add(look.sweep);
  }
  ASSERT_EQ(memory.size(), 4u);
  const auto before = all_known(memory);
  for (int i = 3; i < 10; ++i) see(memory, {}, at({300, 0}), i, 0.4 * i);
  const Vector2d drift(4, 0.5);
  fill(look, rocks, at({5, 0}), at(Vector2d(5, 0) + drift), 11, 4.0);
  memory.add(look.sweep);
  EXPECT_LT((memory.shift() - drift).norm(), 0.05);
  const auto after = all_known(memory);
  ASSERT_EQ(after.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(after[i].id, before[i].id);
    const Vector2d moved = after[i].outline_W.front() - before[i].outline_W.front();
    const bool seen = after[i].last_seen == t(11);
    EXPECT_EQ(seen, before[i].outline_W.front().x() > 0);
    if (seen) {
      EXPECT_LT((moved - drift).norm(), 0.1) << i;
    } else {
      EXPECT_EQ(moved, Vector2d::Zero());
    }
    EXPECT_NEAR(after[i].margin_m, seen ? 1.0 : 2 * std::sqrt(16 + 0.25), 0.01);
  }
}

// A fix between two sweeps moves the vehicle in W, and with it all that it sees: nothing is met as a stranger.
// ledger: S6-66
TEST(ObstacleMemory, FollowsAFixThatMovesTheEstimate) {
  const std::vector<Polygon> rocks = {box(10, 0, 1, 1), box(-6, 8, 1.5, 1)};
  ObstacleMemory memory;
  for (int i = 0; i < 3; ++i) see(memory, rocks, at({0, 0}), i, 3.0);
  for (int i = 3; i < 6; ++i) see(memory, rocks, at({4, -3}), i, 0.1);
  const auto all = all_known(memory);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].sightings, 6);
  EXPECT_LT((nearest_point(all[0].outline_W, {14, -3}) - Vector2d(14, -3)).norm(), 1e-9);
  EXPECT_NEAR(area(all[0].outline_W), 4, 0.5);
}

// A wall that leaves the view piece by piece is remembered as long as it was, and what is out of view is given to
// planning while the rest is seen. ledger: S6-66
TEST(ObstacleMemory, KeepsThePartOfAWallThatLeavesTheView) {
  ObstacleMemory memory;
  for (int i = 0; i <= 40; ++i) {
    const double x = i;  // along a wall from 0 to 60 at y = 10, of which 20 m either way are seen
    const double low = std::max(0.0, x - 20), high = std::min(60.0, x + 20);
    see(memory, {box((low + high) / 2 - x, 10, (high - low) / 2, 0.5)}, at({x, 0}), i, 0.0, 22);
  }
  const auto remembered = not_in_view(memory, {40, 0}, 100);
  for (double x = 0.5; x < 60; x += 1) {
    const bool seen_now = x > 20;
    const bool known = std::any_of(remembered.begin(), remembered.end(), [&](const RememberedObstacle& o) {
      return reach_beyond(o, {x, 10}) <= o.margin_m;
    });
    EXPECT_TRUE(known || seen_now) << x;
  }
  EXPECT_LE(memory.size(), 3u);
}

// A bay of three walls, cut differently by every sweep: the free water within must not be swallowed. ledger: S6-66
TEST(ObstacleMemory, DoesNotFillABay) {
  ISOBATH_NOT_SANITIZED();
  ObstacleMemory memory(confirmed_at_once());
  Random random(3);
  for (int i = 0; i < 60; ++i) {
    std::vector<Polygon> pieces;
    const auto wall = [&](double x0, double y0, double x1, double y1) {
      const double cut = random.uniform(0.2, 0.8);
      const double xm = x0 + cut * (x1 - x0), ym = y0 + cut * (y1 - y0);
      pieces.push_back(box((x0 + xm) / 2, (y0 + ym) / 2, (xm - x0) / 2 + 0.5, (ym - y0) / 2 + 0.5));
      pieces.push_back(box((xm + x1) / 2, (ym + y1) / 2, (x1 - xm) / 2 + 0.5, (y1 - ym) / 2 + 0.5));
    };
    wall(5, -8, 20, -8);
    wall(20, -8, 20, 8);
    wall(5, 8, 20, 8);
    see(memory, pieces, at({0, 0}), i);
  }
  const auto all = all_known(memory);
  for (double x = 0; x < 18; x += 0.5) {
    for (double y = -5.5; y < 6; y += 0.5) {
      for (const RememberedObstacle& o : all) EXPECT_FALSE(contains(o.outline_W, {x, y})) << x << ' ' << y;
    }
  }
  EXPECT_LE(memory.size(), 12u);
}

// What was taken for more than it is shrinks again, when all of it has been in view and the rest is free.
// ledger: S6-66
TEST(ObstacleMemory, ShrinksToWhatIsThere) {
  ObstacleMemory memory;
  for (int i = 0; i < 3; ++i) see(memory, {box(15, 0, 4, 1)}, at({0, 0}), i);
  for (int i = 3; i < 6; ++i) see(memory, {box(12, 0, 1, 1)}, at({0, 0}), i);
  EXPECT_NEAR(area(all_known(memory).at(0).outline_W), 16, 1e-9);
  for (int i = 6; i < 9; ++i) see(memory, {box(12, 0, 1, 1)}, at({0, 0}), i);
  ASSERT_EQ(memory.size(), 1u);
  EXPECT_NEAR(area(all_known(memory)[0].outline_W), 4, 1e-9);
}

// A false alarm in one sweep, a doubtful echo and a weak one are no obstacles to come. ledger: S6-66
TEST(ObstacleMemory, TakesInOnlyWhatWasConfirmed) {
  ObstacleMemory memory;
  Look look;
  fill(look, std::vector<Polygon>{box(10, 0, 1, 1), box(0, 10, 1, 1), box(-10, 0, 1, 1)}, at({0, 0}), 0, 0.0);
  look.obstacles[1].possible_multiple = true;
  look.obstacles[2].existence = 0.7;
  look.sweep.obstacles = look.obstacles;
  memory.add(look.sweep);
  EXPECT_EQ(memory.size(), 1u);
  see(memory, {}, at({500, 0}), 1);
  EXPECT_TRUE(not_in_view(memory, {0, 0}, 100).empty());
  see(memory, {}, at({500, 0}), 59);
  EXPECT_EQ(memory.size(), 1u);
  see(memory, {}, at({500, 0}), 61);
  EXPECT_EQ(memory.size(), 0u);
}

// ledger: S6-66
TEST(ObstacleMemory, TellsAsWhichObstacleItTookEachOfASweep) {
  ObstacleMemory memory(confirmed_at_once());
  const auto look = [&](double s, std::vector<Obstacle> seen) {
    MemorySweep sweep;
    sweep.time = t(s);
    sweep.X_WL = at({0, 0});
    sweep.obstacles = seen;
    ASSERT_TRUE(memory.add(sweep));
  };
  look(1, {obstacle_of(box(10, 0, 1, 1)), obstacle_of(box(30, 0, 1, 1))});
  ASSERT_EQ(memory.seen_as().size(), 2u);
  const std::uint32_t first = memory.seen_as()[0], second = memory.seen_as()[1];
  EXPECT_NE(first, second);
  Obstacle doubtful = obstacle_of(box(-20, 0, 1, 1)), broken = obstacle_of({{0, 0}});
  doubtful.possible_multiple = true;
  look(2, {broken, obstacle_of(box(30.2, 0.1, 1, 1)), doubtful, obstacle_of(box(10, 0.3, 1, 1))});
  EXPECT_EQ(std::vector(memory.seen_as().begin(), memory.seen_as().end()),
            (std::vector<std::uint32_t>{0, second, 0, first}));
  // one outline that holds both pieces of what was known: what is dropped as part of another is that other
  look(3, {obstacle_of(box(50, 0, 1, 1)), obstacle_of(box(50, 4, 1, 1))});
  look(4, {obstacle_of(box(50, 0, 1, 1)), obstacle_of(box(50, 4, 1, 1)), obstacle_of(box(50, 2, 1, 3.2))});
  const auto all = all_known(memory);
  for (const std::uint32_t id : memory.seen_as()) {
    EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const RememberedObstacle& o) { return o.id == id; })) << id;
  }
}

// Raw fixes of 2.5 m: what was heard a moment ago keeps its place about the vehicle, whose error has changed; what was
// heard before a long drift keeps its place in the world, which the fix has found again. ledger: S6-53 S6-66
TEST(ObstacleMemory, AJumpOfThePositionMovesWhatWasSeenSinceTheDriftBegan) {
  const auto seen = [](ObstacleMemory& memory, double now, const Pose& X_WL, double sigma, const Vector2d& jumped,
                       const std::vector<Polygon>& outlines) {
    MemorySweep sweep;
    std::vector<Obstacle> obstacles;
    for (const Polygon& o : outlines) obstacles.push_back(obstacle_of(o));
    sweep.time = t(now);
    sweep.X_WL = X_WL;
    sweep.sigma_m = sigma;
    sweep.jumped = jumped;
    sweep.obstacles = obstacles;
    ASSERT_TRUE(memory.add(sweep));
  };
  const Vector2d jump(3, -2);
  ObstacleMemory fixes;
  for (const double now : {0.0, 1.0}) seen(fixes, now, at({0, 0}), 2.5, {0, 0}, {box(10, 0, 1, 1)});
  seen(fixes, 2, at(jump), 2.5, jump, {});
  seen(fixes, 3, at(jump), 2.5, jump, {});
  const auto recent = fixes.known({0, 0}, 100);
  ASSERT_EQ(recent.size(), 1u);
  EXPECT_NEAR((circle_of(recent[0].outline_W).centre - Vector2d(13, -2)).norm(), 0, 1e-9);
  EXPECT_LT(recent[0].margin_m, 1.5) << "no less certain about the vehicle than before";

  ObstacleMemory drift;
  for (const double now : {0.0, 1.0}) seen(drift, now, at({0, 0}), 0.5, {0, 0}, {box(10, 0, 1, 1)});
  for (int i = 2; i < 60; ++i) seen(drift, i, at({0, 1.5 * i}), 0.5 + 0.05 * i, {0, 0}, {});
  seen(drift, 60, at(Vector2d(0, 90) + jump), 0.5, jump, {});
  const auto old = drift.known({0, 0}, 100);
  ASSERT_EQ(old.size(), 1u);
  EXPECT_NEAR((circle_of(old[0].outline_W).centre - Vector2d(10, 0)).norm(), 0, 1e-9);
}

// The number that people see changes only where the obstacle is seen under another one.
TEST(ObstacleMemory, KeepsTheNumberOfTheObstacleThatItsPieceWasLastSeenAs) {
  ObstacleMemory memory;
  Look look;
  for (double now = 0; now < 3; ++now) {
    fill(look, {box(10, 0, 1, 1), box(10, 8, 1, 1)}, at({0, 0}), now, 0.0);
    look.obstacles[0].number = 4;
    look.obstacles[1].number = 9;
    ASSERT_TRUE(memory.add(look.sweep));
  }
  fill(look, {box(10, 0, 1, 1)}, at({0, 0}), 3, 0.0);
  look.obstacles[0].number = 5;
  ASSERT_TRUE(memory.add(look.sweep));
  const auto all = all_known(memory);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].number, 5);
  EXPECT_EQ(all[1].number, 9) << "it was not seen since";
}

// What another vehicle tells counts at once, with the errors of both positions, until free water is seen there.
// ledger: S2-50 S2-51
TEST(ObstacleMemory, CountsWhatIsToldUntilItIsSeenNotToBeThere) {
  ObstacleMemory memory;
  Look look;
  fill(look, {}, at({0, 0}), 0, 1.0);
  ASSERT_TRUE(memory.add(look.sweep));
  EXPECT_TRUE(memory.tell({2, 9, {50, 0}, 1.5, 1.0}, t(1)));
  EXPECT_FALSE(memory.tell({2, 9, {51, 0}, 1.5, 1.0}, t(2))) << "the same one, elsewhere now";
  EXPECT_FALSE(memory.tell({3, 4, {50, 1}, 1.5, 1.0}, t(2))) << "another vehicle tells of the same";
  EXPECT_TRUE(memory.tell({2, 9, {90, 40}, 1.5, 1.0}, t(2))) << "far away it is another one, whatever its key";
  ASSERT_EQ(memory.known({0, 0}, 200).size(), 2u);
  EXPECT_TRUE(memory.known({0, 0}, 200)[0].told);
  EXPECT_NEAR(memory.known({0, 0}, 200)[0].margin_m, 2 * std::sqrt(1 + 1 + 0.25), 1e-9);
  EXPECT_TRUE(contains(memory.known({0, 0}, 200)[0].outline_W, Vector2d(51, 1.4)));
  fill(look, {}, at({0, 0}), 3, 1.0);
  memory.add(look.sweep);
  EXPECT_EQ(memory.known({0, 0}, 200).size(), 2u) << "they are out of view";
  for (int i = 0; i < 20; ++i) {
    fill(look, {}, at({40, 0}), 10 + i, 1.0);
    memory.add(look.sweep);
  }
  EXPECT_EQ(memory.known({0, 0}, 200).size(), 1u) << "the other one is still out of view";
  EXPECT_FALSE(memory.tell({2, 9, {kNaN, 0}, 1, 1}, t(60)));
  EXPECT_FALSE(memory.tell({2, 9, {0, 0}, 0, 1}, t(60)));
  EXPECT_EQ(memory.refused(), 2u);
}

// ledger: S2-50
TEST(ObstacleMemory, TakesWhatItSeesForWhatItWasTold) {
  ObstacleMemory memory;
  Look look;
  fill(look, {outline_of({{20, 0}})}, at({0, 0}), 0, 0.5);
  memory.add(look.sweep);
  EXPECT_FALSE(memory.tell({1, 1, {20, 1}, 1.5, 0.5}, t(0.5))) << "it has seen that one itself";
  EXPECT_TRUE(memory.tell({1, 2, {60, 0}, 1.5, 0.5}, t(0.5)));
  fill(look, {outline_of({{22, 1.5}})}, at({39, 0}), 1, 0.5);  // 1.8 m from where it was told
  memory.add(look.sweep);
  const auto known = memory.known({60, 0}, 10);
  ASSERT_EQ(known.size(), 1u);
  EXPECT_FALSE(known[0].told);
  EXPECT_TRUE(contains(known[0].outline_W, Vector2d(61, 1.5)));
}

TEST(ObstacleMemory, IsBoundedAndNeverGivesAnIdTwice) {
  ISOBATH_NOT_SANITIZED();
  ObstacleMemoryConfig config;
  config.max_obstacles = 20;
  ObstacleMemory memory(config);
  std::set<std::uint32_t> ids;
  for (int i = 0; i < 100; ++i) {
    for (int k = 0; k < 2; ++k) see(memory, {box(10, 0, 1, 1), box(0, 12, 1, 1)}, at({70.0 * i, 0}), 2 * i + k);
    const auto all = all_known(memory);
    EXPECT_LE(all.size(), 20u);
    for (std::size_t n = 1; n < all.size(); ++n) EXPECT_LT(all[n - 1].id, all[n].id);
    for (const RememberedObstacle& o : all) ids.insert(o.id);
  }
  EXPECT_EQ(ids.size(), 200u);
  EXPECT_EQ(all_known(memory).back().last_seen, t(199));  // the newest stays
}

// ledger: S6-66
TEST(ObstacleMemory, RefusesWhatIsNotFiniteOrInOrder) {
  ObstacleMemory memory;
  const std::vector<Polygon> rock = {box(10, 0, 1, 1)};
  see(memory, rock, at({0, 0}), 5);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Look look;
  fill(look, rock, at({0, 0}), 4, 0.0);
  EXPECT_FALSE(memory.add(look.sweep));
  fill(look, rock, at({0, 0}), 6, nan);
  EXPECT_FALSE(memory.add(look.sweep));
  fill(look, rock, at({0, 0}), 6, -1.0);
  EXPECT_FALSE(memory.add(look.sweep));
  fill(look, rock, at({0, 0}), 6, 0.0);
  look.sweep.X_WL.translation.x() = nan;
  EXPECT_FALSE(memory.add(look.sweep));
  EXPECT_EQ(memory.refused(), 4u);
  fill(look, std::vector<Polygon>{{{1, 1}, {2, 2}}, {{nan, 0}, {1, 0}, {1, 1}}}, at({0, 0}), 6, 0.0);
  EXPECT_TRUE(memory.add(look.sweep));
  EXPECT_EQ(memory.size(), 1u);
  // Without a word about free water nothing is ever let go of.
  for (int i = 7; i < 40; ++i) {
    fill(look, std::vector<Polygon>{}, at({0, 0}), i, 0.0);
    look.sweep.water = {};
    memory.add(look.sweep);
  }
  EXPECT_EQ(memory.size(), 1u);
}

}  // namespace
}  // namespace isobath
