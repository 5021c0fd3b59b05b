#include <gmock/gmock.h>
#include <isobath/io/input/survey_track.hpp>
#include <limits>

namespace isobath {
namespace {

using std::chrono::milliseconds;

Time at(double s) { return Time{seconds(1e9 + s)}; }

constexpr GeoPoint kHome{45, 10};
/// A point `north` metres from home, within a millimetre over a hundred metres.
GeoPoint north_of_home(double north) { return LocalPlane(kHome).to_geo({north, 0}); }

PositionFix fix_at(double s, double north, std::optional<double> speed = {}) {
  PositionFix fix{at(s), north_of_home(north), {}, Angle::degrees(90), 0.5};
  if (speed) fix.velocity = along({}, *speed);
  return fix;
}
MotionSample motion_at(double s, double roll_deg, double heave_m = 0, double heading_deg = 350) {
  return {at(s), Angle::degrees(roll_deg), {}, heave_m, Angle::degrees(heading_deg), 0, 0, 0};
}
SwathRecord swath_at(double s, Swath::Frame frame = Swath::Frame::kLevel) {
  SwathRecord record;
  record.swath.time = at(s);
  record.swath.frame = frame;
  record.swath.soundings.resize(3);
  return record;
}

struct Track {
  SourceReport report;
  SurveyTrack track{report};
  std::vector<Event> drain() {
    std::vector<Event> events;
    while (auto event = track.next()) events.push_back(*std::move(event));
    return events;
  }
  std::vector<Event> finish() {
    track.finish();
    return drain();
  }
};

std::string kinds(const std::vector<Event>& events) {
  std::string text;
  for (const Event& e : events) text += std::holds_alternative<Swath>(e) ? 'S' : 'n';
  return text;
}

TEST(SurveyTrack, PutsWhatWasWrittenOutOfOrderInOrderOfTime) {
  Track t;
  t.track.add(fix_at(1.0, 10));
  t.track.add(swath_at(0.75));
  t.track.add(fix_at(0.0, 0));
  t.track.add(swath_at(0.25));
  t.track.add(motion_at(0, 0));
  t.track.add(motion_at(1, 4, 0.2, 10));
  EXPECT_TRUE(t.drain().empty()) << "two seconds are waited";
  const auto events = t.finish();
  EXPECT_EQ(kinds(events), "nnSnSn");
  const auto& fix = std::get<Navigation>(events.at(3));
  EXPECT_EQ(fix.time, at(0.75));
  EXPECT_NEAR(fix.X_WB.translation.x(), 7.5 - 10, 1e-3)
      << "between the fixes; the origin is the first that was written";
  EXPECT_NEAR(fix.X_WB.translation.z(), 0.15, 1e-12) << "heave";
  EXPECT_NEAR(fix.X_WB.rotation.roll().degrees(), 3, 1e-9);
  EXPECT_NEAR(fix.X_WB.rotation.heading().degrees(), 5, 1e-9) << "from 350 to 10 by way of north";
  ASSERT_TRUE(fix.covariance);
  EXPECT_DOUBLE_EQ((*fix.covariance)(1, 1), 0.25);
  EXPECT_GT((*fix.covariance)(5, 5), 0) << "what is not stated has the resolution of the record, never zero";
}

TEST(SurveyTrack, ReleasesWhatIsTwoSecondsOld) {
  Track t;
  t.track.add(fix_at(0, 0));
  t.track.add(swath_at(0.1));
  t.track.add(fix_at(2.05, 0));
  EXPECT_EQ(kinds(t.drain()), "n");
  t.track.add(motion_at(2.2, 0));
  EXPECT_EQ(kinds(t.drain()), "nS");
}

TEST(SurveyTrack, HoldsAPingUntilThereIsAPosition) {
  Track t;
  t.track.add(swath_at(0));
  t.track.add(motion_at(3, 0));
  EXPECT_TRUE(t.drain().empty()) << "beyond the usual wait";
  t.track.add(fix_at(3.5, 7, 2.0));
  const auto events = t.drain();
  ASSERT_EQ(kinds(events), "nS");
  EXPECT_NEAR(std::get<Navigation>(events[0]).X_WB.translation.x(), -7, 1e-3) << "back along its velocity";
  EXPECT_NEAR(std::get<Navigation>(events[0]).v_WB->x(), 2, 1e-12);
}

TEST(SurveyTrack, SwathThatFindsNoPositionGoesOutAlone) {
  Track t;
  t.track.add(swath_at(0));
  t.track.add(motion_at(6, 0));
  EXPECT_EQ(kinds(t.drain()), "S");
  t.track.add(fix_at(20, 0));
  t.track.add(swath_at(21.5));
  EXPECT_EQ(kinds(t.finish()), "nS") << "a position without speed is carried for a second";
  EXPECT_EQ(t.report.details.at("swaths"), "2 without a position");
}

TEST(SurveyTrack, TwoHeadsOfOnePingShareAFix) {
  Track t;
  t.track.add(fix_at(0, 0));
  t.track.add(swath_at(0.5));
  t.track.add(swath_at(0.5));
  EXPECT_EQ(kinds(t.finish()), "nnSS");
}

TEST(SurveyTrack, SwathsThatStateTheirPositionReplacePositionRecords) {
  Track t;
  t.track.add(fix_at(0, 0));
  auto stated = swath_at(0.5);
  stated.position = north_of_home(3);
  stated.depth_m = -0.4;
  t.track.add(stated);
  t.track.add(fix_at(1, 100));
  t.track.add(fix_at(2, 100));
  const auto events = t.finish();
  ASSERT_EQ(kinds(events), "nnSn");
  const auto& fix = std::get<Navigation>(events[1]);
  EXPECT_NEAR(fix.X_WB.translation.x(), 3, 1e-3);
  EXPECT_EQ(fix.X_WB.translation.z(), -0.4);
  EXPECT_EQ(time_of(events[3]), at(2)) << "after a second without swaths";
}

TEST(SurveyTrack, PointsInTheBodyNeedAnAttitudeNearTheirTime) {
  Track t;
  t.track.add(fix_at(0, 0));
  t.track.add(motion_at(0, 0));
  t.track.add(swath_at(0.1, Swath::Frame::kBody));
  t.track.add(swath_at(0.3, Swath::Frame::kBody));
  t.track.add(swath_at(0.3, Swath::Frame::kLevel));
  EXPECT_EQ(kinds(t.finish()), "nnSnS");
  EXPECT_EQ(t.report.rejected.at("swath without an attitude near its time"), 1u);
}

TEST(SurveyTrack, ClockThatIsSetBackBeginsAnew) {
  Track t;
  t.track.add(fix_at(1000, 0));
  t.track.add(swath_at(1000.5));
  t.track.add(fix_at(0, 50));
  t.track.add(swath_at(0.5));
  const auto events = t.finish();
  EXPECT_EQ(kinds(events), "nnSnnS");
  EXPECT_NEAR(std::get<Navigation>(events[4]).X_WB.translation.x(), 50, 1e-3) << "nothing of the old time is mixed in";
}

TEST(SurveyTrack, RefusesWhatCannotBe) {
  Track t;
  t.track.add({at(0), {91, 0}, {}, {}, 0});
  t.track.add({at(0), {0, 0}, {}, {}, 0});
  t.track.add({at(0), {std::numeric_limits<double>::quiet_NaN(), 0}, {}, {}, 0});
  t.track.add(fix_at(0, 0));
  t.track.add({at(0.1), {-45, 10}, {}, {}, 0});
  t.track.add(motion_at(0, std::numeric_limits<double>::infinity()));
  EXPECT_EQ(kinds(t.finish()), "n");
  EXPECT_EQ(t.report.rejected.at("invalid position"), 3u);
  EXPECT_EQ(t.report.rejected.at("position over 1000 km from the first"), 1u);
  EXPECT_EQ(t.report.rejected.at("attitude sample that is not finite"), 1u);
}

TEST(SurveyTrack, MemoryIsBounded) {
  Track t;
  for (std::size_t i = 0; i < SurveyTrack::kMaxPending + 10; ++i) t.track.add(swath_at(0));
  EXPECT_EQ(t.drain().size(), 10u) << "of the same time for ever";
  for (std::size_t i = 0; i < 20; ++i) {
    auto record = swath_at(0);
    record.swath.soundings.resize(Swath::kMaxSoundings);
    t.track.add(std::move(record));
  }
  EXPECT_GT(t.drain().size(), SurveyTrack::kMaxPending - 10);
}

}  // namespace
}  // namespace isobath
