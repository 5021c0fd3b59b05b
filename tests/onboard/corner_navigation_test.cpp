// A vehicle that turns a scanning sonar before a charted corner while it moves.
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/onboard/corner_navigation.hpp>
#include <numbers>
#include <tests/support/events.hpp>
#include <tests/support/plane_rays.hpp>

namespace isobath::corner_navigation_test {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kContrast = 6;

/// A block of 12 m x 16 m.
std::vector<ChartedWall> block(const Vector2d& at = {0, 0}) {
  const std::array<Vector2d, 4> corners{Vector2d(-6, -8), Vector2d(-6, 8), Vector2d(6, 8), Vector2d(6, -8)};
  std::vector<ChartedWall> walls;
  for (std::size_t i = 0; i < 4; ++i) walls.push_back({at + corners[i], at + corners[(i + 1) % 4]});
  return walls;
}

/// Fixes and pings of a vehicle that goes east past the block's corner at (6, 8), 1 m/s, at a constant navigation
/// error.
class Passage {
 public:
  Passage(CornerNavigation& corners, const Vector2d& error) : corners_(corners), error_(error) {
    for (const ChartedWall& wall : block()) room_.segments.push_back({wall.a, wall.b});
  }

  /// The fix of now, as the navigation gives it: with a standard deviation of 0.5 m.
  [[nodiscard]] Navigation fix() const {
    Navigation fix = test::fix_at(t_, 0);
    fix.X_WB.translation << place() + error_, 4;
    fix.covariance.emplace(Eigen::Matrix<double, 6, 6>::Zero());
    fix.covariance->diagonal().head<2>().setConstant(sigma_m * sigma_m);
    return fix;
  }
  /// One turn of 144 beams in 7 s, posed by the corrected navigation.
  void turn() {
    for (int beam = 0; beam < 144; ++beam, t_ += 0.05) {
      const Angle bearing = Angle::degrees(2.5 * beam);
      double nearest = std::numeric_limits<double>::infinity();
      for (int ray = -5; ray <= 5; ++ray) {
        nearest = std::min(nearest, room_.range(place(), (bearing + Angle::degrees(0.22 * ray)).radians()));
      }
      Navigation now = fix();
      correct(now);
      std::vector<std::uint8_t> samples(300, 10);
      const int bin = nearest < 30 ? static_cast<int>(nearest / 0.1) : -1;
      if (bin >= 0) samples[static_cast<std::size_t>(bin)] = 200;
      const auto fan = std::make_shared<BeamFan>(BeamFan{{bearing}, {Angle::degrees(2.5)}, Angle::degrees(20)});
      const Ping ping = make_ping(now.time, fan, {0, 0.1, 300}, samples);
      EchoDecisions decisions;
      decisions.reset(1, 300);
      if (bin >= 0) decisions.set_hit(0, bin);
      corners_.on_ping({ping, now.X_WB, decisions});
    }
    corners_.on_sweep(true);
  }
  /// Corrects a fix, and moves the poses along if the position jumps.
  std::optional<CornerMove> correct(Navigation& fix) {
    const auto move = corners_.correct(fix);
    if (!move) return move;
    corners_.on_jump({move->by.x(), move->by.y(), 0});
    corners_.follow(*move);
    return move;
  }
  [[nodiscard]] Vector2d place() const { return {13, 10 + t_}; }

  double sigma_m = 0.5;

