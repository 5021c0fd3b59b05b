#include <fmt/format.h>
#include <isobath/app/config_options.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/settings_json.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/studies/track_study.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

struct TrackOptions {
  TrackRequest request;
  SettingOptions config;
  std::filesystem::path out = "out/tracks";
  bool show_settings = false;
  bool json = false;
};

nlohmann::ordered_json score_json(const TrackScore& score) {
  return {{"asked", score.asked},
          {"held", score.held},
          {"switches", score.switches},
          {"velocities", score.velocities},
          {"velocity_error_rms", score.velocity_rms},
          {"velocity_error_median", score.velocity_median},
          {"still", score.still},
          {"still_moving", score.still_moving},
          {"false_tracks", score.false_tracks},
          {"ospa_m", score.ospa_m}};
}

void print_score(const char* name, const TrackScore& score) {
  const double held = score.asked > 0 ? 100.0 * static_cast<double>(score.held) / static_cast<double>(score.asked) : 0;
  fmt::print("{:18}  {:5.1f} %  {:8}  {:12.2f}  {:15.2f}  {:>12}  {:12.2f}  {:7.2f}\n", name, held, score.switches,
             score.velocity_median, score.velocity_rms, fmt::format("{} of {}", score.still_moving, score.still),
             score.false_tracks, score.ospa_m);
}

void print_tracks(const TrackStudy& study, int most_readings, const std::filesystem::path& out,
                  const std::vector<std::filesystem::path>& files) {
  const std::size_t still = static_cast<std::size_t>(std::ranges::count_if(study.courses, &TrackCourse::lies_still));
  fmt::print("{} positions: {} tracks, {} of them of bodies that lie still at last\n", study.table.rows.size(),
             study.courses.size(), still);
  for (const auto& [reason, rows] : study.table.left_out) fmt::print("left out {}: {}\n", rows, reason);
  if (study.table.out_of_order > 0) {
    fmt::print("{} positions are earlier than one above them in the table; they were sorted by time\n",
               study.table.out_of_order);
  }
  if (study.counts.above_max_readings > 0) {
    fmt::print("left out {}: more than {} positions of one time\n", study.counts.above_max_readings, most_readings);
  }
  if (study.counts.above_max_tracks > 0)
    fmt::print("gave up {} tracks, to bound the work\n", study.counts.above_max_tracks);
  if (!study.table.names.empty()) {
    fmt::print("{} bodies are named, {} of {} positions asked for\n", study.table.names.size(), study.score.asked,
               study.table.rows.size());
    fmt::print(
        "tracker                held  switches  median error  rms error, m/s  still, moves  false tracks  OSPA, m\n");
    print_score("isobath", study.score);
    print_score("nearest neighbour", study.nearest);
  }
  fmt::print("written to {}:", out.string());
  for (const auto& file : files) fmt::print(" {}", file.string());
  fmt::print("\n");
}

int follow(TrackOptions& options) {
  TrackRequest& request = options.request;
  std::vector<Section> all = sections(request);
  options.config.read_into(all);
  if (options.show_settings) {
    print_settings(sections(request), options.json);
    return kSuccess;
  }
  check_output_folder(options.out, "--out");
  const TrackStudy study = study_tracks(request);
  const auto files = write_tracks(study, options.out);
  if (!options.json) {
    print_tracks(study, request.tracker.max_readings, options.out, files);
    return kSuccess;
  }
  nlohmann::ordered_json json{{"positions", study.table.rows.size()}, {"bodies", study.table.names.size()}};
  json["left_out"] = nlohmann::ordered_json::object();
  for (const auto& [reason, rows] : study.table.left_out) json["left_out"][reason] = rows;
  json["out_of_order"] = study.table.out_of_order;
  json["readings_left_out"] = study.counts.above_max_readings;
  json["tracks_left_out"] = study.counts.above_max_tracks;
  json["tracks"] = nlohmann::ordered_json::array();
  for (const TrackCourse& course : study.courses) {
    json["tracks"].push_back({{"number", course.number},
                              {"readings", course.times.size()},
                              {"from_s", to_seconds(course.times.front())},
                              {"to_s", to_seconds(course.times.back())},
                              {"velocity", {course.velocity_W.x(), course.velocity_W.y()}},
                              {"still_probability", course.share_still}});
  }
  if (!study.table.names.empty()) {
    json["score"] = score_json(study.score);
    json["nearest_neighbour"] = score_json(study.nearest);
  }
  add_files(json, options.out, files);
  print_json(json);
  return kSuccess;
}

}  // namespace

Action add_track(CLI::App& program) {
  auto options = std::make_shared<TrackOptions>();
  CLI::App* command = program.add_subcommand(
      "track", "Make tracks of bodies from a table of their positions; where it names them, score the tracks");
  command->add_option("FILE", options->request.file, "Table of time and position, such as AIS reports (.csv)")
      ->type_name("FILE")
      ->check(reads());
  add_output_folder(*command, options->out, "Folder for the tracks", "--out,-o");
  add_json_flag(*command, options->json);
  command->add_flag("--settings", options->show_settings, "Print all settings, explained, and exit")->group("Output");
  const auto names = [] {
    TrackRequest request;
    return setting_names(sections(request));
  };
  options->config.add_to(*command, names, "motion.max_speed=20; isobath track --settings lists all");
  add_example(*command, "track contacts.csv --out out/contacts");
  add_example(*command, "track ais.csv --set positions.sigma_m=10 --set motion.max_speed=20 --json");
  return [options] { return follow(*options); };
}

}  // namespace isobath::app
