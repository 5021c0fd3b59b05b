// Water columns of Kongsberg echo sounders: records built field by field, then the recordings of five ships.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/io/formats/kongsberg/kongsberg.hpp>
#include <isobath/io/formats/kongsberg/kongsberg_water.hpp>
#include <isobath/io/open_source.hpp>
#include <limits>
#include <tests/io/survey_datagrams.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using test::all_water;
using test::drain;
using test::in_memory;
using test::KmallWater;
using test::WaterBeamBytes;

struct Heard {
  std::vector<Event> events;
  SourceReport report;

  explicit Heard(std::unique_ptr<Source> source) : events(drain(*source)), report(source->report()) {
    for (const Event& event : events) {
      const auto* ping = std::get_if<Ping>(&event);
      if (ping) pings_.push_back(*ping);
    }
    for (const Ping& ping : pings_) {
      EXPECT_EQ(check(ping), PingFault::kNone);
    }
  }
  template <class T>
  [[nodiscard]] std::vector<T> of() const {
    std::vector<T> all;
    for (const Event& e : events) {
      if (const auto* x = std::get_if<T>(&e)) all.push_back(*x);
    }
    return all;
  }
  [[nodiscard]] const std::vector<Ping>& pings() const { return pings_; }
  [[nodiscard]] std::uint64_t refused(WaterFault fault) const { return refused(to_text(fault)); }
  [[nodiscard]] std::uint64_t refused(const std::string& reason) const {
    const auto at = report.rejected.find(reason);
    return at == report.rejected.end() ? 0 : at->second;
  }

 private:
  std::vector<Ping> pings_;
};
Heard hear_kmall(const std::string& bytes) { return Heard(open_kmall(in_memory(bytes), {})); }
Heard hear_all(const std::string& bytes) { return Heard(open_kongsberg_all(in_memory(bytes), {})); }

/// Where the middle of a bin is in the body.
Vector3d place_of(const Ping& ping, int beam, double range_m) {
  const Angle azimuth = ping.fan->azimuth[static_cast<std::size_t>(beam)];
  return ping.X_BS * Vector3d(range_m * cos(azimuth), range_m * sin(azimuth), 0);
}

// Records
// --------------------------------------------------------------------------------------------------------------

TEST(KongsbergWater, PingIsAVerticalFanAthwart) {
  for (const auto& heard : {hear_kmall(KmallWater{}.bytes()), hear_all(all_water(1000, {{60}, {0}, {-60}}).bytes())}) {
    ASSERT_EQ(heard.pings().size(), 1u);
    const Ping ping = heard.pings()[0];
    ASSERT_EQ(ping.fan->beams(), 3);
    EXPECT_TRUE(place_of(ping, 1, 10).isApprox(Vector3d(0, 0, 10), 1e-9)) << "straight down";
    EXPECT_TRUE(place_of(ping, 0, 10).isApprox(Vector3d(0, -10 * std::sin(M_PI / 3), 5), 1e-6)) << "60 degrees to port";
    EXPECT_TRUE(place_of(ping, 2, 10).isApprox(Vector3d(0, 10 * std::sin(M_PI / 3), 5), 1e-6)) << "to starboard";
    EXPECT_EQ(ping.sound_speed, 1500);
    EXPECT_TRUE(heard.report.rejected.empty());
    EXPECT_THAT(heard.report.details.at("water column"), testing::StartsWith("3 beams, half decibels"));
  }
}

TEST(KongsbergWater, SamplesStandInTheMiddleOfTheirBinsAsAmplitudes) {
  const Heard heard = hear_kmall(KmallWater{.beams = {{10, {0, 40, -40, 127, -128}, 4}}}.bytes());
  const Ping ping = heard.pings().at(0);
  EXPECT_NEAR(ping.window.centre(0), 4 * 1500.0 / (2 * 30000), 1e-9) << "index times c over twice the rate";
  EXPECT_NEAR(ping.window.bin_m, 0.025, 1e-12);
  const double expected[] = {1, 10, 0.1, std::pow(10, 63.5 / 20), std::pow(10, -64.0 / 20)};
  for (int k = 0; k < 5; ++k) EXPECT_NEAR(static_cast<double>(ping.intensity(0, k)) / expected[k], 1, 1e-6);
  EXPECT_FLOAT_EQ(ping.full_scale, ping.intensity(0, 3));
}

