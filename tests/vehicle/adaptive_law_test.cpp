// The adaptive law against equations of motion that are written apart from it, and against its own theorem.
#include <gtest/gtest.h>
#include <isobath/vehicle/adaptive_law.hpp>
#include <tests/support/count_allocations.hpp>
#include <tests/vehicle/fossen.hpp>

namespace isobath::adaptive_law_test {
namespace {

Eigen::Matrix3d random_attitude(Random& random) {
  return Rotation::exp({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-3, 3)}).matrix();
}

const std::vector<VehicleModel>& vehicles() {
  static const std::vector<VehicleModel> all = {test::remus(), test::rov(), test::six_thrusters()};
  return all;
}

// With nu_r = nu, Y theta is the wrench that gives the acceleration nu_r'. ledger: S7-07
TEST(AdaptiveLaw, ItsRegressorIsTheEquationOfMotion) {
  Random random(1);
  for (const VehicleModel& model : vehicles()) {
    const AdaptiveLaw law(model);
    const Matrix6 M = rigid_body_mass(model) + model.added_mass;
    for (int i = 0; i < 100; ++i) {
      const Eigen::Matrix3d R_WB = random_attitude(random);
      const ReferenceMotion motion{test::random_velocity(random), test::random_velocity(random)};
      const Vector6 wrench =
          law.regressor(motion, motion.velocity, R_WB) * plant_parameters(model) + law.known(motion, motion.velocity);
      const Vector6 needed =
          M * motion.acceleration - test::fossen_force(model, R_WB, motion.velocity, Vector6::Zero());
      EXPECT_LT((wrench - needed).norm(), 1e-9 * (1 + needed.norm()));
    }
  }
}

// A force of the world turns with the hull, a moment of yaw does not.
TEST(AdaptiveLaw, TakesForcesOfTheWorldAndAMomentOfYaw) {
  const AdaptiveLaw law(test::rov());
  const Eigen::Matrix3d R_WB = Rotation::from_heading(Angle::degrees(90)).matrix();
  ParameterVector theta = ParameterVector::Zero();
  theta(kForce) = 3;  // to the north, on a hull that heads east: to port
  theta(kYaw) = 2;
  Vector6 against;
  against << 0, 3, 0, 0, 0, -2;
  EXPECT_LT((law.regressor({}, Vector6::Zero(), R_WB) * theta - against).norm(), 1e-12);
}

/// Plant, attitude and estimates in one system of equations: nothing is sampled.
struct ClosedLoop {
  struct State {
    Eigen::Vector4d q;  ///< x, y, z, w
    Vector6 nu, sum;    ///< sum: integral of nu - nu_d
    ParameterVector theta;

    [[nodiscard]] State moved(const State& rate, double dt) const {
      return {q + dt * rate.q, nu + dt * rate.nu, sum + dt * rate.sum, theta + dt * rate.theta};
    }
  };
  static constexpr double kLambda = 0.8;

  explicit ClosedLoop(const VehicleModel& plant)
      : model(plant), law(plant), M(rigid_body_mass(plant) + plant.added_mass), inverse(M.inverse()) {}

  /// What the velocity is to be, with its derivative: all axes, with several frequencies.
  static ReferenceMotion wanted(double t) {
    ReferenceMotion out;
    for (int i = 0; i < 6; ++i) {
      const double w = 0.5 + 0.17 * i, size = i < 3 ? 0.5 : 0.2;
      out.velocity(i) = size * std::sin(w * t + i);
      out.acceleration(i) = size * w * std::cos(w * t + i);
    }
    return out;
  }
  [[nodiscard]] ReferenceMotion reference(double t, const State& x) const {
    ReferenceMotion r = wanted(t);
    r.acceleration -= kLambda * (x.nu - r.velocity);
    r.velocity -= kLambda * x.sum;
    return r;
  }
  State rate(double t, const State& x) {
    const Eigen::Matrix3d R_WB = Eigen::Quaterniond(x.q).normalized().toRotationMatrix();
    const ReferenceMotion r = reference(t, x);
    const Vector6 s = x.nu - r.velocity;
    const Regressor Y = law.regressor(r, x.nu, R_WB);
    law.set_theta(x.theta);
    const Vector6 tau = law.wrench(Y, law.known(r, x.nu), s);
    const Eigen::Vector3d w = x.nu.tail<3>(), v = x.q.head<3>();
    State out;
    out.q << 0.5 * (x.q(3) * w + v.cross(w)), -0.5 * v.dot(w);
    out.nu = inverse * test::fossen_force(model, R_WB, x.nu, tau);
    out.sum = x.nu - wanted(t).velocity;
    out.theta = law.rate(Y, s);
    return out;
  }
  State step(double t, const State& x, double dt) {
    const State k1 = rate(t, x), k2 = rate(t + dt / 2, x.moved(k1, dt / 2));
    const State k3 = rate(t + dt / 2, x.moved(k2, dt / 2)), k4 = rate(t + dt, x.moved(k3, dt));
    return x.moved(k1, dt / 6).moved(k2, dt / 3).moved(k3, dt / 3).moved(k4, dt / 6);
  }
  [[nodiscard]] double lyapunov(double t, const State& x) const {
    const Vector6 s = x.nu - reference(t, x).velocity;
    const ParameterVector off = x.theta - plant_parameters(model);
    return 0.5 * (s.dot(M * s) + off.dot(off.cwiseQuotient(law.gains())));
  }

