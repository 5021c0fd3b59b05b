#include <algorithm>
#include <fmt/format.h>
#include <isobath/configuration/configuration.hpp>
#include <isobath/io/input/fingerprint.hpp>
#include <isobath/map/depth/map_folder.hpp>
#include <isobath/run/log_identity.hpp>
#include <isobath/run/run_outputs.hpp>
#include <isobath/scenario/scenario.hpp>
#include <vector>

namespace isobath {

std::optional<MapVisit> visit_of(const std::filesystem::path& map, const std::string& fingerprint) {
  if (map.empty() || fingerprint.empty() || !looks_like_map(map)) return std::nullopt;
  const std::vector<MapVisit> visits = read_record(map).record.facts.visits;  // the trees are large
  const auto same = std::ranges::find(visits, fingerprint, &MapVisit::fingerprint);
  if (same == visits.end() || !open_map(map).damages.empty()) return std::nullopt;
  return *same;
}

std::string fingerprint_of_log(const RunRequest& request) {
  if (request.map.empty() || request.input.empty() || is_scene(request.input)) return {};
  const std::filesystem::path map = std::filesystem::weakly_canonical(request.map);
  const auto written = [&](const std::filesystem::path& file) {
    const std::filesystem::path place = std::filesystem::weakly_canonical(file);
    const bool of_map = std::mismatch(map.begin(), map.end(), place.begin(), place.end()).first == map.end();
    const bool of_run = std::ranges::any_of(kRunFiles, [&](const char* name) { return file.filename() == name; });
    return of_map || of_run;
  };
  const InputConfig& chosen = request.configuration.input;
  return fmt::format("{} only={} without={} set={} pass={}", fingerprint_of(request.input, written), chosen.survey.only,
                     chosen.survey.without, chosen.set, chosen.pass);
}

}  // namespace isobath
