// Scores by the steering rules of the sea, on tracks made by hand. ledger: S3-01
#include <gtest/gtest.h>
#include <isobath/evaluation/rules_score.hpp>

namespace isobath::rules_score_test {
namespace {

using Eigen::Vector2d;

/// A target that is at (60, 0) after 40 s.
Body target(const Vector2d& velocity) {
  const Vector2d from = Vector2d(60, 0) - 40 * velocity, to = from + 100 * velocity;
  Body body;
  body.path = {0, from.x(), from.y(), 15, 100, to.x(), to.y(), 15};
  return body;
}

/// From (0, 0) along these legs, each at constant speed until the time of its end, ten samples a second.
std::vector<TrueMotion> track(const std::vector<std::pair<double, Vector2d>>& legs) {
  std::vector<TrueMotion> all;
  double begin_s = 0;
  Vector2d from(0, 0);
  for (const auto& [end_s, to] : legs) {
    for (double t = begin_s; t < end_s - 0.05; t += 0.1) {
      const Vector2d p = from + (t - begin_s) / (end_s - begin_s) * (to - from);
      all.emplace_back();
      all.back().time = Time{} + seconds(t);
      all.back().state.X_WB.translation = {p.x(), p.y(), 15};
    }
    begin_s = end_s;
    from = to;
  }
  return all;
}

RulesScore scored(const std::vector<TrueMotion>& own, EncounterKind kind, const Vector2d& velocity) {
  const Body body = target(velocity);
  return rules_score(own, std::span(&body, 1), {kind});
}

const std::vector<TrueMotion> kToStarboard = track({{20, {30, 0}}, {40, {54, 18}}, {80, {114, 18}}}),
                              kToPort = track({{20, {30, 0}}, {40, {54, -18}}, {80, {114, -18}}}),
                              kStraight = track({{80, {120, 0}}});

TEST(RulesScore, ATargetFromStarboardShouldBePassedAstern) {
  const RulesScore astern = scored(kToStarboard, EncounterKind::kFromStarboard, {0, -1});
  EXPECT_EQ(astern.give_way, 1);
  EXPECT_EQ(astern.passed_astern, 1);
  EXPECT_EQ(scored(kToPort, EncounterKind::kFromStarboard, {0, -1}).passed_astern, 0);
  EXPECT_EQ(scored(track({{20, {30, 0}}, {60, {40, 0}}}), EncounterKind::kFromStarboard, {0, -1}).passed_astern, 1)
      << "it has slowed down, and the target passes ahead";
}

TEST(RulesScore, ATargetMetHeadOnShouldBePassedPortToPort) {
  const RulesScore port = scored(kToStarboard, EncounterKind::kHeadOn, {-1, 0});
  EXPECT_EQ(port.head_on, 1);
  EXPECT_EQ(port.passed_port_to_port, 1);
  EXPECT_EQ(scored(kToPort, EncounterKind::kHeadOn, {-1, 0}).passed_port_to_port, 0);
}

TEST(RulesScore, TheVehicleShouldStandOnUntil12SecondsBeforeTheClosestApproach) {
  const auto stands_on = [](double turns_s) {
    const Vector2d turns(1.5 * turns_s, 0);
    return scored(track({{turns_s, turns}, {turns_s + 40, turns + Vector2d(48, 36)}}), EncounterKind::kFromPort,
                  {0, 1});
  };
  EXPECT_EQ(stands_on(30).stand_on, 1);
  EXPECT_EQ(stands_on(30).stood_on, 1);
  EXPECT_EQ(stands_on(20).stood_on, 0);
  EXPECT_EQ(scored(track({{20, {30, 0}}, {80, {60, 0}}}), EncounterKind::kOvertaking, {2.5, 0}).stood_on, 0)
      << "it has slowed down";
  EXPECT_EQ(scored(kStraight, EncounterKind::kOvertaking, {2.5, 0}).stood_on, 1);
}

TEST(RulesScore, DoesNotCountWhatIsNotMetOrWhereAnotherTargetMustBeGivenWay) {
  const RulesScore early = scored(track({{30, {45, 0}}}), EncounterKind::kFromStarboard, {0, -1});
  EXPECT_EQ(early.give_way, 0) << "the run ends before";
  const std::vector<Body> both = {target({0, 1}), target({0, -1})};
  const RulesScore score = rules_score(kToStarboard, both, {EncounterKind::kFromPort, EncounterKind::kFromStarboard});
  EXPECT_EQ(score.stand_on, 0);
  EXPECT_EQ(score.give_way, 1);
  EXPECT_EQ(rules_score({}, both, {EncounterKind::kFromPort, EncounterKind::kFromStarboard}).give_way, 0);
}

}  // namespace
}  // namespace isobath::rules_score_test
