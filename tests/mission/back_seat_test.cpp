// Back-seat drivers: who bids for what, and what they then drive.
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/mission/agents/back_seat.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

template <class T>
std::vector<T> of(const std::vector<Message>& said) {
  std::vector<T> out;
  for (const Message& m : said) {
    if (const T* t = std::get_if<T>(&m)) out.push_back(*t);
  }
  return out;
}

constexpr double kTurningRadius = 3;  // m

std::vector<Message> tell(Agent& agent, const Message& message) {
  Outbox out;
  agent.on_message(message, Time{}, out);
  return std::move(out.said());
}

TaskCall call(const std::string& task, std::uint32_t id = 1) {
  TaskCall c;
  c.id = id;
  c.task = task;
  c.at.name = "wreck";
  c.at.north_east = {100, 50};
  c.at.depth_m = 4;
  return c;
}

double suitability(Agent& agent, const std::string& task) {
  const auto bids = of<TaskBid>(tell(agent, call(task)));
  return bids.empty() ? 0 : bids[0].suitability;
}

std::vector<Vector2d> planned(Agent& agent, const std::string& driver, const std::string& task) {
  (void)tell(agent, call(task, 7));
  const auto plans = of<TaskPlan>(tell(agent, TaskAward{7, driver}));
  std::vector<Vector2d> way;
  if (plans.size() != 1) return way;
  for (const Waypoint& w : plans[0].waypoints) way.emplace_back(w.north, w.east);
  return way;
}

void place(Agent& agent, double north, double east) {
  Navigation fix;
  fix.X_WB.translation = {north, east, 2};
  (void)tell(agent, fix);
}

// ledger: S6-41
TEST(BackSeat, DriversBidByWhatTheTaskAsksFor) {
  SurveyDriver survey({}, kTurningRadius);
  CircleDriver circle({}, kTurningRadius);
  EXPECT_GT(suitability(survey, "survey length_m=80 breadth_m=40"), 0);
  EXPECT_EQ(suitability(circle, "survey length_m=80 breadth_m=40"), 0);
  EXPECT_EQ(suitability(survey, "circle radius_m=8"), 0);
  EXPECT_GT(suitability(circle, "circle radius_m=8"), 0);
  EXPECT_GT(suitability(circle, "inspect radius_m=8"), suitability(survey, "inspect radius_m=8"))
      << "both can, and going round is better";
  EXPECT_GT(suitability(survey, "inspect radius_m=8"), 0);
  EXPECT_GT(suitability(survey, "survey spacing_m=10"), suitability(survey, "survey spacing_m=4"))
      << "lanes nearer than the turns are wide";
  EXPECT_EQ(suitability(survey, "dig"), 0);
  EXPECT_TRUE(tell(survey, call("dig")).empty());
}

// ledger: S6-41
TEST(BackSeat, WhatCannotBeDoneAsAskedGetsNoBidAndAReason) {
  SurveyDriver survey({}, kTurningRadius);
  CircleDriver circle({}, kTurningRadius);
  const auto reason = [](Agent& agent, const std::string& task) {
    const auto said = tell(agent, call(task));
    EXPECT_TRUE(of<TaskBid>(said).empty()) << task;
    const auto decisions = of<Decision>(said);
    return decisions.empty() ? std::string() : decisions[0].reason;
  };
  using testing::HasSubstr;
  EXPECT_THAT(reason(survey, "survey lenght_m=80"), HasSubstr("lenght_m: unknown number"));
  EXPECT_THAT(reason(survey, "survey length_m"), HasSubstr("is not name=number"));
  EXPECT_THAT(reason(survey, "survey length_m=nan"), HasSubstr("is not name=number"));
  EXPECT_THAT(reason(survey, "survey length_m=1 length_m=2"), HasSubstr("is given twice"));
  EXPECT_THAT(reason(survey, "survey length_m=-5"), HasSubstr("out of range"));
  EXPECT_THAT(reason(survey, "survey length_m=9000 breadth_m=9000"), HasSubstr("too long"));
  EXPECT_THAT(reason(circle, "circle radius_m=1"), HasSubstr("out of range; allowed: 3 .. 5000"));
  EXPECT_THAT(reason(circle, "circle turns=1000"), HasSubstr("out of range"));
  EXPECT_THAT(reason(circle, ""), HasSubstr("without a name"));
}