  VehicleModel model;
  AdaptiveLaw law;
  Matrix6 M, inverse;
};

// From zero estimates, V never rises, and the tracking error goes to zero: box, box with lift, torpedo with coupled
// masses, all six axes with forces at will. ledger: S7-07
TEST(AdaptiveLaw, LyapunovValueNeverRisesAndTheErrorVanishes) {
  for (VehicleModel model : vehicles()) {
    AutopilotConfig& c = model.autopilot;
    c.force_bandwidth = c.attitude_bandwidth = c.heading_bandwidth = 4;
    ClosedLoop loop(model);
    ClosedLoop::State x{{0, 0, 0, 1}, Vector6::Zero(), Vector6::Zero(), ParameterVector::Zero()};
    constexpr double kDt = 0.005, kSeconds = 300;
    const double first = loop.lyapunov(0, x);
    double before = first, rise = 0, early = 0, late = 0;
    for (int i = 0; i * kDt < kSeconds; ++i) {
      const double t = i * kDt;
      x = loop.step(t, x, kDt);
      const double now = loop.lyapunov(t + kDt, x);
      rise = std::max(rise, now - before);
      before = now;
      const double error = (x.nu - ClosedLoop::wanted(t + kDt).velocity).norm();
      if (t < 10) early = std::max(early, error);
      if (t > kSeconds - 10) late = std::max(late, error);
    }
    EXPECT_LT(rise, 1e-9 * first) << model.name;
    EXPECT_LT(before, first) << model.name;
    EXPECT_LT(late, 0.2 * early) << model.name << ": " << early << " m/s, later " << late;
  }
}

// ledger: S7-10
TEST(AdaptiveLaw, EstimatesStayWithinTheirRangeWhateverIsMeasured) {
  Random random(2);
  for (const VehicleModel& model : vehicles()) {
    AdaptiveLaw law(model);
    const ParameterRange range = parameter_range(model);
    const ParameterVector file = plant_parameters(model);
    EXPECT_TRUE((file.array() >= range.low.array() - 1e-12).all());
    EXPECT_TRUE((file.array() <= range.high.array() + 1e-12).all());
    for (int i = 0; i < 20000; ++i) {
      const ReferenceMotion motion{test::random_velocity(random, 3), test::random_velocity(random, 3)};
      const Vector6 velocity = test::random_velocity(random, 3);
      law.adapt(law.regressor(motion, velocity, random_attitude(random)), velocity - motion.velocity, 0.1);
      ASSERT_TRUE((law.theta().array() >= range.low.array()).all());
      ASSERT_TRUE((law.theta().array() <= range.high.array()).all());
    }
    const ParameterVector kept = law.theta();
    Vector6 bad = Vector6::Zero();
    bad(2) = std::numeric_limits<double>::quiet_NaN();
    law.adapt(law.regressor({}, Vector6::Zero(), Eigen::Matrix3d::Identity()), bad, 0.1);
    EXPECT_EQ(law.theta(), kept) << "a measurement that is not a number";
  }
}

// An axis that is left out learns nothing; without motion the estimates return to the file. ledger: S7-10
TEST(AdaptiveLaw, LearnsOnlyWhereItIsToldAndForgetsMassAndDrag) {
  const VehicleModel model = test::rov();
  AdaptiveLaw law(model);
  const ParameterVector file = plant_parameters(model);
  ReferenceMotion motion;
  motion.velocity(0) = motion.acceleration(0) = 0.5;
  Vector6 s = Vector6::Zero();
  s(0) = -0.1;
  for (int i = 0; i < 50; ++i) law.adapt(law.regressor(motion, motion.velocity, Eigen::Matrix3d::Identity()), s, 0.02);
  EXPECT_GT(law.theta()(kMasses), file(kMasses) + 0.01);
  EXPECT_GT(law.theta()(kLinearDrag), file(kLinearDrag) + 0.01);
  EXPECT_LT(law.theta()(kForce), -0.1);
  for (const int still : {kMasses + 1, kMasses + 2, kLinearDrag + 1, kForce + 1, kForce + 2, int{kYaw}}) {
    EXPECT_EQ(law.theta()(still), file(still)) << still;
  }
  const double force = law.theta()(kForce);
  for (int i = 0; i < 200000; ++i) {
    law.adapt(law.regressor({}, Vector6::Zero(), Eigen::Matrix3d::Identity()), Vector6::Zero(), 0.02);
  }
  EXPECT_NEAR(law.theta()(kMasses), file(kMasses), 1e-3);
  EXPECT_EQ(law.theta()(kForce), force);
}

TEST(AdaptiveLaw, AllocatesNothing) {
  AdaptiveLaw law(test::rov());
  const auto before = test::allocations();
  const ReferenceMotion motion{Vector6::Ones(), Vector6::Ones()};
  const Regressor Y = law.regressor(motion, Vector6::Ones(), Eigen::Matrix3d::Identity());
  law.adapt(Y, Vector6::Ones(), 0.02);
  EXPECT_TRUE(law.wrench(Y, law.known(motion, Vector6::Ones()), Vector6::Ones()).allFinite());
  EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace isobath::adaptive_law_test
