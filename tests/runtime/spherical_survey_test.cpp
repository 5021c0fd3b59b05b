// The room of lines and arcs in the grid at position 10, and the pictures of it.
#include <cairo/cairo.h>
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/runtime/spherical_pages.hpp>
#include <isobath/runtime/spherical_survey.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;

Scene polygon_room() { return load_scene((test::source_folder() / "scenarios/polygon_room.toml").string()); }

// ledger: S4-D01 S4-D02 S4-01 S4-35
TEST(SphericalSurvey, KnowsTheRoomAtPositionTenAsItWasSeenOnTheWay) {
  const Scene scene = polygon_room();
  const SphericalSurvey survey = run_spherical_survey(scene, survey_config(scene));
  EXPECT_EQ(survey.path.scans.size(), 10u);
  EXPECT_EQ(survey.beams, 1440u);
  EXPECT_GT(survey.echoes, 1200u);
  EXPECT_EQ(survey.dropped_echoes, 0u);
  std::uint64_t held = 0;
  survey.grid->cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
    for (const SphericalCell& cell : beam) held += cell.echoes;
  });
  EXPECT_EQ(held, survey.echoes) << "none is lost on the way";
  EXPECT_LT(survey.median_error_m, 0.25);
  // The west face of the parallelogram is behind it, seen from position 10.
  const Vector3d at = survey.path.scans.back().at;
  const auto known = [&](double north, double east) {
    double least = 1e9;
    survey.grid->cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
      for (const SphericalCell& cell : beam) {
        if (SphericalGrid::probability(cell) < 0.5) continue;
        const Vector3d p = world_from_grid_axes(survey.grid->point_of(cell)) + at;
        least = std::min(least, std::hypot(p.x() - north, p.y() - east));
      }
    });
    return least;
  };
  EXPECT_LT(known(-3, 3), 0.7) << "the parallelogram's far side, seen from 1 to 6";
  EXPECT_LT(known(-20, -20), 2.5) << "the farthest corner";
  EXPECT_GT(known(0, 0), 2) << "open water";
}

// ledger: S4-D01 S4-E04 S4-E08
TEST(SphericalSurvey, RunsByThePapersRuleForComparison) {
  const Scene scene = polygon_room();
  SphericalSurveyConfig config = survey_config(scene);
  const SphericalSurvey by_log_odds = run_spherical_survey(scene, config);
  config.mapper.rule = SphericalMapperConfig::Rule::kMaximumResponse;
  const SphericalSurvey by_response = run_spherical_survey(scene, config);
  EXPECT_EQ(by_response.echoes, by_log_odds.echoes);
  const auto at_least = [](const SphericalSurvey& survey, double probability) {
    int n = 0;
    survey.grid->cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
      for (const SphericalCell& cell : beam) n += SphericalGrid::probability(cell) >= probability ? 1 : 0;
    });
    return n;
  };
  EXPECT_GT(at_least(by_response, 0.2), 300);
  EXPECT_EQ(at_least(by_response, 0.5), 0) << "level beams lie between two rows: no middle of a cell is near one";
  EXPECT_GT(at_least(by_log_odds, 0.5), 1000) << "masses do not depend on where middles are";
}

// ledger: S4-36
TEST(SphericalSurvey, RunsWithTheListedSonars) {
  const Scene scene = polygon_room();
  for (const char* name : {"em_1000_shallow", "wesmar_ss150", "simulated_2_5"}) {
    const SonarResolution sonar = listed_resolution(name);
    SphericalSurveyConfig config = survey_config(scene);
    config.grid = grid_for(sonar);
    config.sonar.beam_width = sonar.beam_width;
    config.sonar.sigma_m = sonar.resolution_m;
    const SphericalSurvey survey = run_spherical_survey(scene, config);
    EXPECT_GT(survey.occupied, 50u) << name;
    EXPECT_LT(survey.median_error_m, 2 * sonar.resolution_m + 0.2) << name;
  }
}

// ledger: S4-34 S4-D02
TEST(SphericalSurvey, AConeHasSlantedWallsInTheGrid) {
  const Scene scene = parse_scene(
      "[scene]\n[vehicle]\nstart = [0, 0, 12]\nspeed = 1\ndive_amplitude = 8\ndive_period_s = 40\n[[waypoint]]\n"
      "north = 0.5\neast = 0\ndepth = 12\n[[prism]]\narcs = [[0, 0, 10, 0, 360]]\ntop = 0\nbottom = 24\n"
      "bottom_scale = 2\n",
      "cone.toml");
  SphericalSurveyConfig config = survey_config(scene);
  config.sonar.noise = false;
  Scene lifted = scene;
  lifted.vehicle.speed = 0.0125;  // half a metre in the forty seconds of a dive
  const SphericalSurvey survey = run_spherical_survey(lifted, config);
  double shallow = 0, deep = 0;
  int n_shallow = 0, n_deep = 0;
  survey.grid->cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
    for (const SphericalCell& cell : beam) {
      if (cell.echoes == 0) continue;
      const Vector3d p = world_from_grid_axes(survey.grid->point_of(cell)) + survey.path.scans.back().at;
      EXPECT_NEAR(p.head<2>().norm(), 10 * (1 + p.z() / 24), 0.8);
      (p.z() < 8 ? shallow : deep) += p.head<2>().norm();
      ++(p.z() < 8 ? n_shallow : n_deep);
    }
  });
  ASSERT_GT(n_shallow, 50);
  ASSERT_GT(n_deep, 50);
  EXPECT_GT(deep / n_deep - shallow / n_shallow, 3);
}