TEST(KongsbergWater, BinsThatABeamHasNotAreSaidToBeMissing) {
  const std::vector<WaterBeamBytes> beams{{30, {2, 2, 2, 2}, 0}, {0, {2, 2}, 5}, {-30, {}, 9}};
  for (const auto& heard : {hear_kmall(KmallWater{.beams = beams}.bytes()), hear_all(all_water(1000, beams).bytes())}) {
    const Ping ping = heard.pings().at(0);
    EXPECT_NEAR(ping.window.centre(0), 0.025, 1e-9) << "sample 0 is the transmission itself";
    ASSERT_TRUE(ping.sampled);
    EXPECT_EQ((*ping.sampled)[0], (BinSpan{0, 3}));
    EXPECT_EQ((*ping.sampled)[1], (BinSpan{4, 6}));
    EXPECT_EQ((*ping.sampled)[2], (BinSpan{0, 0}));
    EXPECT_EQ(ping.window.bins, WaterPings::kBinStep);
    EXPECT_EQ(ping.intensity(1, 3), 0);
    EXPECT_GT(ping.intensity(1, 4), 1);
    EXPECT_GT(ping.intensity(1, 5), 1);
    EXPECT_EQ(ping.intensity(1, 6), 0);
  }
}

TEST(KongsbergWater, RollIsTakenOutOnceAndPitchStays) {
  const auto heard =
      hear_kmall(test::kmall_position(1600000000, 47.5, 8) +
                 test::kmall_attitude({{.roll_deg = 5, .pitch_deg = 3, .heading_deg = 90}}) + KmallWater{}.bytes());
  const Ping ping = heard.pings().at(0);
  const auto fixes = heard.of<Navigation>();
  ASSERT_FALSE(fixes.empty());
  ASSERT_EQ(fixes.back().time, ping.time) << "a fix of its own";
  EXPECT_NEAR(fixes.back().X_WB.rotation.roll().degrees(), 5, 1e-6);
  const Rotation R_WS = fixes.back().X_WB.rotation * ping.X_BS.rotation;
  const Angle pitch = Angle::degrees(3);
  const Vector3d down = R_WS * Vector3d::UnitX(), starboard = R_WS * Vector3d::UnitY();
  EXPECT_TRUE(down.isApprox(Vector3d(0, sin(pitch), cos(pitch)), 1e-6)) << "nose up: down looks ahead, to the east";
  EXPECT_TRUE(starboard.isApprox(Vector3d(-1, 0, 0), 1e-6)) << "level, to the south";
}

TEST(KongsbergWater, FanIsThatOfTheTransmitArray) {
  const auto ahead = [](const std::string& array, const std::vector<float>& tilts) {
    std::vector<WaterBeamBytes> beams{{20}, {-20}};
    beams[1].sector = static_cast<std::uint8_t>(tilts.size() - 1);
    const Heard heard =
        hear_kmall(test::kmall_installation("EMXI:SWLZ=0.5,TRAI_TX1:X=1;Y=2;Z=3;" + array + ",TRAI_RX1:X=2;Y=2;Z=4;") +
                   KmallWater{.beams = beams, .tilts_deg = tilts}.bytes());
    EXPECT_TRUE(heard.pings().at(0).X_BS.translation.isApprox(Vector3d(1.5, 2, 3.5))) << "between both arrays";
    return heard.pings()[0];
  };
  const auto forward = [](const Ping& ping) {
    return Angle::radians(std::asin((ping.X_BS.rotation * Vector3d::UnitX()).x())).degrees();
  };
  EXPECT_NEAR(forward(ahead("P=1.5;H=0", {2})), 3.5, 1e-6);
  EXPECT_NEAR(forward(ahead("P=1.5;H=180", {2})), -3.5, 1e-6) << "mounted backwards";
  const Ping two = ahead("P=0;H=0", {1, 2});
  EXPECT_NEAR(forward(two), 1.5, 1e-6) << "the mean of both sectors";
  EXPECT_NEAR(two.fan->height.degrees(), 2, 1e-6) << "1 degree, and 1 more by which the sectors differ";
  for (const char* heading : {"P=0;H=178", "P=0;H=358", "P=0;H=-2"}) {
    const Vector3d starboard = ahead(heading, {0}).X_BS.rotation * Vector3d::UnitY();
    EXPECT_NEAR(std::asin(starboard.x()) * 180 / M_PI, 2, 1e-6) << heading << ": turned to port, so it looks ahead";
  }
}

