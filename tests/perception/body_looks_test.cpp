// Readings of bodies from the echoes of fans and of scanning heads.
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/perception/tracking/body_looks.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr int kLookBins = 240;
constexpr double kLookBin = 0.25;  // m

Time look_time(double s) { return Time(seconds(s)); }
Pose sonar_at(double north, double east, double heading_deg) {
  return {Rotation::from_heading(Angle::degrees(heading_deg)), {north, east, 2}};
}

/// A ping of beams one degree apart, without samples: looks are made of decisions.
Ping ping_of(std::shared_ptr<const BeamFan> fan, double s) {
  Ping ping;
  ping.time = look_time(s);
  ping.fan = std::move(fan);
  ping.window = {0, kLookBin, kLookBins};
  return ping;
}
std::shared_ptr<const BeamFan> level_fan() {
  return even_fan(121, Angle::degrees(120), Angle::degrees(1), Angle::degrees(20));
}
std::shared_ptr<const BeamFan> head_at(double azimuth_deg) {
  BeamFan one;
  one.azimuth = {Angle::degrees(azimuth_deg)};
  one.width = {Angle::degrees(2)};
  one.height = Angle::degrees(20);
  return std::make_shared<const BeamFan>(one);
}

EchoDecisions no_echoes(const Ping& ping) {
  EchoDecisions decisions;
  decisions.reset(ping.fan->beams(), ping.window.bins);
  return decisions;
}
/// Echoes in the bins that a disc covers, seen from the sonar at the origin of its frame.
void add_disc(const Ping& ping, EchoDecisions& decisions, const Vector2d& middle_S, double radius) {
  for (int b = 0; b < ping.fan->beams(); ++b) {
    const Vector2d along(cos(ping.fan->azimuth[b]), sin(ping.fan->azimuth[b]));
    for (int k = 0; k < kLookBins; ++k) {
      if ((ping.window.centre(k) * along - middle_S).norm() <= radius) decisions.set_hit(b, k);
    }
  }
}

// ledger: S3-04
TEST(BodyLooks, OfAFanHaveAReadingForEachBodyWhereItIsInTheWorld) {
  BodyLooks looks({});
  const Ping ping = ping_of(level_fan(), 3);
  EchoDecisions decisions = no_echoes(ping);
  add_disc(ping, decisions, {30, 0}, 1);
  add_disc(ping, decisions, {20, 15}, 1);
  const BodyLook* look = looks.add(ping, decisions, sonar_at(100, 50, 90));
  ASSERT_NE(look, nullptr);
  EXPECT_EQ(look->time(), look_time(3));
  ASSERT_EQ(look->readings().size(), 2u);
  for (const BodyReading& r : look->readings()) {
    const Vector2d truth = r.p_W.y() > 75 ? Vector2d(100, 80) : Vector2d(85, 70);
    EXPECT_LT((r.p_W - truth).norm(), 0.15);
    EXPECT_EQ(r.age_s, 0);
    EXPECT_NEAR(std::sqrt(r.scatter(0, 0)), 0.5, 0.15) << "a disc of 1 m";
  }
  EXPECT_GT(look->detection({100, 75}), 0.5);
  EXPECT_EQ(look->detection({100, 30}), 0) << "astern";
  EXPECT_EQ(look->detection({100, 50 + kLookBin * kLookBins + 1}), 0) << "beyond the range";
}

// ledger: S3-15
TEST(BodyLooks, OfAScanningHeadGiveABodyTheTimeOfItsOwnEchoes) {
  BodyLooks looks({});
  std::vector<BodyReading> readings;
  std::vector<Time> times;
  for (int k = 0; k < 60; ++k) {
    const Ping ping = ping_of(head_at(2 * k - 60), 0.1 * k);
    EchoDecisions decisions = no_echoes(ping);
    add_disc(ping, decisions, {20, 0}, 1);  // at azimuth zero: the thirtieth beam, after 3 s
    if (const BodyLook* look = looks.add(ping, decisions, Pose{})) {
      times.push_back(look->time());
      for (const BodyReading& r : look->readings()) {
        readings.push_back(r);
        EXPECT_NEAR(to_seconds(look->time() - seconds(r.age_s)), 3, 0.06);
      }
    }
  }
  EXPECT_GE(times.size(), 4u) << "a look each 15 degrees";
  ASSERT_EQ(readings.size(), 1u) << "a sector does not cut it in two";
  EXPECT_LT((readings[0].p_W - Vector2d(20, 0)).norm(), 0.3);
}

TEST(BodyLooks, TakeAWallForAStructureThatHidesWhatLiesBehind) {
  BodyLooks looks({});
  const Ping ping = ping_of(level_fan(), 0);
  EchoDecisions decisions = no_echoes(ping);
  for (int b = 30; b <= 90; ++b) {
    const int bin = static_cast<int>(30 / cos(ping.fan->azimuth[b]) / kLookBin);  // 30 m ahead, 34 m long
    for (int k = 0; k < 3; ++k) decisions.set_hit(b, bin + k);
  }
  add_disc(ping, decisions, {14, 16}, 1);
  const BodyLook* look = looks.add(ping, decisions, Pose{});
  ASSERT_NE(look, nullptr);
  ASSERT_EQ(look->readings().size(), 1u);
  EXPECT_LT((look->readings()[0].p_W - Vector2d(14, 16)).norm(), 0.2);
  EXPECT_LT(look->detection({40, 0}), 0.5 * look->detection({20, 0}));
}

