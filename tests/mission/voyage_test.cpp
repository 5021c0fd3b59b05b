// Whole missions of the standard agents on a point that does what it is told, past obstacles that are injected or seen.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/mission/agents/standard_agents.hpp>
#include <isobath/mission/command/executor.hpp>

#include "agent_script.hpp"

namespace isobath::voyage_test {
namespace {

using Eigen::Vector2d;

/// A vehicle that turns and speeds up within limits, a navigator that may be wrong, a sonar that sees all within 60 m.
class Voyage {
 public:
  explicit Voyage(MissionPlan mission) : plan(std::move(mission)) {
    parameters.min_speed = 0;
    parameters.limits.turning_radius = 0;
    parameters.braking = 0.5;
  }

  void sail(double for_s) {
    if (!executor) begin();
    for (const double end = now + for_s; now < end - 1e-6;) step();
  }
  [[nodiscard]] MissionReport report() const {
    const auto reports = only<MissionReport>(said);
    return reports.empty() ? MissionReport{} : reports.back();
  }
  [[nodiscard]] double clearance() const {
    double least = INFINITY;
    for (const Vector2d& p : track) {
      for (const Polygon& o : stands)
        least = std::min(least, (p - nearest_point(o, p)).norm() - parameters.half_width_m);
    }
    return least;
  }
  [[nodiscard]] std::vector<std::size_t> points(PointReport::Kind kind) const {
    std::vector<std::size_t> result;
    for (const PointReport& r : only<PointReport>(said)) {
      if (r.kind == kind) result.push_back(r.point);
    }
    return result;
  }

  MissionPlan plan;
  MissionConfig config;
  VehicleParameters parameters;
  std::vector<Polygon> stands;        ///< in the water, in truth
  std::vector<Polygon> seen;          ///< of these by the sonar
  Vector2d error = Vector2d::Zero();  ///< of navigation
  Vector2d current = Vector2d::Zero();
  std::vector<Vector2d> track;  ///< in truth
  std::vector<Message> said;
  std::vector<double> said_at;
  std::unique_ptr<Executor> executor;
  double now = 0;

 private:
  void begin() {
    ExecutorConfig crew_config;
    crew_config.arbiter.safety_officer.clear();
    executor = std::make_unique<Executor>(standard_agents(config, parameters), parameters, crew_config,
                                          [this](const Envelope& e) {
                                            said.push_back(e.message);
                                            said_at.push_back(to_seconds(e.time));
                                          });
    navigate();
    OperatorCommand go;
    go.kind = OperatorCommand::Kind::kStart;
    go.plan = std::make_shared<const MissionPlan>(plan);
    executor->on_message(go, at(now));
  }
  void navigate() {
    const Vector2d p = p_ + error;
    Navigation n = fix(now, p.x(), p.y(), psi_ * 180 / M_PI, 0);
    const Vector2d v = v_ * Vector2d(std::cos(psi_), std::sin(psi_)) + current;
    n.v_WB = Eigen::Vector3d(v.x(), v.y(), 0);
    executor->on_message(n, at(now));
  }
  void look() {
    auto map = std::make_shared<Detection>();
    map->time = at(now);
    map->X_WB = fix(now, p_.x() + error.x(), p_.y() + error.y(), psi_ * 180 / M_PI).X_WB;
    map->cells.cell_m = 0.5;
    const PlanFrame truth{p_, Angle::radians(psi_)};
    for (const Polygon& outline : seen) {
      Polygon outline_L;
      for (const Vector2d& p : outline) outline_L.push_back(truth.to_local(p));
      const Obstacle o = obstacle(outline_L, 0.99);
      if (o.range_m < 60) map->obstacles.push_back(o);
    }
    executor->on_message(Sweep{++sweeps_, true, 0.1, map}, at(now));
  }
  void step() {
    const Setpoint wanted = executor->helm(at(now));
    const double turn = std::remainder(wanted.heading.radians() - psi_, 2 * M_PI);
    psi_ = std::remainder(psi_ + std::clamp(turn, -0.05, 0.05), 2 * M_PI);
    v_ += std::clamp(wanted.speed - v_, -0.05, 0.05);
    p_ += 0.1 * (v_ * Vector2d(std::cos(psi_), std::sin(psi_)) + current);
    track.push_back(p_);
    now = std::round((now + 0.1) * 10) / 10;
    navigate();
    if (std::lround(now * 10) % 20 == 0) look();
  }

