#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/sim/simulator.hpp>

namespace isobath::hydrophones {
namespace {

Scene scene_with(std::vector<SoundConfig> sounds) {
  Scene scene;
  scene.about.duration_s = 600;
  scene.vehicle.start = {0, 0, 5};
  scene.vehicle.speed = 0;
  scene.hydrophones = {.on = true, .interval_s = 0.5, .fluctuation_db = 0};
  scene.sounds = std::move(sounds);
  return scene;
}

std::vector<PassiveBearing> heard_in(Scene scene, SimulationConfig config = {}) {
  Simulator simulator(std::move(scene), config);
  std::vector<PassiveBearing> all;
  while (const auto event = simulator.next()) {
    if (const auto* heard = std::get_if<PassiveBearing>(&*event)) all.push_back(*heard);
  }
  return all;
}

// ledger: S4-54
TEST(Hydrophones, HearBearingsWithTheStatedError) {
  const auto all = heard_in(scene_with({{.name = "pump", .position = {30, 40, 5}, .frequency_hz = 120}}));
  ASSERT_GE(all.size(), 1200U);
  double sum = 0, squares = 0;
  for (const PassiveBearing& b : all) {
    const double off = b.bearing.degrees() - Angle::radians(std::atan2(40, 30)).degrees();
    sum += off;
    squares += off * off;
    EXPECT_NEAR(b.frequency_hz, 120, 1);
    EXPECT_FALSE(b.elevation);
    // 130 dB over 50 m, noise 75 dB in a cell of 0.5 Hz, gain 6 dB
    EXPECT_NEAR(b.snr_db, 130 - 20 * std::log10(50.0) - (75 + 10 * std::log10(0.5) - 6), 0.01);
  }
  const double n = static_cast<double>(all.size()), mean = sum / n;
  EXPECT_LT(std::abs(mean), 3 * 1.5) << "the bias is half of 3 degrees";
  EXPECT_NEAR(std::sqrt(squares / n - mean * mean), 3 * std::sqrt(0.75), 0.2);
}

// ledger: S4-54
TEST(Hydrophones, DoNotHearWhatIsFaintFarOrOutOfTheBand) {
  const auto count = [](SoundConfig sound) { return heard_in(scene_with({sound})).size(); };
  // The level that reaches the threshold of 8 dB at 50 m.
  const double level = 8 + 20 * std::log10(50.0) + (75 + 10 * std::log10(0.5) - 6);
  EXPECT_GT(count({.position = {30, 40, 5}, .source_level_db = level + 0.1}), 1000U);
  EXPECT_EQ(count({.position = {30, 40, 5}, .source_level_db = level - 0.1}), 0U);
  EXPECT_EQ(count({.position = {300, 400, 5}, .source_level_db = level + 10}), 0U);
  EXPECT_EQ(count({.position = {30, 40, 5}, .frequency_hz = 5000, .source_level_db = 200}), 0U);
}

TEST(Hydrophones, AreAFunctionOfTheSeedAndChangeNothingElse) {
  const SoundConfig sound{.position = {30, 40, 15}};
  Scene scene = scene_with({sound});
  scene.hydrophones.elevation_error = Angle::degrees(2);
  const auto once = heard_in(scene, {.seed = 4}), again = heard_in(scene, {.seed = 4}),
             other = heard_in(scene, {.seed = 5});
  ASSERT_EQ(once.size(), again.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_EQ(once[i].bearing, again[i].bearing);
    ASSERT_TRUE(once[i].elevation);
    EXPECT_NEAR(once[i].elevation->degrees(), -std::atan2(10, 50) * 180 / std::numbers::pi, 10);
  }
  EXPECT_NE(once[0].bearing, other[0].bearing);
  EXPECT_TRUE(heard_in([&] {
                Scene off = scene;
                off.hydrophones.on = false;
                return off;
              }())
                  .empty());
}

TEST(Hydrophones, ASoundSitsInItsBody) {
  Scene scene = scene_with({{.body = "barge"}});
  scene.hydrophones.bearing_error = Angle::degrees(0.01);
  scene.bodies = {{.name = "barge", .shape = Box{.centre = {0, 30, 2}, .size = {10, 4, 6}}}};
  for (const PassiveBearing& b : heard_in(scene)) EXPECT_NEAR(b.bearing.degrees(), 90, 0.1);
}

TEST(Hydrophones, RefuseASoundInABodyThatIsNotThere) {
  try {
    (void)parse_scene("[[box]]\nname = \"barge\"\n[[sound]]\nbody = \"bargee\"\n", "scene.toml");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("unknown body bargee"));
    EXPECT_THAT(error.what(), testing::HasSubstr("scene.toml:3"));
  }
}

}  // namespace
}  // namespace isobath::hydrophones
