#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/io/formats/xtf.hpp>
#include <tests/io/survey_datagrams.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using test::drain;
using test::in_memory;
using test::R2SonicPing;

const char* const kLine = "xtf-r2sonic/0009-150708_R2Testing-0001.xtf";

std::string small_log(const R2SonicPing& ping = {}) {
  return test::xtf_header() + test::xtf_position(0, 37.75, -122.375) + test::xtf_attitude(0, 2, -3, 0.25F, 350) +
         ping.bytes() + test::xtf_attitude(0.5, 2, -3, 0.25F, 350) + test::xtf_position(0.5, 37.75, -122.375);
}

std::vector<Swath> swaths_of(const std::vector<Event>& events) {
  std::vector<Swath> swaths;
  for (const Event& e : events) {
    if (const auto* s = std::get_if<Swath>(&e)) swaths.push_back(*s);
  }
  return swaths;
}

// The fields of the three packets, each by its offset in the public description of XTF (revision 40) and of BTH0.
TEST(Xtf, PingIsASwathInTheBody) {
  ASSERT_TRUE(looks_like_xtf(bytes_of(small_log())));
  const auto source = open_xtf(in_memory(small_log({.s = 0.25})), {});
  const auto events = drain(*source);
  const auto swaths = swaths_of(events);
  ASSERT_EQ(swaths.size(), 1u);
  const Swath& s = swaths[0];
  EXPECT_EQ(check(s), SwathFault::kNone);
  EXPECT_EQ(s.time, Time{seconds(test::kXtfEpoch + 0.25)});
  EXPECT_EQ(s.frame, Swath::Frame::kBody);
  EXPECT_EQ(s.sound_speed, 1500);
  EXPECT_NEAR(s.beam_width.radians(), 0.0175, 1e-6);
  ASSERT_EQ(s.soundings.size(), 3u);
  EXPECT_NEAR(s.soundings[0].range_m, 15, 1e-3) << "20 ms two ways at 1500 m/s";
  EXPECT_NEAR(s.soundings[0].point.y(), -15 * std::sin(0.5), 1e-3) << "port is negative";
  EXPECT_NEAR(s.soundings[0].point.z(), 15 * std::cos(0.5), 1e-3);
  EXPECT_NEAR(s.soundings[1].point.z(), 12, 1e-3) << "steps add up: the middle beam looks down";
  EXPECT_NEAR(s.soundings[2].point.y(), 15 * std::sin(0.5), 1e-3);
  ASSERT_EQ(events.size(), 4u);
  const auto& fix = std::get<Navigation>(events[1]);
  EXPECT_EQ(fix.time, s.time);
  EXPECT_NEAR(fix.X_WB.rotation.pitch().degrees(), 2, 1e-6);
  EXPECT_NEAR(fix.X_WB.rotation.roll().degrees(), -3, 1e-6);
  EXPECT_NEAR(fix.X_WB.rotation.heading().degrees(), -10, 1e-6);
  EXPECT_NEAR(fix.X_WB.translation.z(), -0.25, 1e-6) << "heave is positive up";
  EXPECT_EQ(*source->report().origin, (GeoPoint{37.75, -122.375}));
  EXPECT_EQ(source->report().details.at("sonar"), "R2Sonic 2026, 400 kHz");
}

TEST(Xtf, HeadIsMountedAsConfigured) {
  InputConfig config;
  config.mount_roll = Angle::degrees(30);
  config.mount_m[2] = 1.5;
  const auto swaths = swaths_of(drain(*open_xtf(in_memory(small_log()), config)));
  const auto& down = swaths.at(0).soundings.at(1);
  EXPECT_NEAR(down.point.y(), -6, 1e-3) << "a head rolled to starboard down looks to port";
  EXPECT_NEAR(down.point.z(), 1.5 + 12 * std::cos(Angle::degrees(30).radians()), 1e-3);
  EXPECT_NEAR(down.range_m, 12, 1e-3);
}

TEST(Xtf, EvenAnglesAndPointsWithoutDetection) {
  const R2SonicPing ping{.ranges = {20000, 0, 20000, 20000, 20000}, .flags = {8, 8, 3, 4, 12}, .even_angles = true};
  const auto source = open_xtf(in_memory(small_log(ping)), {});
  const auto swaths = swaths_of(drain(*source));
  ASSERT_EQ(swaths.at(0).soundings.size(), 3u);
  EXPECT_EQ(swaths[0].soundings[1].beam, 3);
  EXPECT_NEAR(swaths[0].soundings[1].point.y(), 15 * std::sin(0.25), 1e-3);
  EXPECT_EQ(source->report().rejected.at("sounding without a detection"), 2u);
}

TEST(Xtf, DamageCostsThePacketInWhichItLies) {
  const std::string head = test::xtf_header() + test::xtf_attitude(0, 0, 0, 0, 0);
  const std::string ping = R2SonicPing{}.bytes();
  const auto count = [&](const std::string& log) { return swaths_of(drain(*open_xtf(in_memory(log), {}))).size(); };
  EXPECT_EQ(count(head + ping + "some noise" + ping), 2u);
  EXPECT_EQ(count(head + ping + ping.substr(0, 300)), 1u);
  std::string bad = ping;
  bad.replace(256, 4, "XXXX");
  EXPECT_EQ(count(head + bad + ping), 1u);
  bad = ping;
  bad.replace(10, 4, std::string(4, '\xff'));
  EXPECT_EQ(count(head + bad + ping), 1u);
  EXPECT_EQ(count(head + R2SonicPing{.ranges = {1, 2, 3, 4, 5}}.bytes() + ping), 1u) << "fewer angles than ranges";
  EXPECT_EQ(count(head + R2SonicPing{.sound_speed = 0}.bytes() + ping), 1u);
}