// Echoes by false alarm stand close together near the head, where neighbouring beams do. They are no bodies.
TEST(BodyLooks, OfAScanningHeadLeaveOutClustersThatFalseAlarmsExplain) {
  constexpr double kRate = 0.02;
  struct Heard {
    int bodies = 0, others = 0;
  };
  const auto hear = [](double told) {
    BodyLooks looks({});
    Random random(4);
    Heard heard;
    for (int i = 0; i < 1200; ++i) {  // twenty sweeps
      const double turned = i % 120 < 60 ? i % 60 : 60 - i % 60;
      const Ping ping = ping_of(head_at(2 * turned - 60), 0.05 * i);
      EchoDecisions decisions = no_echoes(ping);
      decisions.false_alarm = told;
      for (int k = 0; k < kLookBins; ++k) {
        if (random.uniform() < kRate) decisions.set_hit(0, k);
      }
      add_disc(ping, decisions, {20, 5}, 1);
      const BodyLook* look = looks.add(ping, decisions, sonar_at(0, 0, 0));
      if (look == nullptr) continue;
      for (const BodyReading& r : look->readings())
        ++((r.p_W - Vector2d(20, 5)).norm() < 1 ? heard.bodies : heard.others);
    }
    return heard;
  };
  const Heard told = hear(kRate), untold = hear(1e-9);
  EXPECT_GE(told.bodies, 14);
  EXPECT_EQ(told.bodies, untold.bodies) << "a body has more echoes than false alarms explain";
  EXPECT_LT(told.others, 0.4 * untold.others) << told.others << " of " << untold.others;
}

// Behind a body nothing is heard, and what is close to it merges with it. ledger: S3-04
TEST(BodyLooks, ABodyHidesWhatLiesBehindIt) {
  BodyLooks looks({});
  const Ping ping = ping_of(level_fan(), 0);
  EchoDecisions decisions = no_echoes(ping);
  add_disc(ping, decisions, {20, 0}, 2);
  const BodyLook* look = looks.add(ping, decisions, Pose{});
  ASSERT_NE(look, nullptr);
  ASSERT_EQ(look->readings().size(), 1u);
  const double open = look->detection({10, 0});
  EXPECT_LT(look->detection({30, 0}), 0.1 * open) << "behind it";
  EXPECT_LT(look->detection({30, 2.5}), 0.1 * open) << "behind its side";
  EXPECT_LT(look->detection({21, 1}), 0.5 * open) << "in its echoes";
  EXPECT_EQ(look->detection({30, 5}), open) << "beside its shadow";
  EXPECT_EQ(look->detection({10, 0}), look->detection({10, 6})) << "before it";
}

TEST(BodyLooks, FindAllEchoesOfABodyOfWhichAPartIsTouched) {
  BodyLooks looks({});
  const Ping ping = ping_of(level_fan(), 0);
  EchoDecisions decisions = no_echoes(ping);
  add_disc(ping, decisions, {30, 0}, 2);
  add_disc(ping, decisions, {20, 15}, 2);
  looks.add(ping, decisions, Pose{});
  std::vector<EchoBox> boxes;
  looks.find_bodies([](const Vector2d& p) { return (p - Vector2d(30, 1)).norm() < 0.6; }, boxes);
  int covered = 0, all = 0;
  for (int b = 0; b < ping.fan->beams(); ++b) {
    for (int k = 0; k < kLookBins; ++k) {
      if (!decisions.hit(b, k) || abs(ping.fan->azimuth[b]) > Angle::degrees(15)) continue;
      ++all;
      covered += std::any_of(boxes.begin(), boxes.end(), [&](const EchoBox& box) {
        const double range = ping.window.centre(k);
        return ping.fan->azimuth[b] >= box.low && ping.fan->azimuth[b] <= box.high && range >= box.near_m &&
               range <= box.far_m;
      });
    }
  }
  EXPECT_GT(all, 20);
  EXPECT_EQ(covered, all);
  for (const EchoBox& box : boxes) EXPECT_LT(box.high, Angle::degrees(15)) << "the other body is not touched";
}

TEST(BodyLooks, LeaveOutWhatIsMoreThanTheyCanSort) {
  BodyLooks looks({});
  const Ping ping = ping_of(level_fan(), 0);
  EchoDecisions decisions = no_echoes(ping);
  for (int b = 0; b < ping.fan->beams(); ++b) {
    for (int k = 0; k < kLookBins; k += 8) decisions.set_hit(b, k);  // 3630 runs in all, 30 a beam
  }
  EXPECT_NE(looks.add(ping, decisions, Pose{}), nullptr);
  EXPECT_EQ(looks.left_out(), 0u) << "only the runs of neighbouring beams are compared";
}

}  // namespace
}  // namespace isobath
