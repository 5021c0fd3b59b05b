#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/io/formats/kongsberg/kongsberg.hpp>
#include <limits>
#include <tests/io/survey_datagrams.hpp>

namespace isobath {
namespace {

using test::all_attitude;
using test::all_ping;
using test::all_position;
using test::AllBeam;
using test::drain;
using test::hex;
using test::in_memory;
using test::KmallMotion;
using test::KmallPing;
using test::KmallSounding;

// The worked examples of the format sheets.
const std::string kPing = hex(
    "3C 00 00 00 02 58 F8 07 D5 3D 34 01 80 EE 36 00 2A 00 13 CF 28 23 98 3A 00 00 C0 3F 01 00 01 00 00 40 1C 46 00 00 "
    "00 00 00 00 A2 41 00 00 40 C0 00 00 00 3F 0A 00 05 00 00 00 06 FF 00 03 44 0B");
const std::string kPosition = hex(
    "53 00 00 00 23 53 50 4F 00 00 F8 07 00 10 5E 5F 80 FB 65 1E 08 00 01 00 01 00 00 00 00 10 5E 5F 00 65 CD 1D 00 00 "
    "00 3F 00 00 00 00 00 C0 47 40 00 00 00 00 00 90 5E C0 00 00 C0 3F 00 00 B4 42 00 00 A2 C1 24 47 50 47 47 41 2C 2C "
    "2A 35 36 53 00 00 00");

struct Log {
  std::vector<Event> events;
  SourceReport report;
  [[nodiscard]] std::vector<Swath> swaths() const { return of<Swath>(); }
  [[nodiscard]] std::vector<Navigation> fixes() const { return of<Navigation>(); }

