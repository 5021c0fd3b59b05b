// Path following in space: kinematics against finite differences, the law in closed loop, and set-points of depth and
// heading with the whole vehicle.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/vehicle/path_following.hpp>
#include <isobath/vehicle/path_helm.hpp>
#include <isobath/vehicle/plant.hpp>
#include <numbers>
#include <tests/support/count_allocations.hpp>
#include <tests/vehicle/models.hpp>

namespace isobath {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using std::numbers::pi;

constexpr double kSpeed = 1.5;

/// The default helix, 10 m deep: 6 m a radian, 4 m to the sides, 2 m up and down.
CurveJet default_helix(double t) {
  const double c = std::cos(t), s = std::sin(t);
  return {{6 * t, 4 * c, 10 - 2 * s}, {6, -4 * s, -2 * c}, {0, -4 * c, 2 * s}, {0, 4 * s, 2 * c}};
}

/// The same grown out of a straight line and fading into one; the rise has three derivatives that are zero at its ends.
CurveJet straight_helix_straight(double x) {
  const auto rise = [](double t, double out[4]) {
    out[0] = t >= 1 ? 1 : 0;
    out[1] = out[2] = out[3] = 0;
    if (t <= 0 || t >= 1) return;
    out[0] = std::pow(t, 4) * (35 - 84 * t + 70 * t * t - 20 * t * t * t);
    out[1] = 140 * std::pow(t * (1 - t), 3);
    out[2] = 420 * std::pow(t * (1 - t), 2) * (1 - 2 * t);
    out[3] = 840 * t * (1 - t) * (1 - 2 * t) * (1 - 2 * t) - 840 * std::pow(t * (1 - t), 2);
  };
  constexpr double kRamp = 20, kEnd = 100;
  double up[4], down[4], e[4], y[4], z[4];
  rise(x / kRamp, up);
  rise((x - kEnd) / kRamp, down);
  for (int i = 0; i < 4; ++i) e[i] = ((x < kEnd ? up[i] : 0) - (x < kEnd ? 0 : down[i])) / std::pow(kRamp, i);
  if (x >= kEnd) e[0] = 1 - down[0];
  const double t = x / 6, k = 1.0 / 6, c = std::cos(t), s = std::sin(t);
  const double cosine[4] = {c, -k * s, -k * k * c, k * k * k * s}, sine[4] = {s, k * c, -k * k * s, -k * k * k * c};
  const auto product = [&e](const double f[4], double by, double out[4]) {
    out[0] = by * e[0] * f[0];
    out[1] = by * (e[1] * f[0] + e[0] * f[1]);
    out[2] = by * (e[2] * f[0] + 2 * e[1] * f[1] + e[0] * f[2]);
    out[3] = by * (e[3] * f[0] + 3 * e[2] * f[1] + 3 * e[1] * f[2] + e[0] * f[3]);
  };
  product(cosine, 4, y);
  product(sine, -2, z);
  return {{x, y[0], 10 + z[0]}, {1, y[1], z[1]}, {0, y[2], z[2]}, {0, y[3], z[3]}};
}

CoursePoint moved(const CoursePoint& at, double speed, double q, double r, double t) {
  CoursePoint x = at;
  const int steps = std::max(1, static_cast<int>(t / 1e-3));
  const double h = t / steps;
  const auto plus = [](const CoursePoint& a, const CoursePoint& d, double by) {
    return CoursePoint{a.p_W + by * d.p_W, a.theta + by * d.theta, a.psi + by * d.psi};
  };
  for (int i = 0; i < steps; ++i) {  // the midpoint rule, fine
    const CoursePoint half = plus(x, course_rates(x, speed, q, r), h / 2);
    x = plus(x, course_rates(half, speed, q, r), h);
  }
  return x;
}

// ledger: S5-48
TEST(CoursePoint, FollowsTheClosedFormArcs) {
  const double U = 1.5, t = 4;
  // Level turn: a circle of radius U / r.
  const double r = 0.2;
  const CoursePoint turned = moved({{1, 2, 3}, 0, 0.5}, U, 0, r, t);
  EXPECT_NEAR(turned.psi, 0.5 + r * t, 1e-9);
  EXPECT_NEAR(turned.p_W.x(), 1 + U / r * (std::sin(0.5 + r * t) - std::sin(0.5)), 1e-6);
  EXPECT_NEAR(turned.p_W.y(), 2 - U / r * (std::cos(0.5 + r * t) - std::cos(0.5)), 1e-6);
  EXPECT_NEAR(turned.p_W.z(), 3, 1e-12);
  // Pull up: a circle in the upright plane; nose up is a smaller depth.
  const double q = 0.1;
  const CoursePoint pulled = moved({{0, 0, 10}, -0.1, pi / 2}, U, q, 0, t);
  EXPECT_NEAR(pulled.theta, -0.1 + q * t, 1e-9);
  EXPECT_NEAR(pulled.p_W.y(), U / q * (std::sin(0.3) - std::sin(-0.1)), 1e-6);
  EXPECT_NEAR(pulled.p_W.z(), 10 + U / q * (std::cos(0.3) - std::cos(-0.1)), 1e-6);
  // A steady climb while turning: a helix, faster in heading by 1 / cos theta.
  EXPECT_NEAR(moved({{0, 0, 10}, 0.4, 0}, U, 0, r, t).psi, r * t / std::cos(0.4), 1e-9);
}

// ledger: S5-48
TEST(CoursePoint, StaysFiniteStraightUp) {
  for (const double theta : {pi / 2, -pi / 2, pi / 2 + 1e-9}) {
    const CoursePoint rates = course_rates({{0, 0, 0}, theta, 0}, 1.5, 0.1, 0.2);
    EXPECT_TRUE(rates.p_W.allFinite());
    EXPECT_LE(std::abs(rates.psi), 200.0 + 1e-9);
  }
}

struct Pair {
  SpacePath path;
  bool frenet;
  [[nodiscard]] PathFrame frame(double s) const { return frenet ? *frenet_frame(path.jet_at(s)) : path.frame_at(s); }
};

// A vehicle and a virtual target that move by themselves: the errors' rates against differences of the errors, in both
// kinds of frame. ledger: S5-50 S5-55 S5-E07 S5-E08
TEST(PathErrors, ChangeAsFiniteDifferencesSay) {
  Random random(5);
  for (const bool frenet : {true, false}) {
    const Pair pair{SpacePath(default_helix, 0, 12), frenet};
    for (int trial = 0; trial < 40; ++trial) {
      const double s = random.uniform(5, 60);
      const PathFrame frame = pair.frame(s);
      CoursePoint at;
      for (int i = 0; i < 3; ++i) at.p_W[i] = frame.p_W[i] + random.uniform(-4, 4);
      at.theta = random.uniform(-0.6, 0.6);
      at.psi = random.uniform(-1, 1);
      const double U = random.uniform(0.5, 2.5);
      const double s_dot = random.uniform(-0.5, 2.5);
      const double q = random.uniform(-0.4, 0.4);
      const double r = random.uniform(-0.4, 0.4);
      const auto errors_after = [&](double t) {
        const CoursePoint rate = course_rates(at, U, q, r);
        const CoursePoint then{at.p_W + t * rate.p_W, at.theta + t * rate.theta, at.psi + t * rate.psi};
        return path_errors(pair.frame(s + t * s_dot), then.p_W, then.R_WV());
      };
      const double h = 1e-4;
      const PathErrors before = errors_after(-h), after = errors_after(h), now = errors_after(0);
      const PathErrorRates rates = error_rates(frame, now, U, s_dot, q, r);
      EXPECT_NEAR(((after.q_F - before.q_F) / (2 * h) - rates.q_F).norm(), 0, 1e-5);
      EXPECT_NEAR((after.theta - before.theta) / (2 * h), rates.theta, 1e-5);
      EXPECT_NEAR(std::remainder(after.psi - before.psi, 2 * pi) / (2 * h), rates.psi, 1e-5);
      // As the paper prints them, with the dot that it lost.
      const double c = std::cos(now.theta), k = frame.k1, k2 = frame.k2, tau = frame.torsion;
      const Vector3d e = now.q_F;
      EXPECT_NEAR(rates.q_F.x(), -s_dot * (1 - k * e.y() - k2 * e.z()) + U * c * std::cos(now.psi), 1e-12);
      EXPECT_NEAR(rates.q_F.y(), -s_dot * (k * e.x() - tau * e.z()) + U * c * std::sin(now.psi), 1e-12);
      EXPECT_NEAR(rates.q_F.z(), -s_dot * (k2 * e.x() + tau * e.y()) - U * std::sin(now.theta), 1e-12);
    }
  }
}

// ledger: S5-51
TEST(VirtualTarget, ClosesUpExponentiallyOnAStraight) {
  const SpacePath line([](double u) { return CurveJet{{u, 0, 5}, {1, 0, 0}, {0, 0, 0}, {0, 0, 0}}; }, 0, 200);
  const PathFollowingConfig config;
  FollowedPoint at{{{13, 0, 5}, 0, 0}, 10};  // 3 m ahead of the target, on the line
  for (int i = 0; i < 100; ++i) at = step_along(line, config, at, kSpeed, 0.05);
  EXPECT_NEAR(at.vehicle.p_W.x() - at.s, 3 * std::exp(-config.k1 * 5), 1e-6);
}

struct Course {
  double off_m = 0, greatest_rise = -1e9, greatest_turn = 0, greatest_jump = 0;
};

Course follow_from(const SpacePath& path, const Vector3d& start_F, double seconds, double dt) {
  const PathFollowingConfig config;
  const PathFrame frame = path.frame_at(0);
  FollowedPoint at;
  at.vehicle = {frame.p_W + frame.R_WF * start_F, -std::asin(frame.tangent().z()),
                std::atan2(frame.tangent().y(), frame.tangent().x())};
  Course course;
  double last = INFINITY, last_turn = NAN;
  for (double t = 0; t < seconds; t += dt) {
    const PathFrame now = path.frame_at(at.s);
    const PathErrors errors = path_errors(now, at.vehicle.p_W, at.vehicle.R_WV());
    const PathFollowingOrder order = follow_path(config, now, errors, kSpeed);
    if (std::isfinite(last)) course.greatest_rise = std::max(course.greatest_rise, order.lyapunov - last);
    if (std::isfinite(last_turn))
      course.greatest_jump = std::max(course.greatest_jump, std::abs(order.turn_rate - last_turn));
    last = order.lyapunov;
    last_turn = order.turn_rate;
    course.greatest_turn = std::max(course.greatest_turn, std::abs(order.turn_rate));
    course.off_m = errors.q_F.norm();
    at = step_along(path, config, at, kSpeed, dt);
  }
  return course;
}

// ledger: S5-52 S5-D08
TEST(PathFollowing, ConvergesFromTheTwoStartsAndVNeverRises) {
  const SpacePath path(default_helix, 0, 15);
  for (const Vector3d& start : {Vector3d(2, -3, 1.5), Vector3d(-5, 4, -2)}) {
    const Course course = follow_from(path, start, 40, 0.05);
    EXPECT_LT(course.off_m, 1e-6);
    EXPECT_LT(course.greatest_rise, 1e-14);
  }
}

// The rate of V by the law, against the rate that its proof promises, with both rates of turn its own: of pitch and of
// heading. ledger: S5-52 S5-E09
TEST(PathFollowing, VFallsAsItsProofSays) {
  const SpacePath path(default_helix, 0, 12);
  const PathFollowingConfig c;
  Random random(9);
  for (int trial = 0; trial < 100; ++trial) {
    const double s = random.uniform(5, 60);
    const PathFrame frame = path.frame_at(s);
    FollowedPoint at;
    at.s = s;
    for (int i = 0; i < 3; ++i) at.vehicle.p_W[i] = frame.p_W[i] + random.uniform(-6, 6);
    at.vehicle.theta = random.uniform(-0.5, 0.5);
    at.vehicle.psi = random.uniform(-0.8, 0.8);
    const auto value = [&](const FollowedPoint& x, PathErrors& e) {
      const PathFrame f = path.frame_at(x.s);
      e = path_errors(f, x.vehicle.p_W, x.vehicle.R_WV());
      return follow_path(c, f, e, kSpeed);
    };
    PathErrors e, unused;
    const PathFollowingOrder now = value(at, e);
    const double h = 1e-4;
    const double slope = (value(step_along(path, c, at, kSpeed, h), unused).lyapunov -
                          value(step_along(path, c, at, kSpeed, -h), unused).lyapunov) /
                         (2 * h);
    const double y = e.q_F.y(), z = e.q_F.z(), dt = e.theta - now.approach_theta, dp = e.psi - now.approach_psi;
    const double promised = -(c.k1 * e.q_F.x() * e.q_F.x() + kSpeed * z * z / (std::abs(z) + c.d1) +
                              kSpeed * std::cos(e.theta) * y * y / (std::abs(y) + c.d2)) /
                                c.c1 -
                            (c.k2 * dt * dt + c.k3 * dp * dp) / c.c2;
    ASSERT_GT(std::cos(e.theta), 0);
    EXPECT_NEAR(slope, promised, 1e-5 * (1 + std::abs(promised)));
    EXPECT_LT(promised, 0);
  }
}

// Where angle and approach angle meet the quotient is 0 / 0: the law goes through it smoothly. ledger: S5-52
TEST(PathFollowing, HasItsLimitWhereTheQuotientHasNone) {
  const PathFollowingConfig c;
  PathFrame frame;
  frame.k1 = 0.1;
  PathErrors e;
  e.q_F = {0.5, 2, -1.5};
  const double d_theta = std::asin(-1.5 / (1.5 + c.d1)), d_psi = std::asin(-2 / (2 + c.d2));
  const auto at = [&](double off) {
    PathErrors x = e;
    x.theta = d_theta + off;
    x.psi = d_psi + off;
    return follow_path(c, frame, x, kSpeed);
  };
  const PathFollowingOrder exact = at(0);
  for (const double off : {1e-3, 1e-6, 1e-9, 1e-12}) {
    EXPECT_NEAR(at(off).pitch_rate, exact.pitch_rate, 10 * off + 1e-12);
    EXPECT_NEAR(at(off).turn_rate, exact.turn_rate, 10 * off + 1e-12);
  }
  // With the limit written out: u_theta = (c2/c1) z U cos d_th + d_th'.
  e.theta = d_theta;
  e.psi = d_psi;
  const PathErrorRates drift = error_rates(frame, e, kSpeed, exact.s_dot, 0, 0);
  const double z = e.q_F.z(), wide = std::abs(z) + c.d1, f = z / wide;
  const double wanted =
      c.c2 / c.c1 * z * kSpeed * std::cos(d_theta) + c.d1 / (wide * wide) / std::sqrt(1 - f * f) * drift.q_F.z();
  EXPECT_NEAR(exact.pitch_rate + drift.theta, wanted, 1e-12);
}

// ledger: S5-55
TEST(PathFollowing, StraightHelixStraightIsFollowedWithoutAJump) {
  const SpacePath path(straight_helix_straight, -10, 150);
  const Course on_it = follow_from(path, Vector3d::Zero(), 110, 0.02);
  EXPECT_LT(on_it.off_m, 1e-6);
  EXPECT_LT(on_it.greatest_turn, 0.25);
  EXPECT_LT(on_it.greatest_jump, 0.003);  // rad/s in 0.02 s: the path's own change of curvature
  const Course beside = follow_from(path, {0, -3, 1.5}, 100, 0.02);
  EXPECT_LT(beside.off_m, 1e-6);
  EXPECT_LT(beside.greatest_rise, 1e-14);
}

// Set-points of depth and heading --------------------------------------------------------------------------------

struct Ride {
  double vertical_rms = 0, lateral_rms = 0, lag_rad = 0, gain = 0;
};

Ride ride(const VehicleModel& model, PlantKind kind, const PathHelmConfig& config, const DepthLoop& loop,
          const Vector3d& current_W = Vector3d::Zero()) {
  const SpacePath path(default_helix, 0, 34);
  const PathFrame start = path.frame_at(0);
  VehicleState state;
  state.X_WB = {Rotation::from_heading(Angle::radians(std::atan2(start.tangent().y(), start.tangent().x()))),
                start.p_W};
  state.v_B.x() = kSpeed;
  const auto plant = make_plant(model, kind, state);
  PathHelm helm(path, config, loop, kSpeed);
  constexpr double kDt = 0.05, kSettle = 40;
  double vertical = 0, lateral = 0, count = 0;
  double cosine_z = 0, sine_z = 0, cosine_path = 0, sine_path = 0;
  for (int i = 0; !helm.finished() && i < 8000; ++i) {
    plant->step(helm.step(plant->state(), kDt), {model.reference_density, current_W}, kDt);
    if (i * kDt < kSettle) continue;
    const PathFrame& target = helm.target();
    const Vector3d p = plant->state().X_WB.translation, off = p - target.p_W;
    const Vector2d ahead = target.tangent().head<2>().normalized();
    const double across = ahead.x() * off.y() - ahead.y() * off.x();
    vertical += off.z() * off.z();
    lateral += across * across;
    ++count;
    const double phase = target.p_W.x() / 6;
    cosine_z += std::cos(phase) * (p.z() - 10);
    sine_z += std::sin(phase) * (p.z() - 10);
    cosine_path += std::cos(phase) * (target.p_W.z() - 10);
    sine_path += std::sin(phase) * (target.p_W.z() - 10);
  }
  EXPECT_TRUE(helm.finished());
  return {std::sqrt(vertical / count), std::sqrt(lateral / count),
          std::remainder(std::atan2(sine_z, cosine_z) - std::atan2(sine_path, cosine_path), 2 * pi),
          std::hypot(cosine_z, sine_z) / std::hypot(cosine_path, sine_path)};
}

constexpr double kPeriod = 42.57 / kSpeed;  // s, of a turn of the helix

// ledger: S5-53
TEST(PathHelm, KeepsTheHelixByDepthAndHeadingAlone) {
  const VehicleModel model = test::remus();
  const Ride dynamic = ride(model, PlantKind::kDynamic, {}, measured_depth_loop(model, kSpeed, kPeriod));
  EXPECT_LT(dynamic.vertical_rms, 0.5);
  EXPECT_LT(dynamic.lateral_rms, 0.1);
  PathHelmConfig at_once;
  at_once.heading_lag_s = 0;
  const Ride kinematic = ride(model, PlantKind::kKinematic, at_once, {});
  EXPECT_LT(kinematic.vertical_rms, 0.05);
  EXPECT_LT(kinematic.lateral_rms, 0.05);
}

// ledger: S5-54
TEST(PathHelm, ShapingByTheInverseOfTheDepthLoopTakesMostOfTheLagAway) {
  const VehicleModel model = test::remus();
  const DepthLoop loop = measured_depth_loop(model, kSpeed, kPeriod);
  PathHelmConfig plain;
  plain.shape_depth = false;
  const Ride without = ride(model, PlantKind::kDynamic, plain, loop), with = ride(model, PlantKind::kDynamic, {}, loop);
  EXPECT_GT(without.lag_rad, Angle::degrees(45).radians());
  EXPECT_LT(std::abs(with.lag_rad), 0.5 * without.lag_rad);
  EXPECT_GT(with.gain, without.gain);
  EXPECT_LT(with.vertical_rms, 0.5 * without.vertical_rms);
}

// A steady current across is steered against. ledger: S5-53
TEST(PathHelm, HoldsTheHelixInACurrent) {
  const VehicleModel model = test::remus();
  const Ride ridden = ride(model, PlantKind::kDynamic, {}, measured_depth_loop(model, kSpeed, kPeriod), {0, 0.3, 0});
  EXPECT_LT(ridden.lateral_rms, 0.4);
  EXPECT_LT(ridden.vertical_rms, 0.7);
}

// A loop that is known, sampled, with an offset and noise on the depth. ledger: S5-54
TEST(DepthLoop, IsIdentifiedFromARecord) {
  for (const double noise : {0.0, 0.02}) {
    Random random(3);
    constexpr double kDt = 0.05, kLag = 5, kLag2 = 9;
    std::vector<double> asked, depth;
    double z = 10, rate = 0;
    for (int i = 0; i < 6000; ++i) {
      const double wanted = 10 + std::sin(0.2 * i * kDt) + 0.5 * std::sin(0.45 * i * kDt);
      asked.push_back(wanted);
      depth.push_back(z + 0.15 + noise * random.normal());
      for (int k = 0; k < 10; ++k) {
        rate += kDt / 10 * (wanted - z - kLag * rate) / kLag2;
        z += kDt / 10 * rate;
      }
    }
    const DepthLoop loop = identify_depth_loop(asked, depth, kDt);
    EXPECT_NEAR(loop.lag_s, kLag, noise > 0 ? 0.2 : 0.05);
    EXPECT_NEAR(loop.lag2_s2, kLag2, noise > 0 ? 0.6 : 0.2);
  }
}

TEST(DepthLoop, IsNotGuessedFromARecordThatStandsStill) {
  const std::vector<double> still(100, 5.0), few(5, 1.0);
  EXPECT_THROW(identify_depth_loop(still, still, 0.1), Error);
  EXPECT_THROW(identify_depth_loop(few, few, 0.1), Error);
}

TEST(PathHelm, StepsWithoutAllocating) {
  const SpacePath path(default_helix, 0, 6);
  PathHelm helm(path, {}, {6, 12}, kSpeed);
  const VehicleState state = test::at_speed(kSpeed);
  helm.step(state, 0.05);
  const auto before = test::allocations();
  for (int i = 0; i < 20; ++i) helm.step(state, 0.05);
  EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace isobath
