#include <cstdio>
#include <fmt/format.h>
#include <isobath/app/commands.hpp>
#include <isobath/app/run_options.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/base/printable_text.hpp>
#include <isobath/evaluation/evaluation_suite.hpp>
#include <isobath/evaluation/fault_injection_check.hpp>
#include <utility>

namespace isobath::app {

void RunOptions::add_to(CLI::App& command, const std::string& out) {
  request.out = out;
  add_output_folder(command, request.out, "Folder for the results");
  command.add_option("--map", request.map, "Depth map to continue or to start")
      ->type_name("FOLDER")
      ->check(writes_folder())
      ->group("Output");
  command.add_option("--record", request.record, "Recording of the run to write (.mcap)")
      ->type_name("FILE")
      ->check(writes_file())
      ->group("Output");
  command
      .add_option("--mission", request.mission,
                  "Mission file, or a scenario with a mission; a scene runs in a closed loop, a log is decided again")
      ->type_name("FILE")
      ->check(reads())
      ->group("Input");
  command.add_option("--model", model_, "Sensor model made by isobath calibrate")
      ->type_name("FILE")
      ->check(reads())
      ->group("Input");
  command.add_option("--input-set", set_, "Set of frames in a folder that holds several")
      ->type_name("NAME")
      ->group("Input");
  command.add_option("--pass", pass_, "Pass of a set that holds several; 0: the first")
      ->check(whole(0, 1'000'000))
      ->capture_default_str()
      ->group("Input");
  command.add_option("--threads", request.threads, "Number of threads; the results are the same")
      ->check(whole(1, 64))
      ->capture_default_str()
      ->group("Run");
  config.add_to(command);
}

void RunOptions::add_suite_to(CLI::App& command) {
  CLI::Option* suite =
      command
          .add_option(
              "--suite", suite_,
              "A run of this suite of isobath eval instead of INPUT; its seed is simulation.seed or the suite's")
          ->type_name("SUITE")
          ->check(such_as(embedded_suites, true))
          ->excludes(command.get_option("INPUT"))
          ->group("Input");
  command.add_option("--variant", variant_, "Only this variant of the suite")
      ->type_name("NAME")
      ->needs(suite)
      ->group("Input");
  command.add_option("--replay", replay_, "Recording of ships for a suite that replays one (.csv)")
      ->type_name("FILE")
      ->check(reads())
      ->needs(suite)
      ->group("Input");
}

RunRequest& RunOptions::read() {
  if (!model_.empty()) config.settings.push_back("sensor.model=" + model_);
  if (!set_.empty()) config.settings.push_back("input.set=" + set_);
  if (pass_ > 0) config.settings.push_back("input.pass=" + std::to_string(pass_));
  request.configuration = config.read();
  check_output_folder(request.out, "--out");
  if (!request.record.empty()) make_parent(request.record);
  if (!suite_.empty()) take_suite_run();
  return request;
}

void RunOptions::take_suite_run() {
  request.input = find_suite(suite_, request.out / "inputs");
  Suite suite = load_suite(request.input);
  if (!variant_.empty()) select_variants(suite, variant_);
  load_recording(suite, replay_);
  SimulationConfig& simulation = request.configuration.simulation;
  if (simulation.seed < 0) simulation.seed = suite.about.seed;
  SuiteRun run = make_run(suite, load_scenes(suite), static_cast<std::uint64_t>(simulation.seed));
  if (run.row) request.configuration = proving(*run.row, request.configuration);
  conditions_ = fmt::format("{}, seed {}: {}{}", suite.about.title, run.seed,
                            run.variant.empty() ? "" : run.variant + "; ", run.conditions);
  request.scenario = std::move(run.scenario);
}

int conclude(const RunRequest& request, const RunOutcome& outcome) {
  const std::string failure = outcome.mission ? outcome.mission->failure() : std::string();
  constexpr std::size_t kMax = 1000;
  std::fflush(stdout);
  if (!outcome.recording_problem.empty()) {
    std::fprintf(stderr, "isobath: %s; the recording ends there, %llu events and messages are missing\n",
                 printable_text(outcome.recording_problem, kMax).c_str(),
                 static_cast<unsigned long long>(outcome.not_recorded));
  }
  if (!outcome.warning.empty())
    std::fprintf(stderr, "isobath: warning: %s\n", printable_text(outcome.warning, kMax).c_str());
  if (outcome.problem.empty() && failure.empty()) {
    return outcome.recording_problem.empty() ? kSuccess : kFailedChecks;
  }
  const std::string& problem = outcome.problem.empty() ? failure : outcome.problem;
  const std::string input = request.input.empty() ? "the embedded scene" : request.input.string();
  std::fprintf(stderr, "isobath: %s: %s\n", printable_text(input, kMax).c_str(), printable_text(problem, kMax).c_str());
  return outcome.problem.empty() || outcome.cut ? kFailedChecks : kBadInput;
}

}  // namespace isobath::app
