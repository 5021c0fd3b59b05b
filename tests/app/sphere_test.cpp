// `isobath sphere`: a room scanned along a path, three pictures of it.
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
using test::ends_with_one_line;
using testing::HasSubstr;

// ledger: S4-D01 S4-35
TEST(Sphere, WritesThreePicturesOfARoomAndSaysWhatIsInItsGrid) {
  const auto folder = test::scratch_folder();
  const std::string room = (test::source_folder() / "scenarios/polygon_room.toml").string();
  const auto result = test::isobath({"sphere", room, "--out", (folder / "out").string(), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["scans"], 10);
  EXPECT_EQ(json["beams"], 1440);
  EXPECT_LT(json["median_error_m"], 0.25);
  for (const char* name : {"plan.png", "above.png", "solid.png"}) {
    EXPECT_EQ(test::content_of(folder / "out" / name).substr(1, 3), "PNG") << name;
  }
  const auto few = test::isobath({"sphere", room, "--out", (folder / "few").string(), "--scans", "3", "--range", "12",
                                  "--rule", "maximum_response"});
  EXPECT_THAT(few.out, HasSubstr("3 scans, 432 beams"));
}

TEST(Sphere, SaysInOneLineWhatItCannotScan) {
  const auto folder = test::scratch_folder();
  const auto tank = (test::source_folder() / "scenarios/tank.toml").string();
  EXPECT_THAT(test::isobath({"sphere", (folder / "nowhere.toml").string()}), ends_with_one_line(HasSubstr("nowhere")));
  EXPECT_EQ(test::isobath({"sphere", tank, "--out", (folder / "out").string()}).exit_code, 2);
  EXPECT_EQ(test::isobath({"sphere"}).exit_code, 2);
}

}  // namespace
}  // namespace isobath
