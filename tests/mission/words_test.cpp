// Texts for people: an obstacle by its number, and where it lies.
#include <gtest/gtest.h>
#include <isobath/mission/messages/reason_text.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

TEST(Words, NameAnObstacleByItsNumberWhereItHasOne) {
  Hazard hazard;
  EXPECT_EQ(text_of(hazard), "an obstacle");
  hazard.obstacle = 3;
  EXPECT_EQ(text_of(hazard), "obstacle 3");
  hazard.kind = HazardKind::kRemembered;
  EXPECT_EQ(text_of(hazard), "remembered obstacle 3");
  hazard.obstacle = 0;
  EXPECT_EQ(text_of(hazard), "a remembered obstacle");
  hazard.kind = HazardKind::kFence;
  EXPECT_EQ(text_of(hazard), "the fence");
}

TEST(Words, SayWhereAPlaceLiesFromTheVehicle) {
  const Vector2d vehicle(100, 200);
  const Angle east = Angle::degrees(90);
  EXPECT_EQ(direction_of({100, 212}, vehicle, east), "12 m ahead");
  EXPECT_EQ(direction_of({106, 210.4}, vehicle, east), "12 m ahead to port") << "north of a vehicle that heads east";
  EXPECT_EQ(direction_of({94, 210.4}, vehicle, east), "12 m ahead to starboard");
  EXPECT_EQ(direction_of({104.2, 200}, vehicle, east), "4.2 m abeam to port");
  EXPECT_EQ(direction_of({97, 195}, vehicle, east), "5.8 m astern to starboard");
  EXPECT_EQ(direction_of({100, 150}, vehicle, east), "50 m astern");
  EXPECT_EQ(direction_of({100, 200}, vehicle, east), "at the vehicle");
}

}  // namespace
}  // namespace isobath
