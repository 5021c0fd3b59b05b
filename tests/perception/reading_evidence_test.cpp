#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/perception/reading_evidence.hpp>
#include <map>
#include <numbers>
#include <tests/support/count_allocations.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath::reading_evidence_test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Config = ReadingEvidenceConfig;
using Kind = PixelEvidence::Kind;
using Outcome = Evidence::Outcome;

constexpr double kDegree = std::numbers::pi / 180;

RangeReading reading(std::optional<double> range_m, double depression_deg = 0, double width_deg = 6,
                     double azimuth_deg = 0) {
  RangeReading r;
  r.range_m = range_m;
  r.max_range_m = 50;
  r.width = Angle::degrees(width_deg);
  r.X_BS.rotation = Rotation::from_heading_pitch_roll(Angle::degrees(azimuth_deg), Angle::degrees(-depression_deg), {});
  return r;
}

Pose at(const Vector3d& p_WB, double heading_deg = 0, double pitch_deg = 0, double roll_deg = 0) {
  return {Rotation::from_heading_pitch_roll(Angle::degrees(heading_deg), Angle::degrees(pitch_deg),
                                            Angle::degrees(roll_deg)),
          p_WB};
}

int count(const Evidence& e, Kind kind) {
  return static_cast<int>(
      std::count_if(e.pixels.begin(), e.pixels.end(), [kind](const PixelEvidence& p) { return p.kind == kind; }));
}

/// Prediction over a flat bottom, as the evidence sees the beam.
RangePrediction over_flat(const ReadingEvidence& evidence, const RangeReading& r, const Pose& X_WB, float depth_m) {
  RangePredictor predictor({}, evidence.grid());
  const BeamCone cone = *evidence.cone(r, X_WB);
  const PixelWindow window = predictor.window(cone, 50);
  const std::vector<float> depth(static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height),
                                 depth_m);
  predictor.pixels(cone, 50, window);
  return predictor.predict_listed(cone, 50, {window, depth});
}

// ---------------------------------------------------------------- obstacle sonar against brute force

struct Expected {
  double bound;
  Kind kind;
};

/// Every pixel of the plane asked by itself, in the angles of the ledger; none where the answer hangs on rounding.
struct BruteForce {
  Vector3d s;
  double beta, delta, a, range;
  bool echo;
  double pixel;

  bool unsure = false;  ///< of the last answer

  std::optional<Expected> operator()(const Vector2d& north_east) {
    const Vector2d d = north_east - s.head<2>();
    const double h = d.norm();
    const double eta = std::remainder(std::atan2(d.y(), d.x()) - beta, 2 * std::numbers::pi);
    const double edge = std::asin(std::sin(a) / std::cos(delta));
    const double reach = range * std::cos(std::max(0.0, std::abs(delta) - a)) + (echo ? 2 * pixel : 0);
    const double ahead = h * std::cos(eta);
    const double rho = h * std::sqrt(1 + std::pow(std::tan(delta) / std::cos(eta), 2));
    unsure =
        std::abs(std::abs(eta) - edge) * h < 1e-6 || std::abs(ahead - reach) < 1e-6 || std::abs(rho - range) < 1e-4;
    if (std::abs(eta) > edge || ahead > reach) return std::nullopt;
    const double A = std::pow(std::cos(a), 2) - std::pow(std::sin(delta), 2);
    const double D =
        std::pow(std::cos(eta) * std::cos(delta), 2) + std::pow(std::sin(delta), 2) - std::pow(std::cos(a), 2);
    const double middle = std::cos(eta) * std::cos(delta) * std::sin(delta);
    const double spread = std::cos(a) * std::sqrt(std::max(D, 0.0));
    const double z_top = s.z() + h * (middle - spread) / A;
    const double z_bottom = s.z() + h * (middle + spread) / A;
    if (z_bottom < 0) return std::nullopt;
    if (rho < range) {
      const double proved = std::min(z_bottom, s.z() + std::sqrt(range * range - h * h));
      return Expected{proved, Kind::kClear};
    }
    if (!echo) return std::nullopt;
    return Expected{std::max(z_top, 0.0), Kind::kObstructed};
  }
};

