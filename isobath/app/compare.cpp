#include <fmt/format.h>
#include <isobath/app/config_options.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/progress.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/studies/comparison.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

struct CompareOptions {
  ConfigOptions config;
  CompareRequest request;
  bool json = false;
};

int act(CompareOptions& options) {
  CompareRequest& request = options.request;
  request.configuration = options.config.read();
  check_output_folder(request.out, "--out");
  ProgressLine progress;
  request.progress = [&](const SourceReport& source, std::uint64_t pings) {
    progress.show(source.bytes_read, source.bytes_total, pings);
  };
  const CompareOutcome outcome = compare(request);
  progress.clear();
  if (options.json) {
    auto json = nlohmann::ordered_json::parse(to_json(outcome));
    add_files(json, request.out, outcome.files);
    print_json(json);
    return kSuccess;
  }
  fmt::print("A: {}\nB: {}\n", outcome.a.name, outcome.b.name);
  fmt::print("{:<56}  {:<26}  {}\n", "", "A", "B");
  for (const ComparedValue& v : compared_values(outcome)) fmt::print("{:<56}  {:<26}  {}\n", v.what, v.a, v.b);
  fmt::print("backgrounds differ by {:.1f} % of the samples at most\n", 100 * outcome.background_distance);
  fmt::print("written to {}: report.html and {} more files\n", request.out.string(), outcome.files.size() - 1);
  return kSuccess;
}

}  // namespace

Action add_compare(CLI::App& program) {
  auto options = std::make_shared<CompareOptions>();
  CompareRequest& request = options->request;
  request.out = "out/comparison";
  CLI::App* command = program.add_subcommand("compare", "Compare the statistics of two recordings, real or simulated");
  command->add_option("A", request.a, "Log, folder of frames, or scene (.toml)")->check(reads())->required();
  command->add_option("B", request.b, "Log, folder of frames, or scene (.toml)")->check(reads())->required();
  add_output_folder(*command, request.out, "Folder for the results");
  add_json_flag(*command, options->json);
  command->add_option("--threads", request.threads, "Number of threads; the results are the same")
      ->check(whole(1, 64))
      ->capture_default_str()
      ->group("Run");
  options->config.add_to(*command);
  add_example(*command, "compare tank.bin scenarios/tank.toml --out out/tank");
  add_example(*command, "compare before.oculus after.oculus --json");
  return [options] { return act(*options); };
}

}  // namespace isobath::app
