#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/sonar/passive_bearing.hpp>

namespace isobath {
namespace {

PassiveBearing heard_from(const Eigen::Vector3d& p_WQ, const Pose& X_WS, bool elevation) {
  const Eigen::Vector3d p_SQ = X_WS.rotation.inverse() * (p_WQ - X_WS.translation);
  PassiveBearing heard;
  heard.bearing = Angle::radians(std::atan2(p_SQ.y(), p_SQ.x()));
  if (elevation) heard.elevation = Angle::radians(std::atan2(-p_SQ.z(), p_SQ.head<2>().norm()));
  return heard;
}

double degrees_off(Angle a, Angle b) { return abs((a - b).wrapped()).degrees(); }

// ledger: S4-54
TEST(PassiveBearing, PointsAtTheSoundWhateverTheVehiclesAttitude) {
  Random random(7);
  for (int i = 0; i < 200; ++i) {
    const Pose X_WS{Rotation::from_heading_pitch_roll(Angle::degrees(random.uniform(0, 360)),
                                                      Angle::degrees(random.uniform(-40, 40)),
                                                      Angle::degrees(random.uniform(-40, 40))),
                    {random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(0, 30)}};
    const Eigen::Vector3d level(random.uniform(20, 90), random.uniform(20, 90), X_WS.translation.z());
    const Eigen::Vector3d deep = level + Eigen::Vector3d(0, 0, random.uniform(-15, 15));
    for (const auto& [sound, elevation] : {std::pair(level, false), std::pair(level, true), std::pair(deep, true)}) {
      const Eigen::Vector3d to = sound - X_WS.translation;
      const auto bearing = bearing_in_world(heard_from(sound, X_WS, elevation), X_WS);
      ASSERT_TRUE(bearing);
      EXPECT_LT(degrees_off(*bearing, Angle::radians(std::atan2(to.y(), to.x()))), 1e-9);
    }
  }
}

TEST(PassiveBearing, StraightDownHasNoDirection) {
  PassiveBearing heard;
  heard.elevation = Angle::degrees(-90);
  EXPECT_FALSE(bearing_in_world(heard, Pose{}));
  const Pose nose_down{Rotation::from_heading_pitch_roll({}, Angle::degrees(90), {}), {0, 0, 0}};
  heard.elevation.reset();
  EXPECT_FALSE(bearing_in_world(heard, nose_down)) << "no direction in its plane is level, or every one is";
}

}  // namespace
}  // namespace isobath
