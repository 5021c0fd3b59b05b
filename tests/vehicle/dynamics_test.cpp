// The equations of motion against closed forms and conservation laws.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/vehicle/dynamics.hpp>
#include <tests/support/count_allocations.hpp>
#include <tests/vehicle/models.hpp>

namespace isobath {
namespace {

using test::frictionless;
using test::random_velocity;

ActuatorVector none() { return ActuatorVector::Zero(0); }

Vector6 velocity_of(const VehicleState& s) {
  Vector6 v;
  v << s.v_B, s.w_B;
  return v;
}

// Acceleration by a step that is short against everything.
Vector6 acceleration(const VehicleModel& model, const VehicleState& state, const WaterConditions& water = {}) {
  constexpr double kDt = 1e-6;
  VehicleDynamics dynamics(model, state);
  dynamics.step(ActuatorVector::Zero(model.actuators()), water, kDt);
  return (velocity_of(dynamics.state()) - velocity_of(state)) / kDt;
}

// ledger: S7-01
TEST(Dynamics, KeepsEnergyAndMomentumWithoutForces) {
  const VehicleModel model = frictionless(test::remus());
  WaterConditions water;
  water.density = model.reference_density;
  VehicleState start;
  start.v_B = {1.0, 0.3, -0.2};
  start.w_B = {0.4, 0.3, -0.5};
  VehicleDynamics dynamics(model, start);
  const Matrix6 M = mass_matrix(model, water.density);
  const auto kinetic_energy = [&] {
    const Vector6 v = velocity_of(dynamics.state());
    return 0.5 * v.dot(M * v);
  };
  const double energy = kinetic_energy();
  const auto impulse = [&] {  // of body and water, components in W: constant by Kirchhoff's equations
    return Eigen::Vector3d(dynamics.state().X_WB.rotation * (M * velocity_of(dynamics.state())).head<3>());
  };
  const Eigen::Vector3d before = impulse();
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    dynamics.step(none(), water, 0.005);
    worst = std::max(worst, std::abs(kinetic_energy() / energy - 1));
  }
  EXPECT_LT(worst, 1e-9);
  EXPECT_LT((impulse() - before).norm() / before.norm(), 1e-8);
  EXPECT_NEAR(dynamics.state().X_WB.rotation.quaternion().norm(), 1, 1e-15);
}

// Halving the step divides the error by sixteen. ledger: S7-01
TEST(Dynamics, IsOfFourthOrder) {
  const VehicleModel model = test::remus();
  const auto end_of = [&](int steps) {
    VehicleDynamics dynamics(model, test::at_speed(1.5));
    ActuatorVector commands(5);
    commands << 5, 0.2, 0.2, 0.1, 0.1;
    // A steady current takes part; lag included.
    const WaterConditions water{1030, {0.3, -0.2, 0.1}};
    for (int i = 0; i < steps; ++i) dynamics.step(commands, water, 4.0 / steps);
    return dynamics.state().X_WB.translation;
  };
  const Eigen::Vector3d exact = end_of(3200);
  const double order = std::log2((end_of(100) - exact).norm() / (end_of(200) - exact).norm());
  EXPECT_NEAR(order, 4, 0.3);
}

// Newton's law for a body that rotates about its centre of gravity off B: no force, no acceleration of G. ledger: S7-02
TEST(Dynamics, CentreOfGravityMovesStraightInVacuum) {
  VehicleModel model = frictionless(test::rov());
  model.added_mass.setZero();
  model.p_BG = {0.2, 0.05, 0.1};  // and the centre of buoyancy with it
  model.p_BC = model.p_BG;
  model.inertia_B = Eigen::Vector3d(0.9, 1.2, 1.3).asDiagonal();
  VehicleState start;
  start.v_B = {0.5, -0.2, 0.1};
  start.w_B = {0.7, -0.4, 0.9};
  VehicleDynamics dynamics(model, start);
  const auto centre = [&] { return Eigen::Vector3d(dynamics.state().X_WB * model.p_BG); };
  const Eigen::Vector3d from = centre(), v_WG = start.v_B + start.w_B.cross(model.p_BG);
  for (int i = 0; i < 2000; ++i) dynamics.step(none(), {model.reference_density, {0, 0, 0}}, 0.005);
  EXPECT_LT((centre() - (from + 10 * v_WG)).norm(), 1e-7);
}

// In pitch (Z_w - X_u added mass) u w turns the slender body across the flow. ledger: S7-02
TEST(Dynamics, MunkMomentFollowsFromAddedMass) {
  VehicleModel model = frictionless(test::remus());
  model.added_mass = Vector6(model.added_mass.diagonal()).asDiagonal();  // no cross terms in the closed form
  VehicleState state;
  state.v_B = {1.5, 0, 0.2};
  const Matrix6 M = mass_matrix(model, model.reference_density);
  WaterConditions water;
  water.density = model.reference_density;
  const double moment = (M * acceleration(model, state, water))(4);
  EXPECT_NEAR(moment, (35.5 - 0.93) * 1.5 * 0.2, 1e-5);
  EXPECT_GT(moment, 0);  // water from below lifts the nose further
}

// ledger: S7-03
TEST(Dynamics, DampingTakesEnergy) {
  Random random(2);
  for (const VehicleModel& vehicle : {test::remus(), test::rov()}) {
    VehicleModel model = frictionless(vehicle);
    model.linear_damping = vehicle.linear_damping;
    model.lift_damping = vehicle.lift_damping;
    model.quadratic_damping = vehicle.quadratic_damping;
    WaterConditions water;
    water.density = model.reference_density;
    const Matrix6 M = mass_matrix(model, water.density);
    for (int i = 0; i < 2000; ++i) {
      const Vector6 v = random_velocity(random, 3);
      VehicleState state;
      state.v_B = v.head<3>();
      state.w_B = v.tail<3>();
      EXPECT_LE(v.dot(M * acceleration(model, state, water)), 0);
    }
  }
}

// ledger: S7-03
TEST(Dynamics, TerminalSpeedIsTheRootOfTheDrag) {
  VehicleModel model = frictionless(test::rov());
  const double linear = 13.7, quadratic = 141, thrust = 25;
  model.linear_damping(0, 0) = linear;
  model.quadratic_damping(0, 0) = quadratic;
  VehicleDynamics dynamics(model);
  Vector6 push = Vector6::Zero();
  push(0) = thrust;
  for (int i = 0; i < 4000; ++i) dynamics.step(none(), {model.reference_density, {0, 0, 0}}, 0.01, push);
  const double expected = (-linear + std::sqrt(linear * linear + 4 * quadratic * thrust)) / (2 * quadratic);
  EXPECT_NEAR(dynamics.state().v_B.x(), expected, 1e-9);
}

// ledger: S7-04
TEST(Dynamics, RollsWithTheLinearisedPeriod) {
  VehicleModel model = frictionless(test::rov());
  model.p_BC.z() = -0.01;
  VehicleState start;
  start.X_WB.rotation = Rotation::from_heading_pitch_roll({}, {}, Angle::degrees(1));
  VehicleDynamics dynamics(model, start);
  // Without roll rate and side force, B swings about itself: I phi'' = -0.01 B phi.
  const double inertia = 0.26 + 0.189;
  const double expected = 2 * std::numbers::pi * std::sqrt(inertia / (0.01 * model.mass * kGravity));
  double previous = 1, first = -1, last = -1;
  int crossings = 0;
  constexpr double kDt = 0.005;
  for (int i = 1; i * kDt < 30; ++i) {
    dynamics.step(none(), {model.reference_density, {0, 0, 0}}, kDt);
    const double roll = dynamics.state().X_WB.rotation.roll().radians();
    if (previous > 0 && roll <= 0) {
      last = (i - roll / (roll - previous)) * kDt;
      if (crossings++ == 0) first = last;
    }
    previous = roll;
  }
  EXPECT_NEAR((last - first) / (crossings - 1), expected, 1e-3 * expected);
}

// ledger: S7-04
TEST(Dynamics, TurnsUprightOnlyWithBuoyancyAboveGravity) {
  for (const double height : {-0.05, 0.05}) {  // z of the centre of buoyancy
    VehicleModel model = test::rov();
    model.p_BC.z() = height;
    VehicleState start;
    start.X_WB.rotation = Rotation::from_heading_pitch_roll({}, {}, Angle::degrees(20));
    VehicleDynamics dynamics(model, start);
    for (int i = 0; i < 3000; ++i) dynamics.step(ActuatorVector::Zero(8), {}, 0.02);
    EXPECT_NEAR(std::abs(dynamics.state().X_WB.rotation.roll().degrees()), height < 0 ? 0 : 180, 1);
  }
}

// ledger: S7-05
TEST(Dynamics, SteadyCurrentCarriesThePassiveVehicle) {
  const WaterConditions water{1030, {0.4, -0.3, 0.05}};
  VehicleModel model = test::remus();
  model.volume = model.mass / water.density;
  VehicleDynamics dynamics(model);
  for (int i = 0; i < 20000; ++i) dynamics.step(ActuatorVector::Zero(5), water, 0.05);
  const Eigen::Vector3d v_WB = dynamics.state().X_WB.rotation * dynamics.state().v_B;
  EXPECT_LT((v_WB - water.current_W).norm(), 0.005);  // quadratic drag: the rest dies away as 1 / t
}

// A vehicle that turns in a steady current moves as in still water, plus the drift: Galileo's principle, with the
// velocity over ground formulated separately. ledger: S7-05
TEST(Dynamics, SteadyCurrentAddsADriftAndNothingElse) {
  const VehicleModel model = test::remus();
  const Eigen::Vector3d current(0.3, 0.5, -0.1);
  VehicleDynamics still(model, test::at_speed(1.5));
  VehicleState start = test::at_speed(1.5);
  start.v_B += current;
  VehicleDynamics carried(model, start);
  ActuatorVector commands(5);
  commands << 4, 0.2, 0.2, 0.05, 0.05;
  for (int i = 0; i < 1000; ++i) {
    still.step(commands, {1030, {0, 0, 0}}, 0.02);
    carried.step(commands, {1030, current}, 0.02);
  }
  const Eigen::Vector3d drift = carried.state().X_WB.translation - still.state().X_WB.translation;
  EXPECT_LT((drift - 20 * current).norm(), 1e-9);
  EXPECT_NEAR((carried.state().w_B - still.state().w_B).norm(), 0, 1e-12);
}

// M_RB nu' + M_A nu_r' + C_RB(nu) nu + C_A(nu_r) nu_r = damping(nu_r), d(current_B)/dt = -w x current_B. ledger: S7-05
TEST(Dynamics, AgreesWithTheEquationForVelocityOverGround) {
  VehicleModel model = test::remus();
  model.p_BG.setZero();
  model.volume = model.mass / model.reference_density;
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    VehicleState state;
    state.X_WB.rotation = Rotation::exp({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
    const Vector6 v = random_velocity(random);
    state.v_B = v.head<3>();
    state.w_B = v.tail<3>();
    const WaterConditions water{model.reference_density, {0.5, -0.4, 0.2}};
    const Eigen::Vector3d current_B = state.X_WB.rotation.inverse() * water.current_W;
    Vector6 current = Vector6::Zero(), rate = Vector6::Zero();
    current.head<3>() = current_B;
    rate.head<3>() = -state.w_B.cross(current_B);
    const Vector6 relative = v - current;
    const Matrix6 body = rigid_body_mass(model), added = model.added_mass;
    const Vector6 tau = test::damping_wrench(model, relative) - test::coriolis(body, v) * v -
                        test::coriolis(added, relative) * relative + added * rate;
    const Vector6 expected = (body + added).inverse() * tau;
    EXPECT_LT((acceleration(model, state, water) - expected).norm(), 1e-4 * (1 + expected.norm()));
  }
}

// ledger: S7-05
TEST(Dynamics, DenserWaterLiftsByArchimedes) {
  const VehicleModel model = test::rov();
  const double denser = 1.03 * model.reference_density;
  const auto heave = [&](double density) { return acceleration(model, {}, {density, {0, 0, 0}})(2); };
  const auto expected = [&](double density) {
    const double mass = model.mass + density / model.reference_density * 18.68;
    return (13.5 - density * 0.0134) * kGravity / mass;
  };
  EXPECT_NEAR(heave(model.reference_density), expected(model.reference_density), 1e-6);
  EXPECT_NEAR(heave(denser), expected(denser), 1e-6);
  EXPECT_LT(heave(denser), 0);
}

// ledger: S7-06
TEST(Actuators, FollowAStepAsAFirstOrderLag) {
  VehicleModel model = test::rov();
  model.thrusters[0].time_constant = 0.4;
  model.thrusters[1].time_constant = 0;
  VehicleDynamics dynamics(model);
  ActuatorVector commands = ActuatorVector::Zero(8);
  commands(0) = 10;
  commands(1) = -10;
  for (int i = 1; i <= 100; ++i) {
    dynamics.step(commands, {}, 0.02);
    EXPECT_NEAR(dynamics.actuators()(0), 10 * (1 - std::exp(-0.02 * i / 0.4)), 1e-12);
    EXPECT_EQ(dynamics.actuators()(1), -10);
  }
}

// ledger: S7-06
TEST(Actuators, SaturateAndHaveADeadZone) {
  VehicleModel model = test::remus();
  for (Thruster& t : model.thrusters) t.time_constant = 0;
  for (Fin& f : model.fins) f.time_constant = 0;
  model.fins[0].dead_zone = Angle::degrees(1);
  VehicleDynamics dynamics(model);
  ActuatorVector commands(5);
  commands << 100, Angle::degrees(0.9).radians(), 1, -1, 0;
  dynamics.step(commands, {}, 0.01);
  EXPECT_EQ(dynamics.actuators()(0), 10.2);
  EXPECT_EQ(dynamics.actuators()(1), 0);
  EXPECT_NEAR(dynamics.actuators()(2), Angle::degrees(20).radians(), 1e-15);
  EXPECT_NEAR(dynamics.actuators()(3), -Angle::degrees(20).radians(), 1e-15);
  commands(0) = 0.04;
  dynamics.step(commands, {}, 0.01);
  EXPECT_EQ(dynamics.actuators()(0), 0);
  commands(0) = -100;
  dynamics.step(commands, {}, 0.01);
  EXPECT_EQ(dynamics.actuators()(0), -3);
}

// ledger: S7-06
TEST(Actuators, LostThrusterPushesNothing) {
  VehicleModel model = frictionless(test::rov());
  model.thrusters = test::rov().thrusters;
  for (Thruster& t : model.thrusters) t.time_constant = 0;
  const auto surge = [&](double effectiveness) {
    VehicleDynamics dynamics(model);
    dynamics.set_effectiveness(0, effectiveness);
    ActuatorVector commands = ActuatorVector::Zero(8);
    commands(0) = 10;
    dynamics.step(commands, {1000, {0, 0, 0}}, 1e-4);
    return dynamics.state().v_B.x() * (13.5 + 6.36) / 1e-4;
  };
  EXPECT_NEAR(surge(1), 10 / std::sqrt(2), 1e-4);
  EXPECT_NEAR(surge(0.5), 5 / std::sqrt(2), 1e-4);
  EXPECT_EQ(surge(0), 0);
}

// The published thruster map of the vehicle: von Benzon 2022, heavy configuration. ledger: S7-06 S7-13
TEST(Allocation, MakesAnyReachableWrench) {
  const Allocator allocator(test::rov());
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    Vector6 demand = random_velocity(random, 20);
    demand.tail<3>() *= 0.1;
    const Allocation a = allocator.allocate(demand, 0, 1000);
    ASSERT_EQ(a.scale, 1);
    EXPECT_LT((a.achieved_B - demand).norm(), 1e-9);
    // Forces of the published matrix, row by row.
    const ActuatorVector& t = a.commands;
    EXPECT_NEAR(std::sqrt(0.5) * (t(0) + t(1) - t(2) - t(3)), demand(0), 1e-9);
    EXPECT_NEAR(std::sqrt(0.5) * (-t(0) + t(1) - t(2) + t(3)), demand(1), 1e-9);
    EXPECT_NEAR(-t(4) - t(5) - t(6) - t(7), demand(2), 1e-9);
    EXPECT_NEAR(0.218 * (t(4) + t(5) - t(6) - t(7)), demand(3), 1e-9);
    EXPECT_NEAR(0.12 * (t(4) - t(5) + t(6) - t(7)), demand(4), 1e-9);
    EXPECT_NEAR(0.267 * std::sqrt(0.5) * (-t(0) + t(1) + t(2) - t(3)), demand(5), 1e-9);
  }
}

// ledger: S7-06
TEST(Allocation, OutOfReachKeepsTheDirection) {
  const Allocator allocator(test::rov());
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const Vector6 demand = random_velocity(random, 500);
    const Allocation a = allocator.allocate(demand, 0, 1000);
    ASSERT_LT(a.scale, 1);
    EXPECT_LT((a.achieved_B - a.scale * demand).norm(), 1e-9 * demand.norm());
    EXPECT_NEAR(a.commands.cwiseAbs().maxCoeff(), 40, 1e-9);
  }
}

