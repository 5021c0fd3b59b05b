#include <fmt/format.h>
#include <isobath/app/config_options.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/settings_json.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/studies/helix_pictures.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

struct HelixOptions {
  HelixRequest request;
  SettingOptions config;
  std::filesystem::path out = "out/helix";
  std::optional<double> width, height, from, speed;
  std::optional<std::string> vehicle;
  bool show_settings = false;
  bool json = false;
};

/// Applies the file, then the settings in their order, then the options.
void read_settings(HelixOptions& options) {
  HelixRequest& request = options.request;
  std::vector<Section> all = sections(request);
  options.config.read_into(all);
  const auto set = [&](const char* key, const std::optional<double>& value) {
    if (value) set_from_text(fmt::format("approach.{}={}", key, *value), all, fmt::format("--{}", key));
  };
  set("width", options.width);
  set("height", options.height);
  set("from", options.from);
  set("speed", options.speed);
  if (options.vehicle) request.vehicle = *options.vehicle;
}

int fly(HelixOptions& options) {
  read_settings(options);
  if (options.show_settings) {
    print_settings(sections(options.request), options.json);
    return kSuccess;
  }
  check_output_folder(options.out, "--out");
  const HelixStudy study = study_helix(options.request);
  const auto files = write_helix_report(study, options.out);
  const double known = study.helix.view.known_share();
  if (options.json) {
    nlohmann::ordered_json json{{"known_share", known},
                                {"known_share_straight", study.straight.view.known_share()},
                                {"free_share", study.helix.free_share_at(study.helix.leave_m)},
                                {"free_share_straight", study.straight.free_share_at(study.helix.leave_m)},
                                {"bits_a_voxel", study.helix.samples.back().bits_a_voxel},
                                {"bits_a_voxel_straight", study.straight.samples.back().bits_a_voxel},
                                {"decision", to_text(study.helix.samples.back().phase)},
                                {"decision_m", study.helix.leave_m},
                                {"latest_decision_m", study.latest_decision_m},
                                {"nearest_m", study.helix.nearest_m},
                                {"vertical_rms_m", study.helix.vertical_rms_m},
                                {"lateral_rms_m", study.helix.lateral_rms_m}};
    const Swing swing = swing_of(study.helix);
    json["swing"] = {{"heading_first_deg", swing.heading_first.degrees()},
                     {"heading_second_deg", swing.heading_second.degrees()},
                     {"pitch_first_deg", swing.pitch_first.degrees()},
                     {"pitch_second_deg", swing.pitch_second.degrees()},
                     {"correlation", swing.correlation}};
    json["opening"] = nlohmann::ordered_json::array();
    for (const SeenOpening& seen : seen_openings(study)) {
      json["opening"].push_back({{"distance_m", seen.distance_m},
                                 {"horizontal_deg", seen.angles.horizontal.degrees()},
                                 {"vertical_deg", seen.angles.vertical.degrees()}});
    }
    json["convergence"] = nlohmann::ordered_json::array();
    for (const Convergence& one : study.convergence) {
      json["convergence"].push_back({{"first_m", one.off_m.front()},
                                     {"last_m", one.off_m.back()},
                                     {"seconds", one.time_s.back()},
                                     {"greatest_rise", one.greatest_rise}});
    }
    add_files(json, options.out, files);
    print_json(json);
  } else {
    for (const auto& [what, value] : helix_facts(study)) fmt::print("{:<40}  {}\n", what, value);
    fmt::print("written to {}: report.html and {} pictures\n", options.out.string(), files.size() - 1);
  }
  return known >= options.request.helix.pass_share ? kSuccess : kFailedChecks;
}

}  // namespace

Action add_helix(CLI::App& program) {
  auto options = std::make_shared<HelixOptions>();
  const HelixRequest& defaults = options->request;
  CLI::App* command = program.add_subcommand(
      "helix", "Approach an opening on a helix and on a straight line; report what a pair of fans sees of it");
  add_output_folder(*command, options->out, "Folder for the results", "--out,-o");
  add_json_flag(*command, options->json);
  command->add_flag("--settings", options->show_settings, "Print all settings, explained, and exit")->group("Output");
  const auto approach = [&](const char* name, std::optional<double>& value, const char* text, double unless_given) {
    command->add_option(name, value, text)
        ->check(number(-INFINITY, INFINITY))
        ->default_str(fmt::format("{:g}", unless_given))
        ->group("Approach");
  };
  approach("--width", options->width, "Width of the opening, m", defaults.width_m);
  approach("--height", options->height, "Height of the opening, surface to bottom, m", defaults.height_m);
  approach("--from", options->from, "Start of the approach, m before the opening", defaults.from_m);
  approach("--speed", options->speed, "Speed, m/s", defaults.speed);
  command->add_option("--vehicle", options->vehicle, "Vehicle file (.toml)")
      ->type_name("FILE")
      ->check(reads())
      ->default_str("the embedded vehicle")
      ->group("Approach");
  const auto names = [] {
    HelixRequest request;
    return setting_names(sections(request));
  };
  options->config.add_to(*command, names, "helix.advance=4; isobath helix --settings lists all");
  add_example(*command, "helix --width 20 --from 80 --out out/gate");
  add_example(*command, "helix --set helix.advance=4 --json");
  add_example(*command, "helix --vehicle vehicles/remus100.toml");
  return [options] { return fly(*options); };
}

}  // namespace isobath::app
