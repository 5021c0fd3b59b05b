// The agents at the helm: the same object before the simulator, a log, and a vehicle that is but a point.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/display/decision_json.hpp>
#include <isobath/onboard/pipeline.hpp>
#include <isobath/onboard/serial_helm.hpp>
#include <limits>
#include <tests/support/mission_runs.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

/// The trivial back end: it is at once what it is told to be, knows where it is, and hears noise alone.
class PointVehicle {
 public:
  void command(const Setpoint& setpoint) { setpoint_ = setpoint; }
  std::vector<Event> tick() {
    const double dt = 0.1;
    t_ += dt;
    place_ +=
        setpoint_.speed * dt * Vector2d(std::cos(setpoint_.heading.radians()), std::sin(setpoint_.heading.radians()));
    const Time now(seconds(t_));
    Navigation fix;
    fix.time = now;
    fix.X_WB = {Rotation::from_heading(setpoint_.heading), {place_.x(), place_.y(), setpoint_.depth}};
    std::vector<Event> events{ping(now), fix};
    if (++ticks_ % 10 == 0) events.emplace_back(Health{now, "vehicle", HealthState::kOk, 1, false, {}});
    return events;
  }
  [[nodiscard]] const Vector2d& place() const { return place_; }
  [[nodiscard]] double t() const { return t_; }

 private:
  Ping ping(Time now) {
    constexpr int kBeams = 30, kBins = 44;
    Ping ping;
    ping.time = now;
    if (!fan_) {
      auto fan = std::make_shared<BeamFan>();
      for (int b = 0; b < kBeams; ++b) {
        fan->azimuth.push_back(Angle::degrees(-45 + 3 * b + 1.5));
        fan->width.push_back(Angle::degrees(3));
      }
      fan->height = Angle::degrees(35);
      fan_ = fan;
    }
    ping.fan = fan_;
    ping.window = {0, 1, kBins};
    auto samples = std::make_shared<std::vector<std::uint8_t>>();
    for (int i = 0; i < kBeams * kBins; ++i) {
      samples->push_back(static_cast<std::uint8_t>(36 + noise_.bits() % 9));  // no sample stands out
    }
    ping.intensity = {samples->data(), SampleType::kU8, kBeams, kBins, kBins, 1};
    ping.storage = samples;
    return ping;
  }

  Setpoint setpoint_;
  Vector2d place_ = Vector2d::Zero();
  double t_ = 0;
  int ticks_ = 0;
  std::shared_ptr<const BeamFan> fan_;
  Random noise_ = random_at(7, 0, 0);
};

MissionSetup square() {
  MissionSetup setup;
  setup.plan.title = "a square";
  for (const auto& [name, north, east] : {std::tuple("A", 40.0, 0.0), {"B", 40.0, 40.0}, {"C", 0.0, 40.0}}) {
    MissionPoint point;
    point.name = name;
    point.north_east = {north, east};
    setup.plan.points.push_back(point);
  }
  setup.vehicle.limits.turning_radius = 0;
  return setup;
}

// ledger: S6-42 S6-D09
TEST(SerialHelm, SteersAPointAsItSteersASimulatedVehicle) {
  ISOBATH_NOT_SANITIZED();
  const auto helm = make_serial_helm(square(), {});
  Pipeline pipeline({}, *helm);
  PointVehicle vehicle;
  std::vector<double> nearest(3, std::numeric_limits<double>::infinity());
  while (vehicle.t() < 240 && helm->progress().phase != MissionPhase::kFinished) {
    for (Event& event : vehicle.tick()) {
      helm->on_event(event);
      pipeline.on_event(std::move(event));
      vehicle.command(helm->steer());
    }
    for (std::size_t i = 0; i < 3; ++i) {
      nearest[i] = std::min(nearest[i], (vehicle.place() - helm->plan().points[i].north_east).norm());
    }
  }
  EXPECT_EQ(helm->progress().phase, MissionPhase::kFinished) << helm->progress().why;
  EXPECT_EQ(helm->progress().reached, 3u);
  for (const double distance : nearest) EXPECT_LE(distance, 5.0);
}

/// What a helm of its own makes of recorded events.
std::vector<Decision> decided_again(const Scenario& scenario, const std::vector<Event>& events) {
  const auto helm = make_serial_helm(setup_of(scenario), {});
  Pipeline pipeline({}, *helm);
  for (const Event& event : events) {
    helm->on_event(event);
    pipeline.on_event(event);
    (void)helm->steer();
  }
  return helm->decisions();
}

// ledger: S6-57 S6-D09
TEST(SerialHelm, DecidesBeforeALogAsItDidInTheLoop) {
  ISOBATH_NOT_SANITIZED();
  const Scenario scenario = test::scenario_of("field_mission_2");
  const test::Sailed sailed = test::sail(scenario);
  ASSERT_GT(sailed.result.decisions.size(), 5u);
  EXPECT_EQ(decisions_text(decided_again(scenario, sailed.events)), decisions_text(sailed.result.decisions));
}

// Agents that die take nobody with them; who is not aboard cannot die.
TEST(SerialHelm, ActsOnTheLossOfAnAgent) {
  Scenario scenario = test::scenario_of("simulated_mission_1");
  FaultConfig dies;
  dies.source = "agent.navigator";
  dies.at_s = 20;
  scenario.scene.faults = {dies};
  const test::Sailed sailed = test::sail(scenario);
  EXPECT_EQ(sailed.result.report.phase, MissionPhase::kAborted);
  EXPECT_NE(sailed.all().find("navigator"), std::string::npos);
  dies.source = "agent.parrot";
  scenario.scene.faults = {dies};
  EXPECT_EQ(test::sail(scenario).result.report.phase, MissionPhase::kFinished);
}

TEST(SerialHelm, HearsNothingThatIsNoNumber) {
  const auto helm = make_serial_helm(square(), {});
  Navigation fix;
  fix.X_WB.translation.x() = std::nan("");
  helm->on_event(fix);
  RangeReading reading;
  reading.range_m = std::numeric_limits<double>::infinity();
  helm->on_event(reading);
  Health health;
  health.battery_share = std::nanf("");
  helm->on_event(health);
  Ping nothing;
  helm->on_event(nothing);
  for (const Decision& d : helm->decisions()) EXPECT_NE(d.what, "start") << "no place to start from was known";
  const Setpoint setpoint = helm->steer();
  EXPECT_TRUE(std::isfinite(setpoint.heading.radians()) && std::isfinite(setpoint.depth));
  EXPECT_EQ(setpoint.speed, 0);
}

}  // namespace
}  // namespace isobath
