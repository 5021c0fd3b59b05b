#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <isobath/app/answers.hpp>
#include <isobath/app/commands.hpp>
#include <isobath/app/echo_picture.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/values.hpp>
#include <isobath/app/vehicle_page.hpp>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/base/printable_text.hpp>
#include <isobath/links/device_search.hpp>
#include <isobath/links/mounting_check.hpp>
#include <isobath/links/vehicle_file.hpp>
#include <isobath/studies/control_study.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

namespace isobath::app {
namespace {

namespace fs = std::filesystem;

struct SetupCommand {
  fs::path file = "vehicle.toml";
  std::vector<std::string> tries, answers, walls;
  double search_s = 4, speed = 1;
  bool no_usual = false, yes = false, overwrite = false;
};

constexpr double kTrial_s = 3, kLongestSweep_s = 40, kShowInterval_s = 3;
constexpr int kPictureRows = 21;

void say(const std::string& line) {
  fmt::print("{}\n", printable_text(line, 2 * kMaxForeignText));
  std::fflush(stdout);
}

/// "40,12": bearing in degrees, range in m.
KnownWall wall_of(const std::string& text) {
  const Eigen::Vector2d pair = pair_of(text);
  if (!(std::abs(pair.x()) <= 360 && pair.y() > 0))
    throw Error(text + ": no bearing and range of a wall", {"--wall"}, "40,12: degrees from the bow, m");
  return {Angle::degrees(pair.x()).wrapped(), pair.y()};
}

/// Sets `NAME.KEY`, as the answers have it, in the configuration of a device.
class DeviceQuestions {
 public:
  DeviceQuestions(DeviceConfig& device, Answers& answers) : device_(device), answers_(answers) {}

  /// All settings that were answered, asked or not.
  void take_given() {
    for (const Field& field : fields(device_)) {
      if (const auto answer = answers_.given(key(field.name()))) set(field.name(), *answer);
    }
  }
  void ask(const std::string& setting, const std::string& question) {
    const auto all = fields(device_);
    const auto field = std::ranges::find(all, setting, &Field::name);
    const std::string answer = answers_.ask(key(setting), device_.called() + ": " + question, field->value());
    if (answer != field->value()) set(setting, answer);
  }

