// The 55 situations of encounters with exact states of the bodies within 60 m: a vehicle that follows plans by the
// steering rules of the sea passes them as the rules say, and one without them does not. ledger: S3-01
#include <gtest/gtest.h>
#include <isobath/evaluation/rules_score.hpp>
#include <isobath/planning/traffic/traffic_planner.hpp>

namespace isobath::encounters_by_rules {
namespace {

using Eigen::Vector2d;

constexpr double kSeen_m = 60, kGoal_m = 120, kArrival_m = 3, kLimit_s = 130, kTick_s = 0.1;

struct Tally {
  RulesScore score;
  int contacts = 0, near_passes = 0, arrived = 0, departed = 0;
  double time_ratio = 0;  ///< over straight ahead, sum
};

std::vector<MovingBody> seen_bodies(const std::vector<Body>& targets, const Vector2d& own, double t_s) {
  std::vector<MovingBody> seen;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const auto place = [&](double at_s) -> Vector2d {
      return Vector2d(targets[i].path[1], targets[i].path[2]) + displacement(targets[i], at_s).head<2>();
    };
    MovingBody body;
    body.number = static_cast<int>(i) + 1;
    body.p_W = place(t_s);
    body.velocity_W = place(t_s + 1) - body.p_W;
    body.radius_m = 0.5;
    body.time = Time{} + seconds(t_s);
    if ((body.p_W - own).norm() < kSeen_m) seen.push_back(std::move(body));
  }
  return seen;
}

/// A REMUS 100 at 1.5 m/s, which cannot stop, with the margin of the Goal Selector.
void pass(bool rules, std::uint64_t seed, Tally& tally) {
  TrafficVehicle vehicle;
  vehicle.radius_m = 0.8;
  vehicle.turning_radius_m = 6;
  vehicle.min_speed = 0.7;
  TrafficConfig config;
  config.margin_m = 1.2;
  config.roads = false;
  config.rules.on = rules;
  TrafficPlanner planner(config, vehicle);
  planner.set_goal({kGoal_m, 0}, kArrival_m);
  const EncounterSituation& situation = encounter_situations()[seed % 55];
  const std::vector<Body> targets = encounter_bodies({}, situation, {{0, 0}, Angle(), 1.5}, seed, kLimit_s);
  MotionState own{{0, 0}, 0, 1.5};
  std::vector<TrueMotion> track;
  double gap_m = 1e9;
  bool departs = false;
  double t_s = 0;
  for (int k = 0; k * kTick_s < kLimit_s - 2 && (own.p_W - Vector2d(kGoal_m, 0)).norm() > kArrival_m; ++k) {
    t_s = k * kTick_s;
    const Time now = Time{} + seconds(t_s);
    const std::vector<MovingBody> seen = seen_bodies(targets, own.p_W, t_s);
    for (const MovingBody& body : seen) gap_m = std::min(gap_m, distance_to(body, own.p_W, 0) - vehicle.radius_m);
    track.emplace_back();
    track.back().time = now;
    track.back().state.X_WB.translation = {own.p_W.x(), own.p_W.y(), 15};
    const TrafficPlan& plan = planner.step(own, now, seen);
    departs = departs || plan.departs;
    own = plan.trajectory.at(to_seconds(now - plan.start) + kTick_s);
  }
  const RulesScore one = rules_score(track, targets, situation);
  tally.score.give_way += one.give_way;
  tally.score.passed_astern += one.passed_astern;
  tally.score.head_on += one.head_on;
  tally.score.passed_port_to_port += one.passed_port_to_port;
  tally.score.stand_on += one.stand_on;
  tally.score.stood_on += one.stood_on;
  tally.contacts += gap_m < 0;
  tally.near_passes += gap_m < 1;
  tally.arrived += (own.p_W - Vector2d(kGoal_m, 0)).norm() <= kArrival_m;
  tally.departed += departs;
  tally.time_ratio += t_s / ((kGoal_m - kArrival_m) / 1.5);
}

Tally pass_all(bool rules) {
  Tally tally;
  for (std::uint64_t seed = 0; seed < 55; ++seed) pass(rules, seed, tally);
  return tally;
}

TEST(EncountersByTheRules, ArePassedAsTheRulesSay) {
  const Tally with = pass_all(true);
  EXPECT_EQ(with.contacts, 0);
  EXPECT_EQ(with.near_passes, 0);
  EXPECT_EQ(with.arrived, 55);
  EXPECT_LE(with.departed, 2);
  EXPECT_LT(with.time_ratio / 55, 1.03);
  EXPECT_EQ(with.score.give_way, 28);
  EXPECT_EQ(with.score.passed_astern, 28);
  EXPECT_EQ(with.score.head_on, 28);
  EXPECT_GE(with.score.passed_port_to_port, 27);
  EXPECT_EQ(with.score.stand_on, 20);
  EXPECT_EQ(with.score.stood_on, 20);
  const Tally without = pass_all(false);
  EXPECT_EQ(without.arrived, 55);
  EXPECT_LT(without.score.passed_astern, 20) << "no more than chance";
  EXPECT_LT(without.score.passed_port_to_port, 14);
  EXPECT_LT(without.score.stood_on, 15);
}

}  // namespace
}  // namespace isobath::encounters_by_rules
