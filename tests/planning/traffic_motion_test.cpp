// Motion of a vehicle and of the bodies around it: closed forms against integration in small steps, and the check of
// pieces of motion against dense samples.
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/planning/traffic/predicted_traffic.hpp>
#include <isobath/planning/traffic/vehicle_motion.hpp>
#include <numbers>

namespace isobath::traffic_motion {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

/// Euler's method with the midpoint of each step.
MotionState integrated(MotionState state, double curvature, double acceleration, double duration_s, double max_speed) {
  constexpr int kSteps = 20000;
  const double dt = duration_s / kSteps;
  for (int k = 0; k < kSteps; ++k) {
    const double next = std::clamp(state.speed + acceleration * dt, 0.0, max_speed);
    const double way = 0.5 * (state.speed + next) * dt, middle = state.heading + 0.5 * curvature * way;
    state.p_W += way * Vector2d(std::cos(middle), std::sin(middle));
    state.heading += curvature * way;
    state.speed = next;
  }
  return state;
}

TEST(VehicleMotion, OfASegmentIsItsIntegral) {
  Random random(1);
  for (int i = 0; i < 40; ++i) {
    const MotionState start{
        {random.uniform(-9, 9), random.uniform(-9, 9)}, random.uniform(-4, 4), random.uniform(0, 2)};
    const double curvature = i % 4 == 0 ? 0 : random.uniform(-0.5, 0.5), acceleration = random.uniform(-0.5, 0.5);
    const double duration_s = random.uniform(0.1, 8);
    const MotionState end = MotionSegment{0, duration_s, start, curvature, acceleration}.after(duration_s);
    const MotionState expected = integrated(start, curvature, acceleration, duration_s, 100);
    EXPECT_NEAR((end.p_W - expected.p_W).norm(), 0, 1e-3);
    EXPECT_NEAR(end.heading, expected.heading, 1e-3);
    EXPECT_NEAR(end.speed, expected.speed, 1e-9);
  }
}

// The turn comes first, and then the goal lies ahead; the speed rises to its maximum. ledger: S3-01
TEST(VehicleMotion, ThatIsDirectReachesTheGoalAtItsTime) {
  Random random(2);
  const TrafficVehicle vehicle;
  int reached = 0;
  for (int i = 0; i < 200; ++i) {
    const MotionState start{
        {random.uniform(-9, 9), random.uniform(-9, 9)}, random.uniform(-4, 4), random.uniform(0, vehicle.max_speed)};
    const Vector2d goal = start.p_W + random.uniform(0, 60) * Vector2d(std::cos(0.1 * i), std::sin(0.1 * i));
    const auto direct = direct_motion(vehicle, start, goal, 0);
    const Vector2d ahead(std::cos(start.heading), std::sin(start.heading)), aside(-ahead.y(), ahead.x());
    const double radius = 1 / vehicle.max_curvature();
    const double side = aside.dot(goal - start.p_W) < 0 ? -1 : 1;
    ASSERT_EQ(direct.has_value(), (goal - start.p_W - side * radius * aside).norm() >= radius);
    if (!direct) continue;
    ++reached;
    EXPECT_NEAR((direct->at(direct->arrival_s).p_W - goal).norm(), 0, 1e-6);
    EXPECT_LE(direct->arc_m, 2 * pi * radius + 1e-9);
    Trajectory as_segments;
    direct->append_to(as_segments, 60);
    for (const double t : {0.0, 0.7, 3.1, 9.3, 30.0, 60.0}) {
      EXPECT_NEAR((as_segments.at(t).p_W - direct->at(t).p_W).norm(), 0, 1e-9);
      EXPECT_NEAR(as_segments.at(t).speed, direct->at(t).speed, 1e-9);
    }
  }
  EXPECT_GT(reached, 150);
}

// k sqrt(lambda_max(P_pos + t^2 P_vel)): along no direction is the spread greater. ledger: S3-30
TEST(MovingBodies, GrowByTheGreatestSpreadOfAnyDirection) {
  MovingBody body;
  body.position_covariance << 0.5, 0.2, 0.2, 0.3;
  body.velocity_covariance << 0.02, -0.01, -0.01, 0.05;
  for (const double t : {0.0, 3.0, 20.0}) {
    double greatest = 0;
    for (int k = 0; k < 3600; ++k) {
      const Vector2d u(std::cos(k * pi / 3600), std::sin(k * pi / 3600));
      greatest = std::max(greatest, u.dot((body.position_covariance + t * t * body.velocity_covariance) * u));
    }
    EXPECT_NEAR(predicted_growth(body, t, 3), 3 * std::sqrt(greatest), 1e-5);
  }
}

// A bar of 8 m that turns by 0.1 rad/s lies across its first direction after 15.7 s. ledger: S3-11 S3-12
TEST(MovingBodies, TurnWithTheirOutline) {
  MovingBody bar;
  bar.outline = {{-4, -0.5}, {4, -0.5}, {4, 0.5}, {-4, 0.5}};
  bar.turn_rate = 0.1;
  bar.velocity_W = {0.2, 0};
  EXPECT_NEAR(distance_to(bar, {6, 0}, 0), 2, 1e-12);
  const double quarter_s = pi / 2 / 0.1;
  EXPECT_NEAR(distance_to(bar, {0.2 * quarter_s, 6}, quarter_s), 2, 1e-9);
  EXPECT_NEAR(distance_to(bar, {0.2 * quarter_s, 3.8}, quarter_s), -0.2, 1e-9);
}

MovingBody random_body(Random& random, int number) {
  MovingBody body;
  body.number = number;
  body.p_W = {random.uniform(-25, 25), random.uniform(-25, 25)};
  body.velocity_W = {random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5)};
  body.radius_m = random.uniform(0.2, 2);
  if (number % 3 == 0) {
    body.outline = convex_hull({{-3, -1}, {3, -1}, {random.uniform(2, 4), 1}, {-3, 1}});
    body.radius_m = 0.1;
    body.turn_rate = random.uniform(-0.5, 0.5);
  }
  if (number % 4 == 0) body.velocity_covariance = Eigen::Matrix2d::Identity() * 0.001;
  return body;
}

