// The smooth bottom through scattered soundings: what it reproduces, how fast it converges, what it knows of its error.
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/geometry/smooth_surface.hpp>
#include <isobath/geometry/surface_error.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

template <class Depth>
std::vector<SurveyPoint> sampled(int count, double extent, std::uint64_t seed, const Depth& depth) {
  Random random(seed);
  std::vector<SurveyPoint> soundings;
  for (int i = 0; i < count; ++i) {
    const Vector2d p(random.uniform(0, extent), random.uniform(0, extent));
    soundings.push_back({p, depth(p), 0});
  }
  return soundings;
}

double wavy(const Vector2d& p) { return 10 + 3 * std::sin(p.x() / 30) * std::cos(p.y() / 40) + 0.01 * p.x(); }
Vector2d slope_of_wavy(const Vector2d& p) {
  return {0.1 * std::cos(p.x() / 30) * std::cos(p.y() / 40) + 0.01,
          -3.0 / 40 * std::sin(p.x() / 30) * std::sin(p.y() / 40)};
}

// ledger: S1-14
TEST(SmoothSurface, ReproducesAPlane) {
  const auto plane = [](const Vector2d& p) { return 12.5 + 0.03 * p.x() - 0.07 * p.y(); };
  const SmoothSurface surface(sampled(500, 200, 1, plane));
  Random random(2);
  int inside = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector2d p(random.uniform(0, 200), random.uniform(0, 200));
    const auto s = surface.at(p);
    if (!s) continue;
    ++inside;
    ASSERT_NEAR(s->depth_m, plane(p), 1e-9);
    ASSERT_LT((s->gradient - Vector2d(0.03, -0.07)).norm(), 1e-9);
  }
  EXPECT_GT(inside, 1900);
}

// ledger: S1-14
TEST(SmoothSurface, ReproducesAQuadraticFromExactSlopes) {
  const auto bowl = [](const Vector2d& p) { return 5 + 0.2 * p.x() + 1e-2 * p.x() * p.x() - 2e-2 * p.x() * p.y(); };
  const auto soundings = sampled(200, 100, 3, bowl);
  std::vector<Vector2d> slopes;
  for (const SurveyPoint& s : soundings) {
    const Vector2d& p = s.north_east;
    slopes.emplace_back(0.2 + 2e-2 * p.x() - 2e-2 * p.y(), -2e-2 * p.x());
  }
  const SmoothSurface surface(soundings, slopes);
  Random random(4);
  for (int i = 0; i < 1000; ++i) {
    const Vector2d p(random.uniform(0, 100), random.uniform(0, 100));
    if (const auto s = surface.at(p)) {
      ASSERT_NEAR(s->depth_m, bowl(p), 1e-9);
    }
  }
}

TEST(SmoothSurface, PassesThroughItsSoundings) {
  const auto soundings = sampled(300, 200, 5, wavy);
  const SmoothSurface surface(soundings);
  for (std::size_t i = 0; i < soundings.size(); ++i) {
    const auto s = surface.at(soundings[i].north_east);
    ASSERT_TRUE(s);
    EXPECT_NEAR(s->depth_m, soundings[i].depth_m, 1e-9);
    EXPECT_LT((s->gradient - surface.gradients()[i]).norm(), 1e-6);
    EXPECT_EQ(s->nearest, static_cast<int>(i));
  }
}

// Along both sides of every side of every triangle, and of the lines from corners to centroids, which split them.
// ledger: S1-14
TEST(SmoothSurface, HasContinuousValueAndSlope) {
  Random random(6);
  const auto rough = [&](const Vector2d&) { return random.uniform(0, 20); };
  const SmoothSurface surface(sampled(120, 100, 7, rough));
  const Triangulation& t = surface.triangulation();
  const double step = 1e-7;
  double steepest = 0;
  const auto expect_smooth = [&](const Vector2d& a, const Vector2d& b) {
    const Vector2d across = Vector2d(a.y() - b.y(), b.x() - a.x()).normalized();
    for (const double share : {0.07, 0.31, 0.5, 0.88}) {
      const Vector2d p = a + share * (b - a);
      const auto left = surface.at(p + step * across), right = surface.at(p - step * across);
      if (!left || !right) continue;
      steepest = std::max(steepest, left->gradient.norm());
      ASSERT_NEAR(left->depth_m, right->depth_m, 1e-4);
      ASSERT_LT((left->gradient - right->gradient).norm(), 2e-4 * (1 + left->gradient.norm()));
    }
  };
  for (const auto& triangle : t.triangles()) {
    const Vector2d *c[3],
        centroid =
            (t.points()[triangle.corner[0]] + t.points()[triangle.corner[1]] + t.points()[triangle.corner[2]]) / 3;
    for (int k = 0; k < 3; ++k) c[k] = &t.points()[triangle.corner[k]];
    if (cross(*c[1] - *c[0], *c[2] - *c[0]) < 1) continue;  // on slivers a step is long
    for (int k = 0; k < 3; ++k) {
      expect_smooth(*c[k], *c[(k + 1) % 3]);
      expect_smooth(*c[k], centroid);
    }
  }
  EXPECT_GT(steepest, 1) << "there was something to be smooth about";
}

