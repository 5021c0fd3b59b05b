// Water against published numbers: absorption, speed of sound, profiles.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/sim/water.hpp>

namespace isobath {
namespace {

constexpr AbsorptionLaw kBoth[] = {AbsorptionLaw::kFrancoisGarrison, AbsorptionLaw::kAinslieMcColm};

double db_per_km(AbsorptionLaw law, double khz, double celsius, double psu, double depth) {
  return 1000 * absorption_db(law, 1000 * khz, celsius, psu, depth, 8);
}

// Pinkerton 1949 (Proc. Phys. Soc. B 62, 129) measured alpha / f^2 of pure water, in 1e-15 Np s2/m; 1 Np is 8.686 dB.
TEST(Absorption, OfFreshWaterIsWhatPinkertonMeasured) {
  struct Row {
    double celsius, measured;
  };
  for (const Row& row : {Row{0, 56.9}, Row{5, 44.1}, Row{10, 36.1}, Row{15, 29.6}, Row{20, 25.3}, Row{30, 19.1}}) {
    for (const double khz : {200.0, 700.0, 1200.0}) {
      const double expected = row.measured * 1e-15 * 8.686 * khz * khz * 1e6 * 1000;
      EXPECT_NEAR(db_per_km(AbsorptionLaw::kFrancoisGarrison, khz, row.celsius, 0, 0) / expected, 1, 0.015)
          << row.celsius;
      EXPECT_NEAR(db_per_km(AbsorptionLaw::kAinslieMcColm, khz, row.celsius, 0, 0) / expected, 1, 0.10) << row.celsius;
    }
  }
}

// What echo sounders of fisheries are set to at 10 degrees C, 35 psu, 250 m (Simrad EK60, after the 1982 equations).
TEST(Absorption, OfTheSeaIsWhatFisheriesEchoSoundersAreSetTo) {
  struct Row {
    double khz, expected;
  };
  for (const Row& row : {Row{38, 9.785}, Row{120, 37.39}, Row{200, 52.69}}) {
    EXPECT_NEAR(db_per_km(AbsorptionLaw::kFrancoisGarrison, row.khz, 10, 35, 250) / row.expected, 1, 0.01) << row.khz;
    EXPECT_NEAR(db_per_km(AbsorptionLaw::kAinslieMcColm, row.khz, 10, 35, 250) / row.expected, 1, 0.10) << row.khz;
  }
}

// Each salt alone, where its term can be read off: boric acid far below, magnesium sulphate near its relaxation.
TEST(Absorption, RelaxesWhereBothPapersSay) {
  for (const AbsorptionLaw law : kBoth) {
    // Excess over fresh water a wavelength peaks at the relaxation of magnesium sulphate: 8.17e8 10^(-1990 / T) kHz.
    double peak_khz = 0, peak = 0;
    for (double khz = 20; khz < 400; khz *= 1.01) {
      const double a_wave = (db_per_km(law, khz, 10, 35, 0) - db_per_km(law, khz, 10, 0, 0)) / khz;
      if (a_wave > peak) {
        peak = a_wave;
        peak_khz = khz;
      }
    }
    EXPECT_NEAR(peak_khz, 8.17 * std::pow(10, 8 - 1990 / 283.0), 8);
  }
}

// Ainslie and McColm 1998 promise 10 % between 100 Hz and 1 MHz.
TEST(Absorption, BothLawsAgreeWithinTenPercent) {
  for (const double psu : {0.0, 35.0}) {
    for (double celsius = 0; celsius <= 25; celsius += 5) {
      for (const double depth : {0.0, 100.0, 1000.0}) {
        for (double khz = 10; khz <= 1000; khz *= 1.2) {
          const double ratio =
              db_per_km(kBoth[1], khz, celsius, psu, depth) / db_per_km(kBoth[0], khz, celsius, psu, depth);
          EXPECT_NEAR(ratio, 1, 0.10) << khz << " kHz, " << celsius << " C, " << psu << " psu, " << depth << " m";
        }
      }
    }
  }
}

TEST(Absorption, CanBeSwitchedOffAndFollowsTheWatersSettings) {
  WaterConfig config;
  config.absorption = AbsorptionLaw::kNone;
  EXPECT_EQ(Water(config).absorption_db(700e3, 10), 0);
  config.absorption = AbsorptionLaw::kFrancoisGarrison;
  config.temperature_c = 10;
  config.salinity_psu = 35;
  config.ph = 7.8;
  EXPECT_EQ(Water(config).absorption_db(1e5, 30), absorption_db(config.absorption, 1e5, 10, 35, 30, 7.8));
}

// Chen and Millero 1977, as tabled in UNESCO Technical Paper in Marine Science 44 (1983), p. 49, at the surface.
TEST(SoundSpeed, OfMedwinIsThatOfUnescosTable) {
  struct Row {
    double psu, celsius, speed, within;
  };
  const Row rows[] = {{25, 0, 1435.8, 0.25},  {25, 10, 1477.7, 0.25}, {25, 20, 1510.3, 0.25}, {25, 30, 1535.2, 0.25},
                      {35, 0, 1449.1, 0.25},  {35, 10, 1489.8, 0.25}, {35, 20, 1521.5, 0.25}, {35, 30, 1545.6, 0.25},
                      {40, 10, 1495.9, 0.35}, {40, 30, 1550.8, 0.35},  // and fresh water, by the same equation:
                      {0, 0, 1402.4, 0.85},   {0, 10, 1447.3, 0.85},  {0, 15, 1465.9, 0.85},  {0, 20, 1482.3, 0.85}};
  for (const Row& row : rows) {
    EXPECT_NEAR(medwin_sound_speed(row.celsius, row.psu, 0), row.speed, row.within) << row.psu << " " << row.celsius;
  }
  // 1 m of sea is 1.01 dbar: Chen and Millero at 35 psu, 10 degrees C, 1000 dbar.
  EXPECT_NEAR(medwin_sound_speed(10, 35, 1000 / 1.01), 1506.3, 0.5);
}

TEST(SoundSpeed, OfAProfileIsLinearBetweenRowsAndConstantBeyond) {
  WaterConfig config;
  config.sound_speed = {5, 1480, 15, 1500, 20, 1490};
  const Water water(config);
  EXPECT_DOUBLE_EQ(water.sound_speed(0), 1480);
  EXPECT_DOUBLE_EQ(water.sound_speed(5), 1480);
  EXPECT_DOUBLE_EQ(water.sound_speed(10), 1490);
  EXPECT_DOUBLE_EQ(water.sound_speed(17.5), 1495);
  EXPECT_DOUBLE_EQ(water.sound_speed(99), 1490);
}

// Through a constant gradient g from c0 the travel time is ln(c1 / c0) / g.
TEST(SoundSpeed, MeanOverAGradientIsThatOfTheClosedForm) {
  WaterConfig config;
  config.sound_speed = {0, 1440, 100, 1540};
  const Water water(config);
  EXPECT_NEAR(water.mean_sound_speed(0, 100), 100 / std::log(1540.0 / 1440.0), 1e-3);
  EXPECT_NEAR(water.mean_sound_speed(80, 20), 60 / std::log(1520.0 / 1460.0), 1e-3);
  EXPECT_DOUBLE_EQ(water.mean_sound_speed(30, 30), 1470);
}

// Two layers with a jump: the time is the sum over both, whatever the depth of the jump.
TEST(SoundSpeed, MeanOverAThermoclineIsThatOfItsLayers) {
  WaterConfig config;
  config.sound_speed = {0, 1500, 30, 1500, 31, 1450, 100, 1450};
  const Water water(config);
  const double time = 30 / 1500.0 + std::log(1500.0 / 1450.0) / 50 + 69 / 1450.0;
  EXPECT_NEAR(water.mean_sound_speed(0, 100), 100 / time, 1e-3);
}

TEST(Current, IsLinearBetweenRowsAndHorizontal) {
  EXPECT_EQ(Water(WaterConfig{}).current(5), Eigen::Vector3d::Zero());
  WaterConfig config;
  config.current = {0, 0.4, -0.2, 10, 0, 0.2};
  const Water water(config);
  EXPECT_TRUE(water.current(-1).isApprox(Eigen::Vector3d(0.4, -0.2, 0)));
  EXPECT_TRUE(water.current(5).isApprox(Eigen::Vector3d(0.2, 0, 0)));
  EXPECT_TRUE(water.current(50).isApprox(Eigen::Vector3d(0, 0.2, 0)));
}

// Pure water at 4 and 25 degrees C; sea water of 35 psu at 15 degrees C (UNESCO 1981: 1025.97 kg/m3).
TEST(Density, FollowsTemperatureAndSalinityUnlessStated) {
  const auto density = [](double celsius, double psu, double stated) {
    WaterConfig config;
    config.temperature_c = celsius;
    config.salinity_psu = psu;
    config.density = stated;
    return Water(config).density();
  };
  EXPECT_NEAR(density(4, 0, 0), 999.97, 0.3);
  EXPECT_NEAR(density(25, 0, 0), 997.05, 0.3);
  EXPECT_NEAR(density(15, 35, 0), 1025.97, 1.0);
  EXPECT_EQ(density(15, 35, 1030), 1030);
}

TEST(Water, RefusesProfilesOutOfOrderAndSpeedsOutOfRange) {
  const auto refusal = [](const WaterConfig& config) -> std::string {
    try {
      (void)Water(config, Place{.file = "a.toml", .line = 3, .column = 1, .key = "water"});
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  WaterConfig same;
  same.sound_speed = {0, 1500, 10, 1490, 10, 1480};
  EXPECT_NE(refusal(same).find("a.toml:3:1: water.sound_speed"), std::string::npos) << refusal(same);
  WaterConfig back;
  back.current = {10, 0, 0, 5, 0, 0};
  EXPECT_NE(refusal(back).find("a.toml:3:1: water.current"), std::string::npos) << refusal(back);
  WaterConfig air;
  air.sound_speed = {0, 340};
  EXPECT_NE(refusal(air).find("water.sound_speed"), std::string::npos) << refusal(air);
  EXPECT_EQ(refusal(WaterConfig{}), "");
}

}  // namespace
}  // namespace isobath
