// A damaged stretch in the middle of a log costs only that stretch, and the report says how many bytes were skipped
// where.
#include <fmt/format.h>
#include <tests/app/logs.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;
using namespace test;
using testing::HasSubstr;

constexpr int kPings = 200, kFirstLost = 100, kLost = 3;

/// What a run must say of a log whose bytes from..to are damaged and lie within as many pings as kLost.
void expect_only_that_stretch_is_lost(const fs::path& log, std::size_t from, std::size_t to) {
  const fs::path out = log.parent_path() / "out";
  const ProgramResult result = isobath_run(log, out);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const auto json = nlohmann::json::parse(result.out), manifest = json_of(out / "manifest.json");
  EXPECT_EQ(json["counts"]["pings"], kPings - kLost);
  EXPECT_EQ(manifest["counts"]["scans"], kPings / kTurn) << "the turns before and after it";
  EXPECT_EQ(manifest["problem"], "");

  const std::string report = content_of(out / "report.html");
  std::size_t skipped = 0;
  ASSERT_FALSE(manifest["skipped"].empty());
  for (const auto& stretch : manifest["skipped"]) {
    const std::size_t offset = stretch["offset"], bytes = stretch["bytes"];
    EXPECT_GE(offset, from);
    EXPECT_LE(offset + bytes, to);
    EXPECT_THAT(report, HasSubstr(fmt::format("(bytes {} to {})", offset, offset + bytes)));
    skipped += bytes;
  }
  EXPECT_EQ(manifest["counts"]["bytes_skipped"], skipped);
  EXPECT_EQ(json["counts"]["bytes_skipped"], skipped);
}

TEST(Damage, StretchOfABinaryLog) {
  std::vector<std::size_t> starts;
  std::string log = wall_ping_viewer_log(kPings, &starts);
  const std::size_t from = starts[kFirstLost], to = starts[kFirstLost + kLost];
  for (std::size_t i = from; i < to; ++i) log[i] = static_cast<char>(i * 37);
  expect_only_that_stretch_is_lost(write(scratch_folder() / "damaged.bin", log), from, to);
}

TEST(Damage, StretchOfATextLog) {
  auto lines = wall_csv_lines(kPings);
  const std::size_t from = joined({lines.begin(), lines.begin() + kFirstLost}).size();
  std::size_t to = from;
  for (int i = kFirstLost; i < kFirstLost + kLost; ++i) {
    for (char& c : lines[i]) {
      if (c == ',') c = '\x01';
    }
    to += lines[i].size();
  }
  expect_only_that_stretch_is_lost(write(scratch_folder() / "damaged.csv", joined(lines)), from, to);
}

TEST(Damage, StretchOfANativeLogCostsTheChunkThatHoldsIt) {
  const fs::path folder = scratch_folder(), whole = folder / "whole.mcap";
  ASSERT_EQ(isobath::test::isobath({"convert", write(folder / "wall.csv", wall_csv(20'000)), whole}).exit_code, 0);
  std::string bytes = content_of(whole);
  for (std::size_t i = bytes.size() / 2; i < bytes.size() / 2 + 8; ++i) bytes[i] = static_cast<char>(~bytes[i]);
  const auto info = isobath::test::isobath({"info", write(folder / "damaged.mcap", bytes), "--json"});
  EXPECT_EQ(info.exit_code, 0) << info.err;
  const auto json = nlohmann::json::parse(info.out);
  ASSERT_EQ(json["damage"].size(), 1u);
  EXPECT_LE(json["damage"][0]["offset"], bytes.size() / 2);
  EXPECT_GT(json["streams"][0]["events"], 10'000) << "the chunks before and after it";
  EXPECT_LT(json["streams"][0]["events"], 20'000);
}

TEST(Damage, RecordedSonarWithAHoleKeepsItsWalls) {
  ISOBATH_NEEDS_DATA(folder, "msis-tank");
  std::string log = content_of(folder / "msis-tank-rev00-20.csv").substr(0, 1'200'000);
  log.resize(log.rfind('\n') + 1);
  for (std::size_t i = 600'000; i < 604'000; ++i) log[i] = '\xff';
  const fs::path out = scratch_folder() / "out";
  const ProgramResult result = isobath_run(write(out.parent_path() / "hole.csv", log), out);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto manifest = json_of(out / "manifest.json");
  EXPECT_LE(manifest["counts"]["bytes_skipped"], 4000 + 2 * 1500) << "whole lines, the broken ones alone";
  EXPECT_GT(manifest["counts"]["pings"], 990);
}

}  // namespace
}  // namespace isobath
