// The spherical grid of a run: what every sonar has heard goes into one grid around the vehicle, and moves with it.
#include <gtest/gtest.h>
#include <isobath/world/spherical_model.hpp>
#include <tests/support/echoes.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;

Time at(double t) { return Time(seconds(t)); }

RangeReading ahead(double t, std::optional<double> range_m) {
  return {.time = at(t), .range_m = range_m, .max_range_m = 50, .width = Angle::degrees(2.5), .X_BS = {}};
}

Pose place(double north) { return {{}, {north, 0, 5}}; }

/// The echo nearest to a place north of the vehicle, m from it.
double nearest_echo(const SphericalModel& model, double north) {
  double nearest = 1e9;
  model.grid()->cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
    for (const SphericalCell& cell : beam) {
      if (cell.echoes > 0) nearest = std::min(nearest, (model.grid()->point_of(cell) - Vector3d(0, north, 0)).norm());
    }
  });
  return nearest;
}

// ledger: S4-01 S4-50
TEST(SphericalModel, HoldsRangesPingsAndSoundingsAlike) {
  SphericalModel model({});
  EXPECT_EQ(model.grid(), nullptr);
  model.update(ahead(1, 20), place(0));
  EXPECT_LT(nearest_echo(model, 20), 0.2);

  const auto value = [](int, int bin) { return bin == 60 ? 250 : 10 + bin % 3; };
  Ping ping = test::ping_of<std::uint8_t>(test::fan_of(1, {}, Angle::degrees(2.5)), {0, 0.5, 100}, value);
  ping.time = at(1.5);
  EchoDecisions decisions;
  decisions.reset(1, 100);
  for (const int bin : {10, 60}) decisions.set_hit(0, bin);
  model.update({ping, place(0), decisions});
  EXPECT_LT(nearest_echo(model, 30.25), 0.3);
  EXPECT_GT(nearest_echo(model, 5.25), 5) << "a decision that does not stand out of the noise";

  Swath swath;
  swath.time = at(2);
  for (const float r : {40.0f, 41.0f}) {
    Sounding& s = swath.soundings.emplace_back();
    s.point = {r, 0, 0};
    s.range_m = r;
  }
  model.update(swath, place(0));
  EXPECT_LT(nearest_echo(model, 40), 0.5);
  const SphericalOutcome outcome = model.outcome(1);
  EXPECT_EQ(outcome.pings + outcome.ranges + outcome.swaths, 3u);
  EXPECT_GT(outcome.occupied, 0u);
}

/// A ping straight ahead, 0.5 m a bin, with decisions for echoes at these bins of even noise; the first `blind` bins
/// tell nothing.
void hear(SphericalModel& model, double north, std::initializer_list<int> echoes, int blind) {
  Ping ping = test::ping_of<std::uint8_t>(test::fan_of(1, {}, Angle::degrees(2.5)), {0, 0.5, 100},
                                          [](int, int bin) { return 100 + 20 * (bin % 3); });
  ping.time = at(1 + north);
  EchoDecisions decisions;
  decisions.reset(1, 100);
  std::fill(decisions.p_detect.begin(), decisions.p_detect.end(), 0.8f);
  for (const int bin : echoes) decisions.set_hit(0, bin);
  for (int bin = 0; bin < blind; ++bin) decisions.set_unusable(bin);
  model.update({ping, place(north), decisions});
}

// Walls and their multiples fill the beams of a tank, so that nothing stands out of one.
// ledger: S4-12 S4-50
TEST(SphericalModel, CallsNoWaterClearBehindEchoesThatComeTooDenselyForFalseAlarms) {
  SphericalModel model({});
  hear(model, 0, {8, 60, 61, 62, 63, 64}, 0);
  EXPECT_LT(nearest_echo(model, 30.25), 0.3);
  EXPECT_GT(nearest_echo(model, 4.25), 4) << "one decision is a false alarm";
  const SphericalOutcome outcome = model.outcome(0.5);
  EXPECT_EQ(outcome.ahead.verdict, WayAhead::Verdict::kBlocked);
  EXPECT_NEAR(outcome.ahead.blocked_m, 30, 1);
}

