#include <fmt/format.h>
#include <isobath/app/commands.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/studies/detection_delay.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

struct DelayOptions {
  DelayRequest request;
  std::filesystem::path out = "out/delay";
  bool json = false;
};

nlohmann::ordered_json false_obstacles_json(const FalseObstacles& of) {
  return {{"mean", of.mean}, {"least", of.least}, {"most", of.most}};
}

int measure(const DelayOptions& options) {
  check_output_folder(options.out, "--out");
  const std::vector<DetectionDelay> rows = measure_delays(options.request);
  make_folder(options.out);
  write_whole_file(options.out / "delay.png", delay_picture(rows));
  if (options.json) {
    nlohmann::ordered_json bases = nlohmann::ordered_json::array();
    for (const DetectionDelay& row : rows) {
      bases.push_back({{"base", row.base},
                       {"readings", row.readings},
                       {"delay_s", DelayRequest::kCycle_s * row.readings},
                       {"prefiltered_s", DelayRequest::kCycle_s * row.readings_merged},
                       {"under_way_s", DelayRequest::kCycle_s * row.readings_merged_under_way},
                       {"false_standing", false_obstacles_json(row.false_standing)},
                       {"false_under_way", false_obstacles_json(row.false_under_way)}});
    }
    nlohmann::ordered_json json{{"spurious_share", options.request.spurious_share},
                                {"readings", options.request.readings},
                                {"seeds", options.request.seeds},
                                {"bases", std::move(bases)}};
    add_files(json, options.out, {"delay.png"});
    print_json(json);
    return kSuccess;
  }
  fmt::print("base  readings      s  prefiltered, s  under way, s  false standing  false under way\n");
  for (const DetectionDelay& row : rows) {
    fmt::print("{:4}  {:8}  {:5.1f}  {:14.1f}  {:12.1f}  {:14.2f}  {:15.2f}\n", row.base, row.readings,
               DelayRequest::kCycle_s * row.readings, DelayRequest::kCycle_s * row.readings_merged,
               DelayRequest::kCycle_s * row.readings_merged_under_way, row.false_standing.mean,
               row.false_under_way.mean);
  }
  fmt::print("false obstacles are per 1000 readings, mean of {} seeds\nwritten to {}: delay.png\n",
             options.request.seeds, options.out.string());
  return kSuccess;
}

}  // namespace

Action add_delay(CLI::App& program) {
  auto options = std::make_shared<DelayOptions>();
  DelayRequest& request = options->request;
  CLI::App* command = program.add_subcommand(
      "delay", "Measure how late the depth map shows a new wall, and how many false obstacles, by base confidence");
  add_output_folder(*command, options->out, "Folder for the picture", "--out,-o");
  add_json_flag(*command, options->json);
  command->add_option("--spurious", request.spurious_share, "Share of false echoes among the readings of empty water")
      ->capture_default_str()
      ->check(number(0, 1))
      ->group("Simulation");
  command->add_option("--readings", request.readings, "Readings of empty water, per seed")
      ->capture_default_str()
      ->check(whole(1, 100'000))
      ->group("Simulation");
  command->add_option("--seeds", request.seeds, "Seeds, from 1")
      ->capture_default_str()
      ->check(whole(1, 10'000))
      ->group("Simulation");
  command->add_option("--wall", request.wall_m, "Distance of the wall, m")
      ->capture_default_str()
      ->check(number(5, 45))
      ->group("Simulation");
  add_example(*command, "delay --out out/delay");
  add_example(*command, "delay --spurious 0.1 --seeds 20 --json");
  return [options] { return measure(*options); };
}

}  // namespace isobath::app
