#include <fstream>
#include <gmock/gmock.h>
#include <isobath/io/open_source.hpp>
#include <tests/io/aris_frames.hpp>
#include <tests/io/oculus_messages.hpp>
#include <tests/io/ping_frames.hpp>
#include <tests/io/survey_datagrams.hpp>
#include <tests/io/tritech_frames.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;

class Open : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& bytes) {
    const fs::path path = folder_ / name;
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  std::string error_of(const fs::path& path) {
    try {
      open_source(path, {});
    } catch (const Error& e) {
      EXPECT_THAT(std::string(e.what()), testing::Not(testing::HasSubstr("\n")));
      return e.what();
    }
    return "opened";
  }
  fs::path folder_ = test::scratch_folder();
};

std::string ping_viewer_log(int records, int bins = 100) {
  test::PingViewerWriter writer;
  int at = 0;
  for (const auto& frame : test::ping360_frames(records, bins, 4)) writer.add(at += 30, frame);
  return writer.log();
}

TEST_F(Open, FormatsAreRecognisedByContentWhateverTheName) {
  const std::string oculus = test::OculusMessage{}.bytes();
  const std::vector<std::pair<std::string, std::string>> logs{
      {"Ping Viewer log", ping_viewer_log(2)},
      {"ping protocol stream", "noise" + test::Ping360Message{}.frame()},
      {"Tritech serial stream", "noise" + test::TritechMessage{}.frame()},
      {"Oculus message stream", "noise" + oculus},
      {"Kongsberg .all", "noise" + test::all_ping(1000, {{}}).bytes()},
      {"Kongsberg .kmall", "noise" + test::KmallPing{.soundings = {{}}}.bytes()},
      {"ARIS recording", test::aris_header() + test::ArisFrame{}.bytes()},
      {"XTF", test::xtf_header() + test::xtf_position(0, 37, -122) + test::xtf_attitude(0, 0, 0, 0, 0)},
      {".oculus log", test::oculus_file_header() + test::oculus_item(1, oculus)},
      {"NMEA 0183", "$GPGGA,123519.00,4807.0380,N,01131.0000,E,4,08,0.9,545.4,M,46.9,M,1.0,0000*43\r\n"},
      {"scan CSV", "# t_s,head_deg,bin_m,nbins,i0,i1,...\n1,2,0.1,2,3,4\n"},
      {"Ping360 arc table", "Angle (gradian);Intensity (0-255)\n   150;76;152\n"},
      {"Seanet CSV", "heading\n1,10:00:00.000,2,16,8965,100,105,125,13,81,2400,4000,16,3200,2,1,2\n"}};
  for (const auto& [format, bytes] : logs) {
    const auto source = open_source(write("input.bin", bytes), {});
    EXPECT_EQ(source->report().format, format);
    EXPECT_FALSE(test::drain(*source).empty()) << format;
  }
}

TEST_F(Open, WhatCannotBeOpenedIsOneLineThatSaysWhatToDo) {
  EXPECT_THAT(error_of(folder_ / "absent.bin"), testing::HasSubstr("absent.bin: no such file"));
  EXPECT_THAT(error_of(write("empty.bin", "")), testing::HasSubstr("empty.bin: is empty"));
  EXPECT_THAT(error_of(write("notes.bin", "Dive 3.\nAll went well.\n")),
              testing::AllOf(testing::HasSubstr("not a known format: looks like text; allowed: "),
                             testing::HasSubstr("Ping Viewer log")));
  EXPECT_THAT(error_of(write("noise.bin", std::string("\x01\x00\x00\x00\x02", 5))),
              testing::HasSubstr("not a known format;"));
  EXPECT_THAT(error_of(write("depths.csv", "y,x,z\n49.7,-93.7,-2.6\n")),
              testing::HasSubstr("is a table whose columns are not declared: y, x, z; declare them"));
  EXPECT_THAT(error_of(folder_), testing::HasSubstr("not a known format: a folder"));
  EXPECT_THAT(error_of(write("view.oculus", "SQLite format 3" + std::string(200, '\0'))),
              testing::HasSubstr("ViewPoint 2"));
  EXPECT_THAT(error_of(write("dive.V4LOG", "\x01\x02\x03")), testing::HasSubstr("export it to CSV"));
  EXPECT_THAT(error_of(write("cut.bin", ping_viewer_log(1).substr(0, 100))),
              testing::HasSubstr("ends within its header"));
}