// ledger: S4-12 S4-50 S6-09
TEST(SphericalModel, KnowsTheWaterBeyondABlindZoneOnceTheVehicleHasComeNear) {
  SphericalModel model({});
  hear(model, 0, {}, 20);
  EXPECT_EQ(model.outcome(0.1).ahead.verdict, WayAhead::Verdict::kUnknown);
  EXPECT_LT(model.outcome(0.1).ahead.clear_m, 1) << "the first 10 m were never heard";
  for (double north = 1; north <= 12; ++north) hear(model, north, {}, 20);
  EXPECT_GT(model.outcome(0.1).ahead.clear_m, 40);
}

// ledger: S4-21 S4-48
TEST(SphericalModel, MovesWithTheVehicleButNotWithAJumpOfItsPosition) {
  SphericalModel model({});
  model.update(ahead(1, 20), place(0));
  model.update(ahead(2, {}), place(3));
  EXPECT_LT(nearest_echo(model, 17), 0.5);
  model.move_along({100, 0, 0});
  model.update(ahead(2.9, {}), place(104));  // 1 m on
  EXPECT_LT(nearest_echo(model, 16), 0.5);
  EXPECT_EQ(model.newest(), nullptr) << "no scan has ended";
  model.update(ahead(3, {}), place(104));
  ASSERT_NE(model.newest(), nullptr) << "a scan ends after 2 s without a sweep";
  EXPECT_EQ(model.newest()->X_WB.translation.x(), 104);
  model.end_scan();
  const auto newest = model.newest();
  model.end_scan();
  EXPECT_EQ(model.newest(), newest) << "nothing came since";
}

// Of a vehicle that heads east, a sounding to port lies north.
TEST(SphericalModel, PlacesEchoesByTheHeadingOfTheVehicle) {
  SphericalModel model({});
  const Pose east{Rotation::from_heading(Angle::degrees(90)), {0, 0, 5}};
  Swath swath;
  swath.time = at(1);
  Sounding& s = swath.soundings.emplace_back();
  s.point = {0, -15, 0};
  s.range_m = 15;
  model.update(swath, east);
  EXPECT_LT(nearest_echo(model, 15), 0.3);
  RangeReading port = ahead(2, 30);
  port.X_BS.rotation = Rotation::from_heading(Angle::degrees(-90));
  model.update(port, east);
  EXPECT_LT(nearest_echo(model, 30), 0.5);
}

// Sensors that tell of different times in turn do not keep a scan open; extreme readings change nothing.
TEST(SphericalModel, EndsItsScansWhateverItsSensorsTell) {
  SphericalModel model({});
  for (int k = 0; k < 40; ++k) {
    model.update(ahead(0.1 * k, 20), place(0));
    model.update(ahead(0.1 * k - 0.3, 20), place(0));
  }
  ASSERT_NE(model.newest(), nullptr);
  RangeReading absurd = ahead(5, 20);
  absurd.X_BS.translation = {1e200, 0, 0};
  model.update(absurd, place(0));
  EXPECT_LT(nearest_echo(model, 20), 0.5);
}

TEST(SphericalModel, SaysWhatIsAhead) {
  SphericalModel model({});
  EXPECT_EQ(model.outcome(1).ahead.verdict, WayAhead::Verdict::kUnknown);
  for (int k = 0; k < 3; ++k) model.update(ahead(k, 20), place(0));
  const WayAhead ahead = model.outcome(0.2).ahead;
  EXPECT_EQ(ahead.verdict, WayAhead::Verdict::kBlocked);
  EXPECT_NEAR(ahead.blocked_m, 20, 1);
}

// ledger: S4-36
TEST(SphericalModel, TakesTheResolutionOfAListedSonar) {
  SphericalModelConfig config;
  config.sonar = "wesmar_ss150";
  SphericalModel model(config);
  model.update(ahead(1, 20), place(0));
  EXPECT_EQ(model.grid()->config().range_m, 100);
  EXPECT_EQ(model.grid()->config().min_layer_m, 0.5);
  config.sonar = "asdic";
  EXPECT_THROW(SphericalModel{config}, Error);
  config = {};
  config.keep = false;
  SphericalModel none(config);
  none.update(ahead(1, 20), place(0));
  EXPECT_EQ(none.grid(), nullptr);
}

}  // namespace
}  // namespace isobath