TEST(KongsbergWater, WidthsAreThoseOfTheRecords) {
  const Ping all = hear_all(test::all_widths(5, 10).bytes() + all_water(1000, {{1}, {-1}}).bytes()).pings().at(0);
  EXPECT_NEAR(all.fan->height.degrees(), 0.5, 1e-9);
  EXPECT_NEAR(all.fan->width[0].degrees(), 1.0, 1e-9);
  test::KmallPing soundings{.soundings = {{}}};  // arrays of 1 and 2 degrees
  const Ping kmall = hear_kmall(soundings.bytes() + KmallWater{.along_deg = 0.8F}.bytes()).pings().at(0);
  EXPECT_NEAR(kmall.fan->height.degrees(), 0.8, 1e-6);
  EXPECT_NEAR(kmall.fan->width[0].degrees(), 1.6, 1e-6);
  EXPECT_EQ(hear_all(all_water(1000, {{1}, {-1}}).bytes()).pings().at(0).fan->height.degrees(), kWaterBeam.degrees());
}

TEST(KongsbergWater, PingOfSeveralRecordsIsJoined) {
  const std::vector<WaterBeamBytes> port{{60, {1, 2}}, {30, {3}}}, starboard{{-30, {4, 5, 6}}};
  auto other_head = all_water(1000, {{10, {9}}});
  other_head.serial = 7;
  const std::string first = all_water(1000, port, 1, 2).bytes(), second = all_water(1000, starboard, 2, 2).bytes();
  for (const std::string& log : {first + other_head.bytes() + second, second + first + other_head.bytes()}) {
    const Heard heard = hear_all(log);
    ASSERT_EQ(heard.pings().size(), 2u);
    const auto& pings = heard.pings();
    const Ping& joined = pings[0].fan->beams() == 3 ? pings[0] : pings[1];
    ASSERT_EQ(joined.fan->beams(), 3);
    EXPECT_FLOAT_EQ(joined.intensity(2, 2), static_cast<float>(std::pow(10, 3.0 / 20)));
    EXPECT_TRUE(heard.report.rejected.empty());
  }
  auto next = all_water(1100, port, 1, 2);
  next.counter = 2;
  const Heard lacking = hear_all(first + next.bytes());
  EXPECT_TRUE(lacking.pings().empty());
  EXPECT_EQ(lacking.refused("water column with missing parts"), 2u);
  const Heard twice = hear_all(first + first + second + second);
  EXPECT_EQ(twice.pings().size(), 1u);
  EXPECT_EQ(twice.refused("duplicate part of a water column"), 2u);
}

TEST(KongsbergWater, BothByteOrdersGiveTheSamePing) {
  const std::vector<WaterBeamBytes> beams{{60, {1, 2}}, {-30, {4, 5, 6}, 3}};
  const Heard big = hear_all(all_water(1000, beams, 1, 1, {1.25}, std::endian::big).bytes());
  const Heard little = hear_all(all_water(1000, beams, 1, 1, {1.25}).bytes());
  const Ping a = big.pings().at(0), b = little.pings().at(0);
  EXPECT_EQ(a.window, b.window);
  EXPECT_EQ(a.fan->azimuth, b.fan->azimuth);
  EXPECT_EQ(*a.sampled, *b.sampled);
  EXPECT_EQ(a.intensity(1, 4), b.intensity(1, 4));
}

