#include <cstdio>
#include <isobath/app/commands.hpp>
#include <isobath/app/run_options.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/base/printable_text.hpp>

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

RunRequest& RunOptions::read() {
  if (!model_.empty()) config.settings.push_back("sensor.model=" + model_);
  if (!set_.empty()) config.settings.push_back("input.set=" + set_);
  if (pass_ > 0) config.settings.push_back("input.pass=" + std::to_string(pass_));
  request.configuration = config.read();
  check_output_folder(request.out, "--out");
  if (!request.record.empty()) make_parent(request.record);
  return request;
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
