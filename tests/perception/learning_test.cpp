// What readings and histories teach: how far to trust a sensor, and what an object does.
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/perception/object_label.hpp>
#include <isobath/perception/sensor_reliability.hpp>

namespace isobath {
namespace {

using Vector3 = Eigen::Vector3d;

Time at(double s) { return Time{seconds(s)}; }

TEST(SensorReliability, AgreementIsWithinTheGate) {
  EXPECT_EQ(agreement(10.0, 10.29, 0.1), Agreement::kConfirming);
  EXPECT_EQ(agreement(10.0, 10.31, 0.1), Agreement::kConflicting);
  EXPECT_EQ(agreement(std::nullopt, 10.0, 0.1), Agreement::kConflicting);
  EXPECT_EQ(agreement(10.0, std::nullopt, 0.1), Agreement::kConflicting);
  EXPECT_EQ(agreement(std::nullopt, std::nullopt, 0.1), Agreement::kConfirming);
}

// By hand: 3 of 4 gives 4 / 6; and the posterior Beta(4, 2) has variance 8 / (36 * 7). ledger: S1-06
TEST(SensorReliability, IsLaplacesEstimate) {
  SensorReliability sensors(2);
  EXPECT_EQ(sensors.counts()[0].reliability(), 0.5);
  for (const auto a : {Agreement::kConfirming, Agreement::kConfirming, Agreement::kConfirming, Agreement::kConflicting,
                       Agreement::kIrrelevant, Agreement::kIrrelevant}) {
    sensors.count(0, a);
  }
  EXPECT_NEAR(sensors.counts()[0].reliability(), 4.0 / 6, 1e-15);
  EXPECT_NEAR(sensors.counts()[0].sigma(), std::sqrt(8.0 / 252), 1e-15);
  EXPECT_EQ(sensors.counts()[0].irrelevant, 2u);
  EXPECT_EQ(sensors.counts()[1].reliability(), 0.5);
}

// ledger: S1-06
TEST(SensorReliability, OutliersLowerItAfter200Readings) {
  SensorReliability sensors(2);
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const double truth = random.uniform(5, 40);
    sensors.count(0, agreement(truth + 0.1 * random.normal(), truth, 0.1));
    const bool outlier = random.uniform() < 0.3;
    sensors.count(1, agreement(outlier ? random.uniform(0, 50) : truth + 0.1 * random.normal(), truth, 0.1));
  }
  const double clean = sensors.counts()[0].reliability(), dirty = sensors.counts()[1].reliability();
  EXPECT_GT(clean, 0.97);
  EXPECT_NEAR(dirty, 0.7, 3 * sensors.counts()[1].sigma());
  const std::vector<double> in_force = {2, 2};
  const auto weights = sensors.suggested_weights(in_force);
  EXPECT_EQ(weights[0], 2);
  EXPECT_NEAR(weights[1], 2 * dirty / clean, 1e-12);
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