TEST(KongsbergWater, PingsOfOneSettingShareFanAndWindow) {
  std::string log;
  for (int i = 0; i < 4; ++i) {
    KmallWater water{.time_s = 1600000000 + 0.25 * i};
    water.sound_speed = 1500 + 0.1F * static_cast<float>(i % 2);
    water.beams[0].to_port_deg = 60 + 0.02 * (i % 2);
    water.beams[1].samples.resize(static_cast<std::size_t>(5 + i), 3);
    if (i == 3) water.beams[0].to_port_deg = 58;
    log += water.bytes();
  }
  const auto pings = Heard(open_kmall(in_memory(log), {})).pings();
  ASSERT_EQ(pings.size(), 4u);
  EXPECT_EQ(pings[1].fan, pings[0].fan);
  EXPECT_EQ(pings[2].window, pings[0].window);
  EXPECT_EQ(pings[3].window, pings[0].window);
  EXPECT_NE(pings[3].fan, pings[0].fan);
}

TEST(KongsbergWater, StructuresOfOtherSizesAreReadByTheSizesThatTheyState) {
  for (const int more : {0, 8}) {
    for (const std::uint8_t phase : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}}) {
      KmallWater water{.phase = phase};
      water.transmit_bytes = static_cast<std::uint16_t>(12 + more);
      water.sector_bytes = static_cast<std::uint16_t>(16 + more);
      water.receiver_bytes = static_cast<std::uint16_t>(16 + more);
      water.entry_bytes = static_cast<std::uint8_t>(more == 0 ? 12 : 24);
      const Heard heard = hear_kmall(water.bytes());
      ASSERT_EQ(heard.pings().size(), 1u) << more << ' ' << int(phase);
      EXPECT_FLOAT_EQ(heard.pings()[0].intensity(2, 1), static_cast<float>(std::pow(10, 10.0 / 20)));
    }
  }
}

TEST(KongsbergWater, RecordsThatCannotBeRightAreRefusedByReason) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(hear_kmall(KmallWater{.sample_hz = kNan}.bytes()).refused(WaterFault::kBadRate), 1u);
  EXPECT_EQ(hear_kmall(KmallWater{.sound_speed = 5000}.bytes()).refused(WaterFault::kBadSoundSpeed), 1u);
  EXPECT_EQ(hear_kmall(KmallWater{.beams = {{0}, {10}}}.bytes()).refused(WaterFault::kBadBeams), 1u);
  EXPECT_EQ(hear_kmall(KmallWater{.beams = {{100}}}.bytes()).refused(WaterFault::kBadBeams), 1u);
  EXPECT_EQ(hear_kmall(KmallWater{.tilts_deg = {kNan}}.bytes()).refused(WaterFault::kBadBeams), 1u);
  EXPECT_EQ(hear_kmall(KmallWater{.beams = {{0, {}}}}.bytes()).refused(WaterFault::kNoSamples), 1u);
  EXPECT_EQ(hear_kmall(KmallWater{.parts = 2}.bytes()).refused("part of a divided datagram"), 1u);
  EXPECT_EQ(hear_kmall(KmallWater{.beams = {{0, {1}, 0, 3}}}.bytes()).refused(WaterFault::kNoSamples), 1u)
      << "of a sector that there is not";
  EXPECT_EQ(hear_kmall(KmallWater{.beams = {{1, {1}, 60000}, {0, {1}, 0}}}.bytes()).refused(WaterFault::kBadSizes), 1u)
      << "a window of which next to nothing was sampled";
  auto wrong = all_water(1000, {{0}});
  wrong.fields.put<std::uint16_t>(28, 99);
  EXPECT_EQ(hear_all(wrong.bytes()).refused("water column shorter than its beams"), 1u);
  EXPECT_EQ(hear_all(all_water(1000, {{0}}, 3, 2).bytes()).refused(WaterFault::kBadSizes), 1u);
  EXPECT_EQ(hear_all(all_water(1000, {{0}}, 1, 40000).bytes()).refused(WaterFault::kBadSizes), 1u);
}