  Vector2d p_ = Vector2d::Zero();
  double psi_ = 0;
  double v_ = 0;
  int sweeps_ = 0;
};

MissionPlan three_points() {
  MissionPlan plan;
  plan.title = "three points";
  plan.points = {point(80, 0), point(80, 90), point(0, 90)};
  return plan;
}

InjectedMap injected(const Polygon& outline) {
  InjectedMap map;
  map.outlines = {outline};
  return map;
}

// ledger: S6-58 S6-D05 S6-54 S6-56
TEST(Voyage, GoesRoundAnObstacleThatIsInjectedTenSecondsAfterTheStart) {
  Voyage voyage(three_points());
  const Polygon reef = {{45, -8}, {55, -8}, {55, 6}, {45, 6}};
  voyage.plan.injected = {injected(reef)};
  voyage.stands = {reef};
  voyage.sail(400);
  EXPECT_EQ(voyage.report().phase, MissionPhase::kFinished);
  EXPECT_EQ(voyage.points(PointReport::Kind::kReached), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_GE(voyage.clearance(), 2);
  for (std::size_t i = 0; i < voyage.said.size(); ++i) {
    const auto* planned = std::get_if<RoutePlanned>(&voyage.said[i]);
    if (planned == nullptr || !planned->avoiding) continue;
    EXPECT_NEAR(voyage.said_at[i], 10, 1e-6) << "with the map, and only then";
    EXPECT_NE(planned->why.find("leg 1 would run into an injected obstacle at north"), std::string::npos);
  }
  EXPECT_EQ(voyage.points(PointReport::Kind::kAvoiding), std::vector<std::size_t>{0});
}

// ledger: S6-58 S6-D06 S6-51
TEST(Voyage, DropsAPointWithAnObstacleOnItAndSailsToTheNext) {
  Voyage voyage(three_points());
  voyage.plan.injected = {injected(square(78, 85, 4))};
  voyage.stands = {square(78, 85, 4)};
  voyage.sail(400);
  EXPECT_EQ(voyage.report().phase, MissionPhase::kFinished);
  EXPECT_EQ(voyage.points(PointReport::Kind::kReached), (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(voyage.points(PointReport::Kind::kDropped), std::vector<std::size_t>{1});
  EXPECT_GE(voyage.clearance(), 2);
}

// ledger: S6-65 S6-D06
TEST(Voyage, MovesThatPointWhereTheMissionAllowsIt) {
  Voyage voyage(three_points());
  voyage.plan.points[1].move_m = 25;
  voyage.config.navigator.drop_distance_m = 10;
  voyage.plan.injected = {injected(square(78, 85, 4))};
  voyage.stands = {square(78, 85, 4)};
  voyage.sail(400);
  EXPECT_EQ(voyage.points(PointReport::Kind::kReached), (std::vector<std::size_t>{0, 1, 2}));
  const auto moved = only<PointMoved>(voyage.said);
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_LE((moved[0].north_east - voyage.plan.points[1].north_east).norm(), 25);
  EXPECT_GE((moved[0].north_east - nearest_point(voyage.stands[0], moved[0].north_east)).norm(), 10);
}

// ledger: S6-53
TEST(Voyage, KeepsTheSameTrackPastWhatItSeesWhereverItBelievesToBe) {
  const auto sail = [](const Vector2d& error) {
    Voyage voyage(three_points());
    for (MissionPoint& p : voyage.plan.points) p.north_east += error;  // relative to the vehicle nothing has changed
    voyage.error = error;
    voyage.stands = voyage.seen = {square(42, 1.3, 3), square(75, 41, 4), square(47, 93.7, 3)};
    voyage.sail(300);
    EXPECT_EQ(voyage.report().reached, 3u);
    EXPECT_GE(voyage.clearance(), 2);
    return voyage.track;
  };
  const auto reference = sail({0, 0});
  const auto biased = sail(Vector2d(60, 80) + 0.01 * Vector2d(2000, 500));  // 100 m, and 1 % of the way up to here
  ASSERT_EQ(reference.size(), biased.size());
  for (std::size_t i = 0; i < reference.size(); ++i) ASSERT_LT((reference[i] - biased[i]).norm(), 1e-6) << i;
}

// ledger: S6-53
TEST(Voyage, KeepsClearWhenAFixMovesItsPositionAtTheSideOfTheObstacle) {
  Voyage voyage(three_points());
  voyage.stands = voyage.seen = {square(42, 1.3, 6)};
  voyage.sail(22);  // just before the corner
  voyage.error = {3, -14};
  voyage.sail(350);
  EXPECT_EQ(voyage.report().reached, 3u);
  EXPECT_GE(voyage.clearance(), 2);
}

// ledger: S6-55 S6-66
TEST(Voyage, SailsThroughAFieldOfObstaclesInACurrentWithoutDithering) {
  Voyage voyage(three_points());
  for (int i = 0; i < 12; ++i) {
    const double t = 0.5 + i;
    const Vector2d p(20 + std::fmod(37.7 * t, 60), -12 + std::fmod(23.3 * t, 90));
    bool near_point = p.norm() < 18;
    for (const MissionPoint& m : voyage.plan.points) near_point = near_point || (p - m.north_east).norm() < 18;
    if (!near_point) voyage.stands.push_back(square(p.x(), p.y(), 1.5));
  }
  ASSERT_GE(voyage.stands.size(), 6u);
  voyage.seen = voyage.stands;
  voyage.current = {-0.2, 0.3};
  voyage.sail(500);
  EXPECT_EQ(voyage.report().reached, 3u);
  EXPECT_GE(voyage.clearance(), 1.5);
  EXPECT_LE(only<RoutePlanned>(voyage.said).size(), 25u);
}

// ledger: S2-28 S2-29 S2-30 S2-31
TEST(Voyage, StopsBeforeANetReplansAndGoesOnToTheSameGoalWithSensingUnchanged) {
  Voyage voyage(three_points());
  voyage.sail(20);
  const Polygon net = {{40, -30}, {41, -30}, {41, 30}, {40, 30}};
  voyage.stands = voyage.seen = {net};
  SafetyAction stop;
  stop.kind = SafetyActionKind::kStop;
  stop.why = "a net ahead";
  voyage.executor->on_message(stop, at(voyage.now));
  const std::size_t before = voyage.track.size();
  voyage.sail(6);
  EXPECT_LT((voyage.track.back() - voyage.track[before]).norm(), 4)
      << "the reflex holds while the way is there already";
  voyage.executor->on_message(SafetyAction{}, at(voyage.now));
  voyage.sail(394);
  EXPECT_EQ(voyage.points(PointReport::Kind::kReached), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_GE(voyage.clearance(), 2);
  std::vector<std::string> order;
  for (const Message& m : voyage.said) {
    if (const auto* d = std::get_if<Decision>(&m); d && (d->what == "emergency" || d->what == "normal")) {
      order.push_back(d->what);
    }
    if (const auto* planned = std::get_if<RoutePlanned>(&m); planned && planned->avoiding) order.emplace_back("way");
  }
  order.erase(std::unique(order.begin(), order.end()), order.end());
  EXPECT_EQ(order, (std::vector<std::string>{"emergency", "way", "normal"}));
  EXPECT_EQ(only<Sweep>(voyage.said).size(), 210u) << "two seconds apart, all along";
}

// ledger: S6-42
TEST(Voyage, IsAFunctionOfWhatItHears) {
  const auto sail = [] {
    Voyage voyage(three_points());
    voyage.stands = voyage.seen = {square(42, 1.3, 3), square(75, 41, 4)};
    voyage.sail(200);
    return voyage.track;
  };
  EXPECT_EQ(sail(), sail());
}

// Ten commands of the operator, 0.6 s apart: each is carried out, the last one holds, and within a cycle of 0.6 s after
// it the Pilot steers for it. ledger: S2-40 S2-32
TEST(Voyage, FollowTenCommandsInQuickSuccession) {
  Voyage voyage(three_points());
  voyage.sail(10);
  const std::size_t orders = only<MissionOrder>(voyage.said).size(), reports = only<MissionReport>(voyage.said).size();
  for (int i = 0; i < 10; ++i) {
    OperatorCommand command;
    command.kind = i % 2 == 0 ? OperatorCommand::Kind::kHold : OperatorCommand::Kind::kResume;
    voyage.executor->on_message(command, at(voyage.now));
    const bool hold = i % 2 == 0;
    EXPECT_EQ(only<MissionOrder>(voyage.said).size(), orders + static_cast<std::size_t>(i) + 1) << "at once";
    EXPECT_EQ(only<MissionReport>(voyage.said).size(), reports + static_cast<std::size_t>(i) + 1);
    EXPECT_EQ(voyage.report().phase, hold ? MissionPhase::kHolding : MissionPhase::kUnderWay);
    voyage.sail(0.6);
    EXPECT_EQ(only<HelmOrder>(voyage.said).back().setpoint.speed > 1, !hold) << i;
  }
  voyage.sail(300);
  EXPECT_EQ(voyage.report().phase, MissionPhase::kFinished);
  EXPECT_EQ(voyage.report().reached, 3u);
}

}  // namespace
}  // namespace isobath::voyage_test
