#include <fmt/format.h>
#include <isobath/app/commands.hpp>
#include <isobath/app/config_options.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/settings_json.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/studies/traffic_pictures.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

struct TrafficOptions {
  TrafficRequest request;
  SettingOptions config;
  std::filesystem::path out = "out/traffic";
  std::vector<std::string> methods;
  std::string scene = "open", map = "known";
  bool show_settings = false;
  bool json = false;
};

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const TrafficMethod method : kTrafficMethods) names.push_back(to_text(method));
  return names;
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const TrafficScenery scenery : kTrafficSceneries) names.push_back(to_text(scenery));
  return names;
}

/// What is run where the options do not say it: the open scene as the table of docs/evaluation.md has it, the others
/// with and without a road map.
void set_defaults(TrafficRequest& request) {
  const bool is_open = request.scenery == TrafficScenery::kOpen;
  if (request.discs.empty()) request.discs = is_open ? TrafficRequest().discs : std::vector<int>{10, 20};
  if (request.max_speeds.empty()) request.max_speeds = is_open ? TrafficRequest().max_speeds : std::vector<double>{1};
  if (!request.methods.empty()) return;
  request.methods =
      is_open ? TrafficRequest().methods : std::vector<TrafficMethod>{TrafficMethod::kPlanner, TrafficMethod::kSearch};
}

nlohmann::ordered_json interval_json(const Interval& interval) {
  return nlohmann::ordered_json::array({interval.low, interval.high});
}

nlohmann::ordered_json traffic_json(const TrafficStudy& study) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const TrafficRow& row : study.rows) {
    rows.push_back({{"method", to_text(row.method)},
                    {"bodies", row.discs},
                    {"max_speed", row.max_speed},
                    {"runs", row.runs},
                    {"arrived", row.arrived},
                    {"arrived_interval", interval_json(row.arrived_share)},
                    {"contacts", row.contacts},
                    {"contact_interval", interval_json(row.contact_share)},
                    {"deep_contacts", row.deep_contacts},
                    {"deep_interval", interval_json(row.deep_share)},
                    {"runs_without_motion", row.without_motion},
                    {"runs_without_path", row.without_path},
                    {"detail", row.at_detail},
                    {"plans", row.plans},
                    {"road_plans", row.road_plans},
                    {"mended", row.mended},
                    {"refused_paths", row.refused_paths},
                    {"length_median", row.length_median},
                    {"deviation_median_m", row.deviation_median_m},
                    {"curvature_most", row.curvature_most},
                    {"time_median", row.time_median},
                    {"time_p95", row.time_p95},
                    {"gap_median_m", row.gap_median_m},
                    {"gap_least_m", row.gap_least_m},
                    {"water_median_m", row.water_median_m},
                    {"water_p05_m", row.water_p05_m},
                    {"step_median_ms", row.step.median_ms},
                    {"step_p99_ms", row.step.p99_ms},
                    {"step_worst_ms", row.step.worst_ms},
                    {"contact_runs", row.contact_runs}});
  }
  return rows;
}