// A piece that is called free is clear at each of 50 moments; one that is not comes within the distance, or, of a body
// that turns, within the stated bound of it. ledger: S3-10 S3-11 S3-12 S3-20
TEST(PredictedTraffic, AgreesWithDenseSamples) {
  Random random(3);
  std::vector<MovingBody> bodies;
  for (int i = 0; i < 40; ++i) bodies.push_back(random_body(random, i));
  PredictedTraffic traffic;
  const TrafficSteps steps{.start = Time(), .count = 10, .distance_m = 0.6, .half_side_m = 20, .piece_m = 1};
  traffic.build(bodies, steps);
  int free_pieces = 0, met_pieces = 0;
  for (int i = 0; i < 1000; ++i) {
    const int step = static_cast<int>(random.index(10));
    const Vector2d a(random.uniform(-22, 22), random.uniform(-22, 22));
    const double angle = random.uniform(0, 2 * pi), way = random.uniform(0, 1), start_s = step + 0.5 * (i % 2);
    const Vector2d b = a + way * Vector2d(std::cos(angle), std::sin(angle));
    double least = INFINITY;
    for (const MovingBody& body : bodies) {
      for (int k = 0; k <= 50; ++k) {
        const double share = k / 50.0;
        least = std::min(least, distance_to(body, a + share * (b - a), start_s + 0.5 * share) -
                                    predicted_growth(body, step + 1, steps.sigmas));
      }
    }
    if (traffic.is_free(step, start_s, 0.5, a, b)) {
      ++free_pieces;
      EXPECT_GE(least, 0.6 - 1e-3);
    } else {
      ++met_pieces;
      EXPECT_LT(least, 0.6 + 0.5);
    }
  }
  EXPECT_GT(free_pieces, 150);
  EXPECT_GT(met_pieces, 150);
}

}  // namespace
}  // namespace isobath::traffic_motion