TEST(Xtf, OtherPacketsAreCountedByTypeAndOtherUnitsRefused) {
  const std::string log = test::xtf_header(0) + test::xtf_packet(2, test::Record(std::endian::little, 64)) +
                          test::xtf_position(0, 37, -122);
  const auto source = open_xtf(in_memory(log), {});
  EXPECT_TRUE(drain(*source).empty());
  EXPECT_EQ(source->report().rejected.at("packet of type 2, which is not read"), 1u);
  EXPECT_EQ(source->report().rejected.at("position in metres of an unknown projection"), 1u);
  EXPECT_THROW(open_xtf(in_memory(test::xtf_header()), {}), Error);
  EXPECT_FALSE(looks_like_xtf(bytes_of("{\"json\": 1}" + std::string(2000, ' '))));
}

TEST(Xtf, SurvivesRandomDamage) {
  const std::string good = small_log() + R2SonicPing{.s = 0.75}.bytes();
  Random random(3);
  for (int round = 0; round < 2000; ++round) {
    std::string bad = good;
    for (int i = 0; i < 4; ++i) bad[1024 + random.index(bad.size() - 1024)] = static_cast<char>(random.bits());
    const auto source = open_xtf(in_memory(bad), {});
    for (const Event& e : drain(*source)) {
      const auto* s = std::get_if<Swath>(&e);
      ASSERT_TRUE(!s || check(*s) == SwathFault::kNone);
    }
    ASSERT_LE(source->report().bytes_skipped, bad.size());
  }
}

TEST(XtfLine, OfSanFranciscoBayIsReadToItsEnd) {
  ISOBATH_NEEDS_DATA(file, kLine);
  const auto source = open_xtf(ByteWindow::open(file), {});
  std::size_t swaths = 0, fixes = 0;
  while (const auto event = source->next()) {
    const auto* s = std::get_if<Swath>(&*event);
    if (!s) {
      ++fixes;
      continue;
    }
    ++swaths;
    ASSERT_EQ(s->soundings.size(), 256u);
    for (const Sounding& p : s->soundings) {
      ASSERT_GT(p.range_m, 10.1F);
      ASSERT_LT(p.range_m, 24.3F);
    }
    EXPECT_NEAR(s->sound_speed, 1515, 1);
  }
  EXPECT_EQ(swaths, 923u);
  EXPECT_EQ(fixes, 923u + 1204u);
  EXPECT_EQ(source->report().bytes_skipped, 0u);
  EXPECT_TRUE(source->report().rejected.empty());
  EXPECT_NEAR(source->report().origin->latitude_deg, 37.757, 1e-3);
}

struct Bottom {
  double tilt_deg, depth;  ///< athwart; below the body
};

/// A straight bottom by least squares through the points within `reach` metres to either side.
Bottom bottom_of(const Swath& swath, Angle roll, Angle pitch, double reach) {
  const Rotation R = Rotation::from_heading_pitch_roll({}, pitch, roll);
  double n = 0, y = 0, z = 0, yy = 0, yz = 0;
  for (const Sounding& s : swath.soundings) {
    const Eigen::Vector3d p = R * s.point.cast<double>();
    if (std::abs(p.y()) > reach) continue;
    n += 1, y += p.y(), z += p.z(), yy += p.y() * p.y(), yz += p.y() * p.z();
  }
  const double slope = (n * yz - y * z) / (n * yy - y * y);
  return {Angle::radians(std::atan(slope)).degrees(), (z - slope * y) / n};
}

double deviation(const std::vector<double>& values) {
  double sum = 0, squares = 0;
  for (const double v : values) sum += v, squares += v * v;
  const double n = static_cast<double>(values.size());
  return std::sqrt(squares / n - sum * sum / n / n);
}

// The public description of the attitude packet, held against the sea: a bottom does not rock with the boat.
TEST(XtfLine, RecordedRollAndHeaveMakeTheBottomStandStill) {
  ISOBATH_NEEDS_DATA(file, kLine);
  const auto source = open_xtf(ByteWindow::open(file), {});
  std::vector<double> level, raw, opposite, depth, heave;
  Navigation last;
  while (const auto event = source->next()) {
    if (const auto* fix = std::get_if<Navigation>(&*event)) last = *fix;
    const auto* s = std::get_if<Swath>(&*event);
    if (!s) continue;
    ASSERT_EQ(s->time, last.time);
    const Angle roll = last.X_WB.rotation.roll(), pitch = last.X_WB.rotation.pitch();
    level.push_back(bottom_of(*s, roll, pitch, 100).tilt_deg);
    raw.push_back(bottom_of(*s, {}, {}, 100).tilt_deg);
    opposite.push_back(bottom_of(*s, -roll, pitch, 100).tilt_deg);
    depth.push_back(bottom_of(*s, roll, pitch, 3).depth);
    heave.push_back(last.X_WB.translation.z());
  }
  EXPECT_LT(deviation(level), 0.2);
  EXPECT_GT(deviation(raw), 1.5);
  EXPECT_GT(deviation(opposite), 3.0) << "the sign of roll";
  // Heave shows in how the depth below the head changes within half a second, when the bottom has hardly changed.
  const auto change = [&](double share_of_heave) {
    std::vector<double> changes;
    for (std::size_t i = 10; i < depth.size(); ++i) {
      changes.push_back(depth[i] - depth[i - 10] + share_of_heave * (heave[i] - heave[i - 10]));
    }
    return deviation(changes);
  };
  EXPECT_LT(change(1), 0.9 * change(0));
  EXPECT_GT(change(-1), 1.2 * change(0)) << "the sign of heave";
}

}  // namespace
}  // namespace isobath
