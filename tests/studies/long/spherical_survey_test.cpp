// The room of lines and arcs in the grid at position 10, and the pictures of it.
#include <algorithm>
#include <cairo/cairo.h>
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/text_file.hpp>
#include <isobath/planning/route_planner.hpp>
#include <isobath/planning/spherical_hazards.hpp>
#include <isobath/studies/spherical_pages.hpp>
#include <isobath/studies/spherical_survey.hpp>
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

/// How much of a wall is within a cell of one of this probability or more.
double covered_share(const SphericalSurvey& survey, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                     double probability) {
  const Vector3d at = survey.path.scans.back().at;
  int covered = 0, places = 0;
  for (double share = 0.025; share < 1; share += 0.05, ++places) {
    const Eigen::Vector2d wall = a + share * (b - a);
    bool any = false;
    survey.grid->cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
      for (const SphericalCell& cell : beam) {
        if (SphericalGrid::probability(cell) < probability) continue;
        const Vector3d p = world_from_grid_axes(survey.grid->point_of(cell)) + at;
        any = any || (p.head<2>() - wall).norm() < survey.grid->layers().thickness(cell.layer);
      }
    });
    covered += any ? 1 : 0;
  }
  return covered / static_cast<double>(places);
}

// The parallelogram's south face was heard by two scans only, aslant: twelve echoes in six metres, about one a cell. An
// echo is spread over the cells that it may be of, so that none of them is likelier than not. They are obstacles all
// the same, and the line through the echoes knows the face to 0.2 m. ledger: S4-D01 S4-45 S4-50
TEST(SphericalSurvey, KnowsTheFaceThatOnlyTwoScansHeardAslant) {
  const Scene scene = polygon_room();
  SphericalSurveyConfig config = survey_config(scene);
  for (const double pass : {0.5, 0.0}) {
    config.mapper.pass = pass;
    const SphericalSurvey unpassed = run_spherical_survey(scene, config);
    EXPECT_LT(covered_share(unpassed, {-6, 2}, {-8, 8}, 0.5), 0.25) << "it is not what passed by that cleared it";
    EXPECT_GT(covered_share(unpassed, {-6, 2}, {0, 4}, 0.5), 0.9) << "the west face, which was heard often";
  }
  config.mapper.pass = 0.5;
  const SphericalSurvey survey = run_spherical_survey(scene, config);
  EXPECT_GT(covered_share(survey, {-6, 2}, {-8, 8}, survey.grid->config().occupied), 0.8);
  const Vector3d at = survey.path.scans.back().at;
  const Eigen::Vector2d a(-6, 2), d(-8, 8);  // its ends
  double sure = 0, nearest_sure = 1e9;
  survey.grid->cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
    for (const SphericalCell& cell : beam) {
      const Vector3d p = world_from_grid_axes(survey.grid->point_of(cell)) + at;
      const double share = (p.head<2>() - a).dot(d - a) / (d - a).squaredNorm();
      const double off = (a + share * (d - a) - p.head<2>()).norm(), probability = SphericalGrid::probability(cell);
      if (share > 0.25 && share < 0.9 && off < 0.5) sure = std::max(sure, probability);
      if (probability >= 0.5) nearest_sure = std::min(nearest_sure, (p.head<2>() - 0.5 * (a + d)).norm());
    }
  });
  EXPECT_LT(sure, 0.5) << "no cell of it is likelier than not";
  EXPECT_GT(nearest_sure, 2) << "from its middle";
  const auto& edges = survey.features.evidence.edges();
  const auto south = std::find_if(edges.begin(), edges.end(), [](const SeenEdge& edge) {
    return edge.line.normal.dot(Eigen::Vector2d(-6, -2).normalized()) > 0.99 && edge.line.length() < 10;
  });
  ASSERT_NE(south, edges.end());
  EXPECT_EQ(south->last_scan, 2);
  EXPECT_LE(south->line.support, 14);
  EXPECT_LT(std::abs(south->line.height_of(a)), 0.3);
  EXPECT_LT(std::abs(south->line.height_of(d)), 0.3);
}

