// Recordings of fish finders: pings made byte by byte, damage, cuts, and a lake and a river.
#include <cmath>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/io/formats/fish_finder.hpp>
#include <isobath/io/open_source.hpp>
#include <tests/io/bytes_by_hand.hpp>
#include <tests/support/data.hpp>

namespace isobath::fish_finders {
namespace {

using test::big;
using test::drain;
using test::in_memory;
using test::little;
using testing::HasSubstr;

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

struct Sl2 {
  std::uint16_t channel = 0;
  float depth_ft = 10, track = 0;
  std::uint32_t milliseconds = 0;
  std::int32_t easting = 1'000'000, northing = 8'000'000;
};
std::string sl2_log(const std::vector<Sl2>& frames, std::size_t echoes = 20) {
  std::string log = test::hex("02 00 01 00 B2 07 00 00");
  for (const Sl2& f : frames) {
    std::string bytes(144 + echoes, '\x33');
    put(bytes, 0, static_cast<std::uint32_t>(log.size()));
    put(bytes, 28, static_cast<std::uint16_t>(bytes.size()));
    put(bytes, 32, f.channel);
    put(bytes, 34, static_cast<std::uint16_t>(echoes));
    put(bytes, 64, f.depth_ft);
    put(bytes, 100, 10.0f);
    put(bytes, 108, f.easting);
    put(bytes, 112, f.northing);
    put(bytes, 120, f.track);
    put(bytes, 128, 0.0f);
    put(bytes, 140, f.milliseconds);
    log += bytes;
  }
  return log;
}

TEST(Lowrance, FramesOfThePrimaryChannelGiveDepthsAndPositionsWhereTheyMove) {
  const std::string log =
      sl2_log({{.track = 1}, {.channel = 2}, {.milliseconds = 500}, {.easting = 1'000'010}, {.depth_ft = 0}});
  ASSERT_TRUE(looks_like_lowrance(bytes_of(log)));
  const auto source = open_lowrance(in_memory(log), {});
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 6u);  // two fixes, then one that goes back to the first position, and three depths
  const auto& fix = std::get<Navigation>(events[0]);
  EXPECT_NEAR(fix.X_WB.rotation.heading().radians(), 1, 1e-6);
  EXPECT_NEAR(fix.v_WB->norm(), 5.1444, 1e-3);
  const auto& reading = std::get<RangeReading>(events[1]);
  EXPECT_NEAR(*reading.range_m, 3.048, 1e-6);
  EXPECT_TRUE((reading.X_BS.rotation * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitZ(), 1e-9));
  EXPECT_EQ(to_seconds(time_of(events[2])), 0.5);
  EXPECT_EQ(source->report().rejected.at("depth of 0: no bottom"), 1u);
  EXPECT_EQ(source->report().details.at("channel 0"), "primary, 4 frames, used for depths");
  EXPECT_EQ(source->report().details.at("channel 2"), "downscan, 1 frames, not used");
}

TEST(Lowrance, DamageCostsItsFrameAndACutOnlyTheEchoes) {
  const std::string log = sl2_log({{}, {}, {}});
  std::string damaged = log;
  damaged.replace(8 + 164, 6, "xxxxxx");
  const auto source = open_lowrance(in_memory(damaged), {});
  EXPECT_EQ(drain(*source).size(), 3u);
  EXPECT_EQ(source->report().bytes_skipped, 164u);
  for (std::size_t cut = 1; cut < log.size(); ++cut) {
    const auto part = open_lowrance(in_memory(log.substr(0, cut)), {});
    EXPECT_EQ(drain(*part).size(), cut < 152 ? 0u : cut < 152 + 164 ? 2u : cut < 152 + 328 ? 3u : 4u) << cut;
    EXPECT_LE(part->report().bytes_skipped, cut);
  }
}

TEST(Lowrance, RealLogsOfALakeAndABoat) {
  ISOBATH_NEEDS_DATA(data, "lowrance-sl2");
  const auto source = open_source(data / "input.sl2", {});
  const auto events = drain(*source);
  EXPECT_EQ(source->report().bytes_skipped, 0u);
  EXPECT_EQ(source->report().details.at("channel 0"), "primary, 112 frames, used for depths");
  EXPECT_EQ(source->report().details.at("channel 2"), "downscan, 111 frames, not used");
  EXPECT_THAT(source->report().details.at("cut off"), HasSubstr("within the echoes"));
  int depths = 0;
  for (const Event& e : events) {
    if (const auto* r = std::get_if<RangeReading>(&e)) {
      ++depths;
      EXPECT_GT(*r->range_m, 3.95);
      EXPECT_LT(*r->range_m, 4.25);
    }
  }
  EXPECT_EQ(depths, 112);
  EXPECT_NEAR(source->report().origin->latitude_deg, 60.149, 0.001);
  EXPECT_NEAR(source->report().origin->longitude_deg, 32.319, 0.001);
  const auto other = open_source(data / "elite4-version-1.sl2", {});
  const auto few = drain(*other);
  EXPECT_NEAR(*std::get<RangeReading>(few.at(1)).range_m, 1.22, 0.01);
  EXPECT_NEAR(other->report().origin->latitude_deg, 59.124, 0.001);
}

std::string son_ping(std::uint32_t number, std::uint32_t depth_dm, std::int32_t easting = -1000,
                     std::size_t echoes = 9) {
  const auto tagged = [](int tag, const std::string& value) { return static_cast<char>(tag) + value; };
  return test::hex("C0 DE AB 21") + tagged(0x80, big(number)) + tagged(0x81, big(number * 100)) +
         tagged(0x82, big(static_cast<std::uint32_t>(easting))) + tagged(0x83, big(std::uint32_t{4'396'652})) +
         tagged(0x84, big(std::uint32_t{(1 << 16) + 900})) + tagged(0x85, big(std::uint32_t{(1 << 16) + 200})) +
         tagged(0x87, big(depth_dm)) + tagged(0x50, "\1") + tagged(0x92, big(std::uint32_t{200'000})) +
         tagged(0xA0, big(static_cast<std::uint32_t>(echoes))) + "!" + std::string(echoes, '\x21');
}

TEST(Humminbird, PingsGiveDepthsAndPositionsWhereTheyMove) {
  const std::string log = son_ping(0, 42) + son_ping(1, 43) + son_ping(2, 0, -990);
  ASSERT_TRUE(looks_like_humminbird(bytes_of(log)));
  const auto source = open_humminbird(in_memory(log), {}, Time{std::chrono::seconds(1000)});
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 4u);
  EXPECT_NEAR(std::get<Navigation>(events[0]).X_WB.rotation.heading().degrees(), 90, 1e-9);
  EXPECT_NEAR(std::get<Navigation>(events[0]).v_WB->y(), 2, 1e-9);
  EXPECT_NEAR(*std::get<RangeReading>(events[2]).range_m, 4.3, 1e-9);
  EXPECT_EQ(to_seconds(time_of(events[2])), 1000.1);
  EXPECT_EQ(source->report().rejected.at("depth of 0: no bottom"), 1u);
}

TEST(Humminbird, DamageAndACutCostOnlyThemselves) {
  const std::string ping = son_ping(0, 42);
  const auto source = open_humminbird(in_memory(ping + "\xC0\xDE\xAB\x21\x07noise" + son_ping(1, 43)), {});
  EXPECT_EQ(drain(*source).size(), 3u);
  EXPECT_EQ(source->report().bytes_skipped, 10u);
  const std::string log = ping + son_ping(1, 43);
  for (std::size_t cut = 1; cut < log.size(); ++cut) {
    const auto part = open_humminbird(in_memory(log.substr(0, cut)), {});
    EXPECT_EQ(drain(*part).size(), cut < ping.size() ? 0u : 2u) << cut;
    EXPECT_LE(part->report().bytes_skipped, cut);
  }
}

TEST(Humminbird, RealLogOfARiver) {
  ISOBATH_NEEDS_DATA(data, "humminbird-river");
  const auto source = open_source(data / "B000.SON", {});
  const auto events = drain(*source);
  EXPECT_EQ(source->report().bytes_skipped, 0u);
  EXPECT_EQ(source->report().details.at("sonar"), "83 kHz");
  std::vector<double> depths;
  for (const Event& e : events) {
    if (const auto* r = std::get_if<RangeReading>(&e)) depths.push_back(*r->range_m);
  }
  ASSERT_EQ(depths.size(), 1726u);
  std::ranges::sort(depths);
  EXPECT_NEAR(depths.front(), 1.0, 1e-9);
  EXPECT_NEAR(depths.back(), 6.6, 1e-9);
  EXPECT_NEAR(depths[depths.size() / 2], 4.2, 0.11);
  EXPECT_NEAR(source->report().origin->latitude_deg, 36.8788, 1e-3);
  EXPECT_NEAR(source->report().origin->longitude_deg, -111.5143, 1e-3);
  EXPECT_THAT(to_text(time_of(events.front())), HasSubstr("2013-10-24T")) << "of the settings beside it";
}

}  // namespace
}  // namespace isobath::fish_finders
