// `isobath control`: what it prints and writes, and what it refuses.
#include <fstream>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using testing::HasSubstr;

// ledger: S7-11 S7-12 S7-D01 S7-D02
TEST(Control, ComparesThreeKindsOfControl) {
  const auto folder = test::scratch_folder();
  const auto result = test::isobath({"control", "--vehicle", "bluerov2", "--task", "station", "--change", "heavy",
                                     "--runs", "2", "--out", folder.string(), "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  ASSERT_EQ(json["rows"].size(), 3u);
  const auto peak = [&](int row) { return json["rows"][row]["at_depth_max_m"]["most"].get<double>(); };
  EXPECT_EQ(json["rows"][0]["control"], "pid");
  EXPECT_EQ(json["rows"][2]["control"], "adaptive");
  EXPECT_LT(peak(2), 0.1);
  EXPECT_GT(peak(0), peak(2));
  for (const auto& bar : json["bars"]) EXPECT_TRUE(bar["met"]) << bar;
  for (const auto& file : json["files"]) EXPECT_TRUE(std::filesystem::exists(file.get<std::string>())) << file;
}

// A vehicle whose file names another bandwidth does not meet the bars: exit code 1, and the words say which.
TEST(Control, ExitCodeSaysWhetherTheBarsAreMet) {
  const auto folder = test::scratch_folder();
  std::string text = test::content_of(test::source_folder() / "vehicles/bluerov2.toml");
  const std::string key = "force_bandwidth = 2";
  ASSERT_NE(text.find(key), std::string::npos);
  text.replace(text.find(key), key.size(), "force_bandwidth = 0.5");
  std::ofstream(folder / "weak.toml") << text;
  const auto result =
      test::isobath({"control", "--vehicle", (folder / "weak.toml").string(), "--task", "station", "--change", "heavy",
                     "--control", "adaptive", "--runs", "1", "--out", (folder / "out").string()});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.out, HasSubstr("NOT MET"));
}

TEST(Control, IsWhereEvalSendsThoseWhoAskItForControl) {
  const auto result = test::isobath({"eval", "control"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("isobath control compares"));
}

TEST(Control, RefusesWhatItDoesNotKnow) {
  const auto refused = [](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"control", "--out", test::scratch_folder().string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto result = test::isobath(arguments);
    EXPECT_EQ(result.exit_code, 2);
    return result.err;
  };
  EXPECT_THAT(refused({"--vehicle", "bluerov"}), HasSubstr("did you mean bluerov2?"));
  EXPECT_THAT(refused({"--task", "loop"}), HasSubstr("--task"));
  EXPECT_THAT(refused({"--runs", "0"}), HasSubstr("--runs"));
}

}  // namespace
}  // namespace isobath