TEST_F(Open, SqliteFileIsNamedByWhatItHolds) {
  const std::string begin = "SQLite format 3" + std::string(200, '\0');
  const auto problem = [&](const std::string& tables) { return error_of(write("dive.oculus", begin + tables)); };
  EXPECT_THAT(problem("CREATE TABLE topics(id)CREATE TABLE \"messages\" (id)"),
              testing::HasSubstr("is a ROS 2 bag that SQLite cannot read"));
  EXPECT_THAT(problem("CREATE TABLE [gpkg_contents](id)"), testing::HasSubstr("is a GeoPackage"));
  EXPECT_THAT(problem("CREATE TABLE layer(id)CREATE TABLE block(id)"), testing::HasSubstr("the voxels of a map"));
  EXPECT_THAT(problem("CREATE TABLE pings(id)CREATE TABLE devices(id)"),
              testing::AllOf(testing::HasSubstr("with the tables devices, pings;"), testing::HasSubstr("ViewPoint 2")));
}

TEST_F(Open, ShortMessageOfAnOculusAmongSamplesMakesNoOculusStream) {
  const std::string samples(1000, '\x18'), message = std::string("SO") + std::string(14, '\0');
  EXPECT_THAT(error_of(write("input.sl2", samples + message + samples)), testing::HasSubstr("not a known format;"));
  EXPECT_EQ(open_source(write("stream.bin", samples + message + message), {})->report().format,
            "Oculus message stream");
}

TEST_F(Open, RealLogOfALowranceIsNoOculusStream) {
  ISOBATH_NEEDS_DATA(data, "lowrance-sl2");
  for (const char* name : {"input.sl2", "elite4-version-1.sl2"}) {
    EXPECT_EQ(open_source(data / name, {})->report().format, "Lowrance .sl2") << name;
  }
}

TEST_F(Open, LogsLongerThanTheWindowAreReadWholeWithoutGaps) {
  const std::string log = ping_viewer_log(3000, 1100);  // more than three windows
  const auto from_file = open_source(write("long.bin", log), {});
  std::size_t count = 0;
  std::optional<Event> kept;
  while (auto event = from_file->next()) {
    if (count++ == 0) kept = std::move(event);
  }
  EXPECT_EQ(count, 3000u);
  EXPECT_EQ(from_file->report().bytes_skipped, 0u);
  EXPECT_EQ(from_file->report().bytes_read, log.size());
  const Ping& ping = std::get<Ping>(*kept);
  const std::string expected = test::ping360_frames(1, 1100, 4)[0].substr(8 + 14, 1100);
  for (int k = 0; k < 1100; ++k) {
    ASSERT_EQ(ping.intensity(0, k), static_cast<unsigned char>(expected[k])) << "a ping keeps its samples alive";
  }
}

TEST_F(Open, FileThatShrinksWhileItIsReadEndsEarlyAndSaysSo) {
  const std::string log = ping_viewer_log(4000, 1100);
  const fs::path path = write("shrinks.bin", log);
  const auto source = open_source(path, {});
  ASSERT_TRUE(source->next());
  fs::resize_file(path, log.size() / 2);
  std::size_t count = 1;
  while (source->next()) ++count;
  EXPECT_GT(count, 1000u);
  EXPECT_LT(count, 3000u);
  ASSERT_FALSE(source->report().damages.empty());
  EXPECT_EQ(source->report().damages.back().reason, "the file shrank while it was read");
  EXPECT_GE(source->report().bytes_skipped, log.size() / 2);
}

TEST_F(Open, TheSameInputGivesTheSameEvents) {
  const fs::path path = write("log.bin", ping_viewer_log(50));
  const auto a = test::drain(*open_source(path, {})), b = test::drain(*open_source(path, {}));
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_TRUE(test::same_samples(a[i], b[i]));
}

TEST(InputConfig, IsReadFromTextAndChecked) {
  InputConfig config;
  std::vector<Section> sections{{"input", "", fields(config)}};
  read_toml("[input]\nmount_heading_deg = 90\nclockwise = false\nsound_speed = 1480\n", "test.toml", sections);
  EXPECT_NEAR(config.mount_heading.degrees(), 90, 1e-12);
  EXPECT_FALSE(config.clockwise);
  EXPECT_THROW(read_toml("[input]\nsound_speed = 340\n", "test.toml", sections), Error);
}

}  // namespace
}  // namespace isobath
