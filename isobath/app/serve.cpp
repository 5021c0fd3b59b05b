#include <cstdio>
#include <fmt/format.h>
#include <future>
#include <isobath/app/group_results.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/run_json.hpp>
#include <isobath/app/run_options.hpp>
#include <isobath/app/speed.hpp>
#include <isobath/app/values.hpp>
#include <isobath/app/vehicle_page.hpp>
#include <isobath/base/error.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/base/printable_text.hpp>
#include <isobath/display/live_page.hpp>
#include <isobath/recording/recorded_playback.hpp>
#include <isobath/report/mission_pages.hpp>
#include <isobath/report/result_text.hpp>
#include <isobath/run/group_run.hpp>
#include <isobath/run/run.hpp>
#include <isobath/server/page_site.hpp>
#include <isobath/server/web_server.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

namespace isobath::app {
namespace {

struct ServeOptions : RunOptions {
  std::string speed;
  PageOptions page;
  bool anew = false, live = false, json = false;
};

/// The default is 4 for the embedded scene, whose sonar takes 12 s for its first turn, else 1.
std::string speed_words(const ServeOptions& options) {
  if (!options.speed.empty()) return options.speed;
  return options.request.input.empty() ? "4" : "1";
}

std::string input_words(const ServeOptions& options) {
  if (!options.conditions().empty()) return printable_text(options.conditions(), 1000);
  return options.request.input.empty() ? "the embedded scene" : options.request.input.string();
}

/// Says where the page is; the first line of --json.
void announce(const ServeOptions& options, const std::string& place, int port, bool recorded) {
  if (options.json) {
    const double pace = recorded ? 0 : speed_of(speed_words(options));
    print_json_line({{"event", "serving"},
                     {"url", place},
                     {"port", port},
                     {"input", options.request.input.string()},
                     {"recorded", recorded},
                     {"live", options.live},
                     {"speed", pace > 0 ? nlohmann::ordered_json(pace) : nlohmann::ordered_json()}});
  } else if (recorded) {
    fmt::print("{} shows {}; press Ctrl-C to end\n", place, input_words(options));
  } else {
    fmt::print("{} shows {}{}, speed {}; press Ctrl-C to end\n", place, input_words(options),
               options.live ? " live" : "", speed_words(options));
  }
  std::fflush(stdout);
}

/// The results of the run; the second line of --json.
void print_end(const ServeOptions& options, const RunOutcome& outcome) {
  const RunRequest& request = options.request;
  if (options.json) {
    nlohmann::ordered_json json{{"event", "finished"}, {"stopped", is_interrupted()}};
    json.update(run_json(request, outcome));
    return print_json_line(json);
  }
  if (outcome.mission) {
    for (const std::string& line : mission_summary(*outcome.mission))
      fmt::print("{}\n", printable_text(line, 2 * kMaxForeignText));
  }
  if (outcome.live) fmt::print("{}\n", live_text(*outcome.live));
  fmt::print("written to {}: report.html, {} and more\n", request.out.string(), request.record.filename().string());
  if (!is_interrupted()) fmt::print("the run is over; its page stays up\n");
  std::fflush(stdout);
}

void print_group_end(const ServeOptions& options, const GroupOutcome& outcome) {
  if (options.json) {
    nlohmann::ordered_json json{{"event", "finished"}, {"stopped", is_interrupted()}};
    json.update(group_results_json(options.request, outcome));
    return print_json_line(json);
  }
  print_group_results(options.request, outcome);
  if (!is_interrupted()) fmt::print("the run is over; its pages stay up\n");
  std::fflush(stdout);
}

/// Serves the page of a recording; nothing runs.
int serve_recording(const ServeOptions& options, const WebServerConfig& config) {
  const std::filesystem::path file = options.request.input;
  { const RecordedPlayback readable(file); }  // throws now if the file cannot be read
  PageSources sources;
  sources.open_playback = [file] { return std::make_unique<RecordedPlayback>(file); };
  sources.version = ISOBATH_VERSION;
  check_page_sources(sources);
  WebServer server(config, page_site(sources));
  announce(options, place_of(config, server.port()), server.port(), true);
  wait_for_interrupt();
  return kSuccess;
}

/// The result of a run of one vehicle or of a group.
struct ServedRun {
  RunOutcome alone;
  std::optional<GroupOutcome> group;
};

ServedRun run_watched(RunRequest& request, const std::optional<Scenario>& group, std::span<const RunWatch> watches) {
  if (group) return {{}, run_group(request, *group, watches)};
  request.watch = watches.front();
  return {run(request), std::nullopt};
}

int serve_run(ServeOptions& options, const WebServerConfig& config) {
  RunRequest& request = options.read();
  if (request.record.empty()) request.record = request.out / "recording.mcap";
  check_output_is_no_input(request.record, {request.input}, "--record");
  make_parent(request.record);
  const double speed = speed_of(speed_words(options));
  if (options.live) request.live_speed = speed;
  const std::optional<Scenario> group = vehicle_group_of(request);
  const std::string token = options.page.token();
  std::vector<std::unique_ptr<VehiclePage>> pages;
  std::vector<const PageSources*> sources;
  std::vector<RunWatch> watches;
  for (std::size_t v = 0; v < (group ? group->mission.group.size() : 1); ++v) {
    VehiclePage& page = *pages.emplace_back(std::make_unique<VehiclePage>());
    const auto record = group ? file_of_vehicle(request.record, group->mission.group[v].name) : request.record;
    sources.push_back(&page.sources(record, token, speed));
    watches.push_back(page.watch(options.live ? 0 : speed));
  }

  WebServer server(config, page_site(sources));  // first, so that an address in use fails before the run
  std::future<ServedRun> running = std::async(std::launch::async, [&] { return run_watched(request, group, watches); });
  announce(options, place_of(config, server.port()), server.port(), false);
  while (running.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) continue;
  for (const auto& page : pages) page->close();
  ServedRun served;
  try {
    served = running.get();
  } catch (...) {
    server.stop();
    throw;
  }
  int code = kSuccess;  // a run that the user stopped has not failed
  if (served.group) {
    print_group_end(options, *served.group);
    if (!is_interrupted()) code = conclude_group(*served.group);
  } else {
    print_end(options, served.alone);
    if (!is_interrupted()) code = conclude(request, served.alone);
  }
  wait_for_interrupt();
  server.stop();
  return code;
}

int serve(ServeOptions& options) {
  if (live_page().empty())
    throw Error("this program was built without the live page", {}, "", "build it with ISOBATH_PAGE=ON");
  const WebServerConfig config = options.page.server();
  listen_for_interrupt();
  const bool recorded = !options.anew && !options.live && is_recording(options.request.input);
  return recorded ? serve_recording(options, config) : serve_run(options, config);
}

}  // namespace

Action add_serve(CLI::App& program) {
  auto options = std::make_shared<ServeOptions>();
  CLI::App* command =
      program.add_subcommand("serve", "Run like isobath run and show the live page, or show a recording");
  command->add_option("INPUT", options->request.input, "Log, scene (.toml) or recording (.mcap)")
      ->check(reads())
      ->default_str("the embedded scene");
  options->add_to(*command, "out/serve");
  options->add_suite_to(*command);
  command
      ->add_flag("--json", options->json, "JSON on standard output: a line when the page is up, another after the run")
      ->group("Output");
  options->page.add_to(*command);
  command->add_option("--speed", options->speed, "A multiple of real time, or max")
      ->type_name("FACTOR")
      ->check(speed())
      ->default_str("1, for the embedded scene 4")
      ->group("Run");
  command->add_flag("--live", options->live, "Run the scene's mission with real threads, as on a vehicle")
      ->group("Run");
  command->add_flag("--anew", options->anew, "Run a recording again instead of showing what was recorded")
      ->group("Run");
  add_example(*command, "serve");
  add_example(*command, "serve scenarios/simulated_mission_1.toml --speed 2 --port 0");
  add_example(*command, "serve --suite pandan --set simulation.seed=7");
  add_example(*command, "serve out/serve/recording.mcap");
  return [options] { return serve(*options); };
}

}  // namespace isobath::app
