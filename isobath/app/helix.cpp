#include <fmt/format.h>
#include <isobath/app/commands.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/studies/helix_pictures.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

struct HelixOptions {
  HelixRequest request;
  std::string config;
  std::vector<std::string> settings;
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
  if (!options.config.empty()) read_toml(text_of_file(options.config), options.config, all);
  for (const std::string& setting : options.settings) set_from_text(setting, all);
  const auto set = [&](const char* key, const std::optional<double>& value) {
    if (value) set_from_text(fmt::format("approach.{}={}", key, *value), all);
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
    fmt::print("{}", write_toml(sections(options.request), true));
    return kSuccess;
  }
  const HelixStudy study = study_helix(options.request);
  const auto files = write_helix_report(study, options.out);
  const double known = study.helix.view.known_share();
  if (options.json) {
    nlohmann::ordered_json json{{"known_share", known},
                                {"known_share_straight", study.straight.view.known_share()},
                                {"bits_a_voxel", study.helix.samples.back().bits_a_voxel},
                                {"bits_a_voxel_straight", study.straight.samples.back().bits_a_voxel},
                                {"decision", to_text(study.helix.samples.back().phase)},
                                {"decision_m", study.helix.leave_m},
                                {"latest_decision_m", study.latest_decision_m},
                                {"nearest_m", study.helix.nearest_m},
                                {"vertical_rms_m", study.helix.vertical_rms_m},
                                {"lateral_rms_m", study.helix.lateral_rms_m}};
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
  CLI::App* command = program.add_subcommand(
      "helix", "Approach an opening on a helix and on a straight line; report what a pair of fans sees of it");
  command->add_option("--out,-o", options->out, "Folder for the results")->capture_default_str();
  command->add_option("--width", options->width, "Width of the opening, m; default: 25");
  command->add_option("--height", options->height, "Height of the opening, surface to bottom, m; default: 8");
  command->add_option("--from", options->from, "Start of the approach, m before the opening; default: 60");
  command->add_option("--speed", options->speed, "Speed, m/s; default: 1.5");
  command->add_option("--vehicle", options->vehicle, "Vehicle file; default: the embedded vehicle");
  command->add_option("--config", options->config, "TOML file with settings")->type_name("FILE");
  command->add_option("--set", options->settings, "One setting, e.g. --set helix.advance=4; may be repeated")
      ->type_name("SECTION.KEY=VALUE")
      ->allow_extra_args(false);
  command->add_flag("--settings", options->show_settings, "Print all settings, annotated, and exit");
  command->add_flag("--json", options->json, "One JSON object on standard output");
  return [options] { return fly(*options); };
}

}  // namespace isobath::app