// ledger: S6-41
TEST(BackSeat, OnlyTheOneThatIsTakenPlans) {
  SurveyDriver survey({}, kTurningRadius);
  (void)tell(survey, call("survey", 3));
  EXPECT_TRUE(tell(survey, TaskAward{3, "circle"}).empty());
  EXPECT_TRUE(tell(survey, TaskAward{2, "survey"}).empty()) << "another call";
  const auto plans = of<TaskPlan>(tell(survey, TaskAward{3, "survey"}));
  ASSERT_EQ(plans.size(), 1u);
  EXPECT_EQ(plans[0].id, 3u);
  EXPECT_EQ(plans[0].driver, "survey");
  EXPECT_EQ(plans[0].waypoints[0].depth, 4);
  EXPECT_EQ(plans[0].waypoints[0].speed, SurveyConfig{}.speed);
  (void)tell(survey, call("dig", 4));
  EXPECT_TRUE(tell(survey, TaskAward{4, "survey"}).empty()) << "it made no bid";
}

/// Distance of p to a way.
double off(const std::vector<Vector2d>& way, const Vector2d& p) {
  double least = INFINITY;
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    const Vector2d side = way[i + 1] - way[i];
    const double share = std::clamp((p - way[i]).dot(side) / side.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (way[i] + share * side - p).norm());
  }
  return least;
}

// Every place of the rectangle lies within half a spacing of a lane. ledger: S6-41
TEST(BackSeat, ASurveyCoversItsRectangle) {
  SurveyDriver survey({}, kTurningRadius);
  const auto way = planned(survey, "survey", "survey length_m=80 breadth_m=45 spacing_m=10 heading_deg=30");
  EXPECT_EQ(way.size(), 10u);
  const double a = M_PI / 6;
  const Vector2d along(std::cos(a), std::sin(a)), across(-std::sin(a), std::cos(a)), middle(100, 50);
  for (double u = -40; u <= 40; u += 2) {
    for (double v = -22.5; v <= 22.5; v += 1.5) {
      EXPECT_LE(off(way, middle + u * along + v * across), 5 + 1e-9);
    }
  }
  for (const Vector2d& p : way) {
    EXPECT_LE(std::abs((p - middle).dot(along)), 40 + 1e-9);
    EXPECT_LE(std::abs((p - middle).dot(across)), 22.5 + 1e-9);
  }
}

// ledger: S6-41
TEST(BackSeat, WaysBeginWhereTheVehicleIs) {
  SurveyDriver survey({}, kTurningRadius);
  CircleDriver circle({}, kTurningRadius);
  for (const Vector2d& vehicle : {Vector2d(180, 120), Vector2d(20, -20), Vector2d(180, -20), Vector2d(20, 120)}) {
    place(survey, vehicle.x(), vehicle.y());
    const auto lanes = planned(survey, "survey", "survey length_m=80 breadth_m=40 spacing_m=10");
    for (const Vector2d& p : lanes) EXPECT_LE((lanes[0] - vehicle).norm(), (p - vehicle).norm() + 1e-9);
    place(circle, vehicle.x(), vehicle.y());
    const auto round = planned(circle, "circle", "circle radius_m=20 turns=1.5");
    ASSERT_GE(round.size(), 3u);
    EXPECT_NEAR((round[0] - vehicle).norm(), (Vector2d(100, 50) - vehicle).norm() - 20, 1e-9);
  }
}

// ledger: S6-41
TEST(BackSeat, ACircleKeepsItsDistanceAndGoesRoundClockwise) {
  CircleDriver circle({}, kTurningRadius);
  const auto way = planned(circle, "circle", "inspect radius_m=20 turns=2.25");
  const Vector2d middle(100, 50);
  double turned = 0;
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    const Vector2d a = way[i] - middle, b = way[i + 1] - middle;
    turned += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    for (const double share : {0.0, 0.5}) EXPECT_NEAR((a + share * (b - a)).norm(), 20, 0.02 * 20);
  }
  EXPECT_NEAR(turned, 2.25 * 2 * M_PI, 1e-9);
}

}  // namespace
}  // namespace isobath
