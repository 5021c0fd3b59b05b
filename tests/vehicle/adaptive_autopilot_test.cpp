// Control by model and adaptive control of whole vehicles, beside PID.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/vehicle/adaptive_autopilot.hpp>
#include <isobath/vehicle/guidance.hpp>
#include <isobath/vehicle/plant.hpp>
#include <tests/support/count_allocations.hpp>
#include <tests/vehicle/models.hpp>

namespace isobath::adaptive_autopilot_test {
namespace {

constexpr double kDt = 0.02;
const WaterConditions kFresh{1000, {0, 0, 0}};

VehicleModel under(ControlKind control, VehicleModel model) {
  model.autopilot.control = control;
  return model;
}

const AdaptiveAutopilot& adaptive(DynamicVehicle& vehicle) {
  return dynamic_cast<const AdaptiveAutopilot&>(vehicle.autopilot());
}

struct DepthErrors {
  double peak = 0, last = 0;
};

/// Ten newtons more buoyancy after 10 s at rest; the error of the depth in the 40 s after it.
DepthErrors after_buoyancy(const VehicleModel& model, double newtons) {
  DynamicVehicle vehicle(model, test::at_speed(0, 5));
  const Setpoint still{Angle(), 5, 0, 0};
  DepthErrors out;
  for (int i = 0; i < 2500; ++i) {
    if (i == 500) vehicle.dynamics().set_model(different_plant(model, {.buoyancy = newtons}));
    vehicle.step(still, kFresh, kDt);
    out.last = std::abs(vehicle.state().X_WB.translation.z() - 5);
    if (i > 500) out.peak = std::max(out.peak, out.last);
  }
  return out;
}

// ArduSub's own test allows 0.3 m. ledger: S7-08 S7-11
TEST(AdaptiveAutopilot, HoldsDepthAgainstTenNewtons) {
  for (const VehicleModel& box : {test::six_thrusters(), test::rov()}) {
    for (const double newtons : {-10.0, 10.0}) {
      const DepthErrors learnt = after_buoyancy(under(ControlKind::kAdaptive, box), newtons);
      EXPECT_LT(learnt.peak, 0.1) << box.name;
      EXPECT_LT(learnt.last, 0.005) << box.name;
      const DepthErrors fixed = after_buoyancy(under(ControlKind::kModel, box), newtons);
      EXPECT_GT(fixed.last, 0.08) << box.name << ": the fixed model keeps the error";
      const DepthErrors pid = after_buoyancy(under(ControlKind::kPid, box), newtons);
      EXPECT_GT(pid.peak, learnt.peak) << box.name;
    }
  }
}

// ledger: S7-09 S7-11
TEST(AdaptiveAutopilot, HoldsItsPlaceWhenACurrentSetsIn) {
  const auto farthest = [](ControlKind control) {
    DynamicVehicle vehicle(under(control, test::six_thrusters()), test::at_speed(0, 5));
    StationKeeper keeper({}, parameters_of(test::six_thrusters()));
    keeper.hold({0, 0, 5, 0.5}, Angle());
    double most = 0;
    for (int i = 0; i < 600; ++i) {
      const VehicleState& s = vehicle.state();
      const Setpoint setpoint = keeper.step(s.X_WB, s.X_WB.rotation * s.v_B, 0.1);
      vehicle.step(setpoint, {1000, i < 100 ? Eigen::Vector3d::Zero().eval() : Eigen::Vector3d(-0.7, 0.7, 0)}, 0.1);
      most = std::max(most, vehicle.state().X_WB.translation.head<2>().norm());
    }
    return most;
  };
  const double learnt = farthest(ControlKind::kAdaptive);
  EXPECT_LT(learnt, 0.3);
  EXPECT_GT(farthest(ControlKind::kPid), 2 * learnt);
}

// The lag of a set-point is that of PID, which planners take into account.
TEST(AdaptiveAutopilot, FollowsDepthAndHeadingAsPidDoes) {
  const auto at_half = [](ControlKind control) {
    DynamicVehicle vehicle(under(control, test::rov()), test::at_speed(0, 5));
    for (int i = 0; i < 200; ++i) vehicle.step({Angle::degrees(30), 5.5, 0, 0}, kFresh, kDt);
    return Eigen::Vector2d(vehicle.state().X_WB.translation.z(), vehicle.state().X_WB.rotation.heading().degrees());
  };
  const Eigen::Vector2d pid = at_half(ControlKind::kPid), learnt = at_half(ControlKind::kAdaptive);
  EXPECT_NEAR(learnt.x(), pid.x(), 0.05);
  EXPECT_NEAR(learnt.y(), pid.y(), 3);
}

// Fins and one propeller; depth by pitch. In a current across the hull, too. ledger: S7-06 S7-07
TEST(AdaptiveAutopilot, SteersAndDivesATorpedo) {
  for (const double across : {0.0, 0.4}) {
    for (const double share : {0.6, 1.0, 1.5}) {  // of the mass and the drag in the file
      const VehicleModel model = under(ControlKind::kAdaptive, test::remus());
      DynamicVehicle vehicle(model, test::at_speed(1.5), {.mass = share, .drag = share});
      for (int i = 0; i < 6000; ++i) {
        vehicle.step({Angle::degrees(90), 15, 1.5, 0}, {1030, {across, 0, 0}}, kDt);
      }
      EXPECT_NEAR(vehicle.state().X_WB.translation.z(), 15, 0.1) << across << ' ' << share;
      EXPECT_NEAR(vehicle.state().X_WB.rotation.heading().degrees(), 90, 1) << across << ' ' << share;
      EXPECT_NEAR(vehicle.state().v_B.x(), 1.5, 0.03) << across << ' ' << share;
      const ParameterVector& theta = adaptive(vehicle).law().theta();
      const ParameterVector file = plant_parameters(model);
      for (const int axis : {1, 2, 3}) EXPECT_EQ(theta(kLinearDrag + axis), file(kLinearDrag + axis)) << "no actuator";
    }
  }
}

// Six thrusters make no pitch: it is left to the righting moment, and nothing is learnt of it. ledger: S7-06 S7-07
TEST(AdaptiveAutopilot, LeavesPitchToAVehicleWithoutIt) {
  const VehicleModel model = under(ControlKind::kAdaptive, test::six_thrusters());
  DynamicVehicle vehicle(model, test::at_speed(0.8, 5));
  for (int i = 0; i < 4000; ++i) vehicle.step({Angle::degrees(60), 7, 0.8, 0}, {1000, {0.1, 0.2, 0}}, kDt);
  EXPECT_EQ(vehicle.autopilot().demand_B()(4), 0);
  EXPECT_EQ(adaptive(vehicle).s()(4), 0);
  EXPECT_EQ(adaptive(vehicle).law().theta()(kMoment), plant_parameters(model)(kMoment));
  EXPECT_NEAR(vehicle.state().X_WB.translation.z(), 7, 0.02);
  EXPECT_NEAR(vehicle.state().X_WB.rotation.heading().degrees(), 60, 1);
  EXPECT_NEAR(vehicle.state().v_B.x(), 0.8, 0.02);
}

// A demand out of reach for a minute teaches nothing in that axis and leaves nothing to unwind. ledger: S7-06 S7-10
TEST(AdaptiveAutopilot, DoesNotLearnFromThrustersThatFallShort) {
  VehicleModel model = under(ControlKind::kAdaptive, test::rov());
  model.limits.max_speed = 5;
  DynamicVehicle vehicle(model, test::at_speed(0, 5));
  for (int i = 0; i < 1000; ++i) vehicle.step({Angle(), 5, 5, 0}, kFresh, kDt);
  const ParameterVector before = adaptive(vehicle).law().theta();
  for (int i = 0; i < 2000; ++i) vehicle.step({Angle(), 5, 5, 0}, kFresh, kDt);
  EXPECT_LT(vehicle.autopilot().allocation().achieved_B(0), 0.9 * vehicle.autopilot().demand_B()(0));
  EXPECT_EQ(adaptive(vehicle).law().theta()(kForce), before(kForce));
  EXPECT_NEAR(vehicle.state().X_WB.translation.z(), 5, 0.05) << "depth comes before speed";
  double back = 0;
  for (int i = 0; i < 1500; ++i) {
    vehicle.step({Angle(), 5, 0, 0}, kFresh, kDt);
    back = std::min(back, vehicle.state().v_B.x());
  }
  EXPECT_NEAR(vehicle.state().v_B.x(), 0, 0.02);
  EXPECT_GT(back, -0.35);
}

// ledger: S7-10
TEST(AdaptiveAutopilot, EstimatesStayBoundedForAnHourOfNoise) {
  const VehicleModel model = under(ControlKind::kAdaptive, test::six_thrusters());
  const ParameterRange range = parameter_range(model);
  AdaptiveAutopilot autopilot(model);
  VehicleDynamics dynamics(model, test::at_speed(0, 5));
  Random random(3);
  const auto noise = [&](double sigma) {
    return Eigen::Vector3d(sigma * random.normal(), sigma * random.normal(), sigma * random.normal());
  };
  double deepest = 0;
  ParameterVector low = autopilot.law().theta(), high = low;
  constexpr double kLong = 0.04;
  for (int i = 0; i * kLong < 3600; ++i) {
    VehicleState measured = dynamics.state();
    measured.X_WB.translation += noise(0.02);
    measured.X_WB.rotation = measured.X_WB.rotation * Rotation::exp(noise(0.005));
    measured.v_B += noise(0.02);
    measured.w_B += noise(0.005);
    const Setpoint setpoint{Angle::degrees(i / 2000 * 90.0).wrapped(), 5, i / 1000 % 2 == 0 ? 0.5 : 0.0, 0};
    dynamics.step(autopilot.update(setpoint, measured, measured.v_B.x(), kLong), kFresh, kLong);
    low = low.cwiseMin(autopilot.law().theta());
    high = high.cwiseMax(autopilot.law().theta());
    deepest = std::max(deepest, std::abs(dynamics.state().X_WB.translation.z() - 5));
  }
  EXPECT_TRUE((low.array() >= range.low.array()).all());
  EXPECT_TRUE((high.array() <= range.high.array()).all());
  EXPECT_LT(deepest, 0.1);
  // The noise raises masses, but not to their limits of 0.3 and 3 times the file's.
  const ParameterVector file = plant_parameters(model);
  for (const int axis : {0, 1, 2, 5}) EXPECT_NEAR(autopilot.law().theta()(axis), file(axis), 0.8 * file(axis)) << axis;
}

// ledger: S7-08 S7-17
TEST(PlantDifference, ChangesWhatItSays) {
  const VehicleModel file = test::rov();
  const VehicleModel plant = different_plant(file, {.mass = 1.5, .drag = 1.6, .buoyancy = 10});
  EXPECT_EQ(plant.mass, 1.5 * file.mass);
  EXPECT_EQ(plant.added_mass, 1.5 * file.added_mass);
  EXPECT_EQ(plant.quadratic_damping, 1.6 * file.quadratic_damping);
  const auto net = [](const VehicleModel& m) { return kGravity * (m.mass - m.reference_density * m.volume); };
  EXPECT_NEAR(net(plant), net(file) - 10, 1e-9);
  EXPECT_EQ(different_plant(file, {}).volume, file.volume);
  EXPECT_THROW(different_plant(file, {.buoyancy = -1000}), Error);

  // 1/2 rho C_d d (L / 2) v^2, against the motion, whatever the heading.
  VehicleState state = test::at_speed(0.5);
  state.X_WB.rotation = Rotation::from_heading(Angle::degrees(70));
  const Vector6 pull = tether_wrench(40, state, kFresh);
  EXPECT_NEAR(pull(0), -0.5 * 1000 * 1.2 * 0.0076 * 20 * 0.25, 1e-9);
  EXPECT_NEAR(pull.tail<5>().norm(), 0, 1e-9);
  EXPECT_EQ(tether_wrench(40, test::at_speed(0), kFresh), Vector6::Zero());
}

TEST(AutopilotSettings, NameTheKindOfControl) {
  const auto read = [](const std::string& control) {
    return parse_vehicle(
               "[body]\nmass = 10\ninertia = [1, 1, 1]\nvolume = 0.01\n[autopilot]\ncontrol = \"" + control + "\"\n",
               "box.toml")
        .autopilot.control;
  };
  EXPECT_EQ(VehicleModel().autopilot.control, ControlKind::kPid);
  for (const ControlKind kind : kControlKinds) EXPECT_EQ(read(to_text(kind)), kind);
  try {
    read("adaptiv");
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("box.toml:6:11: autopilot.control"));
    EXPECT_THAT(e.what(), testing::HasSubstr("did you mean adaptive?"));
  }
}

TEST(AdaptiveAutopilot, AllocatesNothing) {
  for (const VehicleModel& file : {test::remus(), test::rov()}) {
    DynamicVehicle vehicle(under(ControlKind::kAdaptive, file), test::at_speed(0.5, 5), {.tether_m = 10});
    const auto before = test::allocations();
    for (int i = 0; i < 10; ++i) vehicle.step({Angle::degrees(10), 6, 3, 0}, kFresh, kDt);
    EXPECT_EQ(test::allocations(), before);
  }
}

}  // namespace
}  // namespace isobath::adaptive_autopilot_test