// ledger: S1-57 S1-58 S1-59 S1-60 S1-64 S1-65 S1-66
TEST(ReadingEvidence, OfAForwardBeamEqualsBruteForceOverAllPixels) {
  Random random(65);
  Config config;
  config.gate = 0;  // nothing is explained: this is about geometry
  for (int i = 0; i < 25; ++i) {
    const PixelGrid grid{{random.uniform(-3, 3), random.uniform(-3, 3)}, random.uniform(0.3, 1.2)};
    ReadingEvidence evidence(config, grid);
    const Vector3d p(random.uniform(-40, 40), random.uniform(-40, 40), random.uniform(0, 12));
    const Pose X_WB = at(p, random.uniform(0, 360), random.uniform(-15, 15), random.uniform(-20, 20));
    const bool echo = i % 5 != 0;
    const double range = echo ? random.uniform(2, 50) : 50;
    const RangeReading r = reading(echo ? std::optional(range) : std::nullopt, random.uniform(-25, 25),
                                   random.uniform(1, 24), random.uniform(-60, 60));
    const BeamCone cone = *evidence.cone(r, X_WB);
    BruteForce truth{p,
                     std::atan2(cone.heading().y(), cone.heading().x()),
                     cone.depression().radians(),
                     r.width.radians() / 2,
                     range,
                     echo,
                     grid.pixel_m};
    const Evidence found = evidence.add_reading(r, X_WB);
    ASSERT_EQ(found.outcome, echo ? Outcome::kEcho : Outcome::kNoEcho);
    std::map<std::pair<int, int>, PixelEvidence> by_pixel;
    for (const PixelEvidence& e : found.pixels) ASSERT_TRUE(by_pixel.insert({{e.column, e.row}, e}).second);
    const Pixel home = grid.at(p.head<2>());
    const int radius = static_cast<int>(60 / grid.pixel_m);
    std::size_t seen = 0;
    for (int row = home.row - radius; row <= home.row + radius; ++row) {
      for (int column = home.column - radius; column <= home.column + radius; ++column) {
        const auto one = by_pixel.find({column, row});
        seen += one != by_pixel.end();
        const auto expected = truth(grid.centre({column, row}));
        if (truth.unsure) continue;
        ASSERT_EQ(one != by_pixel.end(), expected.has_value()) << i << ": " << column << " " << row;
        if (!expected) continue;
        ASSERT_EQ(one->second.kind, expected->kind);
        const double h2 = (grid.centre({column, row}) - p.head<2>()).squaredNorm();
        ASSERT_NEAR(one->second.bound_m, expected->bound, std::abs(range * range - h2) < 1 ? 1e-3 : 1e-4);
      }
    }
    ASSERT_EQ(seen, found.pixels.size());
  }
}

// ledger: S1-65
TEST(ReadingEvidence, OfAConeAboutTheVerticalEqualsTheConeColumnByColumn) {
  const PixelGrid grid;
  Config config;
  config.depth_within = Angle::degrees(10);
  config.gate = 0;
  ReadingEvidence evidence(config, grid);
  const Pose X_WB = at({0.3, 0.2, 4});
  const RangeReading r = reading(15, 60, 80);
  const BeamCone cone = *evidence.cone(r, X_WB);
  ASSERT_TRUE(cone.contains_vertical());
  const Evidence found = evidence.add_reading(r, X_WB);
  // A clear bound is the deepest point of the column that is in the cone and nearer than the echo: by sampling.
  int behind = 0;
  for (const PixelEvidence& e : found.pixels) {
    if (e.kind != Kind::kClear) continue;
    const Vector2d centre = grid.centre({e.column, e.row});
    double deepest = -1;
    for (double z = 0; z < 25; z += 0.01) {
      const Vector3d p(centre.x(), centre.y(), z);
      const Vector3d d = p - cone.apex();
      if (cone.axis().dot(d) >= cone.cos_half_angle() * d.norm() && d.norm() < 15) deepest = z;
    }
    ASSERT_NEAR(e.bound_m, deepest, 0.011);
    behind += centre.x() < 0.3;
  }
  EXPECT_GT(behind, 100);
  EXPECT_GT(count(found, Kind::kObstructed), 100);
}

// A noise-free first echo of a slope of any inclination: what is called clear must be water, in any geometry of flight.
// ledger: S1-62 S1-65
TEST(ReadingEvidence, ClearEvidenceOfAnExactRangeNeverContradictsTheTruth) {
  Random random(62);
  const PixelGrid grid;
  ReadingEvidence evidence({}, grid);
  int echoes = 0;
  int planes_wrong = 0;
  Config printed;
  printed.geometry = Config::Geometry::kPlanes;
  ReadingEvidence planes(printed, grid);
  for (int i = 0; i < 300; ++i) {
    const Pose X_WB = at({0, 0, 6}, random.uniform(0, 360), random.uniform(-15, 15), random.uniform(-15, 15));
    RangeReading r = reading(std::nullopt, random.uniform(-5, 40), random.uniform(2, 20));
    const BeamCone cone = *evidence.cone(r, X_WB);
    const Vector3d up = Vector3d(random.normal() * 0.1, random.normal() * 0.1, -1).normalized();
    const double below = random.uniform(3, 20);
    // The plane up . (p - s) = -below |up_z|; nearest direction of the cone in closed form.
    const double off_axis = std::acos(std::clamp(-up.dot(cone.axis()), -1.0, 1.0));
    const double nearest = std::max(0.0, off_axis - cone.half_angle().radians());
    const double range = std::cos(nearest) > 0 ? -below * up.z() / std::cos(nearest) : 1e9;
    const double surface = cone.range_to_level(0).value_or(1e9);
    if (range > 49 || surface < range) continue;
    ++echoes;
    r.range_m = range;
    const auto floor_at = [&](const PixelEvidence& e) {
      const Vector2d d = grid.centre({e.column, e.row});
      return 6 + below - (up.x() * d.x() + up.y() * d.y()) / up.z();
    };
    for (const PixelEvidence& e : evidence.add_reading(r, X_WB).pixels) {
      if (e.kind == Kind::kClear) {
        ASSERT_LE(e.bound_m, floor_at(e) + 2e-3) << i;
      }
    }
    const Evidence wrong = planes.add_reading(r, X_WB);
    planes_wrong += std::any_of(wrong.pixels.begin(), wrong.pixels.end(), [&](const PixelEvidence& e) {
      return e.kind == Kind::kClear && e.bound_m > floor_at(e) + 0.5;
    });
  }
  EXPECT_GT(echoes, 100);
  EXPECT_GT(planes_wrong, 20);  // what the exact cone is for
}