 private:
  [[nodiscard]] std::string key(const std::string& setting) const { return device_.called() + "." + setting; }
  void set(const std::string& setting, std::string value) {
    if (setting == "position_m" && !value.starts_with('[')) value = "[" + value + "]";
    std::vector<Section> section{{device_.called(), "", fields(device_)}};
    set_from_text(key(setting) + "=" + value, section, "--answer");
  }
  DeviceConfig& device_;
  Answers& answers_;
};

void ask_about(DeviceConfig& device, Answers& answers, bool has_autopilot) {
  DeviceQuestions questions(device, answers);
  if (device.scans()) device.sector = Angle::degrees(120);
  if (device.kind == DeviceKind::kNmea) device.navigation = !has_autopilot;
  questions.take_given();
  questions.ask("position_m", "position, metres forward, starboard and down of the vehicle's reference point");
  if (device.images()) {
    questions.ask("heading_deg", "direction of its zero bearing, degrees from the bow to starboard");
    questions.ask("range_m", "range, m");
  }
  if (device.scans()) {
    questions.ask("upside_down", "does it hang upside down (true or false)");
    questions.ask("sector_deg", "sector that it sweeps, degrees");
  }
  if (device.kind == DeviceKind::kOculus) {
    questions.ask("pitch_deg", "upward tilt, degrees");
    questions.ask("roll_deg", "roll, degrees; 180: upside down");
  }
  if (device.kind == DeviceKind::kPing1D) questions.ask("looks", "does it look ahead or down (ahead, down or usual)");
  if (device.kind == DeviceKind::kDvlA50 || device.kind == DeviceKind::kNmea)
    questions.ask("navigation", "does it give the vehicle's navigation in place of the autopilot (true or false)");
}

/// A sonar as it looks around: all that it can see.
DeviceConfig looking_around(DeviceConfig config) {
  if (config.scans()) {
    config.sector = Angle::degrees(360);
    config.middle = {};
  }
  return config;
}

void show(const EchoPanorama& echoes) {
  say(fmt::format("echoes up to {:.0f} m, seen from above, the bow up:", echoes.reach_m()));
  for (const std::string& line : echo_picture(echoes, kPictureRows)) say("  " + line);
}

/// One turn of a scanning head, or a few pings of a fan; in a terminal with pictures meanwhile.
EchoPanorama look_around(const DeviceConfig& config, double speed) {
  DeviceTrial trial(looking_around(config), speed);
  EchoPanorama echoes;
  const bool live = ::isatty(STDOUT_FILENO) != 0;
  double shown_s = 0;
  int pings = 0;
  while (!is_interrupted() && trial.age_s() < kLongestSweep_s) {
    const auto event = trial.next();
    if (live && pings > 0 && trial.age_s() - shown_s > kShowInterval_s) {
      shown_s = trial.age_s();
      show(echoes);
    }
    const auto* ping = event ? std::get_if<Ping>(&*event) : nullptr;
    if (!ping) continue;
    // The head takes a moment until it looks as it was told.
    if (std::abs(ping->window.end_m() - config.range_m) > 0.1 * config.range_m && trial.age_s() < kTrial_s) continue;
    echoes.add(*ping);
    ++pings;
    if (config.scans() ? echoes.heard() >= 0.99 : pings >= 5) break;
  }
  return echoes;
}

void check_device(DeviceConfig& device, const std::vector<KnownWall>& walls, Answers& answers, double speed) {
  say(fmt::format("{} looks around", device.called()));
  const EchoPanorama echoes = look_around(device, speed);
  if (echoes.reach_m() <= 0) return say("  nothing came");
  show(echoes);
  if (walls.empty()) return say("  its mounting is not checked: no wall was named");
  std::vector<std::optional<EchoPanorama::Echo>> seen;
  for (const KnownWall& wall : walls) seen.push_back(echoes.wall_at(wall.range_m));
  const MountingVerdict verdict = check_mounting(device, walls, seen);
  for (const std::string& remark : verdict.remarks) say("  " + remark);
  using Kind = MountingVerdict::Kind;
  if (verdict.kind == Kind::kRight || verdict.kind == Kind::kUnclear) return;
  const std::string answer =
      answers.ask(device.called() + ".correct", "correct the settings so (true or false)", "true");
  if (answer == "true") device = verdict.proposed;
}

/// What was found, each device with the settings of the program.
VehicleFile found_vehicle(const std::vector<Speaker>& speakers, bool& has_autopilot) {
  VehicleFile vehicle;
  has_autopilot = false;
  std::map<std::string, int> of_kind;
  for (const Speaker& speaker : speakers) {
    if (!speaker.device) {
      if (!std::exchange(has_autopilot, true)) vehicle.autopilot.link = speaker.link;
      continue;
    }
    DeviceConfig device;
    device.kind = *speaker.device;
    device.link = speaker.link;
    const int number = ++of_kind[to_text(device.kind)];
    if (number > 1) device.name = fmt::format("{}-{}", to_text(device.kind), number);
    vehicle.devices.push_back(device);
  }
  vehicle.mission_from = has_autopilot ? VehicleFile::MissionFrom::kAutopilot : VehicleFile::MissionFrom::kNone;
  return vehicle;
}

VehicleFile search(const SetupCommand& options, bool& has_autopilot) {
  std::vector<std::string> links = options.tries;
  if (!options.no_usual) {
    const auto usual = usual_links();
    links.insert(links.end(), usual.begin(), usual.end());
  }
  if (links.empty()) throw Error("no link to look at", {"--no-usual"}, "", "name one with --try LINK");
  say(fmt::format("looks for devices at {} links, {:g} s", links.size(), options.search_s));
  const SearchResult result = search_devices(links, options.search_s, options.speed);
  for (const std::string& problem : result.problems) say("  not tried: " + problem);
  for (const Speaker& speaker : result.speakers) say(fmt::format("  {} at {}", speaker.what, speaker.link));
  VehicleFile vehicle = found_vehicle(result.speakers, has_autopilot);
  if (!has_autopilot) say("  no autopilot was heard");
  if (vehicle.devices.empty()) say("  no device was heard");
  return vehicle;
}

/// Each device at work for a few seconds.
void try_out(const VehicleFile& vehicle, double speed) {
  std::vector<std::unique_ptr<DeviceTrial>> trials;
  for (DeviceConfig device : vehicle.devices) {
    device.navigation = device.kind == DeviceKind::kNmea;
    trials.push_back(std::make_unique<DeviceTrial>(device, speed));
  }
  {
    std::vector<std::jthread> threads;
    for (const auto& trial : trials) {
      threads.emplace_back([&trial] {
        while (!is_interrupted() && trial->age_s() < kTrial_s) (void)trial->next();
      });
    }
  }
  for (const auto& trial : trials) say(fmt::format("  {}: {}", trial->config().called(), trial->summary()));
}

int setup(const SetupCommand& options) {
  if (fs::exists(options.file) && !options.overwrite)
    throw Error(options.file.string() + " is there already", {}, "", "another file, or --overwrite");
  std::vector<KnownWall> walls;
  for (const std::string& wall : options.walls) walls.push_back(wall_of(wall));
  Answers answers(options.answers, options.yes);
  listen_for_interrupt();
  bool has_autopilot = false;
  VehicleFile vehicle = search(options, has_autopilot);
  if (vehicle.devices.empty() && !has_autopilot) return kFailedChecks;
  try_out(vehicle, options.speed);
  vehicle.title = answers.ask("vehicle.title", "name of the vehicle", vehicle.title);
  vehicle.model =
      answers.ask("vehicle.model", "its size and limits: a vehicle of the program, or a file (.toml)", vehicle.model);
  (void)control_vehicle(vehicle.model);
  for (DeviceConfig& device : vehicle.devices) ask_about(device, answers, has_autopilot);
  const bool images = std::ranges::any_of(vehicle.devices, [](const DeviceConfig& d) { return d.images(); });
  if (images && walls.empty()) {
    const std::string wall = answers.ask(
        "wall", "a wall to check the mounting with: degrees from the bow and range in m, such as 40,12; none: no check",
        "none");
    if (wall != "none") walls.push_back(wall_of(wall));
  }
  for (DeviceConfig& device : vehicle.devices) {
    if (device.images()) check_device(device, walls, answers, options.speed);
  }
  answers.check_all_used();
  if (is_interrupted()) return kSuccess;
  const std::string text = vehicle_file_text(vehicle);
  (void)parse_vehicle_file(text, options.file.string());  // what is written is accepted
  make_parent(options.file);
  write_whole_file(options.file, text);
  say(fmt::format("written to {}; the next command hears and decides, and commands nothing:", options.file.string()));
  say(fmt::format("  isobath aboard {} --dry-run", options.file.string()));
  return kSuccess;
}

}  // namespace

Action add_setup(CLI::App& program) {
  auto options = std::make_shared<SetupCommand>();
  CLI::App* command = program.add_subcommand(
      "setup", "Find the devices of a vehicle, check how its sonars are mounted, and write its vehicle file");
  command->add_option("VEHICLE", options->file, "Vehicle file to write (.toml)")
      ->check(writes_file())
      ->capture_default_str();
  command->add_option("--try", options->tries, "A link to look at, too, such as serial:/dev/ttyUSB0:115200")
      ->type_name("LINK")
      ->allow_extra_args(false)
      ->group("Search");
  command->add_flag("--no-usual", options->no_usual, "Look only at the links of --try")->group("Search");
  command->add_option("--search", options->search_s, "How long to look for devices, s")
      ->check(number(0.5, 600.0))
      ->capture_default_str()
      ->group("Search");
  command->add_option("--speed", options->speed, "How many times as fast as the clock the devices run; for stand-ins")
      ->check(number(0.1, 100.0))
      ->capture_default_str()
      ->group("Search");
  command
      ->add_option("--wall", options->walls,
                   "A wall: degrees from the bow to starboard and its range in m, such as 40,12")
      ->type_name("DEGREES,RANGE")
      ->allow_extra_args(false)
      ->group("Answers");
  command->add_option("--answer", options->answers, "The answer to a question, such as ping360.range_m=30")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->group("Answers");
  command->add_flag("--yes,-y", options->yes, "Take the defaults of all other questions")->group("Answers");
  command->add_flag("--overwrite", options->overwrite, "Replace the vehicle file if it is there")->group("Output");
  add_example(*command, "setup vehicle.toml");
  add_example(*command, "setup vehicle.toml --try serial:/dev/ttyUSB0:115200 --wall 40,12 --wall -90,5");
  return [options] { return setup(*options); };
}

}  // namespace isobath::app