TEST(SmoothSurface, SlopeIsTheDerivativeOfTheDepth) {
  const SmoothSurface surface(sampled(200, 200, 8, wavy));
  Random random(9);
  for (int i = 0; i < 300; ++i) {
    const Vector2d p(random.uniform(20, 180), random.uniform(20, 180));
    const double h = 1e-4;
    const auto n = surface.at(p + Vector2d(h, 0)), s = surface.at(p - Vector2d(h, 0));
    const auto e = surface.at(p + Vector2d(0, h)), w = surface.at(p - Vector2d(0, h));
    const auto here = surface.at(p);
    ASSERT_TRUE(n && s && e && w && here);
    EXPECT_NEAR(here->gradient.x(), (n->depth_m - s->depth_m) / (2 * h), 1e-4);
    EXPECT_NEAR(here->gradient.y(), (e->depth_m - w->depth_m) / (2 * h), 1e-4);
  }
}

// Four times the soundings halve the spacing: the error falls by 8, the error of the slope by 4.
// ledger: S1-14
TEST(SmoothSurface, ConvergesWithTheThirdPowerOfTheSpacing) {
  const auto rms = [](int count, double& of_slope) {
    const SmoothSurface surface(sampled(count, 200, 10, wavy));
    Random random(11);
    double sum = 0, slopes = 0;
    int n = 0;
    while (n < 3000) {
      const Vector2d p(random.uniform(20, 180), random.uniform(20, 180));
      const auto s = surface.at(p);
      if (!s) continue;
      sum += std::pow(s->depth_m - wavy(p), 2);
      slopes += (s->gradient - slope_of_wavy(p)).squaredNorm();
      ++n;
    }
    of_slope = std::sqrt(slopes / n);
    return std::sqrt(sum / n);
  };
  double slope_500 = 0, slope_2000 = 0, slope_8000 = 0;
  const double at_500 = rms(500, slope_500), at_2000 = rms(2000, slope_2000), at_8000 = rms(8000, slope_8000);
  RecordProperty("order", std::to_string(std::log2(at_500 / at_8000) / 2));
  EXPECT_GT(std::log2(at_500 / at_2000), 2.5);
  EXPECT_GT(std::log2(at_2000 / at_8000), 2.5);
  EXPECT_GT(std::log2(slope_500 / slope_8000) / 2, 1.6);
  EXPECT_LT(at_8000, 2e-3) << "of 3 m high waves, 2.2 m between soundings";
}

// ledger: S1-14
TEST(SmoothSurface, SaysNothingOutsideTheHull) {
  const SmoothSurface surface(sampled(100, 100, 12, wavy));
  const Polygon hull = convex_hull(surface.triangulation().points());
  Random random(13);
  for (int i = 0; i < 2000; ++i) {
    const Vector2d p(random.uniform(-20, 120), random.uniform(-20, 120));
    ASSERT_EQ(surface.at(p).has_value(), contains(hull, p));
  }
}

TEST(SmoothSurface, RefusesSoundingsOnOneLine) {
  std::vector<SurveyPoint> line;
  for (int i = 0; i < 30; ++i) line.push_back({{i * 1.0, i * 3.0}, 10, 0});
  EXPECT_THROW(SmoothSurface{line}, Error);
  EXPECT_THROW(SmoothSurface{std::vector<SurveyPoint>()}, Error);
}