/// How many pixels have their centres in a triangle, each asked by itself; between the two where a centre is so near to
/// the border that rounding decides.
struct InTriangle {
  int least = 0, most = 0;

  InTriangle(const PixelGrid& grid, const Vector2d& apex, double heading, double half_angle, double reach_m) {
    const Vector2d along(std::cos(heading), std::sin(heading)), across(-along.y(), along.x());
    const double far = reach_m / std::cos(half_angle);
    const auto first = grid.at(apex + Vector2d(far, -far)), last = grid.at(apex + Vector2d(-far, far));
    for (auto row = first.row; row <= last.row; ++row) {
      for (auto column = first.column; column <= last.column; ++column) {
        const Vector2d d = grid.centre({column, row}) - apex;
        const double x = along.dot(d), y = std::abs(across.dot(d));
        const double inside_m = std::min(reach_m - x, x * std::sin(half_angle) - y * std::cos(half_angle));
        least += inside_m > kRounding_m ? 1 : 0;
        most += inside_m > -kRounding_m ? 1 : 0;
      }
    }
  }
  static constexpr double kRounding_m = 1e-4;
};

// ledger: S1-57
TEST(ReadingEvidence, CountsThePixelsOfTheLedger) {
  ISOBATH_NOT_SANITIZED();
  const PixelGrid grid;
  ReadingEvidence evidence({}, grid);
  Random random(545);
  for (const auto& [range, pixels] : {std::tuple(50.0, 545), std::tuple(10.0, 25)}) {
    double sum = 0;
    for (int i = 0; i < 2000; ++i) {
      const double north = random.uniform(-1, 1);  // one draw a line: the order of arguments is the compiler's
      const double east = random.uniform(-1, 1);
      RangeReading r = reading(range);
      r.max_range_m = 60;
      if (range == 50.0) r.range_m = 49.999;
      const double heading_deg = random.uniform(0, 360);
      const auto n = static_cast<int>(evidence.add_reading(r, at({north, east, 10}, heading_deg)).pixels.size());
      sum += n;
      if (i % 20 != 0) continue;  // asking every pixel takes long
      const InTriangle triangle(grid, {north, east}, heading_deg * kDegree, 3 * kDegree, *r.range_m + 2 * grid.pixel_m);
      ASSERT_GE(n, triangle.least) << i;
      ASSERT_LE(n, triangle.most) << i;
    }
    EXPECT_NEAR(sum / 2000, pixels, 0.02 * pixels);
  }
}

// ledger: S1-58
TEST(ReadingEvidence, IsExtendedByTwoPixelsSoThatPartOfTheObstacleIsIn) {
  const PixelGrid grid;
  const Pose X_WB = at({0.2, 0.1, 10}, 25);
  const auto farthest = [&](double extension_px) {
    Config config;
    config.extension_px = extension_px;
    ReadingEvidence evidence(config, grid);
    double far = 0;
    for (const PixelEvidence& e : evidence.add_reading(reading(30), X_WB).pixels) {
      const double h = (grid.centre({e.column, e.row}) - X_WB.translation.head<2>()).norm();
      if (e.kind == Kind::kObstructed) {
        EXPECT_GE(h, 30);
      }
      if (e.kind == Kind::kClear) {
        EXPECT_LT(h, 30);
      }
      far = std::max(far, h);
    }
    return far;
  };
  EXPECT_NEAR(farthest(2), 31, 0.25);
  EXPECT_LT(farthest(0), 30 + 0.05);
}

// ledger: S1-60
TEST(ReadingEvidence, JudgesBySlantRangeNotByDistanceInThePlan) {
  const PixelGrid grid;
  for (const auto geometry : {Config::Geometry::kExact, Config::Geometry::kPlanes}) {
    Config config;
    config.geometry = geometry;
    ReadingEvidence evidence(config, grid);
    const double range = 30;
    int between = 0;
    for (const PixelEvidence& e : evidence.add_reading(reading(range, 20), at({0, 0, 3})).pixels) {
      const Vector2d centre = grid.centre({e.column, e.row});
      if (std::abs(centre.y()) > 0.5) continue;
      const bool beyond = centre.norm() / std::cos(20 * kDegree) > range;
      EXPECT_EQ(e.kind, beyond ? Kind::kObstructed : Kind::kClear);
      between += beyond && centre.norm() < range;
    }
    EXPECT_GT(between, 2);
  }
}

