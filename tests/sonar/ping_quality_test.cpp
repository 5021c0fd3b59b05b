// What a ping says about its sonar: against a plain count, on broken pings, and on recordings of sonars that were well.
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/io/open_source.hpp>
#include <isobath/sonar/echo_detector.hpp>
#include <isobath/sonar/ping_quality.hpp>
#include <tests/support/count_allocations.hpp>
#include <tests/support/data.hpp>
#include <tests/support/echoes.hpp>

namespace isobath::ping_quality_test {
namespace {

constexpr RangeWindow kWindow{0.5, 0.25, 200};

template <class Sample>
Ping noise(int beams, std::uint64_t seed, float full_scale = 255) {
  Random random(seed);
  const auto background = test::rayleigh(0.1 * static_cast<double>(full_scale));
  return test::ping_of<Sample>(
      test::fan_of(beams, Angle::degrees(-0.5 * (beams - 1))), kWindow,
      [&](int, int) { return std::min(background(random), static_cast<double>(full_scale)); }, full_scale);
}

template <class Sample>
void expect_counts(float full_scale) {
  const Ping ping = noise<Sample>(9, 4, full_scale);
  const PingQuality quality = quality_of(ping);
  double all = 0, port = 0, starboard = 0, steps = 0, full = 0, zero = 0;
  for (int b = 0; b < 9; ++b) {
    for (int k = 0; k < kWindow.bins; ++k) {
      const double sample = static_cast<double>(ping.intensity(b, k) / full_scale);
      all += sample;
      if (b < 4) port += sample;
      if (b > 4) starboard += sample;
      if (k > 0) steps += std::abs(sample - static_cast<double>(ping.intensity(b, k - 1) / full_scale));
      full += sample >= 1;
      zero += sample <= 0;
    }
  }
  const double samples = 9 * kWindow.bins;
  EXPECT_NEAR(quality.mean, all / samples, 1e-6);
  EXPECT_NEAR(quality.port.value_or(-1), port / (4 * kWindow.bins), 1e-6);
  EXPECT_NEAR(quality.starboard.value_or(-1), starboard / (4 * kWindow.bins), 1e-6);
  EXPECT_NEAR(quality.roughness, steps / (9 * (kWindow.bins - 1)), 1e-6);
  EXPECT_NEAR(quality.full_scale, full / samples, 1e-12);
  EXPECT_NEAR(quality.silent, zero / samples, 1e-12);
}

TEST(PingQuality, AreWhatAPlainCountGives) {
  expect_counts<std::uint8_t>(255);
  expect_counts<std::uint16_t>(65535);
  expect_counts<float>(1);
}

TEST(PingQuality, OneBeamHasOneSide) {
  const auto of = [](double bearing) {
    return quality_of(
        test::ping_of<std::uint8_t>(test::fan_of(1, Angle::degrees(bearing)), kWindow, [](int, int) { return 50; }));
  };
  EXPECT_TRUE(of(-30).port);
  EXPECT_FALSE(of(-30).starboard);
  EXPECT_TRUE(of(30).starboard);
  EXPECT_FALSE(of(30).port);
  EXPECT_FALSE(of(0).port);
  EXPECT_FALSE(of(0).starboard);
  EXPECT_TRUE(of(200).port) << "bearings run round";
  EXPECT_NEAR(of(30).bearing.degrees(), 30, 1e-9);
}

// One sample that differs by one count, anywhere, is another ping.
TEST(PingQuality, TheDigestSeesEverySample) {
  const Ping ping = noise<std::uint8_t>(5, 1);
  const std::uint64_t digest = quality_of(ping).digest;
  for (int b = 0; b < 5; ++b) {
    for (int k = 0; k < kWindow.bins; k += 7) {
      const Ping other = test::ping_of<std::uint8_t>(ping.fan, kWindow, [&](int beam, int bin) {
        const double old = static_cast<double>(ping.intensity(beam, bin));
        return beam == b && bin == k ? (old < 255 ? old + 1 : old - 1) : old;
      });
      ASSERT_NE(quality_of(other).digest, digest) << b << " " << k;
    }
  }
  EXPECT_EQ(quality_of(noise<std::uint8_t>(5, 1)).digest, digest);
}

TEST(PingQuality, GarbageIsRoughAndWaterIsNot) {
  Random random(2);
  const Ping garbage = test::ping_of<std::uint8_t>(test::fan_of(1, Angle::degrees(10)), {0, 1, 44},
                                                   [&](int, int) { return 255 * random.uniform(); });
  EXPECT_GT(quality_of(garbage).roughness, 0.25);
  EXPECT_LT(quality_of(noise<std::uint8_t>(1, 3)).roughness, 0.1);
}

TEST(PingQuality, AllocateNothing) {
  const Ping ping = noise<std::uint8_t>(64, 3);
  const std::uint64_t before = test::allocations();
  const PingQuality quality = quality_of(ping);
  EXPECT_EQ(test::allocations(), before);
  EXPECT_GT(quality.mean, 0);
}

/// The worst of a recording, and what a watch of it would have seen.
struct Worst {
  int pings = 0, same = 0, low_in_a_row = 0;
  double roughness = 0, full_scale = 0, silent = 0;
};

Worst worst_of(const std::filesystem::path& recording, const std::string& set = "") {
  InputConfig config;
  config.set = set;
  const auto source = open_source(recording, config);
  Worst worst;
  std::optional<std::uint64_t> last;
  double port = 0, starboard = 0;
  int low = 0;
  while (const auto event = source->next()) {
    const auto* ping = std::get_if<Ping>(&*event);
    if (!ping || check(*ping) != PingFault::kNone) continue;
    const PingQuality quality = quality_of(*ping);
    ++worst.pings;
    worst.roughness = std::max(worst.roughness, quality.roughness);
    worst.full_scale = std::max(worst.full_scale, quality.full_scale);
    worst.silent = std::max(worst.silent, quality.silent);
    worst.same += last == quality.digest;
    last = quality.digest;
    if (quality.port) port += 0.1 * (*quality.port - port);
    if (quality.starboard) starboard += 0.1 * (*quality.starboard - starboard);
    const bool bad = (quality.port && starboard > 0.002 && *quality.port < 0.1 * starboard) ||
                     (quality.starboard && port > 0.002 && *quality.starboard < 0.1 * port);
    low = bad ? low + 1 : 0;
    worst.low_in_a_row = std::max(worst.low_in_a_row, low);
  }
  return worst;
}

void expect_well(const Worst& worst, int pings) {
  EXPECT_GE(worst.pings, pings);
  EXPECT_EQ(worst.same, 0) << "frozen";
  EXPECT_LT(worst.roughness, 0.25 / 2) << "garbled";
  EXPECT_LT(worst.full_scale, 0.5 / 2) << "saturated";
  EXPECT_LT(worst.silent, 1) << "deaf";
  EXPECT_LT(worst.low_in_a_row, 10) << "blind on one side";
}

TEST(PingQualityRecordings, OfSonarsThatWereWellRaiseNoFalseAlarm) {
  ISOBATH_NEEDS_DATA(tank, "msis-tank/msis-tank-rev00-20.csv");
  ISOBATH_NEEDS_DATA(arc, "ping360-arc");
  ISOBATH_NEEDS_DATA(oculus, "oculus-m1200/three_pings_8bit.raw");
  ISOBATH_NEEDS_DATA(didson, "didson-hull/background");
  ISOBATH_NEEDS_DATA(targets, "didson-hull/test");
  ISOBATH_NEEDS_DATA(holo, "holo-boat");
  expect_well(worst_of(tank), 4000);
  expect_well(worst_of(arc / "2024-03-13_15-50-16_gain0_messages.txt"), 100);
  expect_well(worst_of(arc / "object_data_demo.csv"), 100);
  expect_well(worst_of(oculus), 3);
  expect_well(worst_of(didson), 80);
  expect_well(worst_of(targets), 8);
  expect_well(worst_of(holo, "noisy"), 100);
  expect_well(worst_of(holo, "clean"), 100);
}

// The nearest echo of each beam that stands out, where it is.
// ledger: S1-44
TEST(NearestEchoes, AreThoseThatStandOutBehindTheBlindZone) {
  EchoDetectorConfig config;
  config.method = DetectionMethod::kGlobal;
  config.global_threshold = 0.25;
  EchoDetector detector(config);
  Random random(6);
  const auto background = test::gaussian(40, 12);
  // Beam 0: an echo at 10 m. 1: noise, with hits. 2: an echo in the blind zone, and one at 20 m. 3: two; 4: none.
  const auto fan = test::fan_of(5, Angle::degrees(-20), Angle::degrees(10));
  Ping ping = test::ping_of<std::uint8_t>(fan, kWindow, [&](int b, int k) {
    const double level = std::clamp(background(random), 0.0, 90.0);
    const double range = kWindow.edge(k);
    const bool echo =
        (b == 0 && range == 10) || (b == 2 && (range == 1 || range == 20)) || (b == 3 && (range == 15 || range == 30));
    return echo ? 220.0 : level;
  });
  ping.blanking_m = 2;
  EchoDecisions decisions;
  detector.detect(ping, decisions);
  int hits = 0;
  for (int k = 0; k < decisions.bins(); ++k) hits += decisions.hit(1, k);
  ASSERT_GT(hits, 0) << "the noise is over the threshold";
  std::vector<Eigen::Vector2d> echoes;
  std::vector<float> silent;
  nearest_echoes(ping, decisions, Rotation(), 6, echoes, silent);
  ASSERT_EQ(echoes.size(), 3u);
  const auto at = [](double range, double bearing_deg) -> Eigen::Vector2d {
    return range * Eigen::Vector2d(std::cos(Angle::degrees(bearing_deg).radians()),
                                   std::sin(Angle::degrees(bearing_deg).radians()));
  };
  EXPECT_NEAR((echoes[0] - at(10, -20)).norm(), 0, 1e-9);
  EXPECT_NEAR((echoes[1] - at(20, 0)).norm(), 0, 1e-9);
  EXPECT_NEAR((echoes[2] - at(15, 10)).norm(), 0, 1e-9);
  ASSERT_EQ(silent.size(), 5u) << "by beam";
  EXPECT_NEAR(silent[0], 10, 1e-5);
  EXPECT_NEAR(silent[2], 20, 1e-5);
  EXPECT_NEAR(silent[3], 15, 1e-5);

  ping.X_BS.rotation = Rotation::from_heading(Angle::degrees(90));
  ping.X_BS.translation = {0.5, 0, 0};
  nearest_echoes(ping, decisions, Rotation(), 6, echoes, silent);
  EXPECT_NEAR((echoes[1] - Eigen::Vector2d(0.5, 20)).norm(), 0, 1e-9) << "a sonar that looks to starboard";
  ping.X_BS.rotation = Rotation::from_heading_pitch_roll({}, Angle::degrees(-60), {});
  nearest_echoes(ping, decisions, Rotation(), 6, echoes, silent);
  EXPECT_TRUE(echoes.empty()) << "that is the bottom";
}

// One bin in 200,000 of Rayleigh noise stands out by six deviations of 200 bins: of 512 beams one every other ping,
// near the vehicle as anywhere, and two pings soon agree. A fan must not have as many as its beams by themselves.
// ledger: S1-44
TEST(NearestEchoes, OfAWideFanOfNoiseAreFarFewerThanOfItsBeams) {
  EchoDecisions everywhere;
  everywhere.reset(512, kWindow.bins);
  for (int b = 0; b < 512; ++b) std::copy_n(everywhere.usable(), everywhere.words(), everywhere.hits(b));
  const Angle step = Angle::degrees(0.25);
  std::vector<Eigen::Vector2d> echoes;
  std::vector<float> silent;
  std::size_t of_the_fan = 0, of_its_beams = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const auto background = test::rayleigh(0.1);
    const Ping fan = test::ping_of<float>(
        test::fan_of(512, -step * 256, step), kWindow, [&](int, int) { return background(random); }, 1);
    nearest_echoes(fan, everywhere, Rotation(), 6, echoes, silent);
    of_the_fan += echoes.size();
    for (int b = 0; b < 512; ++b) {  // each by itself
      const Ping beam = test::ping_of<float>(
          test::fan_of(1, Angle{}), kWindow, [&](int, int k) { return static_cast<double>(fan.intensity(b, k)); }, 1);
      EchoDecisions one;
      one.reset(1, kWindow.bins);
      std::copy_n(one.usable(), one.words(), one.hits(0));
      nearest_echoes(beam, one, Rotation(), 6, echoes, silent);
      of_its_beams += echoes.size();
    }
  }
  EXPECT_GT(of_its_beams, 3u) << "of three million bins of noise";
  EXPECT_GT(of_its_beams, 20u);
  EXPECT_LE(10 * of_the_fan, of_its_beams);
}

// By enumeration of decisions at random: as rare as stated without a target, sure with one of ten bins.
// ledger: S6-14 S4-50
TEST(NearestDenseEcho, IsRareInNoiseAndFindsWhereAWallBegins) {
  Random random(7);
  constexpr int kBeams = 20'000, kBins = 200, kWall = 120;
  EchoDecisions noise, wall;
  for (EchoDecisions* decisions : {&noise, &wall}) {
    decisions->reset(kBeams, kBins);
    std::fill(decisions->p_detect.begin(), decisions->p_detect.end(), 0.8f);
    for (int beam = 0; beam < kBeams; ++beam) {
      for (int bin = 0; bin < kBins; ++bin) {
        const bool target = decisions == &wall && bin >= kWall && bin < kWall + 10;
        if (random.uniform() < (target ? 0.8 : 0.02)) decisions->set_hit(beam, bin);
      }
    }
  }
  int rare = 0, found = 0;
  for (int beam = 0; beam < kBeams; ++beam) {
    rare += nearest_dense_echo(noise, beam).has_value();
    const auto bin = nearest_dense_echo(wall, beam);
    found += bin && *bin >= kWall - 4 && *bin <= kWall + 4;
  }
  EXPECT_LE(rare, kBeams / 1000);
  EXPECT_GE(found, kBeams * 97 / 100);
}

}  // namespace
}  // namespace isobath::ping_quality_test