// ledger: S7-06
TEST(Allocation, KnowsALostThruster) {
  ActuatorVector works = ActuatorVector::Ones(8);
  works(2) = 0;
  const Allocator allocator(test::rov(), works);
  Vector6 demand;
  demand << 10, 4, -5, 0.3, -0.2, 1;
  const Allocation a = allocator.allocate(demand, 0, 1000);
  EXPECT_LT((a.achieved_B - demand).norm(), 1e-9);  // seven still span all six axes
  EXPECT_NEAR(a.commands(2), 0, 1e-12);
}

// N = N_uudr u^2 delta, M = M_uuds u^2 delta (Prestero 2001). ledger: S7-06
TEST(Allocation, SteersByFins) {
  const Allocator allocator(test::remus());
  Vector6 demand = Vector6::Zero();
  demand << 3, 0, 0, 0, 1, -2;
  const Allocation a = allocator.allocate(demand, 1.5, 1030);
  EXPECT_NEAR(a.commands(0), 3, 1e-9);
  for (int rudder : {1, 2}) EXPECT_NEAR(a.commands(rudder), 2 / (6.15 * 2.25), 1e-4);
  for (int plane : {3, 4}) EXPECT_NEAR(a.commands(plane), -1 / (6.15 * 2.25), 1e-4);
  EXPECT_NEAR(allocator.allocate(demand, 3.0, 1030).commands(1), a.commands(1) / 4, 1e-12);
  demand(5) = -20;
  const Allocation most = allocator.allocate(demand, 1.5, 1030);
  EXPECT_NEAR(most.commands(1), Angle::degrees(20).radians(), 1e-12);
  EXPECT_EQ(most.commands(3), a.commands(3));  // the other pair does not suffer
}

TEST(Dynamics, AllocatesNothing) {
  VehicleDynamics dynamics(test::remus(), test::at_speed(1.5));
  const ActuatorVector commands = ActuatorVector::Zero(5);
  const auto before = test::allocations();
  for (int i = 0; i < 10; ++i) dynamics.step(commands, {1025.0 + i, {0.1, 0, 0}}, 0.01 * (1 + i % 2));
  EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace isobath
