// Devices on serial lines, on the network and found by their broadcasts, each against its stand-in.
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/links/device_search.hpp>
#include <tests/links/joined.hpp>

namespace isobath::serial_devices {
namespace {

using test::Joined;

/// What came of a device.
struct Heard {
  int pings = 0, ranges = 0, fixes = 0;
  double reach_m = 0;
  std::optional<Navigation> fix;
  std::optional<RangeReading> range;
  std::optional<Ping> ping;

  void add(const Event& event) {
    if (const auto* p = std::get_if<Ping>(&event)) {
      ++pings;
      reach_m = p->window.end_m();
      ping = *p;
    } else if (const auto* r = std::get_if<RangeReading>(&event)) {
      ++ranges;
      range = *r;
    } else if (const auto* f = std::get_if<Navigation>(&event)) {
      ++fixes;
      fix = *f;
    }
  }
};

std::string nmea_device(const std::string& link) {
  return "[[device]]\nkind = \"nmea\"\nlink = \"" + link + "\"\nnavigation = true\nposition_m = [0.3, 0, 0.7]\n";
}

void expect_position_and_depths(Joined& joined) {
  Heard heard;
  EXPECT_TRUE(joined.until([&](const Event& event) {
    heard.add(event);
    return heard.fixes > 5 && heard.ranges > 5;
  })) << heard.fixes
      << " fixes, " << heard.ranges << " ranges";
  ASSERT_TRUE(heard.fix && heard.range);
  EXPECT_LT(heard.fix->X_WB.translation.norm(), 8) << "it stands at the origin of the scene";
  EXPECT_EQ(heard.fix->X_WB.translation.z(), 0) << "NMEA 0183 has no depth of the vehicle";
  EXPECT_NEAR(heard.range->range_m.value_or(0), 8.5, 1) << "the bottom is 9 m deep";
  EXPECT_NEAR(heard.range->X_BS.translation.x(), 0.3, 1e-9);
  EXPECT_NEAR(heard.range->X_BS.translation.z(), 0.7, 1e-9);
}

TEST(NmeaDevices, GivePositionAndDepthsOverTcp) {
  Joined joined(Joined::with({{DeviceKind::kNmea, "tcp-server:0"}}), nmea_device("tcp:127.0.0.1:@nmea"));
  expect_position_and_depths(joined);
}

TEST(NmeaDevices, GivePositionAndDepthsOnASerialLine) {
  const std::string line = (test::scratch_folder() / "nmea").string();
  Joined joined(Joined::with({{DeviceKind::kNmea, "pty:" + line}}), nmea_device("serial:" + line + ":4800"));
  expect_position_and_depths(joined);
}

TEST(NmeaDevices, GivePositionAndDepthsInDatagrams) {
  for (int port = 42110; port < 42210; ++port) {  // the first that is free
    try {
      Joined joined(Joined::with({{DeviceKind::kNmea, fmt::format("udp:127.0.0.1:{}", port)}}),
                    nmea_device(fmt::format("udp-server:{}", port)));
      return expect_position_and_depths(joined);
    } catch (const Error&) {
      continue;
    }
  }
  FAIL() << "no free port";
}

TEST(NmeaDevices, OnlyOneDeviceNavigates) {
  const std::string two = nmea_device("tcp:a:1") + "name = \"a\"\n" + nmea_device("tcp:a:2") + "name = \"b\"\n";
  EXPECT_THROW(parse_vehicle_file(two, "vehicle.toml"), Error);
  EXPECT_THROW(parse_vehicle_file(nmea_device("udp:127.0.0.1:10110"), "vehicle.toml"), Error)
      << "nothing comes to a port that nobody knows";
}

TEST(MicronDevices, AreCommandedAndAskedLineByLineOnASerialLine) {
  const std::string line = (test::scratch_folder() / "micron").string();
  Joined joined(Joined::with({{DeviceKind::kMicron, "pty:" + line}}),
                "[[device]]\nkind = \"micron\"\nlink = \"serial:" + line +
                    ":115200\"\nrange_m = 15\nsector_deg = 90\nposition_m = [0.4, 0, -0.1]\n");
  Heard heard;
  double widest_deg = 0;
  EXPECT_TRUE(joined.until([&](const Event& event) {
    heard.add(event);
    if (heard.pings > 5 && heard.ping)
      widest_deg = std::max(widest_deg, std::abs(heard.ping->fan->azimuth.front().degrees()));
    return heard.pings > 60;
  })) << heard.pings
      << " pings";
  EXPECT_NEAR(heard.reach_m, 15, 0.2) << "the range that it was commanded to";
  EXPECT_GT(widest_deg, 40);
  EXPECT_LT(widest_deg, 48) << "the sector that it was commanded to";
  ASSERT_TRUE(heard.ping);
  EXPECT_NEAR(heard.ping->X_BS.translation.x(), 0.4, 1e-9);
  joined.vehicle().scan({.range_m = 8});
  EXPECT_TRUE(joined.until([&](const Event& event) {
    heard.add(event);
    return std::abs(heard.reach_m - 8) < 0.2;
  })) << "a command while it runs; it reaches "
      << heard.reach_m << " m";
}

TEST(MicronDevices, AreFoundAgainAfterEachPull) {
  const std::string line = (test::scratch_folder() / "micron").string();
  StandInRequest request = Joined::with({{DeviceKind::kMicron, "pty:" + line}});
  request.unplug = {.times = 3, .mean_s = 2, .longest_s = 2, .seed = 5};
  Joined joined(request, "[[device]]\nkind = \"micron\"\nlink = \"serial:" + line + ":115200\"\n");
  int pings = 0;
  EXPECT_TRUE(joined.until([&](const Event& event) {
    if (joined.stand_ins().devices().front()->pulled() < 3) return false;
    pings += std::holds_alternative<Ping>(event);
    return pings > 10;
  })) << joined.stand_ins().devices().front()->pulled()
      << " pulls, then " << pings << " pings";
}

TEST(OculusDevices, AreFoundByTheirBroadcasts) {
  StandInRequest request = Joined::with({{DeviceKind::kOculus, "tcp-server:127.52.1.21:52100"}});
  request.oculus_status = "udp:127.255.255.255:52199";
  Joined joined(request, "[[device]]\nkind = \"oculus\"\nlink = \"oculus:auto:52199\"\nrange_m = 20\n",
                "scenarios/aboard_oculus.toml");
  Heard heard;
  EXPECT_TRUE(joined.until([&](const Event& event) {
    heard.add(event);
    return heard.pings > 3;
  })) << heard.pings
      << " pings";
  ASSERT_TRUE(heard.ping);
  EXPECT_EQ(heard.ping->fan->beams(), 512);
}

TEST(DeviceSearch, TellsWhatSpeaksOnEachLink) {
  const std::string line = (test::scratch_folder() / "micron").string();
  StandInRequest request = Joined::with({{DeviceKind::kPing360, "udp-server:127.0.0.9:12345"},
                                         {DeviceKind::kPing1D, "udp-server:0"},
                                         {DeviceKind::kMicron, "pty:" + line},
                                         {DeviceKind::kOculus, "tcp-server:127.52.1.22:52100"},
                                         {DeviceKind::kDvlA50, "tcp-server:0"},
                                         {DeviceKind::kNmea, "tcp-server:0"}});
  request.oculus_status = "udp:127.255.255.255:52198";
  request.ping360_discovery = "udp-server:127.255.255.255:30303";
  Joined joined(request, "");
  const auto port = [&](std::size_t i) { return joined.stand_ins().devices()[i]->port(); };
  const SearchResult found = search_devices(
      {"udp:127.255.255.255:30303", fmt::format("udp:127.0.0.1:{}", port(1)), "serial:" + line + ":115200",
       "udp-server:0.0.0.0:52198", fmt::format("tcp:127.0.0.1:{}", port(4)), fmt::format("tcp:127.0.0.1:{}", port(5)),
       "udp:127.0.0.1:9", fmt::format("udp:127.0.0.1:{}", joined.stand_ins().autopilot_port())},
      20, Joined::kSpeed);
  std::vector<std::string> heard;
  for (const Speaker& s : found.speakers) {
    const std::string kind = s.device ? to_text(*s.device) : "autopilot";
    heard.push_back(kind + " " + s.link);
  }
  EXPECT_THAT(heard, testing::ElementsAre(testing::StartsWith("autopilot udp:"), "ping360 udp:127.0.0.9:12345",
                                          testing::StartsWith("ping1d udp:"), testing::StartsWith("micron serial:"),
                                          "oculus oculus:7892:52198", testing::StartsWith("dvl-a50 tcp:"),
                                          testing::StartsWith("nmea tcp:")));
  EXPECT_THAT(found.problems, testing::IsEmpty());
}

}  // namespace
}  // namespace isobath::serial_devices