// ledger: S4-D02 S4-42 S4-45 S4-47
TEST(SphericalSurvey, TellsTheRoomAsEdgesArcsAndCornersThatItConfirmsOnTheWay) {
  const Scene scene = polygon_room();
  SphericalSurveyConfig config = survey_config(scene);
  for (const int seed : {-1, 5}) {
    config.seed = seed;
    const SphericalSurvey survey = run_spherical_survey(scene, config);
    const SurveyFeatures& features = survey.features;
    EXPECT_EQ(features.accounted.size() + features.unaccounted.size(), survey.echoes);
    EXPECT_LT(features.unaccounted.size(), survey.echoes / 25);
    const auto corner_at = [&](double north, double east) -> const SeenCorner* {
      for (const SeenCorner& seen : features.evidence.corners()) {
        if (seen.corner.convex && (seen.corner.at - Eigen::Vector2d(north, east)).norm() < 0.4) return &seen;
      }
      return nullptr;
    };
    // west and south faces are heard from 1 and 2, the south one vanishes at 3; the north one appears at 5, the west
    // one vanishes at 7, where it is less than a beam wide; the east one appears at 10
    const SeenCorner *south_west = corner_at(-6, 2), *north_west = corner_at(0, 4), *north_east = corner_at(-2, 10);
    ASSERT_TRUE(south_west && north_west && north_east) << seed;
    EXPECT_LE(south_west->hypothesised, 2);
    EXPECT_EQ(south_west->confirmed, 3);
    EXPECT_EQ(north_west->hypothesised, 5);
    EXPECT_EQ(north_west->confirmed, 7) << "within the next two";
    EXPECT_GE(north_east->hypothesised, 9);
    EXPECT_EQ(north_east->confirmed, 0) << "nobody has gone round it";
    for (const SeenCorner& seen : features.evidence.corners()) {
      if (seen.confirmed > 0) {
        EXPECT_TRUE(&seen == south_west || &seen == north_west) << "no other corner is a body's";
      }
    }
    const bool tank = std::any_of(features.arcs.begin(), features.arcs.end(), [](const SurveyArc& seen) {
      return (seen.arc.centre - Eigen::Vector2d(12, -10)).norm() < 0.5 && std::abs(seen.arc.radius - 3) < 0.5;
    });
    EXPECT_TRUE(tank);
    // four walls, three faces of four; the longest planes of the grid are walls, and they are upright
    ASSERT_GE(features.planes.planes.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(features.planes.planes[i].normal.z(), 0, 1e-9);
  }
}

// ledger: S4-51
TEST(SphericalSurvey, WaysPlannedOnTheGridKeepClearOfTheTrueWalls) {
  const Scene scene = polygon_room();
  const SphericalSurvey survey = run_spherical_survey(scene, survey_config(scene));
  const Eigen::Vector2d at = survey.path.scans.back().at.head<2>();
  const std::vector<Hazard> hazards = hazards_of(*survey.grid, 3);
  ASSERT_GT(hazards.size(), 500u);
  for (const Hazard& hazard : hazards) {  // 2.5 degrees across, whatever the range
    const double across = (hazard.outline[2] - hazard.outline[3]).norm(), range = hazard.outline[2].norm();
    ASSERT_NEAR(across / range, Angle::degrees(2.5).radians(), 1e-3) << "finer near, coarser far";
  }
  const HazardMap map(hazards);
  const PlaneSection truth(scene, survey.path.scans.back().at.z());
  RouteConfig config;
  config.cell_m = 0.5;
  config.clearance_m = 0.5;
  config.wished_clearance_m = 1.5;
  RouteTask task;
  task.half_width_m = 0.4;
  const std::vector<Eigen::Vector2d> goals{{-16, -14}, {16, 0}, {-3, -8}, {-15, 16}, {5, -16}};
  for (const Eigen::Vector2d& goal : goals) {
    task.goal = goal - at;
    const auto way = plan_route(map, task, config);
    ASSERT_TRUE(way) << goal.transpose();
    double least = 1e9;
    for (std::size_t i = 1; i < way->points.size(); ++i) {
      for (double share = 0; share <= 1; share += 0.01) {
        const Eigen::Vector2d p = at + way->points[i - 1] + share * (way->points[i] - way->points[i - 1]);
        least = std::min(least, distance_to(truth, p));
      }
    }
    EXPECT_GT(least, task.half_width_m) << goal.transpose();
  }
  // the straight way to the third goal leads through the parallelogram
  EXPECT_FALSE(map.leg_is_clear({0, 0}, goals[2] - at, 0.4));
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

// The multibeam covers 150 degrees about the course; the head turns all round. ledger: S4-36
TEST(SphericalSurvey, RunsWithTheListedSonars) {
  const Scene scene = polygon_room();
  for (const char* name : {"em_1000_shallow", "wesmar_ss150", "simulated_2_5"}) {
    const SonarResolution sonar = listed_resolution(name);
    const SphericalSurvey survey = run_spherical_survey(scene, survey_config(sonar));
    EXPECT_GT(survey.occupied, 50u) << name;
    EXPECT_LT(survey.median_error_m, 2 * sonar.resolution_m + 0.2) << name;
    double widest_deg = 0;
    for (const SurveyEcho& echo : survey.stored) {
      const ScanPosition& from = survey.path.scans[static_cast<std::size_t>(echo.scan) - 1];
      const Vector3d d = echo.at_W - from.at;
      widest_deg =
          std::max(widest_deg, std::abs((Angle::radians(std::atan2(d.y(), d.x())) - from.course).wrapped().degrees()));
      EXPECT_NEAR(d.head<2>().norm(), echo.range_m, 1e-9);
    }
    const bool multibeam = sonar.beams == 60;
    EXPECT_NEAR(widest_deg, multibeam ? 75 : 179, multibeam ? 4 : 2) << name;
  }
}

// The walks of the picture of the grid's structure, against a filter over all cells. ledger: S4-16
TEST(SphericalPages, WalkTheCellsOfALayerAsAFilterOverAllCellsFindsThem) {
  const Scene scene = polygon_room();
  const SphericalSurvey survey = run_spherical_survey(scene, survey_config(scene));
  const GridWalks walks = walks_of(*survey.grid);
  std::vector<int> of_layer, beam;
  std::size_t in_ring = 0;
  survey.grid->cells().each_beam([&](const SphericalDirection& d, std::span<const SphericalCell> cells) {
    for (const SphericalCell& cell : cells) {
      if (d.elevation != walks.elevation) continue;
      ++in_ring;
      if (cell.layer == walks.layer) of_layer.push_back(d.azimuth);
      if (d.azimuth == walks.azimuth) beam.push_back(cell.layer);
    }
  });
  EXPECT_GT(of_layer.size(), 20u);
  EXPECT_GT(beam.size(), 5u);
  EXPECT_EQ(walks.ring_cells, in_ring);
  EXPECT_EQ(walks.of_layer, of_layer);
  EXPECT_TRUE(std::is_sorted(walks.of_layer.begin(), walks.of_layer.end())) << "in the order of beams";
  EXPECT_EQ(walks.beam, beam);
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
  const std::string solid = spherical_solid_picture(survey, *survey.grid);
  EXPECT_EQ(solid, spherical_solid_picture(again, *again.grid));
  const PngPixels plan = pixels_of(spherical_plan_picture(scene, survey));
  const PngPixels above = pixels_of(spherical_above_picture(scene, survey));
  const PngPixels features = pixels_of(spherical_features_picture(scene, survey));
  EXPECT_GT(std::count(features.argb.begin(), features.argb.end(), 0xff009e73u), 100) << "confirmed corners, green";
  EXPECT_GT(plan.width, 700);
  EXPECT_GT(above.width, 700);
  EXPECT_GT(dark_pixels(above), 20'000) << "walls of cells, not lines";
  EXPECT_LT(dark_pixels(plan), 15'000);
  SphericalCamera other;
  other.looking = Angle::degrees(200);
  EXPECT_NE(solid, spherical_solid_picture(survey, *survey.grid, other));
  SphericalCamera near;
  near.zoom = 0.5;
  EXPECT_LT(dark_pixels(pixels_of(spherical_solid_picture(survey, *survey.grid, near))), dark_pixels(pixels_of(solid)));
}

/// Share of the pixels below the title whose brightness differs by more than a fifth.
double share_that_differs(const PngPixels& a, const PngPixels& b) {
  if (a.width != b.width || a.height != b.height) return 1;
  const auto brightness = [](std::uint32_t c) {
    return static_cast<int>((c & 0xff) + (c >> 8 & 0xff) + (c >> 16 & 0xff)) / 3;
  };
  constexpr int kTitle = 40;
  const auto first = static_cast<std::size_t>(kTitle * a.width);
  std::size_t differ = 0;
  for (std::size_t i = first; i < a.argb.size(); ++i)
    differ += std::abs(brightness(a.argb[i]) - brightness(b.argb[i])) > 51;
  return static_cast<double>(differ) / static_cast<double>(a.argb.size() - first);
}

// The picture of the documentation, which was stored; another bearing or another rule shows another picture.
// ledger: S4-37
TEST(SphericalPages, DrawTheGridAsInTheStoredPicture) {
  const Scene scene = polygon_room();
  SphericalSurveyConfig config = survey_config(scene);
  const SphericalSurvey survey = run_spherical_survey(scene, config);
  const PngPixels stored = pixels_of(text_of_file((test::source_folder() / "docs/images/sphere-solid.png").string()));
  const auto differs = [&](const SphericalSurvey& of, const SphericalCamera& camera) {
    return share_that_differs(stored, pixels_of(spherical_solid_picture(of, *of.grid, camera)));
  };
  EXPECT_LT(differs(survey, {}), 0.01);
  EXPECT_GT(differs(survey, {.looking = Angle::degrees(25)}), 0.04);
  config.mapper.rule = SphericalMapperConfig::Rule::kMaximumResponse;
  EXPECT_GT(differs(run_spherical_survey(scene, config), {}), 0.04);
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