// ledger: S1-61 S1-62 S1-63 S1-E15
TEST(ReadingEvidence, BoundsOnTheAxisAreTheTwoPlanesOfTheBeam) {
  const PixelGrid grid{{0.25, -0.25}, 0.5};  // the vehicle stands on the centre of a pixel
  for (const auto geometry : {Config::Geometry::kExact, Config::Geometry::kPlanes}) {
    Config config;
    config.geometry = geometry;
    ReadingEvidence evidence(config, grid);
    int axis = 0;
    for (const PixelEvidence& e : evidence.add_reading(reading(40), at({0, 0, 10})).pixels) {
      const Vector2d centre = grid.centre({e.column, e.row});
      if (centre.y() != 0 || centre.x() == 0) continue;
      ++axis;
      const double half = centre.x() * std::tan(3 * kDegree);
      if (e.kind == Kind::kObstructed) {
        EXPECT_GE(centre.x(), 40);
        EXPECT_NEAR(e.bound_m, 10 - half, 1e-4);
      } else if (centre.x() < 40 * std::cos(3 * kDegree)) {
        EXPECT_NEAR(e.bound_m, 10 + half, 1e-4);
      }
    }
    EXPECT_GT(axis, 75);
  }
}

// ledger: S1-59
TEST(ReadingEvidence, TouchedPixelsTellNoMoreThanTheBeamDoes) {
  const PixelGrid grid;
  Config config;
  config.coverage = Config::Coverage::kTouched;
  ReadingEvidence touched(config, grid);
  ReadingEvidence centres({}, grid);
  const Pose X_WB = at({0.1, 0.2, 10}, 63);
  const RangeReading r = reading(30, 4, 2);
  std::map<std::pair<int, int>, PixelEvidence> by_pixel;
  for (const PixelEvidence& e : touched.add_reading(r, X_WB).pixels) by_pixel[{e.column, e.row}] = e;
  const Evidence inner = centres.add_reading(r, X_WB);
  EXPECT_LT(inner.pixels.size(), by_pixel.size());
  for (const PixelEvidence& e : inner.pixels) {
    const PixelEvidence& same = by_pixel.at({e.column, e.row});
    EXPECT_EQ(same.kind, e.kind);
    EXPECT_EQ(same.bound_m, e.bound_m);
  }
  for (const auto& [pixel, e] : by_pixel) {
    ASSERT_TRUE(std::isfinite(e.bound_m));
    if (e.kind == Kind::kClear) {
      EXPECT_LT(e.bound_m, 10 + 30 * std::sin(5.1 * kDegree));
    }
    if (e.kind == Kind::kObstructed) {
      EXPECT_GT(e.bound_m, 10 + 28 * std::sin(3 * kDegree));
    }
  }
  // Along the axis no pixel is left out, from the vehicle on.
  for (double t = 0; t < 29; t += 0.05) {
    const Pixel p = grid.at(X_WB.translation.head<2>() + t * Vector2d(std::cos(63 * kDegree), std::sin(63 * kDegree)));
    const auto found = by_pixel.find({p.column, p.row});
    ASSERT_NE(found, by_pixel.end());
    EXPECT_EQ(found->second.kind, Kind::kClear);
  }
}

// ---------------------------------------------------------------- no echo, surface, explained echoes

// ledger: S1-64 S1-E12
TEST(ReadingEvidence, NoEchoClearsUpToTheMaximumAndObstructsNothing) {
  ReadingEvidence evidence({}, {});
  for (const std::optional<double> range : {std::optional<double>(), std::optional(50.0), std::optional(70.0)}) {
    const Evidence e = evidence.add_reading(reading(range), at({0, 0, 10}));
    EXPECT_EQ(e.outcome, Outcome::kNoEcho);
    EXPECT_EQ(count(e, Kind::kClear), static_cast<int>(e.pixels.size()));
    EXPECT_NEAR(static_cast<double>(e.pixels.size()), 2500 * std::tan(3 * kDegree) / 0.25, 40);
  }
  // The smaller of the sonar's maximum and the configured one.
  RangeReading near = reading(25);
  near.max_range_m = 20;
  EXPECT_EQ(evidence.add_reading(near, at({0, 0, 10})).outcome, Outcome::kNoEcho);
  near.max_range_m = 100;
  near.range_m = 60;
  EXPECT_EQ(evidence.add_reading(near, at({0, 0, 10})).outcome, Outcome::kNoEcho);
}

