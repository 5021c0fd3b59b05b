// Which bodies move, and what of their echoes the maps get.
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/onboard/moving_bodies.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr int kLookBins = 240;
constexpr double kLookBin = 0.25, kLookRate = 5;  // m; pings a second

/// A vehicle with a fan of 120 degrees in water with round bodies, which echo with a probability of 0.7 a bin.
class Water {
 public:
  /// `free`: whether the grid knows all water to be free.
  explicit Water(std::uint64_t seed, bool on = true, bool free = true)
      : random_(seed), grid_(BodyGridConfig{.cells_x = 130, .cells_y = 130}) {
    for (int x = 0; free && x < 130; ++x) {
      for (int y = 0; y < 130; ++y) grid_.set_probability({x, y}, 1e-3);
    }
    MovingBodiesConfig config;
    config.on = on;
    bodies_ = std::make_unique<MovingBodies>(config);
    ping_.fan = even_fan(121, Angle::degrees(120), Angle::degrees(1), Angle::degrees(20));
    ping_.window = {0, kLookBin, kLookBins};
  }

  struct Disc {
    Vector2d p_W;
    double radius = 0.8;
  };
  /// One ping; what the position is said to be may be off by `error_W`.
  void ping(std::span<const Disc> discs, const Vector2d& error_W = Vector2d::Zero()) {
    ping_.time = Time(seconds(++pings_ / kLookRate));
    decisions_.reset(ping_.fan->beams(), kLookBins);
    for (int b = 0; b < ping_.fan->beams(); ++b) {
      const Vector2d along(cos(ping_.fan->azimuth[b]), sin(ping_.fan->azimuth[b]));
      for (int k = 0; k < kLookBins; ++k) {
        const Vector2d p = ping_.window.centre(k) * along;
        const bool in_one =
            std::any_of(discs.begin(), discs.end(), [&](const Disc& d) { return (p - d.p_W).norm() < d.radius; });
        if (random_.uniform() < (in_one ? 0.7 : 2e-4)) decisions_.set_hit(b, k);
      }
    }
    X_WB_.translation = {error_W.x(), error_W.y(), 0};
    bodies_->look(ping_, decisions_, X_WB_, MovingBodies::Water{grid_, X_WB_});
    withheld_ = bodies_->withhold(ping_, X_WB_, decisions_);
  }
  /// Echoes that the maps get within `radius` of a place as it is seen.
  [[nodiscard]] int echoes_near(const Vector2d& p_B, double radius) const {
    int count = 0;
    for (int b = 0; b < ping_.fan->beams(); ++b) {
      const Vector2d along(cos(ping_.fan->azimuth[b]), sin(ping_.fan->azimuth[b]));
      for (int k = 0; k < kLookBins; ++k) {
        count += decisions_.hit(b, k) && (ping_.window.centre(k) * along - p_B).norm() < radius ? 1 : 0;
      }
    }
    return count;
  }
  [[nodiscard]] std::vector<Obstacle> moving() const { return bodies_->obstacles(ping_.time, X_WB_); }
  void mark_doubtful(std::vector<Obstacle>& obstacles) const { bodies_->mark_doubtful(ping_.time, X_WB_, obstacles); }
  [[nodiscard]] int withheld() const { return withheld_; }
  MovingBodies& bodies() { return *bodies_; }

 private:
  Random random_;
  BodyGrid grid_;
  std::unique_ptr<MovingBodies> bodies_;
  Ping ping_;
  EchoDecisions decisions_;
  Pose X_WB_;
  int pings_ = 0, withheld_ = 0;
};

// ledger: S3-15 S3-04
TEST(MovingBodies, AreKnownWithTheirVelocityAndEchoToNoMap) {
  const Vector2d buoy(25, 12), velocity(0.2, 1.0);
  int near = 0, kept = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Water water(seed);
    Vector2d p(35, -15);
    for (int k = 0; k < 75; ++k, p += velocity / kLookRate) {
      water.ping(std::array{Water::Disc{p}, Water::Disc{buoy}});
      if (k < 40) continue;
      near += water.echoes_near(p, 1.2);
      kept += water.echoes_near(buoy, 1.2);
    }
    const std::vector<Obstacle> moving = water.moving();
    ASSERT_EQ(moving.size(), 1u) << seed;
    EXPECT_LT((moving[0].motion.velocity_W - velocity).norm(), 0.15) << seed;
    EXPECT_LT((moving[0].centre - (p - velocity / kLookRate)).norm(), 0.4) << seed;
    EXPECT_TRUE(contains(moving[0].outline, p - velocity / kLookRate)) << seed;
  }
  EXPECT_EQ(near, 0) << "of the body that moves";
  EXPECT_GT(kept, 1000) << "of the body that lies still";
}

// Two seconds of readings are too few to take its echoes out of the maps, but enough not to remember it, where another
// body is known to move. ledger: S3-21
TEST(MovingBodies, MayMoveBeforeTheyAreKnownToMove) {
  const Vector2d buoy(25, 12), velocity(0.2, 1.0);
  for (const bool traffic : {false, true}) {
    int marked = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      Water water(seed);
      Vector2d other(45, -15), p(35, -15);
      for (int k = 0; k < 87; ++k, other += velocity / kLookRate) {
        std::vector<Water::Disc> discs{{buoy}};
        if (traffic) discs.push_back({other});
        if (k >= 75) discs.push_back({p += velocity / kLookRate});
        water.ping(discs);
      }
      std::vector<Obstacle> seen(2);
      seen[0].centre = p;
      seen[1].centre = buoy;
      water.mark_doubtful(seen);
      EXPECT_EQ(water.moving().size(), traffic ? 1u : 0u) << seed;
      EXPECT_FALSE(seen[1].may_move) << seed;
      if (!seen[0].may_move) continue;
      ++marked;
      EXPECT_FALSE(seen[0].moves());
      EXPECT_LT((seen[0].motion.velocity_W - velocity).norm(), 0.4) << seed;
    }
    if (traffic) {
      EXPECT_GE(marked, 9);
    } else {
      EXPECT_EQ(marked, 0);
    }
  }
}

