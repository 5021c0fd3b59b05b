// Second bounces and echoes of nothing, in simulated turns of a scanning sonar that hears both.
#include <algorithm>
#include <gmock/gmock.h>
#include <isobath/scenario/scenario.hpp>
#include <isobath/studies/spherical_survey.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A quay, a corner of two walls and nine poles.
constexpr const char* kHarbour = R"(
[scene]
title = "Harbour"
duration_s = 60
[vehicle]
start = [0, 0, 5]
speed = 0.5
[[waypoint]]
north = 11
east = 4
depth = 5
speed = 0.5
[[sonar]]
preset = "micron"
sector_deg = 360
step_deg = 2.5
width_deg = 2.5
range_m = 45
[[prism]]
name = "quay"
lines = [[-20, 16, 40, 16]]
top = 0
bottom = 20
[[prism]]
name = "walls"
lines = [[34, -24, 34, -10], [34, -24, 20, -24]]
top = 0
bottom = 20
[[prism]]
name = "poles"
arcs = [[-8, -11, 0.5, 0, 360], [-3, -14, 0.5, 0, 360], [2, -17, 0.5, 0, 360], [7, -11, 0.5, 0, 360], [12, -14, 0.5, 0, 360],
        [17, -17, 0.5, 0, 360], [22, -11, 0.5, 0, 360], [27, -14, 0.5, 0, 360], [32, -17, 0.5, 0, 360]]
top = 0
bottom = 20
)";

struct Told {
  int things = 0, false_clusters = 0;  ///< walls and poles that some cluster is of; clusters of none
};

/// A cluster is of what half its cells lie within a metre of.
Told compare(const SphericalSurvey& survey, const PlaneSection& section) {
  std::vector<PlaneSection> alone;
  for (const SectionLine& line : section.lines()) alone.emplace_back().add(line);
  for (const SectionArc& arc : section.arcs()) alone.emplace_back().add(arc);
  std::vector<bool> met(alone.size());
  Told told;
  for (const SurveyFeatures::Target& target : survey.features.targets) {
    std::size_t true_cells = 0;
    for (const SphericalPlace& place : target.cluster.cells) {
      const Vector3d p = survey.grid->from_table(survey.grid->middle_in_table(place));
      const Vector2d plan = (survey.path.scans.back().at + world_from_grid_axes(p)).head<2>();
      if (distance_to(section, plan) > 1) continue;
      ++true_cells;
      for (std::size_t i = 0; i < alone.size(); ++i) met[i] = met[i] || distance_to(alone[i], plan) < 1;
    }
    if (2 * true_cells < target.cluster.cells.size()) ++told.false_clusters;
  }
  told.things = static_cast<int>(std::count(met.begin(), met.end(), true));
  return told;
}

// ledger: S4-52
TEST(FalseEchoes, LeaveFiveTimesFewerFalseClustersAndNearlyAllThings) {
  const Scene scene = parse_scenario(kHarbour, "harbour.toml").scene;
  const PlaneSection section(scene, 5);
  SphericalSurveyConfig config = survey_config(scene);
  config.scans = 15;
  config.sonar.multiple_share = 0.3;
  config.sonar.clutter_per_turn = 4;
  Told all, kept;
  std::array<std::array<std::uint64_t, 3>, 3> causes{};
  for (int seed = 1; seed <= 8; ++seed) {
    config.seed = seed;
    for (const bool leave_out : {false, true}) {
      config.leave_out_false = leave_out;
      const SphericalSurvey survey = run_spherical_survey(scene, config);
      const Told told = compare(survey, section);
      Told& sum = leave_out ? kept : all;
      sum.things += told.things;
      sum.false_clusters += told.false_clusters;
      for (std::size_t i = 0; i < 9; ++i) causes[i / 3][i % 3] += survey.causes[i / 3][i % 3];
    }
  }
  EXPECT_GT(all.false_clusters, 40);
  EXPECT_LE(5 * kept.false_clusters, all.false_clusters);
  EXPECT_GT(all.things, 80);
  EXPECT_GE(kept.things, 0.95 * all.things);
  const auto share = [&](SectionEcho echo, EchoCause told) {
    const auto& row = causes[static_cast<std::size_t>(echo)];
    return static_cast<double>(row[static_cast<std::size_t>(told)]) / static_cast<double>(row[0] + row[1] + row[2]);
  };
  EXPECT_GT(share(SectionEcho::kDirect, EchoCause::kDirect), 0.95);
  EXPECT_GT(share(SectionEcho::kMultiple, EchoCause::kMultiple), 0.9);
  EXPECT_GT(share(SectionEcho::kClutter, EchoCause::kFalse), 0.8);
}

}  // namespace
}  // namespace isobath