// ledger: S1-64
TEST(ReadingEvidence, AFailedReadingTellsNothing) {
  Config config;
  config.min_confidence = 0.5;
  ReadingEvidence evidence(config, {});
  const Pose good = at({0, 0, 10});
  const double nan = std::nan("");
  for (const double range : {nan, 0.0, -3.0, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(evidence.add_reading(reading(range), good).outcome, Outcome::kNothing) << range;
  }
  EXPECT_EQ(evidence.add_reading(reading(20, 0, 179), good).outcome, Outcome::kNothing);
  EXPECT_EQ(evidence.add_reading(reading(20, 0, nan), good).outcome, Outcome::kNothing);
  EXPECT_EQ(evidence.add_reading(reading(20), at({nan, 0, 10})).outcome, Outcome::kNothing);
  EXPECT_EQ(evidence.add_reading(reading(20, -80), good).outcome, Outcome::kNothing);  // looks up
  EXPECT_EQ(evidence.add_reading(reading(std::nullopt, 90), good).outcome, Outcome::kNothing);
  RangeReading unsure = reading(20);
  unsure.confidence = 0.4f;
  const Evidence e = evidence.add_reading(unsure, good);
  EXPECT_EQ(e.outcome, Outcome::kNothing);
  EXPECT_TRUE(e.pixels.empty());
  EXPECT_EQ(e.weight, 0);
}

// ledger: S1-66
TEST(ReadingEvidence, NoDepthIsAboveTheSurface) {
  Random random(66);
  ReadingEvidence evidence({}, {});
  for (int i = 0; i < 200; ++i) {
    const RangeReading r = reading(random.uniform(5, 50), random.uniform(-20, 5), random.uniform(2, 12));
    const Pose X_WB = at({0, 0, i % 10 == 0 ? -0.2 : 0.5}, random.uniform(0, 360), random.uniform(-10, 10));
    for (const PixelEvidence& e : evidence.add_reading(r, X_WB).pixels) ASSERT_GE(e.bound_m, 0);
  }
  const Evidence level = evidence.add_reading(reading(30), at({0, 0, 0.5}));
  EXPECT_GT(count(level, Kind::kObstructed), 0);
  for (const PixelEvidence& e : level.pixels) {
    if (e.kind == Kind::kObstructed) {
      EXPECT_LT(e.bound_m, 0.5);
    }
  }
}

// ledger: S1-66
TEST(ReadingEvidence, AnEchoOfTheSurfaceConfirmsAndDoesNotConflict) {
  ReadingEvidence evidence({}, {});
  const double range = 1.5 / std::sin(3 * kDegree);
  const Evidence surface = evidence.add_reading(reading(range), at({0, 0, 1.5}));
  EXPECT_TRUE(surface.explained);
  EXPECT_EQ(count(surface, Kind::kObstructed), 0);
  EXPECT_GT(count(surface, Kind::kConfirm), 0);
  // Much nearer than the surface can be: something else.
  EXPECT_FALSE(evidence.add_reading(reading(10), at({0, 0, 1.5})).explained);
}

// ledger: S1-66
TEST(ReadingEvidence, ALevelRunTwoMetresAboveAKnownBottomRaisesNoWall) {
  Random random(67);
  ReadingEvidence evidence({}, {});
  for (int i = 0; i < 100; ++i) {
    const Pose X_WB = at({0.6 * i, 0, 8}, 10);
    const RangeReading r = reading(2 / std::sin(3 * kDegree) + 0.2 * random.normal());
    const RangePrediction known = over_flat(evidence, r, X_WB, 10);
    ReadingContext context;
    context.prediction = &known;
    const Evidence e = evidence.add_reading(r, X_WB, context);
    EXPECT_TRUE(e.explained);
    EXPECT_EQ(count(e, Kind::kObstructed), 0);
    EXPECT_GT(count(e, Kind::kConfirm), 0);
    // A wall at half that range is none of the bottom's.
    EXPECT_GT(count(evidence.add_reading(reading(19), X_WB, context), Kind::kObstructed), 0);
  }
}

// ledger: S1-65 S1-F09
TEST(ReadingEvidence, PitchingOverAFlatBottomRaisesNothingWithTheExactConeAndMuchWithThePlanes) {
  const float bottom = 20;
  for (const auto geometry : {Config::Geometry::kExact, Config::Geometry::kPlanes}) {
    Config config;
    config.geometry = geometry;
    ReadingEvidence evidence(config, {});
    int raised = 0;
    for (double pitch = -10; pitch <= 10; pitch += 0.5) {
      const Pose X_WB = at({pitch, 0, 5}, 30, pitch);
      RangeReading r = reading(std::nullopt);
      const BeamCone truth(r, X_WB);
      const double echo = std::min(truth.range_to_level(bottom).value_or(1e9), truth.range_to_level(0).value_or(1e9));
      if (echo < 50) r.range_m = echo;
      const RangePrediction known = over_flat(evidence, r, X_WB, bottom);
      ReadingContext context;
      context.prediction = &known;
      for (const PixelEvidence& e : evidence.add_reading(r, X_WB, context).pixels) {
        raised += e.kind == Kind::kObstructed && e.bound_m < bottom;
        if (geometry == Config::Geometry::kExact && e.kind == Kind::kClear) {
          ASSERT_LE(e.bound_m, bottom + 1e-3);
        }
      }
    }
    if (geometry == Config::Geometry::kExact) {
      EXPECT_EQ(raised, 0);
    } else {
      EXPECT_GT(raised, 100);
    }
  }
}

// ledger: S1-65
TEST(ReadingEvidence, NeglectOfAttitudeCostsWhatTheLedgerSays) {
  const auto top_at_50 = [](const Pose& X_WB, double azimuth, Config::Geometry geometry) {
    Config config;
    config.geometry = geometry;
    config.range_cap_m = 60;
    ReadingEvidence evidence(config, {});
    RangeReading r = reading(50, 0, 6, azimuth);
    r.max_range_m = 60;
    const Vector2d axis = X_WB.translation.head<2>() + 50.3 * evidence.cone(r, X_WB)->heading();
    const Pixel p = evidence.grid().at(axis);
    for (const PixelEvidence& e : evidence.add_reading(r, X_WB).pixels) {
      if (Pixel{e.column, e.row} == p) return static_cast<double>(e.bound_m);
    }
    return std::nan("");
  };
  const Vector3d p(0, 0, 20);
  const double pitch =
      top_at_50(at(p, 0, -5), 0, Config::Geometry::kExact) - top_at_50(at(p, 0, -5), 0, Config::Geometry::kPlanes);
  EXPECT_NEAR(pitch, 4.36, 0.1);
  const double roll = top_at_50(at(p, 0, 0, 5), 30, Config::Geometry::kExact) -
                      top_at_50(at(p, 0, 0, 5), 30, Config::Geometry::kPlanes);
  EXPECT_NEAR(roll, 2.18, 0.1);
}

// ---------------------------------------------------------------- depth sonar

// ledger: S1-53
TEST(ReadingEvidence, FootprintIsTheSmallestSquareThatCoversTheSpot) {
  const double tangent = std::tan(3 * kDegree);
  EXPECT_EQ(footprint_half_width(10 * tangent, 0.5), 1);
  EXPECT_EQ(footprint_half_width(30 * tangent, 0.5), 3);
  EXPECT_EQ(footprint_half_width(50 * tangent, 0.5), 5);
  for (int step = 0; step <= 500; ++step) {  // the paper's table, every 0.1 m
    const double radius = 0.1 * step * tangent;
    const int n = footprint_half_width(radius, 0.5);
    EXPECT_GE((n + 0.5) * 0.5, radius);
    if (n > 0) {
      EXPECT_LT((n - 0.5) * 0.5, radius);
    }
  }
}

// ledger: S1-54 S1-55
TEST(ReadingEvidence, OfADepthSonarIsTheSquareAroundTheSpot) {
  const PixelGrid grid;
  ReadingEvidence evidence({}, grid);
  const Evidence e = evidence.add_reading(reading(30, 90), at({4.2, -7.3, 6}));
  EXPECT_EQ(e.outcome, Outcome::kBottom);
  EXPECT_EQ(e.pixels.size(), 49U);
  const Pixel middle = grid.at({4.2, -7.3});
  for (const PixelEvidence& p : e.pixels) {
    EXPECT_EQ(p.kind, Kind::kBottom);
    EXPECT_NEAR(p.bound_m, 36, 1e-5);
    EXPECT_LE(std::abs(p.column - middle.column), 3);
    EXPECT_LE(std::abs(p.row - middle.row), 3);
  }
  EXPECT_FLOAT_EQ(e.margin_m, 0.6f);
  EXPECT_FLOAT_EQ(evidence.add_reading(reading(20, 90), at({0, 0, 6})).margin_m, 0.5f);
}

// ledger: S1-55 S1-F09
TEST(ReadingEvidence, RollMovesTheSpotAndTheDepthAsTheLedgerSays) {
  const PixelGrid grid;
  ReadingEvidence evidence({}, grid);
  const Evidence e = evidence.add_reading(reading(20, 90), at({0, 0, 0}, 0, 0, 5));
  double east = 0;
  for (const PixelEvidence& p : e.pixels)
    east += grid.centre({p.column, p.row}).y() / static_cast<double>(e.pixels.size());
  EXPECT_NEAR(std::abs(east), 1.74, 0.25);
  EXPECT_NEAR(20 - e.pixels[0].bound_m, 0.08, 0.005);
}

// ledger: S1-55
TEST(ReadingEvidence, RollingOverAStepMapsItsEdgeWithinAPixelOnlyWithTheAttitude) {
  const PixelGrid grid;
  const auto misplaced = [&](Config::Geometry geometry) {
    Config config;
    config.geometry = geometry;
    ReadingEvidence evidence(config, grid);
    double worst = 0;
    for (double east = -8; east <= 8; east += 0.1) {
      const double roll = 10 * std::sin(3 * east);
      const Pose X_WB = at({0, east, 5}, 0, 0, roll);
      // A thin beam to a bottom of 25 m west of the edge and of 23 m east of it.
      const Vector3d u = BeamCone(reading(20, 90, 0.2), X_WB).axis();
      const double deep = 20 / u.z();
      const bool west = east + deep * u.y() < 0 && east + 18 / u.z() * u.y() < 0;
      const RangeReading r = reading(west ? deep : 18 / u.z(), 90, 0.2);
      for (const PixelEvidence& p : evidence.add_reading(r, X_WB).pixels) {
        const double centre = grid.centre({p.column, p.row}).y();
        const bool mapped_west = p.bound_m > 24;
        if (mapped_west != (centre < 0)) worst = std::max(worst, std::abs(centre));
      }
    }
    return worst / grid.pixel_m;
  };
  EXPECT_LE(misplaced(Config::Geometry::kExact), 1);
  EXPECT_GT(misplaced(Config::Geometry::kPlanes), 3);
}

// ledger: S1-E07
TEST(ReadingEvidence, FootprintMayBeASquareACircleOrAnEllipse) {
  const PixelGrid grid{{0, 0}, 0.05};
  const auto spot = [&](Config::Footprint footprint, double roll) {
    Config config;
    config.footprint = footprint;
    ReadingEvidence evidence(config, grid);
    const Pose X_WB = at({0, 0, 0}, 20, 0, roll);
    const Evidence e = evidence.add_reading(reading(40, 90), X_WB);
    return std::vector<PixelEvidence>(e.pixels.begin(), e.pixels.end());
  };
  const double radius = 40 * std::tan(3 * kDegree);
  const double pixel_area = 0.05 * 0.05;
  const auto area = [&](const auto& pixels) { return static_cast<double>(pixels.size()) * pixel_area; };
  EXPECT_NEAR(area(spot(Config::Footprint::kCircle, 0)), std::numbers::pi * radius * radius, 0.05);
  EXPECT_NEAR(area(spot(Config::Footprint::kSquare, 0)), 4 * radius * radius, 0.5);
  const auto ellipse = spot(Config::Footprint::kEllipse, 30);
  EXPECT_NEAR(area(ellipse), std::numbers::pi * radius * radius / std::cos(30 * kDegree), 0.05);
  // Its long axis lies along the tilt: to port, for starboard went down.
  const Vector2d tilt(std::cos(-70 * kDegree), std::sin(-70 * kDegree));
  const Vector2d middle = 40 * std::sin(30 * kDegree) * tilt;
  double along = 0;
  double across = 0;
  for (const PixelEvidence& p : ellipse) {
    const Vector2d d = grid.centre({p.column, p.row}) - middle;
    along = std::max(along, std::abs(d.dot(tilt)));
    across = std::max(across, std::abs(d.x() * tilt.y() - d.y() * tilt.x()));
  }
  EXPECT_NEAR(along, radius / std::cos(30 * kDegree), 0.05);
  EXPECT_NEAR(across, radius, 0.05);
}

// ledger: S1-54 S1-55 S1-E07
TEST(ReadingEvidence, RoundFootprintsEqualBruteForce) {
  Random random(54);
  for (int i = 0; i < 200; ++i) {
    const PixelGrid grid{{random.uniform(-1, 1), random.uniform(-1, 1)}, 0.5};
    Config config;
    config.footprint = i % 2 == 0 ? Config::Footprint::kCircle : Config::Footprint::kEllipse;
    ReadingEvidence evidence(config, grid);
    const double range = random.uniform(0.5, 50);
    const Pose X_WB = at({random.uniform(-9, 9), random.uniform(-9, 9), 5}, random.uniform(0, 360),
                         random.uniform(-20, 20), random.uniform(-20, 20));
    const BeamCone cone = *evidence.cone(reading(range, 90), X_WB);
    const Vector3d p = cone.apex() + range * cone.axis();
    const double radius = range * std::tan(3 * kDegree);
    const double stretch = i % 2 == 0 ? 1 : 1 / cone.axis().z();
    std::map<std::pair<int, int>, PixelEvidence> found;
    for (const PixelEvidence& e : evidence.add_reading(reading(range, 90), X_WB).pixels) found[{e.column, e.row}] = e;
    std::size_t expected = 0;
    const Pixel middle = grid.at(p.head<2>());
    for (int row = middle.row - 15; row <= middle.row + 15; ++row) {
      for (int column = middle.column - 15; column <= middle.column + 15; ++column) {
        const Vector2d d = grid.centre({column, row}) - p.head<2>();
        const double along = d.dot(cone.heading()) / stretch;
        const double across = d.x() * cone.heading().y() - d.y() * cone.heading().x();
        const bool inside = std::hypot(along, across) <= radius || Pixel{column, row} == middle;
        expected += inside;
        ASSERT_EQ(found.count({column, row}) == 1, inside) << i << ": " << column << " " << row;
      }
    }
    ASSERT_EQ(found.size(), expected);
  }
}

// ledger: S1-E13
TEST(ReadingEvidence, OverASlopeNoPixelOfTheFootprintIsDeeperThanTheBottom) {
  const PixelGrid grid;
  ReadingEvidence evidence({}, grid);
  const double a = 10 * kDegree, along = 20;  // bottom 20 m below the sonar, along the axis
  for (const double slope : {0.0, 5.0, 15.0, 25.0}) {
    const double g = slope * kDegree, range = along * std::cos(g) / std::cos(std::max(0.0, g - a));
    // The rim of the footprint of a slant range lies a little beyond the cone, and pixels are whole.
    const double rim =
        range * (1 - std::cos(a) + (std::tan(a) - std::sin(a)) * std::tan(g)) + grid.pixel_m * std::tan(g);
    for (const PixelEvidence& e : evidence.add_reading(reading(range, 90, 20), at({0, 0, 5})).pixels) {
      const double bottom = 5 + along - grid.centre({e.column, e.row}).x() * std::tan(g);
      EXPECT_LE(e.bound_m, bottom + rim + 1e-4) << slope;
    }
  }
}

// ledger: S1-54
TEST(ReadingEvidence, TakesSoundingsByTheSameDoor) {
  const PixelGrid grid;
  ReadingEvidence evidence({}, grid);
  const Vector3d u(0, std::sin(50 * kDegree), std::cos(50 * kDegree));
  const Vector3d p(3.1, 24.2, 20.4);
  const Evidence thin = evidence.add_sounding(p, u, 31, {}, 0, {});
  ASSERT_EQ(thin.pixels.size(), 1U);
  EXPECT_EQ((Pixel{thin.pixels[0].column, thin.pixels[0].row}), grid.at(p.head<2>()));
  EXPECT_FLOAT_EQ(thin.pixels[0].bound_m, 20.4f);
  EXPECT_EQ(thin.weight, 2);
  EXPECT_FLOAT_EQ(thin.margin_m, 0.62f);
  EXPECT_NEAR(thin.sigma_m, RangeDeviation().total(31, 0.25), 1e-6);
  EXPECT_EQ(evidence.add_sounding(p, u, 31, Angle::degrees(1), 0.1).pixels.size(), 9U);
  EXPECT_NEAR(evidence.add_sounding(p, u, 31, Angle::degrees(1), 0.1).sigma_m,
              std::hypot(0.1, RangeDeviation().of_pose(31, 0.25)), 1e-6);
  EXPECT_EQ(evidence.add_sounding({std::nan(""), 0, 0}, u, 31, {}, 0).outcome, Outcome::kNothing);
  // What a damaged file says of a beam asks for no more memory than the widest reading.
  EXPECT_LE(evidence.add_sounding(p, u, 1e12, Angle::degrees(88), 0).pixels.size(), 201U * 201U);
}

// ---------------------------------------------------------------- weights, windows, memory

// ledger: S1-48 S1-69 S1-E06
TEST(ReadingEvidence, WeighsByKindTimesCountUpToTheCap) {
  Config config;
  config.weight_cap = 5;
  ReadingEvidence evidence(config, {});
  ReadingContext merged;
  const Pose X_WB = at({0, 0, 5});
  EXPECT_EQ(evidence.add_reading(reading(20), X_WB).weight, 1);
  EXPECT_EQ(evidence.add_reading(reading(20, 90), X_WB).weight, 2);
  merged.count = 4;
  EXPECT_EQ(evidence.add_reading(reading(20), X_WB, merged).weight, 4);
  EXPECT_EQ(evidence.add_reading(reading(20, 90), X_WB, merged).weight, 5);
  // By default a merged reading changes no more than the threshold, which is one reading of the depth sonar.
  EXPECT_EQ(ReadingEvidence({}, {}).add_reading(reading(20, 90), X_WB, merged).weight, 2);
}

// ledger: S1-73
TEST(ReadingEvidence, StatesItsDeviation) {
  ReadingEvidence evidence({}, {});
  const RangeDeviation d;
  ReadingContext fixed;
  fixed.navigation_m = 3;
  EXPECT_NEAR(evidence.add_reading(reading(40), at({0, 0, 5})).sigma_m, d.total(40, d.navigation_m), 1e-6);
  EXPECT_NEAR(evidence.add_reading(reading(40), at({0, 0, 5}), fixed).sigma_m, d.total(40, 3), 1e-6);
}

// ledger: S1-59
TEST(ReadingEvidence, KeepsWithinTheWindowOfTheMap) {
  ReadingEvidence evidence({}, {});
  for (const RangeReading& r : {reading(40), reading(30, 90)}) {
    const Pose X_WB = at({0, 0, 5}, 40);
    ReadingContext context;
    context.window = {-2, -60, 30, 59};
    std::size_t expected = 0;
    for (const PixelEvidence& e : evidence.add_reading(r, X_WB).pixels) {
      expected += context.window.contains({e.column, e.row});
    }
    const Evidence clipped = evidence.add_reading(r, X_WB, context);
    EXPECT_EQ(clipped.pixels.size(), expected);
    for (const PixelEvidence& e : clipped.pixels) EXPECT_TRUE(context.window.contains({e.column, e.row}));
  }
}

TEST(ReadingEvidence, AllocatesNothing) {
  ReadingEvidence evidence({}, {});
  RangePredictor predictor({}, {});
  const std::vector<float> depth(200 * 200, 12.0f);
  const DepthPatch patch{{-100, -100, 200, 200}, depth};
  const auto one_turn = [&](int every) {
    int pixels = 0;
    for (int heading = 0; heading < 360; heading += every) {
      const Pose X_WB = at({0.01 * heading, 0, 9}, heading, 5, -7);
      const RangeReading wide = reading(49, 0, 30);
      const BeamCone cone = *evidence.cone(wide, X_WB);
      predictor.pixels(cone, 50, patch.window);
      const RangePrediction known = predictor.predict_listed(cone, 50, patch);
      ReadingContext context;
      context.prediction = &known;
      pixels += static_cast<int>(evidence.add_reading(wide, X_WB, context).pixels.size());
      pixels += static_cast<int>(evidence.add_reading(reading(std::nullopt), X_WB).pixels.size());
      pixels += static_cast<int>(evidence.add_reading(reading(30, 90), X_WB).pixels.size());
    }
    return pixels;
  };
  one_turn(45);  // the predictor's rows of pixels
  const std::uint64_t before = test::allocations();
  EXPECT_GT(one_turn(5), 72 * 2000);
  EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace isobath::reading_evidence_test
