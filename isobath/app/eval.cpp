#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <isobath/app/config_options.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/progress.hpp>
#include <isobath/app/settings_json.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/error.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/base/printable_text.hpp>
#include <isobath/evaluation/evaluation_report.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

struct EvalOptions {
  ConfigOptions config;
  EvaluationRequest request;
  std::string suite;
  std::string out;
  std::string variant;
  std::string replay;
  int only = -1;
  bool alone = false;
  bool json = false;
};

/// Version and digest of the program itself, so that results of another build are not reused.
std::string program_version() {
  std::uint64_t digest = 0xcbf29ce484222325u;
  if (std::FILE* self = std::fopen("/proc/self/exe", "rb")) {
    std::vector<unsigned char> block(1 << 16);
    while (const std::size_t got = std::fread(block.data(), 1, block.size(), self)) {
      for (std::size_t i = 0; i < got; ++i) digest = (digest ^ block[i]) * 0x100000001b3u;
    }
    std::fclose(self);
  }
  return fmt::format("{} {:016x}", ISOBATH_VERSION, digest);
}

/// Prints a table. Each column is as wide as its widest cell; numbers are aligned to the right.
void print_variants(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths(rows.empty() ? 0 : rows.front().size());
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  for (const auto& row : rows) {
    fmt::print("{:<{}}", row.front(), widths.front());
    for (std::size_t i = 1; i < row.size(); ++i) fmt::print("  {:>{}}", row[i], widths[i]);
    fmt::print("\n");
  }
}

void print(const EvaluationRequest& request, const Evaluation& evaluation) {
  fmt::print("{}: {} runs from seed {}", printable_text(request.suite.about.title), evaluation.runs.size(),
             evaluation.runs.front().seed);
  if (evaluation.taken_over > 0) fmt::print(", {} of them from an earlier evaluation", evaluation.taken_over);
  fmt::print("\n");
  for (const auto& row : evaluation_table(evaluation)) {
    fmt::print("{:<24}", row.front());
    for (std::size_t i = 1; i < row.size(); ++i) fmt::print("  {:<35}", row[i]);
    fmt::print("\n");
  }
  print_variants(variant_table(evaluation));
  for (const std::string& line : comparison_lines(evaluation)) fmt::print("{}\n", line);
  for (const auto& [why, count] : evaluation.summaries.front().reasons) fmt::print("refused {}: {}\n", count, why);
  for (const std::string& bar : evaluation.broken) fmt::print("BELOW THE BAR: {}\n", bar);
  fmt::print("written to {}: report.html, results.json, runs.jsonl\n", request.out.string());
}

int act(EvalOptions& options) {
  EvaluationRequest& request = options.request;
  if (options.suite == "control" && !std::filesystem::exists(options.suite)) {
    throw Error("control is a study of trials, not a suite of missions", {}, {},
                "isobath control compares the kinds of control; isobath eval clutter-control flies missions");
  }
  const Configuration configuration = options.config.read();
  const std::string name = std::filesystem::path(options.suite).stem().string();
  // The runs of one variant get their own folder, so that those of the whole suite are kept.
  std::string folder = options.variant.empty() ? name : name + "-" + options.variant;
  std::replace(folder.begin(), folder.end(), '/', '-');
  request.out = options.out.empty() ? "out/eval/" + folder : options.out;
  check_output_folder(request.out, "--out");
  request.suite = load_suite(find_suite(options.suite, request.out / "inputs"));
  if (!options.variant.empty()) select_variants(request.suite, options.variant);
  load_recording(request.suite, options.replay);
  if (options.alone) request.suite.baselines.clear();
  request.methods = methods_of(request.suite, configuration);
  request.version = program_version();
  if (options.only >= 0) {
    request.seed = (request.seed >= 0 ? request.seed : request.suite.about.seed) + options.only;
    request.runs = 1;
  }
  ProgressLine progress;
  request.progress = [&progress](int done, int all) {
    progress.show(static_cast<std::uint64_t>(done), static_cast<std::uint64_t>(all), static_cast<std::uint64_t>(done),
                  "runs");
  };
  const Evaluation evaluation = evaluate(request);
  progress.clear();
  write_evaluation(request, evaluation);
  if (options.json) {
    auto json = nlohmann::ordered_json::parse(to_json(request, evaluation));
    Suite suite = request.suite;
    Schema all = schema(suite);
    std::erase_if(all.sections, [](const Section& section) { return section.name != "bars"; });
    json.update(settings_json({all.sections, {}}, true));
    add_files(json, request.out, {"report.html", "results.json", "runs.jsonl"});
    print_json(json);
  } else {
    print(request, evaluation);
  }
  std::fflush(stdout);
  for (const std::string& bar : evaluation.broken)
    std::fprintf(stderr, "isobath: below the bar: %s\n", printable_text(bar).c_str());
  return evaluation.broken.empty() ? kSuccess : kFailedChecks;
}

}  // namespace

Action add_eval(CLI::App& program) {
  auto options = std::make_shared<EvalOptions>();
  EvaluationRequest& request = options->request;
  request.threads = 2;
  CLI::App* command = program.add_subcommand(
      "eval", "Score the runs of a suite beside baseline methods; exit code 1 below the suite's bars");
  command
      ->add_option("SUITE", options->suite,
                   fmt::format("File (.toml), or one of {}", fmt::join(embedded_suites(), ", ")))
      ->check(such_as(embedded_suites, true))
      ->required();
  command->add_option("--out", options->out, "Folder for the results; runs that are finished there are kept")
      ->type_name("FOLDER")
      ->check(writes_folder())
      ->default_str("out/eval/SUITE")
      ->group("Output");
  add_json_flag(*command, options->json);
  command->add_option("--runs", request.runs, "Number of runs")
      ->check(whole(1, 1'000'000))
      ->default_str("the suite's")
      ->group("Runs");
  command->add_option("--seed", request.seed, "Seed of the first run; the next runs add 1")
      ->check(whole(0, 1'000'000'000))
      ->default_str("the suite's")
      ->group("Runs");
  command->add_option("--only", options->only, "Only this run, counted from 0")
      ->check(whole(0, 999'999))
      ->group("Runs");
  command
      ->add_option("--variant", options->variant,
                   "Only this variant of the suite, or those whose names have these parts: remus100/altimeter")
      ->type_name("NAME")
      ->group("Runs");
  command
      ->add_option("--replay", options->replay,
                   "Recording of ships for a suite that replays one, such as strait: a table of AIS reports (.csv)")
      ->type_name("FILE")
      ->check(reads())
      ->group("Runs");
  command->add_option("--threads", request.threads, "Runs in parallel; the results are the same")
      ->check(whole(1, 256))
      ->capture_default_str()
      ->group("Runs");
  command->add_flag("--alone", options->alone, "Leave out the baselines")->group("Runs");
  options->config.add_to(*command);
  add_example(*command, "eval clutter-low --runs 100");
  add_example(*command, "eval imaging-low --variant remus100/altimeter --json");
  add_example(*command, "eval suites/pandan.toml --only 3 --alone");
  add_example(*command, "eval strait --replay ais.csv --runs 20");
  return [options] { return act(*options); };
}

}  // namespace isobath::app
