// How sharply a moving fan's detections lie, against a count that is made in another way.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/world/placed_detections.hpp>
#include <isobath/world/track_drift.hpp>
#include <set>
#include <tests/support/fan_folder.hpp>
#include <tests/support/sanitized.hpp>
#include <utility>

namespace isobath {
namespace {

using test::FanRecording;

constexpr double kDegree = std::numbers::pi / 180;

Swath walls_from(const FanRecording::Place& place, double mount_deg) {
  Swath swath;
  swath.time = Time{seconds(place.t_s)};
  swath.beam_height = Angle::degrees(20);
  for (int beam = -60; beam <= 60; ++beam) {
    const double range = FanRecording::range_to_wall(place, place.heading + (beam + mount_deg) * kDegree);
    Sounding& s = swath.soundings.emplace_back();
    s.point = Eigen::Vector3d(range * std::cos(beam * kDegree), range * std::sin(beam * kDegree), 0).cast<float>();
    s.range_m = static_cast<float>(range);
    s.kind = Sounding::Kind::kWater;
  }
  return swath;
}

Pose pose_of(const FanRecording::Place& place) {
  return {Rotation::from_heading_pitch_roll(Angle::radians(place.heading), {}, {}), {place.north, place.east, 0}};
}

PlacedDetections circled(double mount_deg) {
  PlacedDetections detections;
  const auto places = FanRecording::track();
  for (std::size_t i = 0; i < places.size(); i += 4) {
    detections.add(walls_from(places[i], mount_deg), pose_of(places[i]));
  }
  return detections;
}

TEST(PlacedDetections, CellsAreThoseOfASlowCount) {
  std::set<std::pair<long, long>> cells, mirrored;
  const auto places = FanRecording::track();
  for (std::size_t i = 0; i < places.size(); i += 4) {
    for (const Sounding& s : walls_from(places[i], 3).soundings) {
      for (const double side : {1.0, -1.0}) {
        const double h = places[i].heading, f = s.point.x(), r = side * double(s.point.y());
        const double north = places[i].north + f * std::cos(h) - r * std::sin(h);
        const double east = places[i].east + f * std::sin(h) + r * std::cos(h);
        (side > 0 ? cells : mirrored)
            .emplace(std::lround(std::floor(north / 0.5)), std::lround(std::floor(east / 0.5)));
      }
    }
  }
  const auto detections = circled(3);
  const auto sharpness = detections.sharpness();
  ASSERT_TRUE(sharpness);
  // A detection on the very edge of a cell may fall to either side.
  EXPECT_NEAR(double(sharpness->cells), double(cells.size()), 3);
  EXPECT_NEAR(double(sharpness->mirrored), double(mirrored.size()), 3);
  EXPECT_EQ(detections.filled_cells().size(), sharpness->cells);
}

TEST(PlacedDetections, TheFewestCellsShowTheErrorOfTheMount) {
  ISOBATH_NOT_SANITIZED();
  for (const double mount_deg : {-12.0, -1.0, 0.0, 7.0}) {
    const auto sharpness = circled(mount_deg).sharpness();
    ASSERT_TRUE(sharpness && sharpness->tells());
    EXPECT_NEAR(sharpness->best.degrees(), mount_deg, 1.01);
    EXPECT_LE(sharpness->low, sharpness->best);
    EXPECT_GE(sharpness->high, sharpness->best);
    EXPECT_GT(sharpness->mirrored, sharpness->best_cells);
  }
}

TEST(PlacedDetections, SayNothingWithoutTravelWithoutElevationOrInTheLevelFrame) {
  PlacedDetections standing, soundings, level_frame;
  const auto places = FanRecording::track();
  for (std::size_t i = 0; i < places.size(); i += 4) {
    Swath swath = walls_from(places[0], 0);
    standing.add(swath, pose_of(places[0]));
    swath.frame = Swath::Frame::kLevel;
    level_frame.add(swath, pose_of(places[i]));
    swath.frame = Swath::Frame::kBody;
    swath.beam_height = {};
    soundings.add(swath, pose_of(places[i]));
  }
  EXPECT_FALSE(standing.sharpness()) << "a fan that stands still fills the same cells at any offset";
  EXPECT_FALSE(soundings.sharpness()) << "a 3-D sonar is no fan";
  EXPECT_FALSE(level_frame.sharpness());
}

TEST(PlacedDetections, LongRecordingsAreThinned) {
  ISOBATH_NOT_SANITIZED();
  PlacedDetections detections;
  const auto places = FanRecording::track();
  const std::size_t scans = 3 * PlacedDetections::kMax / 121;
  for (std::size_t i = 0; i < scans; ++i) {
    detections.add(walls_from(places[i % places.size()], 2), pose_of(places[i % places.size()]));
  }
  const auto sharpness = detections.sharpness();
  ASSERT_TRUE(sharpness);
  EXPECT_LE(sharpness->detections, PlacedDetections::kMax);
  EXPECT_GE(sharpness->detections, PlacedDetections::kMax / 3);
  EXPECT_NEAR(sharpness->best.degrees(), 2, 1.01);
}

// ledger: S6-66 S6-F04
TEST(TrackDrift, AnObstacleMovesByTheDriftSinceItWasSeen) {
  // The vehicle goes north at 1 m/s and believes 10 % more; the obstacle is seen at 10 s and remembered until 30 s.
  std::vector<Navigation> truth;
  for (int t = 0; t <= 30; ++t) {
    Navigation fix;
    fix.time = Time{seconds(t)};
    fix.X_WB.translation = {double(t), 0, 0};
    truth.push_back(fix);
  }
  TrackDrift drift{PoseTimeline(truth)};
  KnownObstacle seen{.middle = {21, 2}, .margin_m = 0, .last_echo = Time{seconds(10)}};
  for (int t = 10; t <= 30; t += 10) {
    seen.margin_m = t == 20 ? 1.1 : 1.5;
    drift.add(Time{seconds(t)}, {{}, {1.1 * t, 0, 0}}, std::span(&seen, 1));
  }
  const auto outcome = drift.outcome(std::span(&seen, 1));
  ASSERT_TRUE(outcome);
  EXPECT_NEAR(outcome->travelled_m, 20, 1e-9);
  EXPECT_NEAR(outcome->last_m, 3, 1e-9);
  EXPECT_NEAR(outcome->rms_m, std::sqrt((1 + 4 + 9) / 3.0), 1e-9);
  EXPECT_NEAR(outcome->placed_max_m, 1, 1e-9) << "the error when it was seen";
  EXPECT_EQ(outcome->sightings, 2u) << "the scan that hears it does not count";
  EXPECT_NEAR(outcome->moved_95_m, 2, 1e-9) << "the error since then";
  EXPECT_NEAR(outcome->share_median, 1 / 11.0, 1e-9) << "1 m of 11 m";
  EXPECT_NEAR(outcome->covered, 0.5, 1e-9) << "1 m within 1.1 m, but 2 m beyond 1.5 m";
}

TEST(TrackDrift, AWrongHeadingMovesWhatIsFarAway) {
  std::vector<Navigation> truth(2);
  truth[1].time = Time{seconds(4)};
  TrackDrift drift{PoseTimeline(truth)};
  const KnownObstacle seen{.middle = {50, 0}, .margin_m = 0, .last_echo = {}};
  const Pose turned{Rotation::from_heading_pitch_roll(Angle::degrees(2), {}, {}), {0, 0, 0}};
  drift.add(Time{}, {}, {});
  drift.add(Time{seconds(4)}, turned, std::span(&seen, 1));
  EXPECT_NEAR(drift.outcome({})->moved_95_m, 2 * 50 * std::sin(1 * kDegree), 1e-9);
}

TEST(TrackDrift, WithoutAReferenceThereIsNone) {
  std::vector<Navigation> truth(2);
  truth[0].time = Time{seconds(100)};
  truth[1].time = Time{seconds(110)};
  TrackDrift drift{PoseTimeline(truth)};
  drift.add(Time{seconds(105)}, {}, {});
  EXPECT_FALSE(drift.outcome({})) << "a gap of 10 s is not interpolated";
}

}  // namespace
}  // namespace isobath
