#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <fstream>
#include <future>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/run_json.hpp>
#include <isobath/app/run_options.hpp>
#include <isobath/app/values.hpp>
#include <isobath/app/vehicle_page.hpp>
#include <isobath/base/error.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/base/printable_text.hpp>
#include <isobath/links/vehicle_links.hpp>
#include <isobath/report/mission_pages.hpp>
#include <isobath/report/result_text.hpp>
#include <isobath/run/aboard.hpp>
#include <isobath/run/run.hpp>
#include <isobath/studies/control_study.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

namespace isobath::app {
namespace {

struct AboardCommand : RunOptions {
  PageOptions page;
  double speed = 1;
  bool dry_run = false, until_done = false, no_page = false, format = false, json = false;
};

constexpr std::chrono::milliseconds kLook{50}, kNews{5000};

void say(const AboardCommand& options, const std::string& line) {
  if (options.json) return;
  fmt::print("{}\n", printable_text(line, 2 * kMaxForeignText));
  std::fflush(stdout);
}

/// What the run still waits for; empty: nothing.
std::string missing(VehicleLinks& links) {
  const VehicleFile& file = links.file();
  if (file.mission_from == VehicleFile::MissionFrom::kNone) return {};
  const FrontSeat& autopilot = links.autopilot();
  const bool moos = file.autopilot.kind == FrontSeatKind::kMoos;
  if (autopilot.authority() == Authority::kNoAutopilot)
    return fmt::format("the {}, at {}", moos ? "MOOSDB" : "autopilot", file.autopilot.link);
  if (!autopilot.origin()) {
    return moos ? "the origin of the local grid: write latitude_deg and longitude_deg into [autopilot]"
                : "the position of the autopilot: it has not stated its origin";
  }
  if (file.mission_from == VehicleFile::MissionFrom::kAutopilot && !autopilot.mission())
    return "the mission of the autopilot";
  return {};
}

/// Waits until the autopilot has told all that the run needs. Returns false if the user ends the program first.
bool wait_for_autopilot(const AboardCommand& options, VehicleLinks& links) {
  if (links.file().mission_from == VehicleFile::MissionFrom::kAutopilot) links.autopilot().want_mission();
  std::string told;
  auto since = std::chrono::steady_clock::now();
  for (;;) {
    const std::string now = missing(links);
    if (now.empty()) {
      links.source().drop_waiting();
      return true;
    }
    if (is_interrupted()) return false;
    if (now != told || std::chrono::steady_clock::now() - since > kNews) {
      say(options, "waits for " + now);
      told = now;
      since = std::chrono::steady_clock::now();
    }
    std::this_thread::sleep_for(kLook);
  }
}

/// The state of the front seat, and when Isobath steers.
std::string steering_text(const AboardCommand& options, VehicleLinks& links) {
  const bool moos = links.file().autopilot.kind == FrontSeatKind::kMoos;
  const char* const when = moos ? "while it is false" : "while it is armed and in GUIDED";
  return fmt::format("{} {}; {}", moos ? "the MOOSDB states" : "the autopilot is in", links.autopilot().mode(),
                     options.dry_run ? "a dry run: nothing is commanded" : fmt::format("Isobath steers {}", when));
}

/// The mission file of the run; empty: none.
std::filesystem::path mission_of(const AboardCommand& options, VehicleLinks& links) {
  const VehicleFile& file = links.file();
  if (!options.request.mission.empty()) return options.request.mission;
  switch (file.mission_from) {
    case VehicleFile::MissionFrom::kNone: return {};
    case VehicleFile::MissionFrom::kFile: return options.request.input.parent_path() / file.mission_file;
    case VehicleFile::MissionFrom::kAutopilot: break;
  }
  const std::filesystem::path plan = options.request.out / "autopilot.plan";
  std::filesystem::create_directories(options.request.out);
  write_whole_file(plan, *links.autopilot().mission());
  return plan;
}

nlohmann::ordered_json aboard_json(const AboardOutcome& aboard) {
  nlohmann::ordered_json devices = nlohmann::ordered_json::array();
  for (const auto& device : aboard.devices)
    devices.push_back({{"name", device.name}, {"heard", device.heard}, {"losses", device.losses}});
  const StageTime& latency = aboard.ping_to_setpoint;
  return {{"setpoints", aboard.setpoints},
          {"withheld", aboard.withheld},
          {"damaged", aboard.damaged},
          {"ping_to_setpoint",
           {{"count", latency.count},
            {"median_ms", latency.median_ms},
            {"p99_ms", latency.p99_ms},
            {"worst_ms", latency.worst_ms}}},
          {"devices", devices}};
}

void print_results(const AboardCommand& options, const RunOutcome& outcome) {
  if (options.json) {
    nlohmann::ordered_json json{{"event", "finished"}, {"stopped", is_interrupted()}};
    json.update(run_json(options.request, outcome));
    json["aboard"] = aboard_json(*outcome.aboard);
    return print_json_line(json);
  }
  if (outcome.mission) {
    for (const std::string& line : mission_summary(*outcome.mission)) say(options, line);
  }
  const AboardOutcome& aboard = *outcome.aboard;
  const StageTime& latency = aboard.ping_to_setpoint;
  say(options, fmt::format("{} set-points sent, {} withheld", aboard.setpoints, aboard.withheld));
  if (latency.count > 0) {
    say(options, fmt::format("from the last byte of a ping to the set-point: median {:.1f} ms, 99 % {:.1f} ms, worst "
                             "{:.1f} ms of {}",
                             latency.median_ms, latency.p99_ms, latency.worst_ms, latency.count));
  }
  for (const auto& device : aboard.devices) {
    if (!device.heard) say(options, device.name + ": nothing was heard of it");
    if (device.losses > 0) say(options, fmt::format("{}: its link was lost {} times", device.name, device.losses));
  }
  if (outcome.live) say(options, live_text(*outcome.live));
  say(options, fmt::format("written to {}: report.html, {} and more", options.request.out.string(),
                           options.request.record.filename().string()));
}

/// The page, while it is wanted and built.
class Page {
 public:
  Page(const AboardCommand& options, const std::filesystem::path& record) {
    if (options.no_page) return;
    const WebServerConfig config = options.page.server();

    server_.emplace(config, page_site(page_.sources(record, options.page.token(), options.speed)));
    place_ = place_of(config, server_->port());
  }
  [[nodiscard]] RunWatch watch() { return page_.watch(0); }
  [[nodiscard]] const std::string& place() const { return place_; }
  void close() {
    page_.close();
    if (server_) server_->stop();
  }

