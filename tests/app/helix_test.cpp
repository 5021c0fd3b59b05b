// `isobath helix`: what it prints and writes, and what it refuses.
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