 private:
  CornerNavigation& corners_;
  Vector2d error_;
  test::PlanRoom room_;
  double t_ = 0;
};

CornerNavigationConfig switched_on() { return {.on = true}; }

// ledger: S4-49
TEST(CornerNavigation, ASweepOfAMovingVehicleMovesThePositionToTheChart) {
  CornerNavigation corners(switched_on(), kContrast, corners_of(block()));
  const Vector2d error(0.5, -0.4);
  Passage passage(corners, error);
  passage.turn();
  Navigation fix = passage.fix();
  const auto move = passage.correct(fix);
  ASSERT_TRUE(move);
  EXPECT_LT((move->by + error).norm(), 0.2) << "7 m of way during the sweep";
  EXPECT_LT((fix.X_WB.translation.head<2>() - passage.place()).norm(), 0.2);
  EXPECT_LT((*fix.covariance)(0, 0), 0.3 * 0.3) << "surer than the navigation";
  EXPECT_NEAR(move->sigma_m, std::sqrt(2.0) * 0.5, 1e-9);
  EXPECT_THAT(to_text(*move), testing::HasSubstr("a corner of the chart moves the position by 0."));
  for (int i = 0; i < 3; ++i) passage.turn();
  const CornerFixOutcome outcome = corners.outcome();
  EXPECT_EQ(outcome.charted, 4U);
  EXPECT_GE(outcome.taken, 2U);
  EXPECT_EQ(outcome.refused, 0U);
  EXPECT_EQ(outcome.last_moves_m.size(), std::min<std::size_t>(5, outcome.taken));
  EXPECT_EQ(outcome.farthest_move_m, outcome.last_moves_m.front());
  EXPECT_LT((outcome.offset + error).norm(), 0.3);
}

TEST(CornerNavigation, OffItChangesNothing) {
  CornerNavigation corners({}, kContrast, corners_of(block()));
  Passage passage(corners, {0.5, -0.4});
  passage.turn();
  Navigation fix = passage.fix();
  const Navigation before = fix;
  EXPECT_FALSE(passage.correct(fix));
  EXPECT_EQ(fix.X_WB.translation, before.X_WB.translation);
  EXPECT_EQ(*fix.covariance, *before.covariance);
  EXPECT_EQ(corners.outcome().sweeps, 0U);
}

// The chart shows the block 10 m off, too far north by more than a fix may move, or elsewhere. ledger: S4-49
TEST(CornerNavigation, AChartThatContradictsTheEchoesIsRefused) {
  for (const Vector2d& off : {Vector2d(10, 0), Vector2d(0, -10), Vector2d(3.5, 0)}) {
    CornerNavigation corners(switched_on(), kContrast, corners_of(block(off)));
    Passage passage(corners, {0, 0});
    passage.sigma_m = 2;
    for (int i = 0; i < 2; ++i) passage.turn();
    EXPECT_GE(corners.outcome().refused, 1U) << off;
    EXPECT_EQ(corners.outcome().taken, 0U) << off;
    Navigation fix = passage.fix();
    EXPECT_FALSE(passage.correct(fix)) << off;
  }
  CornerNavigation elsewhere(switched_on(), kContrast, corners_of(block({200, 0})));
  Passage passage(elsewhere, {0, 0});
  passage.turn();
  EXPECT_EQ(elsewhere.outcome().sweeps, 1U);
  EXPECT_EQ(elsewhere.outcome().refused, 0U) << "the chart has nothing in range";
}

// ledger: S4-49
TEST(CornerNavigation, AFixOfTheNavigationItselfEndsTheCorrection) {
  CornerNavigation corners(switched_on(), kContrast, corners_of(block()));
  Passage passage(corners, {0.5, -0.4});
  passage.turn();
  Navigation fix = passage.fix();
  ASSERT_TRUE(passage.correct(fix));
  passage.sigma_m = 0.1;  // a receiver at the surface
  fix = passage.fix();
  const Navigation stated = fix;
  EXPECT_TRUE(passage.correct(fix)) << "back to the navigation";
  EXPECT_EQ(fix.X_WB.translation, stated.X_WB.translation);
  EXPECT_EQ(*fix.covariance, *stated.covariance);
}

// The mapping thread of a live run may end a sweep before the poses contain the last fix. ledger: S4-49
TEST(CornerNavigation, WaitsUntilThePosesContainTheLastFix) {
  CornerNavigation corners(switched_on(), kContrast, corners_of(block()));
  Passage passage(corners, {0.5, -0.4});
  passage.turn();
  Navigation fix = passage.fix();
  ASSERT_TRUE(corners.correct(fix));
  passage.turn();
  EXPECT_EQ(corners.outcome().sweeps, 2U);
  EXPECT_EQ(corners.outcome().taken, 1U);
}

}  // namespace
}  // namespace isobath::corner_navigation_test
