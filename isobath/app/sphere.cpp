#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <isobath/app/commands.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/base/printable_text.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/scenario/scenario.hpp>
#include <isobath/studies/spherical_closer.hpp>
#include <isobath/studies/spherical_pages.hpp>
#include <isobath/studies/spherical_sizes.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

constexpr std::size_t kMinEchoes = 5;  // of a target that is listed

struct SphereOptions {
  std::filesystem::path scene, out = "sphere";
  int scans = 10, seed = -1, passes = 1;
  double drift_percent = 0;
  double range_m = 0;
  std::string rule = "log_odds", sonar;
  double looking_deg = 20, down_deg = 35, zoom = 1;
  int coarser = 1, closer = 1;
  bool json = false, false_echoes = false, known = false;
};

/// What a user gets: the survey, and closer looks at its targets.
struct SphereResults {
  SphericalSurvey survey;
  std::vector<CloserLook> closer;
};

/// Standard deviation of the corner's position, m.
double sigma_of(const PlaneCorner& corner) { return std::sqrt(corner.covariance.trace()); }

nlohmann::json features_json(const SurveyFeatures& features) {
  nlohmann::json corners = nlohmann::json::array();
  for (const SeenCorner& seen : features.evidence.corners()) {
    corners.push_back({{"north_m", seen.corner.at.x()},
                       {"east_m", seen.corner.at.y()},
                       {"sigma_m", sigma_of(seen.corner)},
                       {"convex", seen.corner.convex},
                       {"hypothesised", seen.hypothesised},
                       {"confirmed", seen.confirmed},
                       {"scans_for", seen.scans_for},
                       {"scans_against", seen.scans_against}});
  }
  return {{"edges", features.evidence.edges().size()},
          {"arcs", features.arcs.size()},
          {"accounted_echoes", features.accounted.size()},
          {"unaccounted_echoes", features.unaccounted.size()},
          {"runs_of_constant_range", features.runs},
          {"planes", features.planes.planes.size()},
          {"corners", std::move(corners)}};
}

/// The targets, and the peaks that a closer look found in each.
nlohmann::ordered_json targets_json(const SphereResults& results) {
  auto json = nlohmann::ordered_json::array();
  const SphericalSurvey& survey = results.survey;
  const auto& targets = survey.features.targets;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (targets[i].score.echoes < kMinEchoes) continue;
    const Eigen::Vector3d at = point_in_world(survey, targets[i].cluster.centroid);
    auto peaks = nlohmann::ordered_json::array();
    const auto look = std::find_if(results.closer.begin(), results.closer.end(),
                                   [i](const CloserLook& closer) { return closer.target == i; });
    if (look != results.closer.end()) {
      for (const SphericalCluster& peak : look->peaks) {
        const Eigen::Vector3d p = point_in_world(survey, peak.centroid);
        peaks.push_back({{"north_m", p.x()}, {"east_m", p.y()}, {"depth_m", p.z()}, {"echoes", peak.echoes}});
      }
    }
    json.push_back({{"north_m", at.x()},
                    {"east_m", at.y()},
                    {"cells", targets[i].cluster.cells.size()},
                    {"echoes", targets[i].score.echoes},
                    {"scans", targets[i].score.scans},
                    {"score", targets[i].score.value()},
                    {"closer_cells", look == results.closer.end() ? 0 : look->grid->cells().size()},
                    {"peaks", std::move(peaks)}});
  }
  return json;
}

/// How the echoes of each true kind were classified.
nlohmann::ordered_json causes_json(const SphericalSurvey& survey) {
  nlohmann::ordered_json json;
  const char* const kinds[] = {"direct", "second_bounces", "false"};
  for (std::size_t i = 0; i < survey.causes.size(); ++i) {
    const auto& told = survey.causes[i];
    json[kinds[i]] = {{"as_direct", told[0]}, {"as_multiple", told[1]}, {"as_false", told[2]}};
  }
  return json;
}

constexpr double kSizedRanges_m[] = {50, 100, 200};  // those of the paper's example
constexpr double kSlice_m = 12;                      // squares of a cell are lines in the picture of a wider slice

/// Cells of the grid at several ranges, beside those of grids with cells of one size.
nlohmann::ordered_json sizes_json(const SphericalGridConfig& config) {
  auto json = nlohmann::ordered_json::array();
  for (const double range_m : kSizedRanges_m) {
    const SphericalSizes sizes = spherical_sizes(config, range_m);
    json.push_back({{"range_m", sizes.range_m},
                    {"layers", sizes.layers},
                    {"uniform_layers", sizes.uniform_layers},
                    {"cells", sizes.cells},
                    {"uniform_cells", sizes.uniform_cells},
                    {"cubic_cells", sizes.cubic_cells},
                    {"slice_cells", sizes.slice_cells},
                    {"square_cells", sizes.square_cells}});
  }
  return json;
}

