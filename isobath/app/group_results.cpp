#include <cstdio>
#include <fmt/format.h>
#include <isobath/app/exit_codes.hpp>
#include <isobath/app/group_results.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/base/printable_text.hpp>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

namespace isobath::app {

std::optional<Scenario> vehicle_group_of(const RunRequest& request) {
  if (!is_scene(request.input)) return std::nullopt;
  Scenario scenario = request.scenario ? *request.scenario : open_scenario(request.input);
  if (scenario.scene.group.empty()) return std::nullopt;
  return scenario;
}

nlohmann::ordered_json group_results_json(const RunRequest& request, const GroupOutcome& outcome) {
  auto all = nlohmann::ordered_json::parse(group_text(outcome));
  add_files(all, request.out, {"report.html", "group.json", "group.png"});
  return all;
}

void print_group_results(const RunRequest& request, const GroupOutcome& outcome) {
  for (const std::string& line : group_summary(outcome)) fmt::print("{}\n", printable_text(line, 2 * kMaxForeignText));
  fmt::print("written to {}: report.html, group.json, group.png and a folder for each vehicle\n", request.out.string());
}

int conclude_group(const GroupOutcome& outcome) {
  std::set<std::string> warnings;
  for (const RunOutcome& run : outcome.runs) warnings.insert(run.warning);
  for (const std::string& warning : warnings) {
    if (!warning.empty()) std::fprintf(stderr, "isobath: warning: %s\n", printable_text(warning, 1000).c_str());
  }
  const std::string failure = outcome.failure();
  if (!failure.empty()) std::fprintf(stderr, "isobath: %s\n", printable_text(failure).c_str());
  return failure.empty() ? kSuccess : kFailedChecks;
}

}  // namespace isobath::app
