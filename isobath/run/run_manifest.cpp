#include <isobath/report/fan_calibration.hpp>
#include <isobath/report/placement_pages.hpp>
#include <isobath/report/result_text.hpp>
#include <isobath/run/run_manifest.hpp>
#include <nlohmann/json.hpp>

namespace isobath {

using nlohmann::ordered_json;

std::string manifest_json(const RunRequest& request, const RunOutcome& outcome) {
  ordered_json manifest{{"program", "isobath"},
                        {"version", ISOBATH_VERSION},
                        {"input", request.input.empty() ? "embedded scene" : request.input.string()},
                        {"format", outcome.source.format},
                        {"bytes", outcome.source.bytes_total},
                        {"problem", outcome.problem},
                        {"warning", outcome.warning}};
  for (const auto& [key, value] : outcome.source.details) manifest["details"][key] = value;
  manifest["counts"] = counts_json(outcome);
  manifest["alarms"] = alarms_json(outcome);
  manifest["rejected"] = rejected_json(outcome);
  manifest["skipped"] = ordered_json::array();
  for (const Damage& d : outcome.source.damages) {
    manifest["skipped"].push_back({{"offset", d.offset}, {"bytes", d.bytes}, {"reason", d.reason}});
  }
  if (outcome.fan) manifest["fan_model"] = departure_json(*outcome.fan);
  if (outcome.voxels) manifest["voxels"] = voxels_json(*outcome.voxels);
  if (outcome.sphere) manifest["sphere"] = sphere_json(*outcome.sphere);
  if (outcome.sharpness) manifest["sharpness"] = sharpness_json(*outcome.sharpness);
  if (outcome.drift) manifest["drift"] = drift_json(*outcome.drift);
  if (outcome.depth) manifest["depth"] = depth_json(*outcome.depth);
  for (const auto& file : outcome.files) manifest["files"].push_back(file.string());
  return manifest.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace isobath