// ledger: S4-37 S4-38 S4-39
TEST(SphericalPages, DrawDarkerWhatIsLikelierWithCornersAndTwelveLines) {
  for (double p = 0.01; p < 1; p += 0.01) EXPECT_LT(state_colour(p).red, state_colour(p - 0.01).red);
  const SphericalGrid grid;
  const SphericalPlace place{{100, 40}, 30};
  for (const Vector3d& corner : corner_points(grid, place)) {
    EXPECT_NEAR(corner.norm(), grid.layers().outer(30), 1e-9);
    const double off = std::acos(corner.normalized().dot(grid.axis_in_table(place.direction)));
    EXPECT_NEAR(off, Angle::degrees(1.25 * std::hypot(1, grid.buckets().cos_elevation(40))).radians(), 1e-3);
  }
  const auto lines = reference_lines(20);
  ASSERT_EQ(lines.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(lines[i].z(), 0);
    EXPECT_NEAR(lines[i].dot(lines[(i + 1) % 12]) / 400, std::cos(Angle::degrees(30).radians()), 1e-9);
  }
}

/// PngPixels of a PNG, as ARGB.
struct PngPixels {
  int width = 0, height = 0;
  std::vector<std::uint32_t> argb;
};
PngPixels pixels_of(const std::string& png) {
  struct Rest {
    const std::string* bytes;
    std::size_t at = 0;
  } rest{&png};
  cairo_surface_t* surface = cairo_image_surface_create_from_png_stream(
      [](void* from, unsigned char* to, unsigned length) {
        auto* r = static_cast<Rest*>(from);
        r->bytes->copy(reinterpret_cast<char*>(to), length, r->at);
        r->at += length;
        return CAIRO_STATUS_SUCCESS;
      },
      &rest);
  PngPixels made{cairo_image_surface_get_width(surface), cairo_image_surface_get_height(surface), {}};
  const unsigned char* data = cairo_image_surface_get_data(surface);
  for (int y = 0; y < made.height; ++y) {
    const auto* row = reinterpret_cast<const std::uint32_t*>(data + y * cairo_image_surface_get_stride(surface));
    made.argb.insert(made.argb.end(), row, row + made.width);
  }
  cairo_surface_destroy(surface);
  return made;
}
int dark_pixels(const PngPixels& p) {
  return static_cast<int>(std::count_if(p.argb.begin(), p.argb.end(), [](std::uint32_t c) {
    return (c & 0xff) < 0x30 && (c >> 8 & 0xff) < 0x30 && (c >> 16 & 0xff) < 0x30;
  }));
}

// ledger: S4-37 S4-D01
TEST(SphericalPages, AreThreePicturesTheSameForTheSameSurvey) {
  const Scene scene = polygon_room();
  const SphericalSurvey survey = run_spherical_survey(scene, survey_config(scene));
  const SphericalSurvey again = run_spherical_survey(scene, survey_config(scene));
  const std::string solid = spherical_solid_picture(survey);
  EXPECT_EQ(solid, spherical_solid_picture(again));
  const PngPixels plan = pixels_of(spherical_plan_picture(scene, survey));
  const PngPixels above = pixels_of(spherical_above_picture(scene, survey));
  EXPECT_GT(plan.width, 700);
  EXPECT_GT(above.width, 700);
  EXPECT_GT(dark_pixels(above), 20'000) << "walls of cells, not lines";
  EXPECT_LT(dark_pixels(plan), 15'000);
  SphericalCamera other;
  other.looking = Angle::degrees(200);
  EXPECT_NE(solid, spherical_solid_picture(survey, other));
  SphericalCamera near;
  near.zoom = 0.5;
  EXPECT_LT(dark_pixels(pixels_of(spherical_solid_picture(survey, near))), dark_pixels(pixels_of(solid)));
}

// ledger: S4-D01
TEST(SphericalSurvey, RefusesASceneWithoutLinesOrAPath) {
  const auto refused = [](const char* text) {
    const Scene scene = parse_scene(text, "empty.toml");
    EXPECT_THROW((void)run_spherical_survey(scene, survey_config(scene)), Error) << text;
  };
  refused("[scene]\n[[waypoint]]\nnorth = 5\n");
  refused("[scene]\n[[prism]]\narcs = [[0, 0, 10, 0, 360]]\n");
}

}  // namespace
}  // namespace isobath
