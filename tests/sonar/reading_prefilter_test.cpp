#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/sonar/reading_prefilter.hpp>
#include <tests/support/count_allocations.hpp>

namespace isobath {
namespace {

using testing::ElementsAre;

RangeReading reading(double time_s, std::optional<double> range_m) {
  RangeReading r;
  r.time = Time(seconds(time_s));
  r.range_m = range_m;
  r.max_range_m = 50;
  r.width = Angle::degrees(6);
  return r;
}

Pose at(double north, double heading_deg = 0, double pitch_deg = 0) {
  return {Rotation::from_heading_pitch_roll(Angle::degrees(heading_deg), Angle::degrees(pitch_deg), {}), {north, 0, 5}};
}

std::vector<int> counts(const std::vector<MergedReading>& merged) {
  std::vector<int> n;
  for (const MergedReading& m : merged) n.push_back(m.count);
  return n;
}

// ledger: S1-68
TEST(ReadingPrefilter, TenEqualReadingsBecomeFourFourTwo) {
  ReadingPrefilter filter;
  std::vector<MergedReading> out;
  for (int i = 0; i < 10; ++i) filter.add(7, reading(0.6 * i, 20), at(1), out);
  EXPECT_THAT(counts(out), ElementsAre(4, 4));
  filter.flush(out);
  EXPECT_THAT(counts(out), ElementsAre(4, 4, 2));
  for (const MergedReading& m : out) {
    EXPECT_EQ(m.sensor, 7);
    EXPECT_EQ(m.reading.range_m, 20);
    EXPECT_EQ(m.X_WB.translation, at(1).translation);
  }
  filter.flush(out);
  EXPECT_EQ(out.size(), 3U);
}

// ledger: S1-68
TEST(ReadingPrefilter, MergesToMeansOfRangePositionAndHeadingOnTheCircle) {
  ReadingPrefilter filter;
  std::vector<MergedReading> out;
  filter.add(1, reading(0, 20.0), at(0, 359), out);
  filter.add(1, reading(0.6, 20.2), at(0.3, 0), out);
  filter.add(1, reading(1.2, 20.4), at(0.6, 0.5), out);
  filter.add(1, reading(1.8, 20.2), at(0.9, 1.5), out);
  ASSERT_THAT(counts(out), ElementsAre(4));
  EXPECT_NEAR(*out[0].reading.range_m, 20.2, 1e-12);
  EXPECT_NEAR(out[0].X_WB.translation.x(), 0.45, 1e-12);
  EXPECT_NEAR(out[0].X_WB.rotation.heading().degrees(), 0.25, 1e-4);
  EXPECT_EQ(out[0].reading.time, Time(seconds(1.8)));
}

// ledger: S1-68
TEST(ReadingPrefilter, AQuaternionAndItsNegativeAreTheSameAttitude) {
  ReadingPrefilter filter;
  std::vector<MergedReading> out;
  const Pose pose = at(0, 40);
  const Eigen::Quaterniond q = pose.rotation.quaternion();
  Pose negative = pose;
  negative.rotation = Rotation::from_unit_quaternion({-q.w(), -q.x(), -q.y(), -q.z()});
  for (const Pose& p : {pose, negative, pose, negative}) filter.add(1, reading(0, 20), p, out);
  ASSERT_THAT(counts(out), ElementsAre(4));
  EXPECT_NEAR(out[0].X_WB.rotation.heading().degrees(), 40, 1e-9);
}

struct Jump {
  const char* name;
  std::optional<double> range_m;
  Pose X_WB;
  friend std::ostream& operator<<(std::ostream& out, const Jump& jump) { return out << jump.name; }
};

class Jumps : public testing::TestWithParam<Jump> {};

// ledger: S1-68
TEST_P(Jumps, CloseTheGroupAtOnce) {
  ReadingPrefilter filter;
  std::vector<MergedReading> out;
  filter.add(1, reading(0, 20), at(0), out);
  filter.add(1, reading(0.6, 20), at(0), out);
  ASSERT_TRUE(out.empty());
  filter.add(1, reading(1.2, GetParam().range_m), GetParam().X_WB, out);
  EXPECT_THAT(counts(out), ElementsAre(2));
  filter.flush(out);
  ASSERT_THAT(counts(out), ElementsAre(2, 1));
  EXPECT_EQ(out[1].reading.range_m, GetParam().range_m);
}

INSTANTIATE_TEST_SUITE_P(Of, Jumps,
                         testing::Values(Jump{"Range", 20.51, at(0)}, Jump{"Position", 20.0, at(1.01)},
                                         Jump{"Heading", 20.0, at(0, 3.01)}, Jump{"Pitch", 20.0, at(0, 0, -3.01)},
                                         Jump{"NoEcho", std::nullopt, at(0)}),
                         [](const auto& i) { return i.param.name; });

// ledger: S1-68
TEST(ReadingPrefilter, MergesJustWithinTheTolerances) {
  ReadingPrefilter filter;
  std::vector<MergedReading> out;
  filter.add(1, reading(0, 20), at(0), out);
  filter.add(1, reading(0.6, 20.49), at(0.99, 0), out);
  filter.add(1, reading(1.2, 19.51), at(0, 2.99), out);
  filter.flush(out);
  EXPECT_THAT(counts(out), ElementsAre(3));
}

// ledger: S1-68
TEST(ReadingPrefilter, ASlowDriftCannotStretchAGroup) {
  ReadingPrefilterConfig config;
  config.max_readings = 100;
  config.hold_s = 1000;
  ReadingPrefilter filter(config);
  std::vector<MergedReading> out;
  for (int i = 0; i < 40; ++i) filter.add(1, reading(i, 10 + 0.125 * i), at(0), out);
  filter.flush(out);
  EXPECT_THAT(counts(out), ElementsAre(5, 5, 5, 5, 5, 5, 5, 5));
}

// ledger: S1-64 S1-68
TEST(ReadingPrefilter, NoEchoMergesWithNoEcho) {
  ReadingPrefilter filter;
  std::vector<MergedReading> out;
  for (int i = 0; i < 3; ++i) filter.add(1, reading(0.6 * i, std::nullopt), at(0), out);
  filter.add(1, reading(1.8, 49), at(0), out);
  filter.flush(out);
  ASSERT_THAT(counts(out), ElementsAre(3, 1));
  EXPECT_FALSE(out[0].reading.range_m);
}

// ledger: S1-68
TEST(ReadingPrefilter, SensorsAndTurnedHeadsAreKeptApart) {
  ReadingPrefilter filter;
  std::vector<MergedReading> out;
  for (int i = 0; i < 4; ++i) {
    filter.add(1, reading(0.6 * i, 20), at(0), out);
    filter.add(2, reading(0.6 * i, 20), at(0), out);
  }
  EXPECT_THAT(counts(out), ElementsAre(4, 4));
  out.clear();
  for (int i = 0; i < 4; ++i) {
    RangeReading r = reading(0.6 * i, 20);
    r.X_BS.rotation = Rotation::from_heading(Angle::degrees(1.8 * i));
    filter.add(3, r, at(0), out);
  }
  filter.flush(out);
  EXPECT_THAT(counts(out), ElementsAre(1, 1, 1, 1));
}

// ledger: S1-68
TEST(ReadingPrefilter, ATimeoutFlushes) {
  ReadingPrefilter filter;
  std::vector<MergedReading> out;
  filter.add(1, reading(10, 20), at(0), out);
  filter.add(1, reading(11, 20), at(0), out);
  filter.add(2, reading(11, 30), at(0), out);
  filter.flush_due(Time(seconds(12.3)), out);
  EXPECT_TRUE(out.empty());
  filter.flush_due(Time(seconds(12.4)), out);
  EXPECT_THAT(counts(out), ElementsAre(2));
  // A late reading closes what is due by itself; and so does one from the past.
  filter.add(2, reading(14, 30), at(0), out);
  filter.add(2, reading(13, 30), at(0), out);
  EXPECT_THAT(counts(out), ElementsAre(2, 1, 1));
}

// ledger: S1-69
TEST(ReadingPrefilter, LosesNoReading) {
  Random random(69);
  ReadingPrefilter filter;
  std::vector<MergedReading> out;
  double sum = 0;
  for (int i = 0; i < 1000; ++i) {
    const double range = 20 + 0.2 * random.normal();
    sum += range;
    filter.add(static_cast<int>(random.index(3)), reading(0.1 * i, range), at(0.05 * i), out);
  }
  filter.flush(out);
  int total = 0;
  double merged = 0;
  for (const MergedReading& m : out) {
    total += m.count;
    merged += m.count * *m.reading.range_m;
  }
  EXPECT_EQ(total, 1000);
  EXPECT_NEAR(merged, sum, 1e-8);
  EXPECT_LT(out.size(), 500U);
}

TEST(ReadingPrefilter, AllocatesNothingOnceEverySensorHasSpoken) {
  ReadingPrefilter filter;
  std::vector<MergedReading> out;
  out.reserve(64);
  for (int sensor = 0; sensor < 6; ++sensor) filter.add(sensor, reading(0, 20), at(0), out);
  const std::uint64_t before = test::allocations();
  for (int i = 1; i < 100; ++i) {
    out.clear();
    for (int sensor = 0; sensor < 6; ++sensor) filter.add(sensor, reading(0.6 * i, 20 + i % 7), at(0.4 * i), out);
    filter.flush_due(Time(seconds(0.6 * i)), out);
  }
  EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace isobath