TEST(MovingBodies, AreNoneWhereAllLieStillAndNavigationDrifts) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Water water(seed);
    Random random(seed);
    std::vector<Water::Disc> discs;
    for (int i = 0; i < 8; ++i) {
      discs.push_back({Vector2d(random.uniform(15, 50), random.uniform(-20, 20)), random.uniform(0.3, 2)});
    }
    for (int k = 0; k < 150; ++k) water.ping(discs, Vector2d(0.03, -0.03) * (k / kLookRate));
    EXPECT_EQ(water.bodies().counts().moving, 0u) << seed;
  }
}

TEST(MovingBodies, AreObstaclesOfTheMapAgainWhenTheyStop) {
  Water water(3);
  Vector2d p(30, -15);
  for (int k = 0; k < 60; ++k, p.y() += 1.0 / kLookRate) water.ping(std::array{Water::Disc{p}});
  ASSERT_EQ(water.moving().size(), 1u);
  EXPECT_GT(water.withheld(), 0);
  for (int k = 0; k < 100; ++k) water.ping(std::array{Water::Disc{p}});
  EXPECT_TRUE(water.moving().empty());
  EXPECT_GT(water.echoes_near(p, 1.2), 0);
}

TEST(MovingBodies, FollowAJumpOfThePositionWithoutAChangeOfVelocity) {
  const Vector2d jump(6, -4);
  Water water(5);
  Vector2d p(30, -12);
  const Vector2d buoy(40, 10);
  for (int k = 0; k < 60; ++k, p.y() += 0.8 / kLookRate) water.ping(std::array{Water::Disc{p}, Water::Disc{buoy}});
  water.bodies().shift(jump);
  for (int k = 0; k < 15; ++k, p.y() += 0.8 / kLookRate)
    water.ping(std::array{Water::Disc{p}, Water::Disc{buoy}}, jump);
  const std::vector<Obstacle> moving = water.moving();
  ASSERT_EQ(moving.size(), 1u);
  EXPECT_LT((moving[0].motion.velocity_W - Vector2d(0, 0.8)).norm(), 0.2);
  EXPECT_LT((moving[0].centre - p).norm(), 0.6) << "in the vehicle's own frame";
}

// The glint on a quay at 30 degrees to the vehicle's way slides along the quay as the vehicle passes, into water that
// was never seen to be free: by the part of the vehicle's way that lies along the quay.
TEST(MovingBodies, AreNoGlintsThatSlideAlongAQuay) {
  const Vector2d along(0.5, 0.866);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Water water(seed, true, false);
    Vector2d own(0, 0), glint(30, -15);
    for (int k = 0; k < 75; ++k) {
      const Vector2d way(0, 1.0 / kLookRate);
      own += way;
      glint += way.dot(along) * along;
      water.ping(std::array{Water::Disc{glint - own}}, own);
    }
    EXPECT_EQ(water.bodies().counts().confirmed, 1u) << seed;
    EXPECT_EQ(water.bodies().counts().moving, 0u) << seed;
    EXPECT_GT(water.echoes_near(glint - own, 1.2), 0) << seed;
  }
}

// No glint comes towards the vehicle, or moves while it lies still: far away, where the grid learns late that water is
// free, that is enough.
TEST(MovingBodies, NeedNoFreeWaterWhereTheirWayIsNotThatOfAGlint) {
  for (const Vector2d& own_way : {Vector2d(0, 0), Vector2d(0, 1.0 / kLookRate)}) {
    Water water(3, true, false);
    Vector2d own(0, 0), p(30, 12);
    for (int k = 0; k < 60; ++k) {
      own += own_way;
      p.y() -= 0.6 / kLookRate;
      water.ping(std::array{Water::Disc{p - own}}, own);
    }
    EXPECT_EQ(water.bodies().counts().moving, 1u) << own_way.y();
  }
}

// A body passes behind another one, for 8 s without an echo: it is known all the time, and keeps its track.
// ledger: S3-04 S3-15
TEST(MovingBodies, KeepTheirTracksBehindABodyThatHidesThem) {
  const Water::Disc before{{15, 0}, 2};
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Water water(seed);
    Vector2d p(30, -14);
    std::optional<std::uint32_t> number;
    for (int k = 0; k < 28 * static_cast<int>(kLookRate); ++k, p.y() += 1 / kLookRate) {
      std::vector<Water::Disc> seen{before};
      if (std::abs(p.y() / p.x()) > 4.0 / 30) seen.push_back({p});
      water.ping(seen);
      if (p.y() < -5) continue;
      const std::vector<Obstacle> moving = water.moving();
      ASSERT_EQ(moving.size(), 1u) << seed << ", " << p.y();
      if (!number) number = moving[0].motion.track;
      EXPECT_EQ(moving[0].motion.track, *number) << seed << ", " << p.y();
      EXPECT_LT((moving[0].centre - p).norm(), 2) << seed << ", " << p.y();
    }
  }
}

TEST(MovingBodies, AreNotLookedForWhereTheyAreSwitchedOff) {
  Water water(3, false);
  Vector2d p(30, -15);
  for (int k = 0; k < 60; ++k, p.y() += 1.0 / kLookRate) water.ping(std::array{Water::Disc{p}});
  EXPECT_TRUE(water.moving().empty());
  EXPECT_EQ(water.withheld(), 0);
}

}  // namespace
}  // namespace isobath
