// The same agents command any vehicle: they receive what is sensed, give set-points, and know nothing else.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/mission/command/executor.hpp>
#include <isobath/vehicle/plant.hpp>
#include <tests/mission/scripted_agent.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

const Eigen::Vector2d kGoal(60, 30);

/// Steers for the goal; says when it is there.
std::vector<AgentSlot> pilot() {
  auto arrived = std::make_shared<bool>(false);
  return test::slots(test::slot("pilot", [arrived](const Message& m, Time, Outbox& out) {
    const auto* fix = std::get_if<Navigation>(&m);
    if (!fix) return;
    const Eigen::Vector2d way = kGoal - fix->X_WB.translation.head<2>();
    if (!*arrived && way.norm() < 5) {
      *arrived = true;
      out.say(PointReport{PointReport::Kind::kReached, 0, ""});
    }
    out.say(HelmOrder{{Angle::radians(std::atan2(way.y(), way.x())), 2, *arrived ? 0 : 1.5, 0}});
  }));
}

/// Runs new agents on a back end until they say that it has arrived; returns where that was.
template <class BackEnd>
std::optional<Eigen::Vector2d> run(BackEnd& vehicle, const VehicleParameters& parameters) {
  ExecutorConfig config;
  config.arbiter.safety_officer = "";
  bool arrived = false;
  Executor executor(pilot(), parameters, config,
                    [&](const Envelope& e) { arrived = arrived || std::holds_alternative<PointReport>(e.message); });
  for (int step = 0; step < 2000; ++step) {
    const Time now = test::at(step * 0.1);
    executor.on_message(vehicle.sense(now), now);
    if (arrived) return vehicle.sense(now).X_WB.translation.template head<2>();
    vehicle.act(executor.helm(now), 0.1);
  }
  return std::nullopt;
}

struct SimulatedVehicle {
  DynamicVehicle plant;
  [[nodiscard]] Navigation sense(Time now) const {
    Navigation fix;
    fix.time = now;
    fix.X_WB = plant.state().X_WB;
    return fix;
  }
  void act(const Setpoint& setpoint, double dt) { plant.step(setpoint, {}, dt); }
};

/// A point that is at once what it is told to be.
struct TrivialVehicle {
  Pose X_WB;
  [[nodiscard]] Navigation sense(Time now) const {
    Navigation fix;
    fix.time = now;
    fix.X_WB = X_WB;
    return fix;
  }
  void act(const Setpoint& s, double dt) {
    X_WB.rotation = Rotation::from_heading(s.heading);
    X_WB.translation += X_WB.rotation * Eigen::Vector3d(s.speed * dt, 0, 0);
    X_WB.translation.z() = s.depth;
  }
};

// ledger: S6-42
TEST(BackEnd, TheSameAgentsCommandASimulatedVehicleAndATrivialOne) {
  const VehicleModel model = load_vehicle((test::source_folder() / "vehicles" / "remus100.toml").string());
  SimulatedVehicle simulated{DynamicVehicle(model)};
  TrivialVehicle trivial{};
  const auto there = run(simulated, parameters_of(model));
  const auto also_there = run(trivial, {});
  ASSERT_TRUE(there);
  ASSERT_TRUE(also_there);
  EXPECT_LT((*there - kGoal).norm(), 5);
  EXPECT_LT((*also_there - kGoal).norm(), 5);
}

}  // namespace
}  // namespace isobath
