// What stands in the water, what is bottom and what is surface; and that nothing is said where nobody can know.
#include <gtest/gtest.h>
#include <isobath/map/voxel/voxel_map.hpp>
#include <isobath/perception/water_label.hpp>

namespace isobath {
namespace {

Obstacle square_at(double ahead_m, double half_m = 1) {
  Obstacle o;
  o.outline = {
      {ahead_m - half_m, -half_m}, {ahead_m + half_m, -half_m}, {ahead_m + half_m, half_m}, {ahead_m - half_m, half_m}};
  o.centre = {ahead_m, 0};
  o.nearest = {ahead_m - half_m, 0};
  o.range_m = ahead_m - half_m;
  return o;
}

/// A sonar 4 m deep over a bottom 12 m deep, of beams 20 degrees tall: their edges meet the surface at 11.7 m, the
/// bottom at 23.4 m, when the vehicle is level.
HeardFrom level_at_four_metres(double pitch_deg = 0) {
  HeardFrom from;
  from.X_WB = {Rotation::from_heading_pitch_roll({}, Angle::degrees(pitch_deg), {}), {0, 0, 4}};
  from.height = Angle::degrees(20);
  from.water = {from.X_WB.rotation, 8.0, 4.0};
  return from;
}

// ledger: S6-69
TEST(WaterLabel, StandsWhatIsNearerThanTheBeamMeetsSurfaceAndBottom) {
  EXPECT_EQ(label_by_reach(square_at(10), level_at_four_metres()), WaterLabel::kStanding);
  EXPECT_EQ(label_by_reach(square_at(13), level_at_four_metres()), WaterLabel::kUnknown) << "the surface";
  EXPECT_EQ(label_by_reach(square_at(13), level_at_four_metres(-10)), WaterLabel::kStanding) << "bow down";
  EXPECT_EQ(label_by_reach(square_at(17), level_at_four_metres(-10)), WaterLabel::kUnknown) << "the bottom";
  HeardFrom blind = level_at_four_metres();
  blind.water.above_bottom_m.reset();
  EXPECT_EQ(label_by_reach(square_at(5), blind), WaterLabel::kUnknown) << "nobody knows where the bottom is";
}

/// Water that a fan standing upright has measured from 0 to 14 m of depth, 8 to 32 m ahead, but for `occupied` depths.
OccupancySnapshot measured_but(double from_m, double to_m) {
  VoxelMap map({.voxel_m = 0.5});
  VoxelBlocks& vertical = map.layer("upright");
  for (int x = 16; x < 64; ++x) {
    for (int y = -6; y < 6; ++y) {
      for (int z = 0; z < 28; ++z) {
        const double depth = 0.5 * z + 0.25;
        vertical.add({x, y, z}, to_evidence(depth > from_m && depth < to_m ? 6 : -6));
      }
    }
  }
  const std::string names[] = {"upright"};
  return {map, names, {0, 0, 4}, 60};
}

// ledger: S6-69 S5-35
TEST(WaterLabel, FollowsWhatASensorThatTellsHeightHasFound) {
  const auto label = [](double from_m, double to_m) {
    return label_by_heights(square_at(20), level_at_four_metres(), measured_but(from_m, to_m));
  };
  EXPECT_EQ(label(11.5, 12.5), WaterLabel::kBottom);
  EXPECT_EQ(label(0, 0.5), WaterLabel::kSurface);
  EXPECT_EQ(label(8, 12.5), WaterLabel::kStanding) << "a bank";
  EXPECT_EQ(label(0, 3), WaterLabel::kStanding) << "a pontoon";
  EXPECT_EQ(label(50, 51), WaterLabel::kUnknown) << "nothing there";
  EXPECT_EQ(label_by_heights(square_at(50), level_at_four_metres(), measured_but(11.5, 12.5)), WaterLabel::kUnknown)
      << "where nobody has looked";
}

TEST(WaterLabel, WithoutAnAltitudeOnlyWhatIsNoDeeperThanTheSonarStands) {
  HeardFrom from = level_at_four_metres();
  from.water.above_bottom_m.reset();
  EXPECT_EQ(label_by_heights(square_at(20), from, measured_but(3, 12)), WaterLabel::kStanding);
  EXPECT_EQ(label_by_heights(square_at(20), from, measured_but(7, 12)), WaterLabel::kUnknown);
}

TEST(WaterLabel, AsksForHeightsOnlyWhereTheReachDoesNotTell) {
  std::vector<Obstacle> both = {square_at(10), square_at(20)};
  label_obstacles(both, level_at_four_metres(), nullptr);
  EXPECT_EQ(both[0].label, WaterLabel::kStanding);
  EXPECT_EQ(both[1].label, WaterLabel::kUnknown);
  const OccupancySnapshot space = measured_but(11.5, 12.5);
  label_obstacles(both, level_at_four_metres(), &space);
  EXPECT_EQ(both[0].label, WaterLabel::kStanding);
  EXPECT_EQ(both[1].label, WaterLabel::kBottom);
}

}  // namespace
}  // namespace isobath