void print_sizes(const SphericalGridConfig& config) {
  fmt::print("\nwhole grid to  layers  uniform layers      cells  uniform cells  cubes of {:g} m\n",
             config.min_layer_m);
  for (const double range_m : kSizedRanges_m) {
    const SphericalSizes sizes = spherical_sizes(config, range_m);
    fmt::print("{:11g} m  {:6}  {:14}  {:9}  {:13}  {:14}\n", sizes.range_m, sizes.layers, sizes.uniform_layers,
               sizes.cells, sizes.uniform_cells, sizes.cubic_cells);
  }
}

void print_features(const SphereResults& results) {
  const SurveyFeatures& features = results.survey.features;
  const std::size_t all = features.accounted.size() + features.unaccounted.size();
  fmt::print(
      "{} edges and {} arcs account for {} of {} echoes; {} runs of constant range; {} tangent planes in the grid\n",
      features.evidence.edges().size(), features.arcs.size(), features.accounted.size(), all, features.runs,
      features.planes.planes.size());
  fmt::print("\ncorner    north     east    +-      supposed at  confirmed at  for  against\n");
  for (const SeenCorner& seen : features.evidence.corners()) {
    if (!seen.corner.convex) continue;
    fmt::print("        {:7.2f}  {:7.2f}  {:5.2f} m  {:11d}  {:>12}  {:3d}  {:7d}\n", seen.corner.at.x(),
               seen.corner.at.y(), sigma_of(seen.corner), seen.hypothesised,
               seen.confirmed > 0 ? std::to_string(seen.confirmed) : "no", seen.scans_for, seen.scans_against);
  }
  fmt::print("\ntarget    cells  echoes  scans  score\n");
  for (const SurveyFeatures::Target& target : features.targets) {
    if (target.score.echoes < kMinEchoes) continue;
    fmt::print("        {:7d} {:7d} {:6d}  {:5.2f}\n", target.cluster.cells.size(), target.score.echoes,
               target.score.scans, target.score.value());
  }
  for (const CloserLook& look : results.closer) {
    fmt::print("closer look at the target of {} cells: {} cells, {} peaks\n",
               features.targets[look.target].cluster.cells.size(), look.grid->cells().size(), look.peaks.size());
  }
  fmt::print("\n");
}

void print_causes(const SphericalSurvey& survey) {
  fmt::print("\nechoes  classified as   direct  multiple   false\n");
  const char* const kEchoes[] = {"direct", "second bounces", "false"};
  for (std::size_t i = 0; i < survey.causes.size(); ++i) {
    const auto& told = survey.causes[i];
    fmt::print("{:<22} {:7d} {:9d} {:7d}\n", kEchoes[i], told[0], told[1], told[2]);
  }
  fmt::print("\n");
}

nlohmann::ordered_json navigation_json(const SphericalSurvey& survey, const SphericalSurveyConfig& config) {
  if (config.drift_share == 0) return {};
  const PositionErrors alone = errors_of(survey.navigation.dead_reckoning, survey.path);
  const PositionErrors fixed = errors_of(survey.navigation.believed, survey.path);
  return {{"way_m", survey.navigation.way_m},        {"fixes", survey.navigation.fixes},
          {"corners", survey.navigation.corners},    {"dead_reckoning_last_m", alone.last_m},
          {"dead_reckoning_worst_m", alone.worst_m}, {"corrected_last_m", fixed.last_m},
          {"corrected_worst_m", fixed.worst_m}};
}

void print_navigation(const SphericalSurvey& survey, const SphericalSurveyConfig& config) {
  const PositionErrors alone = errors_of(survey.navigation.dead_reckoning, survey.path);
  const PositionErrors fixed = errors_of(survey.navigation.believed, survey.path);
  fmt::print(
      "{:.0f} m of way at {:g} % drift: dead reckoning ends {:.2f} m off; with {} fixes by {} corners the position is "
      "{:.2f} m off at the end, {:.2f} m at most\n",
      survey.navigation.way_m, 100 * config.drift_share, alone.last_m, survey.navigation.fixes,
      survey.navigation.corners, fixed.last_m, fixed.worst_m);
}

