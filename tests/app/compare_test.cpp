// isobath compare: two inputs of any kind side by side.
#include <tests/app/logs.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;
using namespace test;
using testing::AllOf, testing::HasSubstr;

constexpr const char* kScene =
    "[scene]\nduration_s = 12\n[vehicle]\nstart = [0, 0, 2]\nspeed = 0\n[[sonar]]\npreset = \"micron\"\n"
    "sector_deg = 360\nstep_deg = 7.2\nrange_m = 6\nbins = 60\nblanking_m = 0.5\n"
    "[[cylinder]]\ncentre = [3, 0, 2]\nradius = 0.3\nlength = 4\n";

class Compare : public testing::Test {
 protected:
  fs::path file(const std::string& name, const std::string& bytes) { return write(folder_ / name, bytes); }
  ProgramResult compare(const fs::path& a, const fs::path& b, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"compare", a, b, "--out", out_, "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return isobath(arguments);
  }
  fs::path folder_ = scratch_folder(), out_ = folder_ / "out";
};

TEST_F(Compare, TheSameLogTwiceIsTheSame) {
  const fs::path log = file("wall.csv", wall_csv(4 * kTurn));
  const ProgramResult result = compare(log, log);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["a"], json["b"]);
  EXPECT_EQ(json["background_distance"], 0);
  EXPECT_EQ(json["a"]["scans"], 4);
  EXPECT_NEAR(json["a"]["strongest_echo"]["range_m"]["median"].get<double>(), kWall, kBin);
  for (const std::string path : json["files"]) EXPECT_TRUE(fs::exists(path)) << path;
  EXPECT_THAT(content_of(out_ / "report.html"), HasSubstr("wall.csv"));
}

TEST_F(Compare, ALogBesideASceneOnAnyNumberOfThreads) {
  const fs::path log = file("wall.csv", wall_csv(2 * kTurn)), scene = file("pole.toml", kScene);
  ASSERT_EQ(compare(log, scene, {"--threads", "1"}).exit_code, 0);
  const auto first = files_of(out_);
  const ProgramResult again = compare(log, scene, {"--threads", "2"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(files_of(out_), first);
  EXPECT_EQ(nlohmann::json::parse(again.out)["b"]["format"], "simulation");
}

TEST_F(Compare, WrongInputEndsInOneLine) {
  const fs::path log = file("wall.csv", wall_csv(kTurn));
  EXPECT_THAT(compare(log, folder_ / "absent.csv"), ends_with_one_line(HasSubstr("absent.csv")));
  EXPECT_THAT(compare(file("bad.toml", "[scene]\ndurations = 3\n"), log),
              ends_with_one_line(AllOf(HasSubstr("bad.toml:2"), HasSubstr("duration"))));
  EXPECT_THAT(compare(log, file("blind.toml", "[scene]\nduration_s = 1\n")),
              ends_with_one_line(HasSubstr("blind.toml")));
  EXPECT_THAT(compare(log, log, {"--set", "calibration.blanking_m=100"}), ends_with_one_line(HasSubstr("blind")));
  EXPECT_THAT(isobath({"compare", log}), ends_with_one_line(HasSubstr("B")));
  EXPECT_FALSE(fs::exists(out_)) << "no results of nothing";
}

}  // namespace
}  // namespace isobath