TEST(KongsbergWater, DamageCostsTheRecordInWhichItLies) {
  const auto logs = {std::pair(KmallWater{}.bytes(), false), std::pair(all_water(1000, {{20}, {0}}).bytes(), true)};
  for (const auto& [record, is_all] : logs) {
    const auto count = [is_all = is_all](const std::string& bytes) {
      return (is_all ? hear_all(bytes) : hear_kmall(bytes)).pings().size();
    };
    std::string again = record;
    if (is_all) {
      auto later = all_water(1200, {{20}, {0}});
      later.counter = 9;
      again = later.bytes();
    }
    EXPECT_EQ(count(record + again), 2u);
    EXPECT_EQ(count(record + "noise #M\x02" + again), 2u);
    EXPECT_EQ(count(record.substr(0, record.size() / 2) + again), 1u);
    for (std::size_t cut = 0; cut < record.size(); ++cut) EXPECT_EQ(count(again + record.substr(0, cut)), 1u) << cut;
    Random random(5);
    for (int i = 0; i < 300; ++i) {  // whatever stands in it: nothing breaks, what comes out passes check
      std::string bytes = record;
      const auto at = static_cast<std::size_t>(random.index(bytes.size()));
      bytes[at] = static_cast<char>(random.index(256));
      count(bytes + again);
    }
  }
}

// Two files
// ------------------------------------------------------------------------------------------------------------

class KongsbergPair : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  static std::string kinds(const Heard& heard) {
    std::string text;
    for (const Event& e : heard.events) text += std::string("pRNhsO")[e.index()];
    return text;
  }
  fs::path folder_ = test::scratch_folder();
};

TEST_F(KongsbergPair, WaterColumnBesideALogIsReadWithItByTime) {
  test::KmallPing one{.time_s = 1600000000, .soundings = {{}}}, two{.time_s = 1600000001, .soundings = {{}}};
  const std::string attitude = test::kmall_attitude({{.time_s = 1600000000, .roll_deg = 4}, {.time_s = 1600000001}});
  const fs::path log = write("line.kmall", attitude + one.bytes() + two.bytes());
  const fs::path water = write("line.KMWCD", test::kmall_position(1600000000, 1, 1) + KmallWater{}.bytes() +
                                                 KmallWater{.time_s = 1600000001}.bytes());
  for (const fs::path& named : {log, water}) {
    const Heard heard(open_source(named, {}));
    EXPECT_EQ(kinds(heard), "NspNsp") << named << ": soundings before the water column of the same time";
    EXPECT_EQ(*heard.report.origin, (GeoPoint{47.5, -122.25})) << "what the second file repeats is passed over";
    EXPECT_EQ(heard.report.bytes_total, fs::file_size(log) + fs::file_size(water));
    EXPECT_EQ(heard.report.details.at("beside"), "line.KMWCD: water columns");
    EXPECT_NEAR(heard.of<Navigation>()[0].X_WB.rotation.roll().degrees(), 4, 1e-6);
  }
  InputConfig dry;
  dry.water_column = false;
  EXPECT_EQ(kinds(Heard(open_source(log, dry))), "NsNs");
  EXPECT_TRUE(Heard(open_source(water, dry)).pings().empty());
  fs::remove(log);
  EXPECT_EQ(kinds(Heard(open_source(water, {}))), "pp") << "alone: no heading, so no navigation";
}

TEST_F(KongsbergPair, AllAndItsWaterColumns) {
  auto ping = test::all_ping(1000, {{}}, 80);
  const fs::path log = write("line.all", test::all_position(1000, 45, 10).bytes() + ping.bytes());
  write("line.wcd", ping.bytes() + test::all_attitude(1000, {{.roll_deg = 3}, {.after_ms = 500}}).bytes() +
                        all_water(1000, {{20}, {0}}).bytes());
  const Heard heard(open_source(log, {}));
  EXPECT_EQ(kinds(heard), "Nsp") << "the soundings once, though both files have them";
  EXPECT_NEAR(heard.of<Navigation>()[0].X_WB.rotation.roll().degrees(), 3, 1e-9) << "attitude of the second file";
}