SphericalSurveyConfig config_of(const Scene& scene, const SphereOptions& options) {
  SphericalSurveyConfig config =
      options.sonar.empty() ? survey_config(scene) : survey_config(listed_resolution(options.sonar));
  config.scans = options.scans;
  config.seed = options.seed;
  config.passes = options.passes;
  config.drift_share = options.drift_percent / 100;
  config.known_walls = options.known;
  config.coarser = options.coarser;
  if (options.range_m > 0) config.sonar.range_m = options.range_m;
  if (options.rule == "maximum_response") config.mapper.rule = SphericalMapperConfig::Rule::kMaximumResponse;
  if (options.false_echoes) {
    config.sonar.multiple_share = 0.3;
    config.sonar.clutter_per_turn = 4;
    config.leave_out_false = true;
  }
  return config;
}

/// Draws the pictures into the output folder; returns their names.
std::vector<std::string> save_pictures(const Scene& scene, const SphericalSurvey& survey,
                                       const SphericalGridConfig& grid, const SphereOptions& options) {
  const SphericalCamera camera{Angle::degrees(options.looking_deg), Angle::degrees(options.down_deg), options.zoom};
  std::vector<std::string> pictures;
  const auto save = [&](const char* name, const std::string& png) {
    write_whole_file(options.out / name, png);
    pictures.emplace_back(name);
  };
  save("plan.png", spherical_plan_picture(scene, survey));
  save("above.png", spherical_above_picture(scene, survey));
  save("solid.png", spherical_solid_picture(survey, *survey.grid, camera));
  save("features.png", spherical_features_picture(scene, survey));
  save("slice.png", spherical_slice_picture(grid, kSlice_m));
  save("structure.png", spherical_structure_picture(survey));
  if (survey.coarse) save("coarse.png", spherical_solid_picture(survey, *survey.coarse, camera));
  return pictures;
}

nlohmann::ordered_json survey_json(const Scene& scene, const SphereResults& results,
                                   const SphericalSurveyConfig& config) {
  const SphericalSurvey& survey = results.survey;
  const GridWalks walks = walks_of(*survey.grid);
  return {{"scene", scene.about.title},
          {"scans", survey.path.scans.size()},
          {"beams", survey.beams},
          {"echoes", survey.echoes},
          {"dropped_echoes", survey.dropped_echoes},
          {"cells", survey.grid->cells().size()},
          {"occupied", survey.occupied},
          {"known", survey.known},
          {"known_error_m", survey.known_error_m},
          {"coarse_cells", survey.coarse ? survey.coarse->cells().size() : 0},
          {"directions", survey.grid->buckets().count()},
          {"layers", survey.grid->layers().count()},
          {"bytes", survey.grid->cells().bytes()},
          {"median_error_m", survey.median_error_m},
          {"worst_error_m", survey.worst_error_m},
          {"navigation", navigation_json(survey, config)},
          {"sizes", sizes_json(config.grid)},
          {"walks",
           {{"beam_cells", walks.beam.size()},
            {"layer", walks.layer},
            {"layer_cells", walks.of_layer.size()},
            {"ring_cells", walks.ring_cells}}},
          {"echoes_by_cause", causes_json(survey)},
          {"targets", targets_json(results)},
          {"features", features_json(survey.features)}};
}

void print_survey(const Scene& scene, const SphereResults& results, const SphericalSurveyConfig& config) {
  const SphericalSurvey& survey = results.survey;
  const SphericalGrid& grid = *survey.grid;
  fmt::print("{}: {} scans, {} beams, {} echoes, of which {} left the range\n", printable_text(scene.about.title),
             survey.path.scans.size(), survey.beams, survey.echoes, survey.dropped_echoes);
  fmt::print("{} cells of {} directions x {} layers, {} occupied, {:.2f} MB\n", grid.cells().size(),
             grid.buckets().count(), grid.layers().count(), survey.occupied,
             static_cast<double>(grid.cells().bytes()) / 1e6);
  fmt::print("occupied cells that echoed are {:.2f} m from a true wall (median), {:.2f} m at most\n",
             survey.median_error_m, survey.worst_error_m);
  if (config.known_walls) {
    fmt::print("{} cells hold walls known from the start, {:.2f} m from the true ones at most\n", survey.known,
               survey.known_error_m);
  }
  if (survey.coarse) {
    fmt::print("{} cells in directions and layers {} times as wide\n", survey.coarse->cells().size(), config.coarser);
  }
  if (config.drift_share > 0) print_navigation(survey, config);
  if (config.leave_out_false) print_causes(survey);
  print_features(results);
  print_sizes(config.grid);
}

