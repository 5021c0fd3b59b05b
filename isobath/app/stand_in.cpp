#include <charconv>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <isobath/app/commands.hpp>
#include <isobath/app/exit_codes.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/values.hpp>
#include <isobath/app/vehicle_page.hpp>
#include <isobath/base/error.hpp>
#include <isobath/base/secret_file.hpp>
#include <isobath/standin/stand_ins.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>

namespace isobath::app {
namespace {

struct StandInCommand {
  std::filesystem::path scene;
  std::string front_seat = "ardusub";
  StandInRequest request;
  std::vector<std::string> devices, pilot;
  std::string key_file;
  bool json = false;
};

std::vector<StandInRequest::Device> devices_of(const std::vector<std::string>& words) {
  std::vector<StandInRequest::Device> devices;
  for (const std::string& word : words) {
    const std::size_t at = word.find('=');
    const std::string kind = word.substr(0, at);
    const auto* const found = std::ranges::find_if(kDeviceKinds, [&](DeviceKind k) { return kind == to_text(k); });
    if (at == std::string::npos || found == std::end(kDeviceKinds)) {
      throw Error(word + ": not a device with its link", {"--device"},
                  "ping360, ping1d, micron, oculus, dvl-a50 or nmea, then =LINK");
    }
    devices.push_back({*found, word.substr(at + 1)});
  }
  return devices;
}

/// Seconds; NaN: the text is no number.
double seconds_in(std::string_view text) {
  double value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  return fault == std::errc() && end == text.data() + text.size() ? value : std::nan("");
}

/// "20-30": POSHOLD from 20 to 30 s.
std::vector<PilotTurn> turns_of(const std::vector<std::string>& words) {
  std::vector<PilotTurn> turns;
  for (const std::string_view word : words) {
    const std::size_t at = word.find('-');
    const bool whole = at != std::string_view::npos;
    const PilotTurn turn{seconds_in(word.substr(0, at)), whole ? seconds_in(word.substr(at + 1)) : 0};
    if (!(turn.from_s >= 0 && turn.to_s > turn.from_s))
      throw Error(fmt::format("{}: not a span of time", word), {"--pilot"}, "20-30");
    turns.push_back(turn);
  }
  return turns;
}

void print_end(const StandInCommand& options, const StandIns& stand_ins) {
  const AutopilotCounts counts = stand_ins.autopilot();
  const TrackTruth& truth = stand_ins.truth();
  int pulled = counts.pulled;
  for (const auto& device : stand_ins.devices()) pulled += device->pulled();
  if (options.json) {
    return print_json_line(
        {{"event", "finished"},
         {"simulated_s", stand_ins.now_s()},
         {"contact_s", truth.contact_s},
         {"contact_with", truth.contact_with},
         {"min_clearance_m", std::isfinite(truth.min_clearance_m) ? nlohmann::ordered_json(truth.min_clearance_m)
                                                                  : nlohmann::ordered_json()},
         {"length_m", truth.length_m},
         {"setpoints", counts.setpoints},
         {"refused", counts.refused},
         {"untrusted", counts.untrusted},
         {"oldest_s", counts.oldest_s},
         {"longest_gap_s", counts.longest_gap_s},
         {"rings", counts.rings},
         {"points", counts.points},
         {"obstacles", counts.obstacles},
         {"malformed", counts.malformed},
         {"texts", counts.texts},
         {"moved_m", counts.moved_m},
         {"pulled", pulled}});
  }
  fmt::print("{:.1f} s simulated; the vehicle went {:.1f} m; {}; least clearance {:.2f} m\n", stand_ins.now_s(),
             truth.length_m, truth.contact_s < 0 ? "no contact" : "CONTACT with " + truth.contact_with,
             truth.min_clearance_m);
  fmt::print("the autopilot followed {} set-points, the oldest {:.3f} s old, at most {:.3f} s apart; refused {}\n",
             counts.setpoints, counts.oldest_s, counts.longest_gap_s, counts.refused);
  if (options.request.front_seat == FrontSeatKind::kMoos) {
    fmt::print("it heard {} obstacles, {} texts, and {} messages that cannot be read\n", counts.obstacles, counts.texts,
               counts.malformed);
  } else {
    fmt::print("it heard {} rings and {} points of obstacles, and {} texts\n", counts.rings, counts.points,
               counts.texts);
  }
  if (counts.moved_m > 0) fmt::print("a DVL measured {:.1f} m of motion\n", counts.moved_m);
  if (counts.untrusted > 0) fmt::print("it refused {} frames without the right signature\n", counts.untrusted);
  if (pulled > 0) fmt::print("cables were pulled {} times\n", pulled);
}

int stand_in(StandInCommand& options) {
  options.request.devices = devices_of(options.devices);
  options.request.turns = turns_of(options.pilot);
  const bool moos = options.front_seat == "moos";
  if (moos) options.request.front_seat = FrontSeatKind::kMoos;
  if (moos && !options.key_file.empty())
    throw Error("messages of MOOS are not signed", {"--key-file"}, "", "leave it out");
  if (!options.key_file.empty()) options.request.key.emplace(secret_of_file(options.key_file));
  listen_for_interrupt();
  StandIns stand_ins(open_scenario(options.scene), options.request);
  nlohmann::ordered_json ports{{"autopilot", stand_ins.autopilot_port()}};
  for (const auto& device : stand_ins.devices()) {
    ports[to_text(device->kind())] = device->port();
    if (!options.json) fmt::print("{} at port {}\n", to_text(device->kind()), device->port());
  }
  if (options.json) print_json_line({{"event", "ready"}, {"ports", ports}});
  if (!options.json)
    fmt::print("the {} {}\n",
               options.request.front_seat == FrontSeatKind::kMoos ? "MOOSDB is at" : "autopilot speaks to",
               stand_ins.autopilot_link());
  std::fflush(stdout);
  while (!is_interrupted() && stand_ins.step()) continue;
  print_end(options, stand_ins);
  return stand_ins.truth().contact_s < 0 ? kSuccess : kFailedChecks;
}

}  // namespace

Action add_stand_in(CLI::App& program) {
  auto options = std::make_shared<StandInCommand>();
  StandInRequest& request = options->request;
  CLI::App* command = program.add_subcommand(
      "stand-in", "Play a vehicle for isobath aboard: a scene whose devices and autopilot speak over sockets");
  command->add_option("SCENE", options->scene, "Scene with a mission and a place on the globe (.toml)")
      ->check(reads())
      ->default_str("the embedded scene");
  command
      ->add_option("--front-seat", options->front_seat, "What controls the vehicle: an ArduSub autopilot or a MOOSDB")
      ->check(one_of({"ardusub", "moos"}))
      ->capture_default_str()
      ->group("Links");
  command->add_option("--autopilot", request.autopilot, "Link to the companion computer")
      ->type_name("LINK")
      ->default_str("udp:127.0.0.1:14550; of a MOOSDB tcp-server:9000")
      ->group("Links");
  command->add_option("--device", options->devices, "A device and its link, such as ping360=udp-server:9092")
      ->type_name("KIND=LINK")
      ->allow_extra_args(false)
      ->group("Links");
  command->add_option("--oculus-status", request.oculus_status, "Where the stand-in of an Oculus broadcasts its status")
      ->type_name("LINK")
      ->capture_default_str()
      ->group("Links");
  command
      ->add_option("--key-file", options->key_file, "File with the passphrase by which the autopilot signs its frames")
      ->type_name("FILE")
      ->check(reads())
      ->group("Links");
  command
      ->add_option(
          "--ping360-discovery", request.ping360_discovery,
          "Where the stand-in of a Ping360 answers those that look for it, such as udp-server:127.255.255.255:30303")
      ->type_name("LINK")
      ->default_str("nowhere")
      ->group("Links");
  command->add_option("--unplug", request.unplug.times, "How often each cable is pulled, at random bytes")
      ->check(whole(0, 1000))
      ->capture_default_str()
      ->group("Links");
  command->add_option("--speed", request.speed, "How many times as fast as the clock it runs")
      ->check(number(0.1, 100.0))
      ->capture_default_str()
      ->group("Run");
  command->add_option("--seed", request.simulation.seed, "Seed of the scene; -1: its own")
      ->check(whole(-1, 2'000'000'000))
      ->capture_default_str()
      ->group("Run");
  command
      ->add_option("--guided-after", request.guided_after_s,
                   "The pilot arms and chooses GUIDED, or sets MOOS_MANUAL_OVERRIDE to false, so many seconds after a "
                   "companion is heard")
      ->check(number(0.0, 3600.0))
      ->capture_default_str()
      ->group("Run");
  command->add_flag("--stay", request.stays, "Go on 5 s after the companion has fallen silent, for the next one")
      ->group("Run");
  command
      ->add_option("--pilot", options->pilot,
                   "The pilot takes over, s after the companion first had the vehicle, such as 20-30")
      ->type_name("FROM-TO")
      ->allow_extra_args(false)
      ->group("Run");
  command->add_flag("--json", options->json, "JSON on standard output: a line at the start, another at the end")
      ->group("Output");
  add_example(*command, "stand-in scenarios/aboard.toml --device ping360=udp-server:9092");
  add_example(*command, "stand-in scenarios/aboard.toml --autopilot udp-server:0 --pilot 20-30 --speed 4");
  add_example(*command, "stand-in scenarios/aboard.toml --front-seat moos");
  return [options] {
    const int seed = options->request.simulation.seed;
    options->request.unplug.seed = seed < 0 ? 1 : static_cast<std::uint64_t>(seed);
    return stand_in(*options);
  };
}

}  // namespace isobath::app
