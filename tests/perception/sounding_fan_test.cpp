// Soundings in the water as decisions of a flat fan: what stands at the vehicle's depth is an echo, the water before it
// is clear, and nothing is said of what no ray has passed.
#include <gtest/gtest.h>
#include <isobath/perception/sounding_fan.hpp>

namespace isobath {
namespace {

Sounding at(float x, float y, float z) {
  Sounding s;
  s.point = {x, y, z};
  s.range_m = s.point.norm();
  s.kind = Sounding::Kind::kWater;
  return s;
}

int bin_at(const SoundingFan& fan, double range_m) { return static_cast<int>(range_m / fan.ping().window.bin_m); }

TEST(SoundingFan, AnEchoAtTheVehiclesDepthIsAHitWithClearWaterBeforeIt) {
  SoundingFan fan(1.5);
  Swath swath;
  swath.soundings = {at(10, 0, 0.5F), at(8, 8, 0), at(8, -8, 6)};  // the last lies far below
  ASSERT_TRUE(fan.update(swath, Pose{}));
  const EchoDecisions& d = fan.decisions();
  const auto beam = [&](double degrees) {
    return static_cast<int>(std::lround(degrees - fan.ping().fan->azimuth.front().degrees()));
  };
  EXPECT_TRUE(d.hit(beam(0), bin_at(fan, 10)));
  EXPECT_TRUE(d.tells(beam(0), bin_at(fan, 9)));
  EXPECT_FALSE(d.hit(beam(0), bin_at(fan, 9)));
  EXPECT_FALSE(d.tells(beam(0), bin_at(fan, 11))) << "hidden";
  EXPECT_TRUE(d.hit(beam(45), bin_at(fan, 11.31)));
  // The ray to the sounding 6 m below leaves the band at a quarter of its way.
  EXPECT_TRUE(d.tells(beam(-45), bin_at(fan, 2.5)));
  EXPECT_FALSE(d.tells(beam(-45), bin_at(fan, 3)));
  EXPECT_FALSE(d.tells(beam(20), bin_at(fan, 5))) << "no ray went there";
}

TEST(SoundingFan, RollAndPitchAreTakenOut) {
  SoundingFan fan(1);
  Swath swath;
  const Pose X_WB{Rotation::from_heading_pitch_roll({}, Angle::degrees(30), {}), {0, 0, 5}};  // bow up
  const Eigen::Vector3d ahead_B = X_WB.rotation.inverse() * Eigen::Vector3d(12.03, 0, 0);
  swath.soundings = {at(static_cast<float>(ahead_B.x()), 0, static_cast<float>(ahead_B.z()))};
  ASSERT_TRUE(fan.update(swath, X_WB));
  int hits = 0;
  for (int b = 0; b < fan.decisions().beams(); ++b) hits += fan.decisions().hit(b, bin_at(fan, 12.03)) ? 1 : 0;
  EXPECT_EQ(hits, 1);
}

TEST(SoundingFan, SoundingsOfTheBottomAndThoseOfAnEchoSounderMakeNoScan) {
  SoundingFan fan(1.5);
  Swath swath;
  EXPECT_FALSE(fan.update(swath, Pose{}));
  swath.soundings = {at(1, 0, 9)};
  EXPECT_FALSE(fan.update(swath, Pose{})) << "none was within the band so far";
  swath.soundings = {at(5, 0, 0)};
  swath.soundings[0].kind = Sounding::Kind::kBottom;
  EXPECT_FALSE(fan.update(swath, Pose{}));
  swath.soundings[0].kind = Sounding::Kind::kWater;
  swath.frame = Swath::Frame::kLevel;
  EXPECT_FALSE(fan.update(swath, Pose{})) << "corrected for motion, as surveys are";
  swath.frame = Swath::Frame::kBody;
  EXPECT_TRUE(fan.update(swath, Pose{}));
  swath.soundings = {at(1, 0, 9)};
  EXPECT_TRUE(fan.update(swath, Pose{})) << "it clears what stood ahead";
}

}  // namespace
}  // namespace isobath