TEST(Merged, KeepsTheMeanOrTheShoalestOfASquare) {
  const std::vector<SurveyPoint> all = {
      {{0.2, 0.2}, 10, 0}, {{0.4, 0.6}, 8, 0}, {{1.5, 0.5}, 5, 0}, {{-0.1, 0.1}, 7, 0}};
  const auto mean = merged(all, 1, Merge::kMean);
  ASSERT_EQ(mean.size(), 3u);
  EXPECT_DOUBLE_EQ(mean[0].depth_m, 9);
  EXPECT_LT((mean[0].north_east - Vector2d(0.3, 0.4)).norm(), 1e-12);
  const auto shoalest = merged(all, 1, Merge::kShoalest);
  ASSERT_EQ(shoalest.size(), 3u);
  EXPECT_EQ(shoalest[0].depth_m, 8);
  EXPECT_EQ(shoalest[0].north_east, Vector2d(0.4, 0.6));
  EXPECT_EQ(merged(all, 0, Merge::kMean).size(), 4u);
  const std::vector<SurveyPoint> twice = {{{0.0, 1}, 3, 0}, {{-0.0, 1}, 5, 0}};
  ASSERT_EQ(merged(twice, 0, Merge::kMean).size(), 1u);
  EXPECT_EQ(merged(twice, 0, Merge::kMean)[0].depth_m, 4);
}

struct Coverage {
  double within_1 = 0, within_2 = 0, rms = 0, mean_sigma = 0;
  int count = 0;
};

/// Held-out soundings against a surface that never saw them.
Coverage coverage(const SmoothSurface& surface, const std::vector<SurveyPoint>& held_out) {
  const SurfaceError error(surface, {}, 1);
  Coverage c;
  for (const SurveyPoint& s : held_out) {
    const auto sample = surface.at(s.north_east);
    if (!sample) continue;
    const double miss = std::abs(sample->depth_m - s.depth_m), sigma = error.sigma_m(*sample);
    c.within_1 += miss <= sigma;
    c.within_2 += miss <= 2 * sigma;
    c.rms += miss * miss;
    c.mean_sigma += sigma;
    ++c.count;
  }
  c.within_1 /= c.count;
  c.within_2 /= c.count;
  c.rms = std::sqrt(c.rms / c.count);
  c.mean_sigma /= c.count;
  testing::Test::RecordProperty("within_1_and_2_sigma", fmt::format("{:.3f} {:.3f}", c.within_1, c.within_2));
  testing::Test::RecordProperty("rms_and_mean_sigma_m", fmt::format("{:.3f} {:.3f}", c.rms, c.mean_sigma));
  return c;
}

/// Places of a whole squares pattern are held out, so that distances from 0 to the half of a square occur.
bool in_held_square(const Vector2d& p, double edge) {
  const auto i = static_cast<long>(std::floor(p.x() / edge)), j = static_cast<long>(std::floor(p.y() / edge));
  return (i % 3 + 3) % 3 == 0 && (j % 3 + 3) % 3 == 1;
}

std::vector<SurveyPoint> harbour() {
  std::ifstream file(test::shared_data("harbour-leixoes") / "Map_Leixoes.txt");
  std::vector<SurveyPoint> all;
  for (std::string line; std::getline(file, line);) {
    double n = 0, e = 0, d = 0;
    if (std::sscanf(line.c_str(), "%lf, %lf, %lf", &n, &e, &d) == 3) all.push_back({{n, e}, d, 0});
  }
  return all;
}

// A harbour of which one sounding in forty is known, in no order.
TEST(SurfaceError, HoldsForSparseSoundingsOfAHarbour) {
  ISOBATH_NEEDS_DATA(folder, "harbour-leixoes");
  std::vector<SurveyPoint> known, held_out;
  Random random(21);
  for (const SurveyPoint& s : harbour()) (random.uniform() < 0.025 ? known : held_out).push_back(s);
  const Coverage c = coverage(SmoothSurface(known), held_out);
  EXPECT_GT(c.count, 60000);
  EXPECT_GT(c.within_1, 0.62);
  EXPECT_LT(c.within_1, 0.85);
  EXPECT_GT(c.within_2, 0.92);
}

// The same harbour with holes of 12 m squares.
TEST(SurfaceError, HoldsAcrossHolesOfAHarbour) {
  ISOBATH_NEEDS_DATA(folder, "harbour-leixoes");
  std::vector<SurveyPoint> known, held_out;
  Random random(22);
  for (const SurveyPoint& s : harbour()) {
    if (in_held_square(s.north_east, 12)) {
      held_out.push_back(s);
    } else if (random.uniform() < 0.06) {
      known.push_back(s);
    }
  }
  const Coverage c = coverage(SmoothSurface(known), held_out);
  EXPECT_GT(c.within_1, 0.60);
  EXPECT_LT(c.within_1, 0.87);
  EXPECT_GT(c.within_2, 0.91);
}

