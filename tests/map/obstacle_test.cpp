#include <gtest/gtest.h>
#include <isobath/map/occupancy/obstacle.hpp>

namespace isobath {
namespace {

TEST(Obstacles, LieInTheWorldWhereTheVehicleSawThemWhateverItsRollAndPitch) {
  Obstacle obstacle;
  obstacle.outline = {{10, -1}, {12, -1}, {12, 1}};  // forward, starboard
  const Rotation R_WB = Rotation::from_heading_pitch_roll(Angle::degrees(90), Angle::degrees(20), Angle::degrees(-5));
  const Polygon outline = world_outline(obstacle, {R_WB, {100, 50, 7}});
  const Polygon expected{{101, 60}, {101, 62}, {99, 62}};  // ahead is east, starboard is south
  ASSERT_EQ(outline.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_LT((outline[i] - expected[i]).norm(), 1e-12) << i;
}

}  // namespace
}  // namespace isobath