TEST_F(KongsbergPair, DamageIsThatOfItsFile) {
  write("line.kmall", test::KmallPing{.soundings = {{}}}.bytes());
  const std::string water = KmallWater{}.bytes();
  write("line.kmwcd", "???" + water + water.substr(0, 50));
  const Heard heard(open_source(folder_ / "line.kmall", {}));
  EXPECT_EQ(heard.pings().size(), 1u);
  ASSERT_GE(heard.report.damages.size(), 2u);
  EXPECT_EQ(heard.report.damages[0].offset, 0u);
  EXPECT_EQ(heard.report.damages[0].bytes, 3u);
  EXPECT_EQ(heard.report.damages[0].reason, "line.kmwcd: no valid frame");
  EXPECT_EQ(heard.report.bytes_skipped, 53u);
}

TEST_F(KongsbergPair, OfAFolderEachLogTakesItsOwn) {
  for (const double t : {0.0, 10.0}) {
    const std::string name = t == 0 ? "a" : "b";
    write(name + ".kmall", test::KmallPing{.time_s = 1600000000 + t, .soundings = {{}}}.bytes());
    write(name + ".kmwcd", KmallWater{.time_s = 1600000000 + t}.bytes());
  }
  const Heard heard(open_source(folder_, {}));
  EXPECT_EQ(kinds(heard), "NspNsp");
  EXPECT_EQ(heard.report.details.at("files"), "2 of 2 read");
  EXPECT_EQ(heard.report.details.at("left out"), "water column, read with its log: a.kmwcd, b.kmwcd");
}

TEST_F(KongsbergPair, WhatOnlyHasTheNameIsNotRead) {
  const fs::path log = write("line.kmall", test::KmallPing{.soundings = {{}}}.bytes());
  write("line.kmwcd", "no log at all");
  EXPECT_EQ(kinds(Heard(open_source(log, {}))), "Ns");
}

// Recordings
// ------------------------------------------------------------------------------------------------------------

constexpr const char* kWaterFolder = "kongsberg-pings";

struct WaterRecording {
  const char* log;
  const char* water;
  std::size_t pings;
  int beams;
  double widest_deg;  ///< of the outermost beam, either side
};

const WaterRecording kWaterRecordings[] = {
    {"em2040c-australia.all", "em2040c-australia.wcd", 35, 256, 36.64},
    {"em2040-northsea-2023.all", "em2040-northsea-2023.wcd", 6, 256, 60.83},  // two heads, three records a ping
    {"em2040-northsea-2016.all", "em2040-northsea-2016.wcd", 6, 256, 70.05},
    {"em710-blacksea.all", "em710-blacksea.wcd", 7, 256, 65.57},
    {"em710-svalbard.all", "em710-svalbard.wcd", 6, 128, 65.2},
    {"em2042-harbour-a.kmall", "em2042-harbour-a.kmwcd", 5, 256, 60},
    {"em2042-harbour-b.kmall", "em2042-harbour-b.kmwcd", 4, 256, 65},
    {"em2042-harbour-c.kmall", "em2042-harbour-c.kmwcd", 5, 256, 65},
    {"em2042-harbour-d.kmall", "em2042-harbour-d.kmwcd", 6, 256, 65},
    {"em2040-florida.kmall", "em2040-florida.kmwcd", 6, 256, 45.06},
};

TEST(KongsbergWaterRecordings, EveryPingIsReadWithItsFix) {
  ISOBATH_NEEDS_DATA(folder, kWaterFolder);
  for (const WaterRecording& r : kWaterRecordings) {
    const Heard heard(open_source(folder / r.water, {}));
    EXPECT_EQ(heard.pings().size(), r.pings) << r.water;
    EXPECT_EQ(heard.report.bytes_skipped, 0u) << r.water;
    double widest = 0;
    Time last{};
    for (const Event& event : heard.events) {
      if (const auto* fix = std::get_if<Navigation>(&event)) last = fix->time;
      const auto* ping = std::get_if<Ping>(&event);
      if (!ping) continue;
      EXPECT_EQ(ping->time, last) << r.water;
      EXPECT_EQ(ping->fan->beams(), r.beams) << r.water;
      widest = std::max({widest, -ping->fan->azimuth.front().degrees(), ping->fan->azimuth.back().degrees()});
    }
    EXPECT_NEAR(widest, r.widest_deg, 0.5) << r.water;
    const Heard by_log(open_source(folder / r.log, {}));
    EXPECT_EQ(by_log.events.size(), heard.events.size()) << "whichever of the two files is named";
  }
}

