// Echoes against closed forms: the sonar equation, geometry, Lambert's law, beam patterns, mirrors.
#include <algorithm>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tests/sim/worlds.hpp>

namespace isobath {
namespace {

using namespace test;

constexpr const char* kStill = "[water]\nsound_speed = [[0, 1500]]\nabsorption = \"none\"\n";

std::string sphere(double north, double east, double depth, double radius, const std::string& material = "matt") {
  return fmt::format("[[sphere]]\ncentre = [{}, {}, {}]\nradius = {}\nmaterial = \"{}\"\n", north, east, depth, radius,
                     material);
}
const std::string kMatt = "[[material]]\nname = \"matt\"\nlambert_db = -20\nreflection_db = -80\n";
const std::string kShiny = "[[material]]\nname = \"shiny\"\nlambert_db = -80\nreflection_db = 0\nroughness = 0.05\n";

EchoImage heard(const Tank& tank, const SonarConfig& sonar, const Pose& X_WS) {
  EchoSynthesizer former(sonar, *tank.world, *tank.water);
  EchoImage image;
  former.form(X_WS, image);
  return image;
}

// A Lambert sphere: mu times the integral of cos^2 over the half that is lit, 2 pi a^2 / 3; 40 log r; absorption.
// ledger: S6-02
TEST(EchoPhysics, LevelOfALambertSphereFallsWithRangeAndAbsorptionAsTheSonarEquationSays) {
  for (const double r : {10.0, 20.0, 40.0, 55.0}) {
    const Tank tank("[water]\nsound_speed = [[0, 1500]]\nabsorption = \"francois_garrison\"\ntemperature_c = 10\n" +
                    kMatt + sphere(r, 0, 20, 0.05));
    const double a = absorption_db(AbsorptionLaw::kFrancoisGarrison, 700e3, 10, 0, 20, 8);
    const double expected = -20 + db(2 * std::numbers::pi * 0.05 * 0.05 / 3) - 40 * std::log10(r) - 2 * a * r;
    EXPECT_NEAR(db(total(heard(tank, clean_beam(10, 10), at_depth(20)))), expected, 0.1) << r << " m";
  }
}

// A rigid sphere much larger than the wave sends back a^2 / 4 (Urick 1983, 9.1).
TEST(EchoPhysics, TargetStrengthOfAMirrorSphereIsAQuarterOfItsRadiusSquared) {
  for (const double a : {0.05, 0.2}) {
    const Tank tank(kStill + kShiny + sphere(50, 0, 20, a, "shiny"));
    const double nearest = 50 - a;
    EXPECT_NEAR(db(total(heard(tank, clean_beam(10, 10), at_depth(20)))), db(a * a / 4) - 40 * std::log10(nearest),
                0.1);
  }
}

// A plane mirror sends back what a source behind it would: 1 / (2r)^2.
TEST(EchoPhysics, APlaneMirrorAnswersLikeItsImageSource) {
  const Tank tank(kStill + kShiny + "[bottom]\nkind = \"flat\"\ndepth = 30\nmaterial = \"shiny\"\n");
  SonarConfig sonar = clean_beam(60, 60);
  sonar.bottom_reverberation = true;
  sonar.rays = 128;
  EXPECT_NEAR(db(total(heard(tank, sonar, at_depth(10, 0, -90)))), db(1 / (4 * 20.0 * 20.0)), 0.1);
}

// ledger: S6-02
TEST(EchoPhysics, RangesOfBottomWallSphereAndCylinderAreThoseOfGeometryWithinHalfABin) {
  SonarConfig sonar = clean_beam(0.5, 0.5);
  sonar.bottom_reverberation = true;
  const double bin = sonar.range_m / sonar.bins;
  const auto range = [&](const Tank& tank, const Pose& X_WS) { return mean_range(heard(tank, sonar, X_WS), bin); };
  const Tank bottom(kStill + std::string("[bottom]\nkind = \"flat\"\ndepth = 12\n"));
  for (const double down : {90.0, 60.0, 35.0}) {
    EXPECT_NEAR(range(bottom, at_depth(2, 0, -down)), 10 / std::sin(down * kDegree), 0.5 * bin + 0.01) << down;
  }
  const Tank wall(kStill + std::string("[[wall]]\nline = [[30, -50], [30, 50]]\ntop = 0\nbottom = 20\n"));
  for (const double aside : {0.0, 20.0, 45.0}) {
    EXPECT_NEAR(range(wall, at_depth(10, aside)), 30 / std::cos(aside * kDegree), 0.5 * bin + 0.01) << aside;
  }
  const Tank ball(kStill + kMatt + sphere(25, 0, 10, 2));
  EXPECT_NEAR(range(ball, at_depth(10)), 23, 0.5 * bin);
  const Tank pole(kStill + std::string("[[cylinder]]\ncentre = [25, 0, 10]\nradius = 1.5\nlength = 10\n"));
  EXPECT_NEAR(range(pole, at_depth(10)), 23.5, 0.5 * bin);
  const double aside = 2;  // degrees: where a ray meets the side of the pole
  const double m = 25 * std::cos(aside * kDegree), off = 25 * std::sin(aside * kDegree);
  EXPECT_NEAR(range(pole, at_depth(10, aside)), m - std::sqrt(1.5 * 1.5 - off * off), 0.5 * bin + 0.02);
}

// Level of a Lambert plane: mu cos(q) W / r^2, r = h / cos(q).
TEST(EchoPhysics, ALambertPlaneFallsWithTheCubeOfTheCosineOfIncidence) {
  const Tank tank(kStill + kMatt + "[bottom]\nkind = \"flat\"\ndepth = 20\nmaterial = \"matt\"\nextent_m = 5000\n");
  SonarConfig sonar = clean_beam(1, 1);
  sonar.bottom_reverberation = true;
  sonar.range_m = 200;
  const double W = kDegree * 2 * std::sin(0.5 * kDegree);
  for (const double incidence : {0.0, 20.0, 40.0, 60.0, 75.0}) {
    const double c = std::cos(incidence * kDegree);
    const double expected = -20 + db(W * c * c * c / 400);
    EXPECT_NEAR(db(total(heard(tank, sonar, at_depth(0, 0, incidence - 90)))), expected, 0.1) << incidence;
  }
}

// ledger: S5-04
TEST(EchoPhysics, TheImageOfAPointIsThreeDecibelsDownAtHalfTheBeamWidth) {
  for (const double width : {0.6, 1.0, 3.0}) {
    for (const PatternKind kind : {PatternKind::kLine, PatternKind::kGaussian}) {
      SonarConfig sonar = clean_beam(width, 20);
      sonar.pattern = kind;
      double axis = 0, edge = 0;
      for (const double off : {0.0, width / 2}) {
        const Tank tank(kStill + kMatt + sphere(40 * std::cos(off * kDegree), 40 * std::sin(off * kDegree), 20, 0.02));
        (off > 0 ? edge : axis) = total(heard(tank, sonar, at_depth(20)));
      }
      EXPECT_NEAR(db(edge / axis), db(0.5), 0.1) << width;
    }
  }
}

/// The highest gain beyond the main lobe.
double first_side_lobe(const BeamPattern& pattern) {
  double previous = 1;
  bool rising = false;
  for (double a = 0; a < 1.5; a += 1e-5) {
    const double gain = pattern.gain(a);
    if (rising && gain < previous) return previous;
    rising = gain > previous;
    previous = gain;
  }
  return 0;
}

TEST(EchoPhysics, TheFirstSideLobeIsAsFarDownAsAskedFor) {
  for (const double level : {13.3, 20.0, 30.0}) {
    const BeamPattern pattern(PatternKind::kLine, Angle::degrees(2), level);
    EXPECT_NEAR(-db(first_side_lobe(pattern)), level, 0.2);
    EXPECT_NEAR(pattern.gain(1 * kDegree), 0.5, 0.002);
  }
}

// A circular piston: 17.57 dB one way, for a transducer that transmits and receives twice that.
TEST(EchoPhysics, ThePistonsFirstSideLobeIsThatOfTheTables) {
  const BeamPattern pattern(PatternKind::kPiston, Angle::degrees(10), 25);
  EXPECT_NEAR(-db(first_side_lobe(pattern)), 2 * 17.57, 0.1);
  EXPECT_NEAR(pattern.gain(5 * kDegree), 0.5, 0.002);
  EXPECT_LT(db(pattern.gain(90 * kDegree)), -60) << "the surface straight above";
}

// By way of the surface: there over it and straight back, or both ways over it.
TEST(EchoPhysics, SurfaceBouncesArriveAtTheRangesOfTheMirrorImage) {
  const double sonar_z = 5, target_z = 8, away = 30;
  const Tank tank(kStill + kMatt + sphere(away, 0, target_z, 0.1));
  SonarConfig sonar = clean_beam(10, 90);
  sonar.surface_bounce = true;
  sonar.rays = 32;
  const EchoImage image = heard(tank, sonar, at_depth(sonar_z));
  const double direct = std::hypot(away, target_z - sonar_z), image_path = std::hypot(away, target_z + sonar_z);
  const double bin = sonar.range_m / sonar.bins;
  for (const double r : {direct, 0.5 * (direct + image_path), image_path}) {
    double near = 0;
    for (int k = 0; k < image.bins; ++k) {
      if (std::abs((k + 0.5) * bin - (r - 0.1)) < 1.5 * bin)
        near += static_cast<double>(image.steady[static_cast<std::size_t>(k)]);
    }
    EXPECT_GT(near, 0) << r;
  }
  const auto label_at = [&](double r) { return image.labels[static_cast<std::size_t>((r - 0.1) / bin + 0.5)]; };
  EXPECT_EQ(label_at(image_path).path(), EchoPath::kSurfaceBounce);
  EXPECT_EQ(label_at(image_path).target(), kFirstBody);
}

// A wall over a bottom: the corner's echo by way of the bottom.
TEST(EchoPhysics, BottomBouncesOfAWallArriveAtTheRangesOfTheMirrorImage) {
  const Tank tank(kStill + std::string("[bottom]\nkind = \"flat\"\ndepth = 10\nmaterial = \"rock\"\n"
                                       "[[wall]]\nline = [[20, -10], [20, 10]]\ntop = 4\nbottom = 4.2\n"));
  SonarConfig sonar = clean_beam(10, 90);
  sonar.bottom_bounce = true;
  sonar.rays = 64;
  const EchoImage image = heard(tank, sonar, at_depth(5));
  const double direct = std::hypot(20, 0.9), mirrored = std::hypot(20, 15 - 4.1);
  const double bin = sonar.range_m / sonar.bins;
  std::vector<double> ranges;
  for (int k = 0; k < image.bins; ++k) {
    if (image.labels[static_cast<std::size_t>(k)].path() == EchoPath::kBottomBounce) ranges.push_back((k + 0.5) * bin);
  }
  const auto heard_near = [&](double r) {
    return std::any_of(ranges.begin(), ranges.end(), [&](double q) { return std::abs(q - r) < 2 * bin; });
  };
  EXPECT_TRUE(heard_near(mirrored));
  EXPECT_TRUE(heard_near(0.5 * (direct + mirrored)));
}

// By the image law the second return of a plane has R^2 H^2 / 4 of the power of the first.
// ledger: S6-64
TEST(EchoPhysics, AWallMetSquareOnReturnsAgainAtTwiceItsRange) {
  const Tank tank(kStill + kShiny + "[bottom]\nkind = \"flat\"\ndepth = 20\nmaterial = \"shiny\"\n");
  SonarConfig sonar = clean_beam(0.5, 60);
  sonar.beams = 121;
  sonar.sector = Angle::degrees(60);
  sonar.rays = 128;
  sonar.bottom_reverberation = sonar.multiple = true;
  sonar.head_reflection_db = -10;
  const EchoImage image = heard(tank, sonar, at_depth(5, 0, -90));
  double first = 0, second = 0;
  const int bin_of_wall = static_cast<int>(15 / 0.1), bin_of_multiple = static_cast<int>(30 / 0.1);
  for (int b = 0; b < image.beams; ++b) {
    for (int k = 0; k < 20; ++k) {
      first += static_cast<double>(image.rough[static_cast<std::size_t>(b * image.bins + bin_of_wall + k)]);
      second += static_cast<double>(image.rough[static_cast<std::size_t>(b * image.bins + bin_of_multiple + k)]);
    }
  }
  EXPECT_NEAR(db(second / first), db(0.25) - 10, 0.2);
}

TEST(EchoPhysics, AGrazedBottomLeavesNoGapsBetweenRays) {
  const Tank tank(kStill + std::string("[bottom]\nkind = \"flat\"\ndepth = 8\n"));
  SonarConfig sonar = clean_beam(3, 35);
  sonar.bottom_reverberation = true;
  sonar.height_pattern = PatternKind::kLine;
  const EchoImage image = heard(tank, sonar, at_depth(1));
  const double bin = sonar.range_m / sonar.bins;
  for (int k = static_cast<int>(25 / bin); k < static_cast<int>(55 / bin); ++k) {
    EXPECT_GT(image.rough[static_cast<std::size_t>(k)], 0) << (k + 0.5) * bin << " m";
  }
}

// ledger: S5-05
TEST(EchoPhysics, AStaveHearsSevenDegreesOffItsPlaneAsWellAsInItAndNothingBeyond) {
  SonarConfig sonar = sonar_preset("p450_horizontal");
  sonar.noise = BackgroundLaw::kNone;
  sonar.surface_bounce = sonar.bottom_bounce = sonar.surface_reverberation = sonar.volume_reverberation = false;
  const auto level = [&](double off) {
    const Tank tank(kStill + kMatt + sphere(40 * std::cos(off * kDegree), 0, 50 + 40 * std::sin(off * kDegree), 0.05));
    return total(heard(tank, sonar, at_depth(50)));
  };
  EXPECT_NEAR(db(level(7.4) / level(0)), 0, 0.1);
  EXPECT_NEAR(db(level(-7.4) / level(0)), 0, 0.1);
  EXPECT_EQ(level(7.6), 0);
}

// ledger: S5-03 S5-08
TEST(EchoPhysics, StavesSeeTheSectorsStated) {
  SonarConfig vertical = sonar_preset("p450_vertical");
  vertical.noise = BackgroundLaw::kNone;
  vertical.surface_bounce = vertical.bottom_bounce = vertical.surface_reverberation = vertical.volume_reverberation =
      false;
  const auto peak = [&](double up) {
    const Tank tank(kStill + kMatt + sphere(40 * std::cos(up * kDegree), 0, 50 - 40 * std::sin(up * kDegree), 0.05));
    const EchoImage image = heard(tank, vertical, at_depth(50) * sensor_pose(vertical));
    double best = 0;
    for (const float p : image.steady) best = std::max(best, static_cast<double>(p));
    return best;
  };
  EXPECT_GT(db(peak(17.5) / peak(0)), -1);
  EXPECT_LT(db(peak(19.5) / peak(0)), -10);
  EXPECT_GT(db(peak(-27.5) / peak(0)), -1);
  EXPECT_LT(db(peak(-29.5) / peak(0)), -10);
}

// Swept through the horizontal field, in steps of 3 degrees from port to starboard. ledger: S5-03
TEST(EchoPhysics, TheHorizontalStavesSeeNinetyDegrees) {
  SonarConfig flat = sonar_preset("p450_horizontal");
  flat.noise = BackgroundLaw::kNone;
  flat.surface_bounce = flat.bottom_bounce = flat.surface_reverberation = flat.volume_reverberation = false;
  const auto peak = [&](double to_starboard) {
    const Tank tank(kStill + kMatt +
                    sphere(40 * std::cos(to_starboard * kDegree), 40 * std::sin(to_starboard * kDegree), 50, 0.05));
    const EchoImage image = heard(tank, flat, at_depth(50) * sensor_pose(flat));
    double best = 0;
    for (const float p : image.steady) best = std::max(best, static_cast<double>(p));
    return best;
  };
  const double ahead = peak(0);
  for (double at = -49.5; at < 50; at += 3) {
    if (std::abs(at) < 45) {
      EXPECT_GT(db(peak(at) / ahead), -1) << at;
    } else if (std::abs(at) > 46) {
      EXPECT_LT(db(std::max(peak(at), 1e-30) / ahead), -10) << at;
    }
  }
}

// ledger: S5-04
TEST(EchoPhysics, TwoTargetsAreApartByTwentyCentimetresInRangeAndNotByHalfADegreeInBearing) {
  SonarConfig sonar = sonar_preset("p450_horizontal");
  sonar.noise = BackgroundLaw::kNone;
  sonar.surface_bounce = sonar.bottom_bounce = sonar.surface_reverberation = sonar.volume_reverberation = false;
  const auto row = [](const EchoImage& image, int beam, int bin) {
    return image.steady[static_cast<std::size_t>(beam * image.bins + bin)];
  };
  const Tank behind(kStill + kMatt + sphere(30, 0, 50, 0.01) + sphere(30.2, 0.05, 50, 0.01));
  const EchoImage a = heard(behind, sonar, at_depth(50));
  const int near = static_cast<int>(29.99 / 0.1), far = static_cast<int>(30.19 / 0.1);
  EXPECT_LT(row(a, 90, near + 1), 0.5f * row(a, 90, near));
  EXPECT_LT(row(a, 90, near + 1), 0.5f * row(a, 90, far));
  const Tank beside(kStill + kMatt + sphere(30, 0, 50, 0.01) +
                    sphere(30 * std::cos(0.5 * kDegree), 30 * std::sin(0.5 * kDegree), 50, 0.01));
  const EchoImage b = heard(beside, sonar, at_depth(50));
  for (int beam = 88; beam < 93; ++beam) {  // one hump: no beam between two that are louder
    const auto sum = [&](int i) { return row(b, i, near) + row(b, i, near + 1) + row(b, i, near - 1); };
    EXPECT_FALSE(sum(beam) < 0.7f * sum(beam - 1) && sum(beam) < 0.7f * sum(beam + 1)) << beam;
  }
}

TEST(EchoPhysics, AWrongSoundSpeedScalesEveryRange) {
  const Tank tank("[water]\nsound_speed = [[0, 1450]]\nabsorption = \"none\"\n" + kMatt + sphere(40, 0, 20, 0.1));
  SonarConfig sonar = clean_beam(5, 5);
  sonar.sound_speed = 1500;
  EXPECT_NEAR((strongest_bin(heard(tank, sonar, at_depth(20))) + 0.5) * 0.1, 39.9 * 1500 / 1450, 0.06);
}

TEST(EchoPhysics, WhatStandsBehindIsNotHeard) {
  const Tank tank(kStill + kMatt + "[[box]]\ncentre = [20, 0, 10]\nsize = [1, 20, 20]\nmaterial = \"matt\"\n" +
                  sphere(30, 0, 10, 0.5));
  const EchoImage image = heard(tank, clean_beam(3, 3), at_depth(10));
  EXPECT_LT(strongest_bin(image), 205);
  for (int k = 250; k < 600; ++k)
    EXPECT_EQ(image.rough[static_cast<std::size_t>(k)] + image.steady[static_cast<std::size_t>(k)], 0);
}

TEST(EchoPhysics, MoreThreadsChangeNothing) {
  const Tank tank(kStill + kMatt + "[bottom]\nkind = \"terrain\"\ndepth = 15\n" + sphere(20, 3, 8, 0.3));
  SonarConfig sonar = sonar_preset("didson");
  EchoSynthesizer one(sonar, *tank.world, *tank.water, 1), two(sonar, *tank.world, *tank.water, 2);
  EchoImage a, b;
  one.form(at_depth(5, 3, -20), a);
  two.form(at_depth(5, 3, -20), b);
  EXPECT_EQ(a.rough, b.rough);
  EXPECT_EQ(a.steady, b.steady);
  EXPECT_TRUE(a.labels == b.labels);
}

}  // namespace
}  // namespace isobath