/// Degrees, minutes and seconds as the sounder writes them, in degrees.
double degrees_of(const std::string& text) {
  double d = 0, m = 0, s = 0;
  std::string plain = text;
  for (char& ch : plain) {
    if (ch != '.' && (ch < '0' || ch > '9')) ch = ' ';
  }
  return std::sscanf(plain.c_str(), "%lf %lf %lf", &d, &m, &s) == 3 ? d + m / 60 + s / 3600 : NAN;
}

/// Soundings of one run of a boat on a lake, in a plane about its middle.
std::vector<SurveyPoint> lake_run(const std::string& name, int number) {
  std::ifstream file(test::shared_data("lake-caputh-m9") / name, std::ios::binary);
  std::vector<SurveyPoint> run;
  for (std::string line; std::getline(file, line, '\r');) {
    std::vector<std::string> cell(1);
    for (const char ch : line) {
      if (ch == ',') {
        cell.emplace_back();
      } else {
        cell.back() += ch;
      }
    }
    if (cell.size() < 12) continue;
    const double depth = std::atof(cell[11].c_str());  // the beam that looks straight down
    const Vector2d p((degrees_of(cell[5]) - 52.339) * 111268, (degrees_of(cell[6]) - 12.9955) * 68150);
    if (depth > 0 && p.allFinite()) run.push_back({p, depth, number});
  }
  return run;
}

// Whole runs held out: what is asked lies between the survey lines, metres to tens of metres from any sounding.
TEST(SurfaceError, HoldsForWholeRunsOnALake) {
  ISOBATH_NEEDS_DATA(folder, "lake-caputh-m9");
  std::vector<SurveyPoint> known, held_out;
  int number = 0;
  for (const char* name : {"20250117160335.sum", "20250117161408.sum", "20250122122110.sum", "20250122130314.sum",
                           "20250122142802.sum", "20250123122332.sum", "20250130115554.sum"}) {
    const auto run = lake_run(name, number++);
    known.insert(known.end(), run.begin(), run.end());
  }
  for (const char* name : {"20250123141712.sum", "20250130132742.sum"}) {
    const auto run = lake_run(name, 0);
    held_out.insert(held_out.end(), run.begin(), run.end());
  }
  ASSERT_GT(known.size(), 10000u);
  const Coverage c = coverage(SmoothSurface(merged(known, 2, Merge::kMean)), held_out);
  EXPECT_GT(c.count, 1000);
  EXPECT_GT(c.within_1, 0.58);
  EXPECT_LT(c.within_1, 0.90);
  EXPECT_GT(c.within_2, 0.88);
}

TEST(SurfaceError, GrowsWithDistanceAndWithRoughness) {
  // the northern half is a plane, the southern half is rough at a scale that the soundings cannot follow
  Random random(31);
  std::vector<SurveyPoint> soundings;
  for (int i = 0; i < 3000; ++i) {
    const Vector2d p(random.uniform(-100, 100), random.uniform(-100, 100));
    soundings.push_back({p, 20 + (p.x() < 0 ? random.normal() : 0.001 * random.normal()), 0});
  }
  const SmoothSurface surface(soundings);
  const SurfaceError error(surface, {}, 1);
  double rough = 0, smooth = 0;
  for (int i = 0; i < 200; ++i) {
    smooth += error.sigma_m(surface.at({random.uniform(10, 90), random.uniform(-90, 90)}).value()) / 200;
    rough += error.sigma_m(surface.at({random.uniform(-90, -10), random.uniform(-90, 90)}).value()) / 200;
  }
  EXPECT_GT(rough, 0.8);
  EXPECT_LT(smooth, 0.6 * rough);
  for (double d = 0.1; d < 200; d *= 1.5) EXPECT_LE(error.sigma_at_distance(d), error.sigma_at_distance(1.5 * d));
  EXPECT_GT(error.sigma_at_distance(500), 2 * error.sigma_at_distance(30));
}

TEST(SurfaceError, FallsBackWhereThereIsLittleToCompare) {
  const SmoothSurface surface({{{0, 0}, 1, 0}, {{10, 0}, 2, 0}, {{0, 10}, 3, 0}, {{10, 10}, 4, 0}});
  const SurfaceError error(surface, {}, 2.5);
  EXPECT_EQ(error.comparisons(), 0u);
  EXPECT_DOUBLE_EQ(error.sigma_at_distance(10), 2.5);
  EXPECT_DOUBLE_EQ(error.sigma_at_distance(40), 10);
}

}  // namespace
}  // namespace isobath
