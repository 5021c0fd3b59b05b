// Swaths from the gate to the outcome of a run.
#include <gmock/gmock.h>
#include <isobath/io/mcap/native_log.hpp>
#include <isobath/run/run.hpp>
#include <isobath/studies/inspection.hpp>
#include <limits>
#include <tests/support/data.hpp>
#include <tests/support/events.hpp>

namespace isobath {
namespace {

Swath swath_at(double t, std::vector<float> depths) {
  Swath swath;
  swath.time = Time(seconds(t));
  swath.frame = Swath::Frame::kLevel;
  swath.sound_speed = 1480 + t;
  for (const float depth : depths) {
    Sounding& s = swath.soundings.emplace_back();
    s.point = {0, 1, depth};
    s.range_m = depth;
  }
  return swath;
}

TEST(SwathGate, AdmitsWhatIsFiniteAndInOrder) {
  EventGate gate({});
  EXPECT_EQ(gate.judge(swath_at(1, {10})), EventGate::Verdict::kAdmitted);
  EXPECT_EQ(gate.judge(swath_at(2, {})), EventGate::Verdict::kAdmitted) << "a ping that found no bottom";
  EXPECT_EQ(gate.judge(swath_at(1.5, {10})), EventGate::Verdict::kRejected);
  EXPECT_EQ(gate.judge(test::ping_at(1.5)), EventGate::Verdict::kAdmitted) << "each stream has its own order";
  EXPECT_EQ(gate.rejected().at(EventGate::kBackwards), 1u);
}

TEST(SwathGate, RejectsWhatNoMapCouldUse) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const auto spoilt = [](auto spoil) {
    Swath swath = swath_at(1, {10, 11});
    spoil(swath);
    return swath;
  };
  EventGate gate({});
  const std::vector<Swath> bad{spoilt([](Swath& s) { s.soundings[1].point.x() = kNan; }),
                               spoilt([](Swath& s) { s.soundings[1].range_m = -1; }),
                               spoilt([](Swath& s) { s.soundings[1].sigma_m = kNan; }),
                               spoilt([](Swath& s) { s.sound_speed = std::numeric_limits<double>::infinity(); }),
                               spoilt([](Swath& s) { s.heading = Angle::radians(double{kNan}); })};
  for (const Swath& swath : bad) EXPECT_EQ(gate.judge(swath), EventGate::Verdict::kRejected);
  EXPECT_EQ(gate.rejected().at("swath not finite"), bad.size());
  EXPECT_EQ(gate.judge(spoilt([](Swath& s) { s.soundings.resize(65537); })), EventGate::Verdict::kRejected);
  EXPECT_EQ(gate.judge(spoilt([](Swath& s) { s.soundings.resize(65536); })), EventGate::Verdict::kAdmitted);
}

TEST(SwathInspection, SaysHowManyAndHowDeep) {
  auto wet = swath_at(2, {3});
  wet.soundings[0].kind = Sounding::Kind::kWater;
  auto bad = swath_at(3, {1});
  bad.soundings[0].range_m = -1;
  test::ListSource source({swath_at(1, {10, 14, 12}), wet, bad});
  const Inspection facts = inspect(source);
  ASSERT_EQ(facts.streams.size(), 1u);
  EXPECT_EQ(facts.streams[0].name, "swaths");
  EXPECT_EQ(facts.streams[0].events, 3u);
  EXPECT_EQ(facts.bad_swaths, 1u);
  EXPECT_EQ(facts.swaths.soundings, 4u);
  EXPECT_EQ(facts.swaths.in_water, 1u);
  EXPECT_EQ(facts.swaths.beams_min, 1u);
  EXPECT_EQ(facts.swaths.beams_max, 3u);
  EXPECT_EQ(facts.swaths.depth_min_m, 3);
  EXPECT_EQ(facts.swaths.depth_max_m, 14);
  EXPECT_EQ(facts.swaths.sound_speed_min, 1481);
  EXPECT_EQ(facts.swaths.sound_speed_max, 1482);
}

TEST(SwathRun, LogOfSwathsAloneIsOfUse) {
  const auto folder = test::scratch_folder();
  NativeLogWriter log(folder / "swaths.mcap");
  for (int i = 0; i < 5; ++i) {
    log.write(test::fix_at(i, i));
    log.write(swath_at(i, {10, 11}));
  }
  log.close();
  RunRequest request;
  request.input = folder / "swaths.mcap";
  request.out = folder / "out";
  const RunOutcome outcome = run(request);
  EXPECT_EQ(outcome.counts.swaths, 5u);
  EXPECT_EQ(outcome.counts.navigation, 5u);
  EXPECT_EQ(outcome.problem, "");
}

}  // namespace
}  // namespace isobath
