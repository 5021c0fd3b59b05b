#include <fmt/format.h>
#include <isobath/app/config_options.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/progress.hpp>
#include <isobath/app/values.hpp>
#include <isobath/studies/check_map.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

struct CrosscheckOptions {
  ConfigOptions config;
  CheckRequest request;
  bool json = false;
};

int act(CrosscheckOptions& options) {
  CheckRequest& request = options.request;
  request.configuration = options.config.read();
  ProgressLine progress;
  request.progress = [&](const SourceReport& source, const PipelineCounts& counts) {
    progress.show(source.bytes_read, source.bytes_total, counts.ranges + counts.swaths);
  };
  const CheckOutcome outcome = check_map(request);
  progress.clear();
  if (options.json) {
    auto json = nlohmann::ordered_json::parse(to_json(outcome.result));
    json["damages"] = nlohmann::ordered_json::array();
    for (const MapDamage& damage : outcome.damages) json["damages"].push_back(map_damage_json(damage));
    add_files(json, request.out, outcome.files);
    print_json(json);
    return kSuccess;
  }
  for (const MapDamage& damage : outcome.damages) fmt::print("damaged: {}\n", to_text(damage));
  fmt::print("{}", to_text(outcome.result));
  if (!outcome.files.empty()) fmt::print("written to {}: crosscheck.html\n", request.out.string());
  return kSuccess;
}

}  // namespace

Action add_crosscheck(CLI::App& program) {
  auto options = std::make_shared<CrosscheckOptions>();
  CheckRequest& request = options->request;
  CLI::App* command = program.add_subcommand("crosscheck", "Compare a map with soundings that are not in it");
  command->add_option("MAP", request.map, "Folder of a depth map")->check(reads_folder())->required();
  command->add_option("LOG", request.input, "Log, folder of logs, or scene (.toml)")->check(reads())->required();
  command->add_option("--out", request.out, "Folder for a report")
      ->type_name("FOLDER")
      ->check(writes_folder())
      ->default_str("no report")
      ->group("Output");
  add_json_flag(*command, options->json);
  options->config.add_to(*command);
  add_example(*command, "crosscheck lake survey/ --set \"input.only='20250117*'\" --out out/check");
  add_example(*command, "crosscheck lake cross-lines.all --json");
  return [options] { return act(*options); };
}

}  // namespace isobath::app
