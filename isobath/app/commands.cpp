#include <charconv>
#include <isobath/app/commands.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/base/error.hpp>

namespace isobath::app {
std::vector<Command> add_commands(CLI::App& program) {
  using Maker = Action (*)(CLI::App&);
  const std::pair<const char*, std::vector<Maker>> groups[] = {
      {"Runs and simulations", {add_run, add_serve, add_setup, add_aboard, add_stand_in, add_sim, add_eval}},
      {"Logs and maps", {add_info, add_convert, add_compare, add_crosscheck, add_path}},
      {"Calibration and studies",
       {add_calibrate, add_control, add_delay, add_helix, add_sphere, add_stereo, add_track, add_traffic}},
      {"Settings and help", {add_config, add_help}}};
  std::vector<Command> commands;
  for (const auto& [group, makers] : groups) {
    for (const Maker add : makers) {
      Action action = add(program);
      CLI::App* const command = program.get_subcommands([](CLI::App*) { return true; }).back();
      command->group(group);
      commands.push_back({command, std::move(action)});
    }
  }
  add_example(program, "run");
  add_example(program, "run dive.bin --out out/dive");
  add_example(program, "serve");
  add_example(program, "eval clutter-low --runs 100");
  return commands;
}

Eigen::Vector2d pair_of(const std::string& text) {
  double first = 0, second = 0;
  const char* const end = text.data() + text.size();
  const auto a = std::from_chars(text.data(), end, first);
  const bool comma = a.ec == std::errc() && a.ptr != end && *a.ptr == ',';
  const auto b = comma ? std::from_chars(a.ptr + 1, end, second) : a;
  if (!comma || b.ec != std::errc() || b.ptr != end) {
    throw Error("\"" + text + "\" is not a way-point", {}, "two numbers separated by a comma: 41.66,-82.82");
  }
  return {first, second};
}

}  // namespace isobath::app
