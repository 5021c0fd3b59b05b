#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/app/commands.hpp>
#include <isobath/app/exit_codes.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/studies/control_study.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

struct ControlOptions {
  ControlRequest request;
  std::filesystem::path out = "out/control";
  std::vector<std::string> tasks, changes, controls;
  bool json = false;
};

template <class Enum, std::size_t kCount>
std::vector<std::string> names_of(const Enum (&all)[kCount]) {
  std::vector<std::string> names;
  for (const Enum one : all) names.emplace_back(to_text(one));
  return names;
}

/// Those of `all` that are named; without names, all.
template <class Enum, std::size_t kCount>
std::vector<Enum> chosen(const Enum (&all)[kCount], const std::vector<std::string>& names) {
  std::vector<Enum> some;
  for (const Enum one : all) {
    if (names.empty() || std::ranges::find(names, to_text(one)) != names.end()) some.push_back(one);
  }
  return some;
}

nlohmann::ordered_json figure_json(const ControlFigure& figure) {
  const auto finite = [](double v) { return std::isfinite(v) ? nlohmann::ordered_json(v) : nullptr; };
  return {{"median", finite(figure.median)}, {"most", finite(figure.most)}};
}

nlohmann::ordered_json control_json(const ControlStudy& study) {
  nlohmann::ordered_json json{{"rows", nlohmann::ordered_json::array()}, {"bars", nlohmann::ordered_json::array()}};
  for (const ControlRow& r : study.rows) {
    json["rows"].push_back({{"vehicle", r.vehicle},
                            {"task", to_text(r.task)},
                            {"change", to_text(r.change)},
                            {"control", to_text(r.control)},
                            {"runs", r.runs},
                            {"recovered", r.recovered},
                            {"before_rms_m", figure_json(r.before_rms_m)},
                            {"at_rms_m", figure_json(r.at_rms_m)},
                            {"after_rms_m", figure_json(r.after_rms_m)},
                            {"at_max_m", figure_json(r.at_max_m)},
                            {"after_max_m", figure_json(r.after_max_m)},
                            {"at_depth_max_m", figure_json(r.at_depth_max_m)},
                            {"at_level_max_m", figure_json(r.at_level_max_m)},
                            {"final_depth_m", figure_json(r.final_depth_m)},
                            {"final_level_m", figure_json(r.final_level_m)},
                            {"recovery_s", figure_json(r.recovery_s)}});
  }
  for (const ControlBar& bar : study.bars) {
    json["bars"].push_back({{"vehicle", bar.vehicle},
                            {"what", bar.what},
                            {"value", bar.value},
                            {"bar", bar.bar},
                            {"met", bar.met},
                            {"cannot", bar.why}});
  }
  return json;
}

void print_control(const ControlStudy& study) {
  std::vector<std::vector<std::string>> table = control_table(study);
  fmt::print("{:<14} {:<8} {:<15}", table[0][0], table[0][1], table[0][2]);
  for (std::size_t i = 3; i < table[0].size(); ++i) fmt::print("  {:<26}", table[0][i]);
  fmt::print("\n");
  for (std::size_t k = 1; k < table.size(); ++k) {
    fmt::print("{:<14} {:<8} {:<15}", table[k][0], table[k][1], table[k][2]);
    for (std::size_t i = 3; i < table[k].size(); ++i) fmt::print("  {:<26}", table[k][i]);
    fmt::print("\n");
  }
  fmt::print(
      "medians of the runs: rms error before the change, greatest after it, rms at the end, m; time to the former "
      "error\n");
  for (const ControlBar& bar : study.bars) {
    fmt::print("{:<14} {}: {:.3f} (bar {:.3f}) {}\n", bar.vehicle, bar.what, bar.value, bar.bar,
               bar.met           ? "met"
               : bar.why.empty() ? "NOT MET"
                                 : "not met: " + bar.why);
  }
}

int run_control_study(ControlOptions& options) {
  ControlRequest& request = options.request;
  request.tasks = chosen(kControlTasks, options.tasks);
  request.changes = chosen(kControlChanges, options.changes);
  request.controls = chosen(kControlKinds, options.controls);
  if (request.vehicles.empty()) request.vehicles = ControlRequest().vehicles;
  check_output_folder(options.out, "--out");
  const ControlStudy study = study_control(request);
  const auto files = write_control_report(request, study, options.out);
  if (options.json) {
    nlohmann::ordered_json json = control_json(study);
    add_files(json, options.out, files);
    print_json(json);
  } else {
    print_control(study);
    fmt::print("written to {}: report.html, control.csv and {} pictures\n", options.out.string(), files.size() - 2);
  }
  const bool below = std::ranges::any_of(study.bars, [](const ControlBar& bar) { return !bar.met && bar.why.empty(); });
  return below ? kFailedChecks : kSuccess;
}

}  // namespace

Action add_control(CLI::App& program) {
  auto options = std::make_shared<ControlOptions>();
  ControlRequest& request = options->request;
  request.threads = 2;
  request.vehicles.clear();
  CLI::App* command = program.add_subcommand(
      "control",
      "Compare PID, model and adaptive control of vehicles that change under way; exit code 1 below the bars");
  add_output_folder(*command, options->out, "Folder for the results", "--out,-o");
  add_json_flag(*command, options->json);
  command->add_option("--vehicle", request.vehicles, "A vehicle of the program, or a file (.toml); may be repeated")
      ->type_name("NAME")
      ->default_str("bluerov2, hovering_rov and remus100")
      ->check(such_as([] { return ControlRequest().vehicles; }, true))
      ->group("Runs");
  const auto choice = [&](const char* name, std::vector<std::string>& value, const char* text,
                          const std::vector<std::string>& names) {
    command->add_option(name, value, text)->type_name("NAME")->default_str("all")->check(one_of(names))->group("Runs");
  };
  choice("--task", options->tasks, "Task; may be repeated", names_of(kControlTasks));
  choice("--change", options->changes, "What changes half-way; may be repeated", names_of(kControlChanges));
  choice("--control", options->controls, "Kind of control; may be repeated", names_of(kControlKinds));
  command->add_option("--runs", request.runs, "Runs of each kind of control through each task and change")
      ->capture_default_str()
      ->check(whole(1, 100'000))
      ->group("Runs");
  command->add_option("--first-run", request.first_run, "Number of the first run, from which it is drawn")
      ->capture_default_str()
      ->check(whole(0, 1'000'000))
      ->group("Runs");
  command->add_option("--threads", request.threads, "Runs in parallel; the results are the same")
      ->capture_default_str()
      ->check(whole(1, 64))
      ->group("Runs");
  add_example(*command, "control --runs 5");
  add_example(*command, "control --vehicle bluerov2 --task station --change current --runs 100");
  add_example(*command, "control --vehicle vehicles/hovering_rov.toml --task helix --change mass --json");
  return [options] { return run_control_study(*options); };
}

}  // namespace isobath::app