int run_traffic_study(TrafficOptions& options) {
  TrafficRequest& request = options.request;
  std::vector<Section> all = sections(request);
  options.config.read_into(all);
  if (options.show_settings) {
    print_settings(all, options.json);
    return kSuccess;
  }
  for (const TrafficScenery scenery : kTrafficSceneries) {
    if (to_text(scenery) == options.scene) request.scenery = scenery;
  }
  request.known_map = options.map == "known";
  request.methods.clear();
  if (!options.methods.empty()) {
    for (const TrafficMethod method : kTrafficMethods) {
      if (std::ranges::find(options.methods, to_text(method)) != options.methods.end())
        request.methods.push_back(method);
    }
  }
  set_defaults(request);
  check_output_folder(options.out, "--out");
  const TrafficStudy study = study_traffic(request);
  make_folder(options.out);
  const std::string picture = traffic_picture(request, request.first_run, std::ranges::max(request.discs),
                                              std::ranges::max(request.max_speeds));
  write_whole_file(options.out / "traffic.png", picture);
  if (options.json) {
    nlohmann::ordered_json json{{"scene", options.scene},
                                {"map", options.map},
                                {"first_run", request.first_run},
                                {"rows", traffic_json(study)}};
    add_files(json, options.out, {"traffic.png"});
    print_json(json);
    return kSuccess;
  }
  fmt::print(
      "{}time over the time of the shortest path past still structures, median and 95 %; gap median and least; "
      "width of the widest way between the bodies, median and 5 %\n",
      traffic_table(study));
  const bool has_roads = std::ranges::any_of(study.rows, [](const TrafficRow& row) { return row.road_plans > 0; });
  if (has_roads) {
    fmt::print(
        "\n{}length over that of the shortest path; runs by the finest detail of a shape; plans, paths that do not "
        "bend enough: means of a run; runs with a step without a path\n",
        traffic_road_table(study));
  }
  fmt::print("written to {}: traffic.png\n", options.out.string());
  return kSuccess;
}

}  // namespace

Action add_traffic(CLI::App& program) {
  auto options = std::make_shared<TrafficOptions>();
  TrafficRequest& request = options->request;
  request.threads = 2;
  request.discs.clear();
  request.max_speeds.clear();
  CLI::App* command = program.add_subcommand(
      "traffic", "Cross moving traffic in random scenes; report contacts, time and planning time of each method");
  add_output_folder(*command, options->out, "Folder for the picture", "--out,-o");
  add_json_flag(*command, options->json);
  command->add_flag("--settings", options->show_settings, "Print all settings, explained, and exit")->group("Output");
  command->add_option("--scene", options->scene, "Open water, structures, or lanes of traffic")
      ->type_name("NAME")
      ->capture_default_str()
      ->check(one_of(scene_names()))
      ->group("Scenes");
  command->add_option("--map", options->map, "Whether structures are known from the start, or when they are in reach")
      ->type_name("NAME")
      ->capture_default_str()
      ->check(one_of({"known", "unknown"}))
      ->group("Scenes");
  command->add_option("--reach", request.reach_m, "Range within which bodies are seen, m")
      ->capture_default_str()
      ->check(number(1, 1000))
      ->group("Scenes");
  command->add_option("--bodies", request.discs, "Number of moving bodies; may be repeated")
      ->default_str("20, 50 and 100 in the open scene, else 10 and 20")
      ->check(whole(0, 1000))
      ->group("Scenes");
  command->add_option("--speed", request.max_speeds, "Maximum speed of the bodies, m/s; may be repeated")
      ->default_str("0.5, 1 and 1.5 in the open scene, else 1")
      ->check(number(0.01, 10))
      ->group("Scenes");
  command->add_option("--runs", request.runs, "Runs for each number of bodies and speed")
      ->capture_default_str()
      ->check(whole(1, 100'000))
      ->group("Scenes");
  command->add_option("--first-run", request.first_run, "Number of the first run, from which its scene is drawn")
      ->capture_default_str()
      ->check(whole(0, 1'000'000))
      ->group("Scenes");
  command->add_option("--planner", options->methods, "Method; may be repeated")
      ->type_name("NAME")
      ->default_str("all but search in the open scene, else planner and search")
      ->check(one_of(method_names()))
      ->group("Scenes");
  command->add_option("--threads", request.threads, "Runs in parallel; the results are the same")
      ->capture_default_str()
      ->check(whole(1, 64))
      ->group("Scenes");
  const auto names = [] {
    TrafficRequest defaults;
    return setting_names(sections(defaults));
  };
  options->config.add_to(*command, names, "planner.margin=0.5; isobath traffic --settings lists all");
  add_example(*command, "traffic --runs 20");
  add_example(*command, "traffic --bodies 100 --speed 1.5 --planner planner --planner orca --json");
  add_example(*command, "traffic --scene quay --runs 50");
  add_example(*command, "traffic --set vehicle.min_speed=0.8 --runs 50");
  return [options] { return run_traffic_study(*options); };
}

}  // namespace isobath::app