 private:
  VehiclePage page_;
  std::optional<WebServer> server_;
  std::string place_;
};

int aboard(AboardCommand& options) {
  if (options.format) {
    fmt::print("{}", vehicle_file_template());
    return kSuccess;
  }
  if (options.request.input.empty()) throw Error("no vehicle file", {}, "", "make one with: isobath aboard --format");
  RunRequest& request = options.read();
  if (request.record.empty()) request.record = request.out / "recording.mcap";
  check_output_is_no_input(request.record, {request.input}, "--record");
  make_parent(request.record);
  constexpr double kPlacedAtOnce_s = 0.15;  // a fix of the autopilot comes every 0.1 s
  double& extrapolate_s = request.configuration.poses.extrapolate_s;
  if (extrapolate_s < 0) extrapolate_s = kPlacedAtOnce_s;
  const VehicleFile file = load_vehicle_file(request.input.string());
  VehicleParameters vehicle = parameters_of(control_vehicle(file.model));
  if (file.autopilot.kind == FrontSeatKind::kMoos) vehicle.can_sway = false;  // MOOS has no variable for it
  listen_for_interrupt();
  // The clock of stand-ins that run n times as fast leaves an agent a n-th of the time for its turn.
  int& missed_ticks = request.configuration.executor.missed_ticks;
  missed_ticks = static_cast<int>(std::lround(missed_ticks * std::max(1.0, options.speed)));
  VehicleLinks links(file, options.speed);
  links.start();
  if (!wait_for_autopilot(options, links)) return kSuccess;
  request.mission = mission_of(options, links);
  Aboard aboard(links, vehicle, {.commands = !options.dry_run, .ends_with_mission = options.until_done});
  request.aboard = &aboard;
  Page page(options, request.record);
  request.watch = page.watch();
  if (options.json) {
    print_json_line({{"event", "aboard"}, {"url", page.place()}, {"mode", links.autopilot().mode()}});
  } else {
    if (!page.place().empty()) say(options, page.place() + " shows the vehicle; press Ctrl-C to end");
    say(options, steering_text(options, links));
  }
  std::future<RunOutcome> running = std::async(std::launch::async, [&] { return run(request); });
  while (running.wait_for(kLook) != std::future_status::ready) {
    if (is_interrupted()) links.source().end();
  }
  const RunOutcome outcome = running.get();
  page.close();
  print_results(options, outcome);
  return is_interrupted() ? kSuccess : conclude(request, outcome);
}

}  // namespace

Action add_aboard(CLI::App& program) {
  auto options = std::make_shared<AboardCommand>();
  CLI::App* command = program.add_subcommand(
      "aboard", "Run on a vehicle: hear its sonars, steer it through its autopilot, record and show it");
  command->add_option("VEHICLE", options->request.input, "Vehicle file (.toml): autopilot, devices, mission")
      ->check(reads());
  options->add_to(*command, "out/aboard");
  command->add_flag("--dry-run", options->dry_run, "Hear and decide, but command nothing")->group("Run");
  command->add_flag("--until-done", options->until_done, "End when the mission is over")->group("Run");
  command->add_option("--speed", options->speed, "How many times as fast as the clock the devices run; for stand-ins")
      ->check(number(0.1, 100.0))
      ->capture_default_str()
      ->group("Run");
  command->add_flag("--no-page", options->no_page, "Do not serve the live page")->group("Page");
  options->page.add_to(*command);
  command->add_flag("--format", options->format, "Print a vehicle file with all settings, and end")->group("Output");
  command->add_flag("--json", options->json, "JSON on standard output: a line at the start, another after the run")
      ->group("Output");
  add_example(*command, "aboard vehicle.toml --dry-run");
  add_example(*command, "aboard --format");
  return [options] { return aboard(*options); };
}

}  // namespace isobath::app
