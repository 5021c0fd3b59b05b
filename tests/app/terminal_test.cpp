// What the program prints is printable and short, whatever the texts of its inputs hold.
#include <gtest/gtest.h>
#include <isobath/io/mcap/native_log.hpp>
#include <tests/app/logs.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;
using namespace test;
using testing::HasSubstr, testing::Not;

/// Clears the screen, sets a title, is no UTF-8, and is ESC [ beyond ASCII.
const std::string kHostile =
    "\x1b[2J\x1b]0;x\x07 \xff \xc2\x9b"
    "31m";

void expect_printable(const std::string& text) {
  for (const char* hostile : {"\x1b", "\x07", "\xff", "\xc2\x9b", "\r"}) EXPECT_THAT(text, Not(HasSubstr(hostile)));
}

fs::path log_with(const fs::path& file, const std::map<std::string, std::string>& details) {
  NativeLogWriter log(file);
  log.set_details(details);
  log.write(Navigation{});
  log.close();
  return file;
}

TEST(Terminal, ShowsADetailOfALogWithoutObeyingIt) {
  const fs::path log = log_with(scratch_folder() / "log.mcap", {{"sonar" + kHostile, "Ping360" + kHostile}});
  const ProgramResult told = isobath({"info", log});
  EXPECT_THAT(told.out, HasSubstr("Ping360 [2J"));
  expect_printable(told.out);
  const ProgramResult json = isobath({"info", log, "--json"});
  expect_printable(json.out);
  EXPECT_TRUE(nlohmann::json::accept(json.out));
  EXPECT_THAT(json.out, HasSubstr("\\u001b[2J")) << "JSON loses nothing";
  EXPECT_THAT(json.out, HasSubstr("\\u009b31m"));
}

TEST(Terminal, ShowsSome200CharactersOfALongText) {
  const fs::path log = log_with(scratch_folder() / "log.mcap", {{"sonar", std::string(100'000, 'x')}});
  EXPECT_LT(isobath({"info", log}).out.size(), 2000u);
}

TEST(Terminal, ShowsTheTitleOfASceneWithoutObeyingIt) {
  const fs::path scene = write(scratch_folder() / "scene.toml", R"([scene]
title = "Pool\u001b[2J\u0007"
duration_s = 1
)");
  const ProgramResult told = isobath({"sim", scene});
  expect_printable(told.out + told.err);
}

TEST(Terminal, ShowsAnErrorOfBoundedLength) {
  const fs::path folder = scratch_folder(), log = write(folder / "wall.csv", wall_csv(20));
  const std::string key(100'000, 'k');
  const fs::path model = write(folder / "model.json", "{\"" + key + "\": " + key + "}");
  const ProgramResult refused = isobath_run(log, folder / "out", {"--model", model.string()});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_LT(refused.err.size(), 3000u);
  const ProgramResult unknown = isobath_run(log, folder / "out", {"--set", "sonar." + key + kHostile + "=1"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_LT(unknown.err.size(), 3000u);
  expect_printable(unknown.err);
}

TEST(Terminal, ShowsTheNameOfAFileWithoutObeyingIt) {
  const fs::path file = write(scratch_folder() / ("log" + std::string("\x1b[2J") + ".bin"), "Dive 3.\n");
  const ProgramResult refused = isobath({"info", file});
  EXPECT_THAT(refused, ends_with_one_line(HasSubstr("log [2J.bin")));
  expect_printable(refused.err);
}

}  // namespace
}  // namespace isobath