/// Of the beams of a ping, how far the strongest echo (behind the first 40 samples) stands from the nearest sounding of
/// the same ping by range, both as seen from the transducer, where a sounding lies within half a degree.
std::vector<double> beside_soundings(const Ping& ping, const Swath& swath, const Pose& X_WB, double widest_deg) {
  const Pose X_WS = X_WB * ping.X_BS;
  const Pose X_WL = frame_in_world(swath, X_WB);
  struct Seen {
    double angle_deg, range_m;
  };
  std::vector<Seen> seen;
  for (const Sounding& s : swath.soundings) {
    if (s.kind != Sounding::Kind::kBottom) continue;
    const Vector3d p = X_WS.inverse() * (X_WL * s.point.cast<double>());
    seen.push_back({Angle::radians(std::atan2(p.y(), p.x())).degrees(), p.norm()});
  }
  std::vector<double> off;
  for (int b = 0; b < ping.fan->beams(); ++b) {
    const double angle = ping.fan->azimuth[static_cast<std::size_t>(b)].degrees();
    if (std::abs(angle) > widest_deg) continue;
    const BinSpan span = sampled_bins(ping, b);
    int best = 40;
    for (int k = best; k < span.end; ++k) best = ping.intensity(b, k) > ping.intensity(b, best) ? k : best;
    double least = std::numeric_limits<double>::infinity();
    for (const Seen& s : seen) {
      if (std::abs(s.angle_deg - angle) < 0.5) least = std::min(least, std::abs(s.range_m - ping.window.centre(best)));
    }
    if (std::isfinite(least)) off.push_back(least);
  }
  std::sort(off.begin(), off.end());
  return off;
}

struct Beside {
  const char* log;
  double widest_deg;
  double within_m;
  double share;
};

// The angles are off the vertical and the ranges right: the strongest echo of a beam stands where the sonar's own
// software, with its sound speed profile and attitude, puts the bottom.
// ledger: S5-12
TEST(KongsbergWaterRecordings, StrongestEchoesStandOnTheSonarsOwnSoundings) {
  ISOBATH_NEEDS_DATA(folder, kWaterFolder);
  for (const Beside& r :
       {Beside{"em2042-harbour-c.kmall", 57, 0.3, 0.98}, Beside{"em2042-harbour-a.kmall", 57, 0.3, 0.98},
        Beside{"em2040-florida.kmall", 40, 0.3, 0.98}, Beside{"em2040c-australia.all", 35, 0.3, 0.97}}) {
    InputConfig as_recorded;
    as_recorded.max_bins = 0;
    const Heard heard(open_source(folder / r.log, as_recorded));
    std::size_t beams = 0, near = 0, pings = 0;
    const Swath* swath = nullptr;
    Pose X_WB;
    for (const Event& event : heard.events) {
      if (const auto* fix = std::get_if<Navigation>(&event)) X_WB = fix->X_WB;
      if (const auto* s = std::get_if<Swath>(&event)) swath = s;
      const auto* ping = std::get_if<Ping>(&event);
      if (!ping || !swath || swath->time != ping->time) continue;
      ++pings;
      const auto off = beside_soundings(*ping, *swath, X_WB, r.widest_deg);
      beams += off.size();
      near += static_cast<std::size_t>(std::upper_bound(off.begin(), off.end(), r.within_m) - off.begin());
    }
    EXPECT_GT(pings, 3u) << r.log;
    EXPECT_GT(static_cast<double>(near), r.share * static_cast<double>(beams))
        << r.log << ": " << near << " of " << beams;
  }
}

}  // namespace
}  // namespace isobath
