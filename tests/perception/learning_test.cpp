// What readings and histories teach: how far to trust a sensor, and what an object does.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/perception/object_label.hpp>
#include <isobath/perception/range_prediction.hpp>
#include <isobath/perception/sensor_reliability.hpp>

namespace isobath {
namespace {

using Vector3 = Eigen::Vector3d;

Time at(double s) { return Time{seconds(s)}; }

// By hand: 3 of 4 gives 4 / 6. ledger: S1-06
TEST(SensorReliability, IsLaplacesEstimate) {
  SensorReliability sensors(2);
  EXPECT_EQ(sensors.counts()[0].reliability(), 0.5);
  for (const auto a : {Agreement::kConfirming, Agreement::kConfirming, Agreement::kConfirming, Agreement::kConflicting,
                       Agreement::kIrrelevant, Agreement::kIrrelevant}) {
    sensors.count(0, a);
  }
  EXPECT_NEAR(sensors.counts()[0].reliability(), 4.0 / 6, 1e-15);
  EXPECT_EQ(sensors.counts()[0].irrelevant, 2u);
  EXPECT_EQ(sensors.counts()[1].reliability(), 0.5);
}

// ledger: S1-06
TEST(SensorReliability, OutliersLowerItAfter200Readings) {
  SensorReliability sensors(2);
  Random random(4);
  const auto hear = [&](std::size_t sensor, double range_m, double expected_m) {
    const bool agrees = RangePrediction{expected_m, 0, 50}.agrees(range_m, 0.1, 3);
    sensors.count(sensor, agrees ? Agreement::kConfirming : Agreement::kConflicting);
  };
  for (int i = 0; i < 200; ++i) {
    const double truth = random.uniform(5, 40);
    hear(0, truth + 0.1 * random.normal(), truth);
    const bool outlier = random.uniform() < 0.3;
    hear(1, outlier ? random.uniform(0, 50) : truth + 0.1 * random.normal(), truth);
  }
  const double clean = sensors.counts()[0].reliability(), dirty = sensors.counts()[1].reliability();
  EXPECT_GT(clean, 0.97);
  EXPECT_NEAR(dirty, 0.7, 3 * std::sqrt(0.7 * 0.3 / 200));
}

std::vector<AttributeEntry> track(const Vector3& v, double sigma, int count, Random& random) {
  std::vector<AttributeEntry> entries;
  for (int i = 0; i < count; ++i) {
    const double north = sigma * random.normal(), east = sigma * random.normal(), depth = sigma * random.normal();
    entries.push_back({at(1.7e9 + 10 * i), Vector3(Vector3(100, 50, 5) + v * 10 * i + Vector3(north, east, depth))});
  }
  return entries;
}

// ledger: S1-06
TEST(ObjectLabel, ADriftingPositionIsMovingANoisyOneIsNot) {
  Random random(5);
  int moving = 0, called_moving = 0;
  for (int i = 0; i < 500; ++i) {
    moving += label_object({}, track({0.05, -0.02, 0}, 0.5, 16, random), {}) == ObjectLabel::kMoving;
    called_moving += label_object({}, track({0, 0, 0}, 0.5, 16, random), {}) == ObjectLabel::kMoving;
  }
  EXPECT_EQ(moving, 500);
  EXPECT_LE(called_moving, 4);  // the gate leaves 0.1 %
  EXPECT_EQ(label_object({}, track({0, 0, 0}, 0.5, 16, random), {}), ObjectLabel::kStatic);
  EXPECT_EQ(label_object({}, track({1, 0, 0}, 0.5, 2, random), {}), ObjectLabel::kUnknown);
  EXPECT_EQ(label_object({}, {}, {}), ObjectLabel::kUnknown);
}

// ledger: S1-06
TEST(ObjectLabel, VanishedIsWhatWasLookedForInVain) {
  Random random(6);
  const auto positions = track({0, 0, 0}, 0.1, 5, random);
  std::vector<AttributeEntry> looks = {{at(0), 1.0}, {at(1), 0.0}, {at(2), 0.0}};
  EXPECT_EQ(label_object({}, positions, looks), ObjectLabel::kStatic);
  looks.push_back({at(3), 0.0});
  EXPECT_EQ(label_object({}, positions, looks), ObjectLabel::kVanished);
  looks.push_back({at(4), 1.0});
  EXPECT_EQ(label_object({}, positions, looks), ObjectLabel::kStatic);
}

}  // namespace
}  // namespace isobath
