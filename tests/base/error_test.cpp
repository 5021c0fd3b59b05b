#include <gmock/gmock.h>
#include <isobath/base/error.hpp>

namespace isobath {
namespace {

TEST(Place, SaysOnlyWhatIsKnown) {
  EXPECT_EQ(Place{}.text(), "");
  EXPECT_EQ((Place{"a.toml", {}, {}, {}, {}}.text()), "a.toml");
  EXPECT_EQ((Place{"a.toml", {}, 3, 9, "sonar.range_m"}.text()), "a.toml:3:9: sonar.range_m");
  EXPECT_EQ((Place{"a.toml", {}, 3, {}, {}}.text()), "a.toml:3");
  EXPECT_EQ((Place{"", {}, 3, 9, {}}.text()), "line 3:9");
  EXPECT_EQ((Place{"a.bin", 4096, {}, {}, "angle"}.text()), "a.bin: byte 4096: angle");
  EXPECT_EQ((Place{"", 0, {}, {}, {}}.text()), "byte 0");
  EXPECT_EQ((Place{"", {}, {}, {}, "angle"}.text()), "angle");
  EXPECT_EQ((Place{"a.toml", {}, {}, 9, {}}.text()), "a.toml") << "a column without its line says nothing";
}

TEST(Error, KeepsItsPlaceForTheCaller) {
  try {
    throw Error("too short", {"log.bin", 77, {}, {}, {}});
  } catch (const std::runtime_error& e) {
    EXPECT_STREQ(e.what(), "log.bin: byte 77: too short");
    EXPECT_EQ(dynamic_cast<const Error&>(e).where().byte, 77u);
  }
}

TEST(Error, UntrustedTextCannotBreakTheLine) {
  const Error e("\x1b[31mred\r\n", {"a\nb", {}, {}, {}, {}}, "x\ty", "\x7f");
  EXPECT_STREQ(e.what(), "a b:  [31mred  ; allowed: x y;  ");
}

TEST(ErrorDeathTest, AFailedAssertionStopsTheProgramAndNamesTheCondition) {
  const int beams = 0;
  EXPECT_DEATH(ISOBATH_ASSERT(beams > 0), "error_test.cpp:[0-9]+: assertion failed: beams > 0");
}

enum class PathFault { kNoPath, kOutOfTime };

Result<int, PathFault> steps_to(int distance) {
  if (distance < 0) return tl::unexpected(PathFault::kNoPath);
  return distance / 2;
}

TEST(Result, IsAValueOrTheReasonWhyThereIsNone) {
  EXPECT_EQ(steps_to(8), 4);
  EXPECT_EQ(steps_to(-1).error(), PathFault::kNoPath);
  EXPECT_EQ(steps_to(-1).value_or(0), 0);
}

}  // namespace
}  // namespace isobath