 private:
  template <class T>
  [[nodiscard]] std::vector<T> of() const {
    std::vector<T> all;
    for (const Event& e : events) {
      if (const auto* x = std::get_if<T>(&e)) all.push_back(*x);
    }
    return all;
  }
};
Log read(std::unique_ptr<Source> source) {
  auto events = drain(*source);
  return {std::move(events), source->report()};
}
Log read_all(const std::string& bytes) { return read(open_kongsberg_all(in_memory(bytes), {})); }
Log read_kmall(const std::string& bytes) { return read(open_kmall(in_memory(bytes), {})); }

std::uint64_t refused(const Log& log, const char* reason) {
  const auto at = log.report.rejected.find(reason);
  return at == log.report.rejected.end() ? 0 : at->second;
}

// .all
// -----------------------------------------------------------------------------------------------------------------

TEST(KongsbergAll, PingOfTheFormatSheetIsASwath) {
  ASSERT_EQ(kPing.size(), 64u);
  ASSERT_TRUE(looks_like_kongsberg_all(bytes_of(kPing)));
  const Log log = read_all(kPing);
  const Swath s = log.swaths().at(0);
  EXPECT_EQ(s.frame, Swath::Frame::kLevel);
  EXPECT_EQ(s.time, Time{std::chrono::sys_days{std::chrono::year(2020) / 9 / 17}.time_since_epoch() +
                         std::chrono::milliseconds(3600000)});
  EXPECT_NEAR(s.heading->degrees(), 90, 1e-9);
  EXPECT_DOUBLE_EQ(s.sound_speed, 1500);
  ASSERT_EQ(s.soundings.size(), 1u);
  const Sounding& p = s.soundings[0];
  EXPECT_EQ(p.point, Eigen::Vector3f(0.5F, -3.0F, 21.75F)) << "below the water line";
  EXPECT_NEAR(p.range_m, std::sqrt(20.25 * 20.25 + 9 + 0.25), 1e-5) << "from the transducer";
  EXPECT_NEAR(p.sigma_m, 5.0 / 2500 * static_cast<double>(p.range_m), 1e-6);
  EXPECT_TRUE(log.fixes().empty()) << "there is no position";
  EXPECT_FALSE(log.report.details.contains("checksums"));
}

TEST(KongsbergAll, BothByteOrdersGiveTheSameEvents) {
  const auto log_in = [](std::endian order) {
    return all_position(1000, 45, 10, 0x81, order).bytes() +
           all_attitude(1000, {{}, {.after_ms = 500}}, 1, order).bytes() +
           all_ping(1200, {{.z = 20, .y = 3}, {.z = 21}}, 42.5, 1.5F, order).bytes();
  };
  const std::string big = log_in(std::endian::big);
  ASSERT_TRUE(looks_like_kongsberg_all(bytes_of(big)));
  const Log a = read_all(log_in(std::endian::little)), b = read_all(big);
  ASSERT_EQ(a.events.size(), 3u);
  ASSERT_EQ(b.events.size(), 3u);
  EXPECT_EQ(b.report.bytes_skipped, 0u);
  EXPECT_EQ(a.swaths()[0].soundings[1].point, b.swaths()[0].soundings[1].point);
  EXPECT_EQ(a.swaths()[0].heading, b.swaths()[0].heading);
  EXPECT_EQ(a.fixes()[1].X_WB.translation, b.fixes()[1].X_WB.translation);
}

TEST(KongsbergAll, PingHasItsPlaceBetweenThePositions) {
  const Log log =
      read_all(test::all_installation("WLZ=-1.5,SMH=213,APS=0,").bytes() + all_ping(1500, {{}}, 80).bytes() +
               all_position(1000, 45, 10).bytes() + all_position(2000, 45.00001, 10).bytes() +
               all_attitude(1000, {{.roll_deg = 2, .heave_m = 0.1}, {.after_ms = 1000, .roll_deg = 4}}).bytes());
  ASSERT_EQ(log.events.size(), 4u);
  const Navigation fix = log.fixes()[1];
  EXPECT_EQ(fix.time, log.swaths()[0].time);
  EXPECT_NEAR(fix.X_WB.translation.x(), 0.5e-5 * 111132, 1e-2);
  EXPECT_NEAR(fix.X_WB.translation.z(), 0.05 + 1.5, 1e-9) << "reference point: heave below its depth at rest";
  EXPECT_NEAR(fix.X_WB.rotation.roll().degrees(), 3, 1e-9);
  EXPECT_NEAR(fix.X_WB.rotation.heading().degrees(), 80, 1e-9) << "that of the ping";
  EXPECT_NEAR(log.fixes()[0].X_WB.rotation.heading().degrees(), 90, 1e-9) << "that of the active sensor";
  EXPECT_NEAR(fix.v_WB->x(), 1, 1e-12);
  EXPECT_NEAR((*fix.covariance)(0, 0), 0.25, 1e-12) << "fix quality 50 cm";
  EXPECT_EQ(*log.report.origin, (GeoPoint{45, 10}));
}

TEST(KongsbergAll, RangeIsFromTheTransducer) {
  const std::string text = "S1X=10.5,S1Y=-2.0,APS=1,P1X=1,P2X=0.5,P2Y=1.0,";
  const Log log = read_all(test::all_installation(text).bytes() + all_ping(1000, {{.z = 4, .y = -3, .x = 10}}).bytes());
  EXPECT_NEAR(log.swaths().at(0).soundings.at(0).range_m, 4, 1e-6)
      << "straight below the head, 10 m before the antenna";
}

TEST(KongsbergAll, BeamsThatTheSonarDoubtsAreLeftOutAndCounted) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<AllBeam> beams{{.z = 20},   {.z = 20, .detection = 0x84}, {.z = 20, .cleaning = -1}, {.z = 0},
                                   {.z = kNan}, {.z = 20, .detection = 0x01}};
  const Log log = read_all(all_ping(1000, beams).bytes());
  ASSERT_EQ(log.swaths().at(0).soundings.size(), 2u);
  EXPECT_EQ(log.swaths()[0].soundings[1].beam, 5);
  EXPECT_EQ(refused(log, "sounding that the sonar calls invalid"), 1u);
  EXPECT_EQ(refused(log, "sounding that real-time cleaning has flagged"), 1u);
  EXPECT_EQ(refused(log, "sounding without a detection"), 1u);
  EXPECT_EQ(refused(log, "sounding that is not finite"), 1u);
}

TEST(KongsbergAll, OldDepthDatagram) {
  const auto datagram = [](std::uint16_t model, std::uint16_t z, std::int8_t multiplier) {
    test::AllDatagram d{.type = 'D', .model = model};
    d.fields.put<std::uint16_t>(20, 4500).put<std::uint16_t>(22, 14800).put<std::uint16_t>(24, 150);
    d.fields.put<std::uint8_t>(26, 2).put<std::uint8_t>(27, 2).put<std::uint8_t>(28, 2).put<std::uint8_t>(29, 3);
    d.fields.put(32, z).put<std::int16_t>(34, -100).put<std::int16_t>(36, 50).put<std::uint8_t>(47, 1);
    d.fields.put<std::uint16_t>(48, 0).put<std::uint8_t>(63, 2).put(64, multiplier);
    return d.bytes();
  };
  const Log log = read_all(datagram(3000, 1000, 0));
  const Swath s = log.swaths().at(0);
  ASSERT_EQ(s.soundings.size(), 1u);
  EXPECT_NEAR(s.soundings[0].point.z(), 20 + 1.5, 1e-5);
  EXPECT_NEAR(s.soundings[0].point.y(), -3, 1e-5);
  EXPECT_NEAR(s.soundings[0].point.x(), 1.5, 1e-5);
  EXPECT_EQ(s.soundings[0].beam, 1);
  EXPECT_EQ(s.soundings[0].sigma_m, 0) << "not stated";
  EXPECT_EQ(refused(log, "sounding without a detection"), 1u);
  EXPECT_NEAR(read_all(datagram(300, 50000, 1)).swaths().at(0).soundings[0].point.z(), 1000 + 1.5 + 655.36, 1e-3);
  EXPECT_NEAR(read_all(datagram(3000, 50000, 0)).swaths().at(0).soundings[0].point.z(), -15536 * 0.02 + 1.5, 1e-3);
}

TEST(KongsbergAll, OnlyActiveSensorsAndValidSamplesCount) {
  const Log log =
      read_all(all_position(1000, 50, 20, 0x02).bytes() + all_attitude(1000, {{.roll_deg = 9}}, 0x1E).bytes() +
               all_attitude(1000, {{.roll_deg = 9, .status = 0x9A9A}, {.after_ms = 1, .roll_deg = 1}}).bytes() +
               all_position(1000, 45, 10).bytes());
  ASSERT_EQ(log.fixes().size(), 1u);
  EXPECT_NEAR(log.fixes()[0].X_WB.rotation.roll().degrees(), 1, 1e-9);
  EXPECT_EQ(log.report.origin->latitude_deg, 45);
  EXPECT_EQ(refused(log, "attitude sample that its sensor calls invalid"), 1u);
  EXPECT_EQ(log.report.details.at("other sensors"), "1 positions and 1 attitude records of inactive sensors, not used");
}

TEST(KongsbergAll, MidnightLiesBetweenTwoDates) {
  auto before = all_ping(86'399'900, {{}}), after = all_position(100, 45, 10);
  after.date = 20200913;
  const Log log = read_all(after.bytes() + before.bytes());
  ASSERT_EQ(log.events.size(), 3u);
  EXPECT_EQ(time_of(log.events[2]) - time_of(log.events[0]), std::chrono::milliseconds(200));
}

TEST(KongsbergAll, TwoHeadsOfOnePingAreTwoSwaths) {
  auto second = all_ping(1000, {{}});
  second.serial = 214;
  second.counter = 65535;
  const Log log = read_all(all_position(1000, 45, 10).bytes() + all_ping(1000, {{}}).bytes() + second.bytes());
  EXPECT_EQ(log.swaths().size(), 2u);
  EXPECT_EQ(log.fixes().size(), 1u);
}

TEST(KongsbergAll, DamageCostsTheDatagramInWhichItLies) {
  const std::string ping = all_ping(1000, {{}, {}}).bytes(), position = all_position(1000, 45, 10).bytes();
  const auto swaths = [](const std::string& bytes) { return read_all(bytes).swaths().size(); };
  EXPECT_EQ(swaths(ping + "noise \x02 with a start in it" + ping), 2u);
  EXPECT_EQ(swaths(ping + ping.substr(0, ping.size() - 1)), 1u) << "cut off";
  std::string bad = ping;
  bad.replace(0, 4, std::string(4, '\0'));
  EXPECT_EQ(swaths(bad + ping), 1u) << "length 0";
  bad.replace(0, 4, "\xff\xff\xff\x7f");
  EXPECT_EQ(swaths(bad + ping), 1u) << "beyond the file";
  bad = ping;
  bad[28] = 100;
  EXPECT_EQ(refused(read_all(bad), "ping shorter than its beams"), 1u);
  auto dateless = all_ping(1000, {{}});
  dateless.date = 20201399;
  EXPECT_EQ(refused(read_all(position + dateless.bytes()), "datagram whose date is impossible"), 1u);
}

TEST(KongsbergAll, WrongChecksumsAreCountedAndUnknownTypesPassedOver) {
  std::string ping = all_ping(1000, {{}}).bytes();
  ping.back() = static_cast<char>(ping.back() + 1);
  const Log log = read_all(ping + test::AllDatagram{.type = 'q'}.bytes() + ping);
  EXPECT_EQ(log.swaths().size(), 2u);
  EXPECT_EQ(log.report.bytes_skipped, 0u);
  EXPECT_THAT(log.report.details.at("checksums"), testing::StartsWith("2 datagrams"));
  EXPECT_EQ(log.report.details.at("other datagrams"), "q x 1");
}

// .kmall
// ---------------------------------------------------------------------------------------------------------------

TEST(Kmall, PositionOfTheFormatSheet) {
  ASSERT_EQ(kPosition.size(), 83u);
  ASSERT_TRUE(looks_like_kmall(bytes_of(kPosition)));
  EXPECT_EQ(refused(read_kmall(kPosition), "position without a heading"), 1u);
  const Log log = read_kmall(kPosition + test::kmall_attitude({{.time_s = 1600000000.5, .roll_deg = -2}}));
  const Navigation fix = log.fixes().at(0);
  EXPECT_EQ(fix.time, Time{seconds(1600000000.5)});
  EXPECT_EQ(*log.report.origin, (GeoPoint{47.5, -122.25}));
  EXPECT_NEAR(fix.v_WB->y(), 1.5, 1e-6) << "to the east";
  EXPECT_NEAR((*fix.covariance)(0, 0), 0.25, 1e-9) << "fix quality 0.5 m";
  EXPECT_NEAR((*fix.covariance)(3, 3), std::pow(Angle::degrees(0.03).radians(), 2), 1e-12) << "as the sensor states it";
}

TEST(Kmall, PingIsASwathBelowTheWaterLine) {
  KmallPing ping{.extra = 1};
  ping.soundings = {{.z = 10, .y = -3, .x = 0.5F}, {.type = 2}, {.z = 4, .type = 1}, {.two_way_s = 0}, {.type = 9}};
  const Log log = read_kmall(test::kmall_attitude({{.time_s = ping.time_s, .roll_deg = 3}}) + ping.bytes());
  ASSERT_EQ(log.events.size(), 2u);
  const Swath s = log.swaths().at(0);
  EXPECT_EQ(check(s), SwathFault::kNone);
  EXPECT_NEAR(s.heading->degrees(), 90, 1e-6);
  EXPECT_NEAR(s.beam_width.degrees(), 2, 1e-6);
  EXPECT_EQ(s.sound_speed, 1500);
  ASSERT_EQ(s.soundings.size(), 2u);
  EXPECT_EQ(s.soundings[0].point, Eigen::Vector3f(0.5F, -3, 9.5F)) << "z less the water level";
  EXPECT_NEAR(s.soundings[0].range_m, 15, 1e-5);
  EXPECT_FLOAT_EQ(s.soundings[0].sigma_m, 0.1F);
  EXPECT_EQ(s.soundings[0].kind, Sounding::Kind::kBottom);
  EXPECT_EQ(s.soundings[1].kind, Sounding::Kind::kWater);
  EXPECT_EQ(s.soundings[1].beam, 2);
  EXPECT_EQ(refused(log, "sounding that the sonar has rejected"), 1u);
  EXPECT_EQ(refused(log, "sounding without a detection"), 1u);
  EXPECT_EQ(refused(log, "sounding of an unknown kind"), 1u);
  const Navigation fix = log.fixes().at(0);
  EXPECT_NEAR(fix.X_WB.translation.z(), -0.5, 1e-9) << "the reference point is above the water";
  EXPECT_NEAR(fix.X_WB.rotation.roll().degrees(), 3, 1e-6);
  EXPECT_EQ(*log.report.origin, (GeoPoint{47.5, -122.25}));
}

TEST(Kmall, StructuresOfOtherSizesAreReadByTheSizesThatTheyState) {
  for (const std::uint16_t info : std::vector<std::uint16_t>{144, 152, 200}) {
    for (const std::uint16_t stride : std::vector<std::uint16_t>{108, 120, 160}) {
      for (const std::uint16_t other : std::vector<std::uint16_t>{0, 12}) {
        KmallPing ping{.version = static_cast<std::uint8_t>(info == 144 ? 0 : 2), .info_bytes = info};
        ping.sector_bytes = static_cast<std::uint16_t>(36 + other);
        ping.stride = stride;
        ping.common_bytes = static_cast<std::uint16_t>(12 + other);
        ping.receiver_bytes = static_cast<std::uint16_t>(32 + other);
        ping.soundings = {{.z = 10}, {.z = 11}};
        const Log log = read_kmall(ping.bytes());
        ASSERT_EQ(log.swaths().size(), 1u) << info << ' ' << stride << ' ' << other;
        EXPECT_EQ(log.swaths()[0].soundings.at(1).point.z(), 10.5F);
      }
    }
  }
}

TEST(Kmall, SizesThatContradictEachOtherCostThePing) {
  const auto reason = [](const KmallPing& ping) {
    const Log log = read_kmall(ping.bytes());
    EXPECT_TRUE(log.events.empty());
    return log.report.rejected.empty() ? std::string() : log.report.rejected.begin()->first;
  };
  const std::vector<KmallSounding> two(2);
  EXPECT_EQ(reason({.stride = 60, .soundings = two}), "ping whose sizes contradict each other");
  std::string long_part = KmallPing{.soundings = two}.bytes();
  long_part.replace(20 + 4, 2, "\xff\xff");
  EXPECT_EQ(refused(read_kmall(long_part), "ping whose sizes contradict each other"), 1u);
  EXPECT_EQ(reason({.parts = 2, .soundings = two}), "part of a divided datagram");
  KmallPing dry{.soundings = two};
  dry.water_level_m = std::numeric_limits<float>::infinity();
  EXPECT_EQ(reason(dry), "ping whose water level is impossible");
  std::string many = KmallPing{.soundings = two}.bytes();
  many.replace(20 + 4 + 12 + 152 + 48 + 2, 2, "\xff\xff");
  EXPECT_EQ(refused(read_kmall(many), "ping whose sizes contradict each other"), 1u);
}

TEST(Kmall, PingWithoutAPositionIsPlacedByThePositionRecords) {
  for (const bool invalid : {false, true}) {
    KmallPing ping{.time_s = 1600000000.5, .soundings = {{}}};
    ping.latitude = invalid ? 10 : 200;
    ping.position_status = invalid ? 1 : 0;
    const Log log = read_kmall(ping.bytes() + test::kmall_position(1600000000, 47.5, 8) +
                               test::kmall_attitude({{.time_s = 1600000000}, {.time_s = 1600000001}}) +
                               test::kmall_position(1600000001, 47.5, 8.00001));
    ASSERT_EQ(log.events.size(), 4u);
    EXPECT_NEAR(log.fixes()[1].X_WB.translation.y(), 0.5e-5 * 75300, 1e-2);
  }
}

TEST(Kmall, SensorsThatAreNotActiveOrNotValidAreLeftOut) {
  const Log log =
      read_kmall(test::kmall_attitude({{.roll_deg = 5}}, 0) +
                 test::kmall_attitude({{.roll_deg = 6, .status = 2}, {.roll_deg = 7}}) +
                 test::kmall_position(1600000000, 10, 10, 0) + test::kmall_position(1600000000, 10, 10, 1 | 16) +
                 test::kmall_position(1600000000, 200, 200) + test::kmall_position(1600000000, 47.5, 8));
  ASSERT_EQ(log.fixes().size(), 1u);
  EXPECT_NEAR(log.fixes()[0].X_WB.rotation.roll().degrees(), 7, 1e-5);
  EXPECT_EQ(log.report.origin->longitude_deg, 8);
  EXPECT_EQ(refused(log, "invalid position"), 2u);
}

TEST(Kmall, DamageCostsTheDatagramInWhichItLies) {
  const std::string ping = KmallPing{.soundings = {{}, {}}}.bytes();
  const auto swaths = [](const std::string& bytes) { return read_kmall(bytes).swaths().size(); };
  EXPECT_EQ(swaths(ping + "noise, #MRZ in it" + ping), 2u);
  EXPECT_EQ(swaths(ping + ping.substr(0, ping.size() - 2)), 1u) << "cut off";
  std::string bad = ping;
  bad.back() = 1;
  EXPECT_EQ(swaths(bad + ping), 1u) << "the second length differs";
  bad = ping;
  bad.replace(0, 4, std::string(4, '\0'));
  EXPECT_EQ(swaths(bad + ping), 1u);
  bad = ping;
  bad.replace(16, 4, std::string(4, '\xff'));
  EXPECT_EQ(refused(read_kmall(bad + ping), "datagram whose time is impossible"), 1u);
  const Log other = read_kmall(test::kmall_datagram("#XYZ", 1600000000, "body") + ping);
  EXPECT_EQ(other.report.details.at("other datagrams"), "#XYZ x 1");
}

TEST(Kongsberg, LogsSurviveRandomDamage) {
  const std::string all = test::all_installation("WLZ=0.5,S1X=1,").bytes() + all_position(1000, 45, 10).bytes() +
                          all_attitude(1000, {{}, {.after_ms = 500}}).bytes() + all_ping(1200, {{}, {}, {}}).bytes() +
                          kPing;
  const std::string kmall = kPosition + test::kmall_attitude({{}, {.time_s = 1600000001}}) +
                            KmallPing{.soundings = {{}, {.type = 1}}}.bytes();
  Random random(7);
  for (int round = 0; round < 3000; ++round) {
    std::string bad = round % 2 == 0 ? all : kmall;
    for (int i = 0; i < 3; ++i) bad[random.index(bad.size())] = static_cast<char>(random.bits());
    const Log log = round % 2 == 0 ? read_all(bad) : read_kmall(bad);
    for (const Swath& s : log.swaths()) ASSERT_EQ(check(s), SwathFault::kNone);
    for (const Navigation& fix : log.fixes()) ASSERT_TRUE(fix.X_WB.is_finite());
    ASSERT_LE(log.report.bytes_skipped, bad.size());
  }
}

}  // namespace
}  // namespace isobath