int act(const SphereOptions& options) {
  check_output_folder(options.out, "--out");
  const Scene scene = open_scene(options.scene);
  const SphericalSurveyConfig config = config_of(scene, options);
  SphereResults results{run_spherical_survey(scene, config), {}};
  const SphericalSurvey& survey = results.survey;
  if (options.closer > 1) results.closer = closer_looks(survey, config, options.closer, kMinEchoes);
  make_folder(options.out);
  const std::vector<std::string> pictures = save_pictures(scene, survey, config.grid, options);
  if (options.json) {
    nlohmann::ordered_json json = survey_json(scene, results, config);
    add_files(json, options.out, {pictures.begin(), pictures.end()});
    print_json(json);
    return kSuccess;
  }
  print_survey(scene, results, config);
  fmt::print("written to {}: {}\n", options.out.string(), fmt::join(pictures, ", "));
  return kSuccess;
}

void add_view_options(CLI::App& command, SphereOptions& options) {
  command.add_option("--looking", options.looking_deg, "Bearing of the view in solid.png, degrees")
      ->capture_default_str()
      ->check(number(0, 360))
      ->group("Output");
  command.add_option("--down", options.down_deg, "Depression of the view in solid.png, degrees")
      ->capture_default_str()
      ->check(number(-90, 90))
      ->group("Output");
  command.add_option("--zoom", options.zoom, "Zoom of solid.png")
      ->capture_default_str()
      ->check(number(0.1, 100))
      ->group("Output");
  command
      .add_option("--coarser", options.coarser,
                  "Also draw the grid with directions and layers this many times as wide (coarse.png)")
      ->capture_default_str()
      ->check(whole(1, 24))
      ->group("Output");
  command
      .add_option("--closer", options.closer,
                  "Look closer at each target: its echoes in a grid with this many times as many directions and layers")
      ->capture_default_str()
      ->check(whole(1, 8))
      ->group("Output");
}

void add_survey_options(CLI::App& command, SphereOptions& options) {
  command.add_option("--scans", options.scans, "Number of scans along the path")
      ->capture_default_str()
      ->check(whole(1, 1000))
      ->group("Simulation");
  command.add_option("--range", options.range_m, "Maximum range of the sonar, m")
      ->check(number(1, 2000))
      ->default_str("the scene's")
      ->group("Simulation");
  command
      .add_option("--sonar", options.sonar,
                  "Scan with a sonar of this data sheet, in place of the scene's: its range, errors, beams and sector")
      ->type_name("NAME")
      ->check(one_of({"em_1000_shallow", "wesmar_ss150", "simulated_2_5"}))
      ->group("Simulation");
  command.add_option("--rule", options.rule, "Rule of the grid; maximum_response is the paper's")
      ->type_name("NAME")
      ->capture_default_str()
      ->check(one_of({"log_odds", "maximum_response"}))
      ->group("Simulation");
  command.add_option("--seed", options.seed, "Seed of every random number")
      ->check(whole(0, 2147483647))
      ->default_str("the scene's")
      ->group("Simulation");
  command.add_option("--passes", options.passes, "How often the vehicle goes along the path, to and fro")
      ->capture_default_str()
      ->check(whole(1, 100))
      ->group("Simulation");
  command
      .add_option("--drift", options.drift_percent,
                  "Error of dead reckoning, % of the way; the corners of the walls correct it")
      ->capture_default_str()
      ->check(number(0, 20))
      ->group("Simulation");
  command.add_flag("--known", options.known, "The walls at the depth of the first scan are in the grid from the start")
      ->group("Simulation");
  command
      .add_flag("--false-echoes", options.false_echoes,
                "Simulate second bounces (3 of 10 perpendicular echoes) and 4 random echoes a turn; remove them")
      ->group("Simulation");
}

}  // namespace

Action add_sphere(CLI::App& program) {
  auto options = std::make_shared<SphereOptions>();
  CLI::App* command = program.add_subcommand(
      "sphere",
      "Scan a room of lines and arcs along a path into the spherical grid; write pictures, edges and corners");
  command->add_option("SCENARIO", options->scene, "Scene (.toml) with prisms, such as scenarios/polygon_room.toml")
      ->check(reads())
      ->required();
  add_output_folder(*command, options->out, "Folder for the pictures");
  add_json_flag(*command, options->json);
  add_view_options(*command, *options);
  add_survey_options(*command, *options);
  add_example(*command, "sphere scenarios/polygon_room.toml --out out/room");
  add_example(*command, "sphere scenarios/polygon_room.toml --scans 20 --false-echoes --json");
  return [options] { return act(*options); };
}

}  // namespace isobath::app
