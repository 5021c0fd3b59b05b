#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/io/formats/aris.hpp>
#include <isobath/io/open_source.hpp>
#include <tests/io/aris_frames.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using test::aris_header;
using test::ArisFrame;
using test::drain;
using test::in_memory;

std::vector<Event> aris_events(const std::string& log, const InputConfig& config = {}) {
  return drain(*open_aris(in_memory(log), config));
}
const Ping& aris_ping(const std::vector<Event>& events, std::size_t i = 0) { return std::get<Ping>(events.at(i)); }

/// Times of the frames that were read.
std::vector<std::uint64_t> times_of(const std::string& log) {
  std::vector<std::uint64_t> times;
  for (const Event& e : aris_events(log)) {
    times.push_back(static_cast<std::uint64_t>(time_of(e).time_since_epoch().count() / 1000));
  }
  return times;
}

// Each field at its place: what a frame of 48 beams and two samples means.
TEST(Aris, FrameIsAFanFromPortToStarboard) {
  const std::string log = aris_header() + ArisFrame{}.bytes();
  ASSERT_EQ(log.size(), 1024u + 1024u + 96u);
  ASSERT_TRUE(looks_like_aris(bytes_of(log)));
  const auto source = open_aris(in_memory(log), {});
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 1u);
  const Ping& ping = aris_ping(events);
  EXPECT_EQ(check(ping), PingFault::kNone);
  EXPECT_EQ(ping.time, Time{std::chrono::microseconds(1'371'217'171'000'000)});
  EXPECT_NEAR(ping.window.start_m, 2.9, 1e-9) << "4 ms two ways at 1450 m/s";
  EXPECT_NEAR(ping.window.bin_m, 0.00725, 1e-9);
  EXPECT_EQ(ping.window.bins, 2);
  EXPECT_EQ(ping.sound_speed, 1450);
  ASSERT_EQ(ping.fan->beams(), 48);
  EXPECT_THAT(test::beam(ping, 47), testing::ElementsAre(1, 49)) << "the first of a row is the beam to starboard";
  EXPECT_THAT(test::beam(ping, 0), testing::ElementsAre(48, 96));
  EXPECT_GT(ping.fan->azimuth[47].degrees(), 13) << "starboard is positive";
  EXPECT_DOUBLE_EQ(ping.fan->height.degrees(), 14);
  EXPECT_EQ(source->report().details.at("sonar"), "ARIS 1200, 48 beams");
  EXPECT_EQ(source->report().details.at("frequency"), "1.2 MHz");
  EXPECT_EQ(source->report().bytes_skipped, 0u);
}

// Centres of some beams in the maker's tables, degrees.
TEST(Aris, AzimuthsAreThoseOfTheLens) {
  struct Known {
    std::uint32_t mode, telephoto;
    int beam;
    double azimuth;
  };
  for (const Known& k : {Known{1, 0, 47, 13.5735},
                         {1, 0, 35, 7.5026},
                         {1, 0, 0, -13.5735},
                         {3, 0, 95, 13.8759},
                         {3, 0, 63, 5.2236},
                         {3, 0, 0, -13.749},
                         {6, 0, 63, 14.703},
                         {6, 0, 43, 5.476},
                         {9, 0, 127, 14.705},
                         {9, 0, 95, 7.407},
                         {1, 1, 47, 6.742},
                         {1, 1, 35, 3.403},
                         {3, 1, 95, 7.419},
                         {3, 1, 63, 2.471},
                         {3, 1, 0, -7.419}}) {
    const auto events = aris_events(aris_header() + ArisFrame{.mode = k.mode, .telephoto = k.telephoto}.bytes());
    const BeamFan& fan = *aris_ping(events).fan;
    EXPECT_NEAR(fan.azimuth.at(static_cast<std::size_t>(k.beam)).degrees(), k.azimuth, 0.1)
        << k.mode << " " << k.telephoto << " " << k.beam;
    EXPECT_EQ(check(aris_ping(events)), PingFault::kNone);
    double widths = 0;
    for (const Angle width : fan.width) widths += width.degrees();
    EXPECT_NEAR(widths, (fan.azimuth.back() - fan.azimuth.front()).degrees() + fan.width[0].degrees(), 0.01)
        << "as wide as they are apart";
  }
}

TEST(Aris, ConfigurationSaysWhatTheRecordingDoesNot) {
  InputConfig config;
  config.beam_width = Angle::degrees(0.8);
  config.beam_height = Angle::degrees(8);
  config.mount_heading = Angle::degrees(90);
  config.sound_speed = 1480;
  const auto events = aris_events(aris_header() + ArisFrame{.sound_speed = 0}.bytes(), config);
  const Ping& ping = aris_ping(events);
  EXPECT_DOUBLE_EQ(ping.fan->width[3].degrees(), 0.8);
  EXPECT_DOUBLE_EQ(ping.fan->height.degrees(), 8);
  EXPECT_NEAR(ping.X_BS.rotation.heading().degrees(), 90, 1e-9);
  EXPECT_EQ(ping.sound_speed, 1480) << "none in the header";
  EXPECT_NEAR(ping.window.start_m, 2.96, 1e-9);
}

TEST(Aris, FramesThatCannotBeUsedAreCountedByReason) {
  const auto source =
      open_aris(in_memory(aris_header() + ArisFrame{.transmits = 0}.bytes() + ArisFrame{.ordered = 0}.bytes() +
                          ArisFrame{.time_us = ~0ull}.bytes() + ArisFrame{.samples = 3}.bytes()),
                {});
  EXPECT_EQ(drain(*source).size(), 1u);
  EXPECT_EQ(source->report().rejected.at("frame without a transmission"), 1u);
  EXPECT_EQ(source->report().rejected.at("frame whose samples are not in the order of its beams"), 1u);
  EXPECT_EQ(source->report().rejected.at("frame whose time is impossible"), 1u);
}

TEST(Aris, CutAtEveryByteItGivesTheWholeFrames) {
  const std::string frame = ArisFrame{}.bytes(), log = aris_header() + frame + frame;
  for (std::size_t size = 1; size < log.size(); ++size) {
    const std::string cut = log.substr(0, size);
    if (size <= 1024) {
      ASSERT_THROW(open_aris(in_memory(cut), {}), Error) << size;
      continue;
    }
    const auto source = open_aris(in_memory(cut), {});
    const std::size_t whole = (size - 1024) / frame.size();
    ASSERT_EQ(drain(*source).size(), whole) << size;
    ASSERT_EQ(source->report().bytes_skipped, size - 1024 - whole * frame.size()) << size;
  }
}

// A header that promises too much or too little costs its own frame; so does what is lost or put in between.
TEST(Aris, DamageCostsTheFrameInWhichItLies) {
  std::vector<std::string> frames;
  for (std::uint64_t i = 0; i < 3; ++i) frames.push_back(ArisFrame{.time_us = 1000 + i, .samples = 40}.bytes());
  const auto log = [&](const std::string& second) { return aris_header() + frames[0] + second + frames[2]; };
  const auto with = [&](std::size_t at, const std::string& bytes) {
    return std::string(frames[1]).replace(at, bytes.size(), bytes);
  };
  using testing::ElementsAre;
  EXPECT_THAT(times_of(log(frames[1])), ElementsAre(1000, 1001, 1002));
  EXPECT_THAT(times_of(log("some noise" + frames[1] + "DDF\x05 and more")), ElementsAre(1000, 1001, 1002));
  for (const std::size_t left : {20u, 700u, 1024u, 1100u, 2900u}) {
    EXPECT_THAT(times_of(log(frames[1].substr(0, left))), ElementsAre(1000, 1002)) << "only " << left << " bytes of it";
  }
  for (const auto& bad : {with(12, "XXXX"), with(436, test::little(std::uint32_t{13})), with(436, std::string(4, '\0')),
                          with(468, std::string(4, '\xff')), with(468, std::string(4, '\0')),
                          with(468, test::little(std::uint32_t{2901})), with(452, std::string(4, '\0')),
                          with(476, std::string(4, '\xff'))}) {
    EXPECT_THAT(times_of(log(bad)), ElementsAre(1000, 1002));
  }
  EXPECT_THAT(times_of(log(with(468, test::little(std::uint32_t{7})))), ElementsAre(1000, 1001, 1002))
      << "samples that nobody promised are skipped";
}

TEST(Aris, SurvivesRandomDamage) {
  const std::string good = aris_header() + ArisFrame{}.bytes() + ArisFrame{.mode = 6, .samples = 5}.bytes();
  Random random(3);
  for (int round = 0; round < 1000; ++round) {
    std::string bad = good;
    for (int i = 0; i < 6; ++i) {
      const std::size_t at = 1024 + random.index(bad.size() - 1024);
      bad[at] = static_cast<char>(random.bits());
    }
    const auto source = open_aris(in_memory(bad), {});
    for (const Event& e : drain(*source)) ASSERT_EQ(check(std::get<Ping>(e)), PingFault::kNone);
    ASSERT_LE(source->report().bytes_skipped, bad.size());
  }
}

// Real: six frames of an ARIS 1200 that stands in a river. Its software shows a window of 3.33 to 23.63 m.
TEST(ArisRecording, OfARiverIsReadWhole) {
  ISOBATH_NEEDS_DATA(folder, "aris-sample");
  InputConfig whole;
  whole.max_bins = 0;
  const auto source = open_source(folder / "sample.aris", whole);
  EXPECT_EQ(source->report().format, "ARIS recording");
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 6u);
  for (const Event& e : events) {
    const Ping& ping = std::get<Ping>(e);
    EXPECT_EQ(check(ping), PingFault::kNone);
    EXPECT_EQ(ping.fan->beams(), 48);
    EXPECT_EQ(ping.window.bins, 2000);
    EXPECT_NEAR(ping.sound_speed, 1435.9, 0.1) << "fresh water of 9 degrees";
    EXPECT_NEAR(ping.window.start_m, 3.33, 0.04);
    EXPECT_NEAR(ping.window.end_m() - ping.window.start_m, 20.3, 0.25);
    double sum = 0;
    for (int b = 0; b < 48; ++b) {
      for (const float v : test::beam(ping, b)) sum += static_cast<double>(v);
    }
    EXPECT_NEAR(sum / (48 * 2000), 60, 40);
  }
  EXPECT_NEAR(to_seconds(time_of(events[1]) - time_of(events[0])), 0.1525, 1e-3);
  EXPECT_EQ(source->report().bytes_skipped, 0u);
  EXPECT_EQ(source->report().details.at("sonar"), "ARIS 1200, 48 beams, telephoto lens");
}

}  // namespace
}  // namespace isobath
