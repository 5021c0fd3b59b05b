// `isobath helix`: what it prints and writes, and what it refuses.
#include <cmath>
#include <numbers>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using testing::HasSubstr;

// ledger: S5-40 S5-56 S5-D08 S5-D09
TEST(Helix, WritesItsPicturesAndTheReport) {
  const auto folder = test::scratch_folder();
  const auto result = test::isobath({"helix", "--out", folder.string(), "--json", "--set", "approach.images=2"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_GE(json["known_share"], 0.9);
  EXPECT_LT(json["known_share_straight"], 0.7);
  EXPECT_EQ(json["decision"], "pass");
  EXPECT_EQ(json["files"].size(), 10u);
  for (const auto& file : json["files"]) EXPECT_TRUE(std::filesystem::exists(file.get<std::string>())) << file;
}

/// What `isobath helix` prints with these settings.
nlohmann::json helix_with(const std::vector<std::string>& settings, int exit_code = 0) {
  std::vector<std::string> arguments{"helix", "--out", test::scratch_folder().string(), "--json"};
  for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
  const auto result = test::isobath(arguments);
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  return nlohmann::json::parse(result.out, nullptr, false);
}

// The straight approach stays on the middle line, where an opening of 25 m by 8 m subtends 2 atan(W / 2D) and
// 2 atan(H / 2D); both grow. With a course of north, the pylons' bearings lie on both sides of it.
// ledger: S5-43 S5-E04 S5-E06
TEST(Helix, StatesTheAnglesOfTheOpeningOnAnyCourse) {
  for (const char* course : {"0", "-4", "180"}) {
    const auto json = helix_with({"approach.images=1", std::string("approach.course_deg=") + course});
    const auto& opening = json["opening"];
    ASSERT_GE(opening.size(), 6u);
    double last = 0;
    for (const auto& seen : opening) {
      const double distance = seen["distance_m"];
      EXPECT_NEAR(seen["horizontal_deg"], 2 * std::atan(12.5 / distance) * 180 / std::numbers::pi, 0.2) << distance;
      EXPECT_NEAR(seen["vertical_deg"], 2 * std::atan(4 / distance) * 180 / std::numbers::pi, 0.2) << distance;
      EXPECT_GT(seen["horizontal_deg"], last) << distance;
      last = seen["horizontal_deg"];
    }
    EXPECT_NEAR(opening[0]["horizontal_deg"], 23.5, 0.1) << "at 60 m";
  }
}

// Of a look at a rock a third gives an echo, of a look at water one in fifty does: the map that is made of them, by
// which the vehicle decides, holds nine tenths of the opening free after the helix and not after the straight approach,
// and knows more of the water; the decision is taken 20 to 30 m before. ledger: S5-40 S5-58 S5-D09
TEST(Helix, WidensTheMapAlsoWithMissedAndFalseEchoes) {
  for (const char* seed : {"1", "2"}) {
    const auto json = helix_with({"approach.images=2", "echoes.false_alarm=0.02", std::string("echoes.seed=") + seed});
    EXPECT_GE(json["free_share"], 0.9);
    EXPECT_LT(json["free_share_straight"], 0.7);
    EXPECT_LT(json["free_share"], 1) << "false echoes are in the map";
    EXPECT_LT(json["bits_a_voxel"], json["bits_a_voxel_straight"].get<double>() - 0.05);
    EXPECT_EQ(json["decision"], "pass");
    EXPECT_GT(json["decision_m"], 20);
    EXPECT_LT(json["decision_m"], 30);
  }
}

// A rock on the middle line, 35 m before the opening: its echoes close the way, and the vehicle turns away before it.
// ledger: S5-45 S5-47
TEST(Helix, TurnsAwayFromARockThatItsMapShows) {
  const auto json = helix_with({"approach.images=2", "approach.rock_radius=1.5"}, 1);
  EXPECT_EQ(json["decision"], "turn away");
  EXPECT_GT(json["nearest_m"], 36.5);
}

// From near by there is no time to look round. ledger: S5-45
TEST(Helix, ExitsWithOneWhereTheOpeningStaysUnknown) {
  const auto folder = test::scratch_folder();
  const auto result = test::isobath({"helix", "-o", folder.string(), "--from", "30", "--width", "40"});
  EXPECT_EQ(result.exit_code, 1) << result.out;
  EXPECT_THAT(result.out, HasSubstr("turn away"));
}

TEST(Helix, RefusesWhatMakesNoSense) {
  using test::ends_with_one_line;
  EXPECT_THAT(test::isobath({"helix", "--speed", "9"}), ends_with_one_line(HasSubstr("cannot go at this speed")));
  EXPECT_THAT(test::isobath({"helix", "--set", "helix.advanze=4"}), ends_with_one_line(HasSubstr("advance")));
  EXPECT_THAT(test::isobath({"helix", "--width", "-3"}), ends_with_one_line(HasSubstr("width")));
  EXPECT_THAT(test::isobath({"helix", "--vehicle", "none.toml"}), ends_with_one_line(HasSubstr("none.toml")));
}

}  // namespace
}  // namespace isobath
