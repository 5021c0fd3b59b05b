#include <cmath>
#include <isobath/io/geojson.hpp>
#include <isobath/runtime/obstacle_json.hpp>

namespace isobath {
namespace {

using nlohmann::ordered_json;

/// To 1e-6: finer than any sonar, and readable.
double tidy(double value) { return std::round(value * 1e6) / 1e6; }

ordered_json outline_of(const Obstacle& o) {
  ordered_json points = ordered_json::array();
  for (const auto& p : o.outline) points.push_back({tidy(p.x()), tidy(p.y())});
  return points;
}

}  // namespace

ordered_json to_json(const std::vector<Obstacle>& obstacles) {
  ordered_json list = ordered_json::array();
  for (const Obstacle& o : obstacles) {
    list.push_back({{"bearing_deg", tidy(o.bearing.wrapped_positive().degrees())},
                    {"range_m", tidy(o.range_m)},
                    {"existence", tidy(o.existence)},
                    {"outline_m", outline_of(o)},
                    {"behind", o.behind},
                    {"possible_multiple", o.possible_multiple},
                    {"centre_m", {tidy(o.centre.x()), tidy(o.centre.y())}},
                    {"covariance_m2", {tidy(o.covariance(0, 0)), tidy(o.covariance(0, 1)), tidy(o.covariance(1, 1))}},
                    {"echoes", o.hits},
                    {"last_echo", to_text(o.last_hit)}});
  }
  return list;
}

ordered_json scan_header(int number, Time time, const Pose& X_WB, bool posed) {
  ordered_json header{{"scan", number}, {"time", to_text(time)}, {"time_ns", time.time_since_epoch().count()}};
  if (posed) {
    header["north_m"] = tidy(X_WB.translation.x());
    header["east_m"] = tidy(X_WB.translation.y());
    header["depth_m"] = tidy(X_WB.translation.z());
    header["heading_deg"] = tidy(X_WB.rotation.heading().wrapped_positive().degrees());
  }
  return header;
}

std::string obstacles_geojson(const std::vector<Obstacle>& obstacles, const Pose& X_WL, const GeoOrigin& origin) {
  std::vector<GeoFeature> features;
  for (const Obstacle& o : obstacles) {
    GeoFeature feature;
    for (const auto& p : o.outline) feature.outline.emplace_back((X_WL * Eigen::Vector3d(p.x(), p.y(), 0)).head<2>());
    feature.properties = {{"existence", tidy(o.existence)},
                          {"range_m", tidy(o.range_m)},
                          {"bearing_deg", tidy(o.bearing.wrapped_positive().degrees())},
                          {"behind", o.behind},
                          {"possible_multiple", o.possible_multiple}};
    features.push_back(std::move(feature));
  }
  return geojson_text(features, origin);
}

ordered_json manifest_json(const RunRequest& request, const RunOutcome& outcome) {
  const PipelineCounts& n = outcome.counts;
  ordered_json manifest{{"program", "isobath"},
                        {"version", ISOBATH_VERSION},
                        {"input", request.input.empty() ? "embedded reservoir" : request.input.string()},
                        {"format", outcome.source.format},
                        {"bytes", outcome.source.bytes_total},
                        {"seed", request.configuration.reservoir.seed},
                        {"problem", outcome.problem}};
  for (const auto& [key, value] : outcome.source.details) manifest["details"][key] = value;
  manifest["counts"] = {{"pings", n.pings},   {"pings_without_pose", n.unposed}, {"navigation", n.navigation},
                        {"ranges", n.ranges}, {"scans", n.scans},                {"bins", n.bins},
                        {"hits", n.hits},     {"obstacles", outcome.obstacles.size()}};
  manifest["rejected"] = ordered_json::object();
  for (const auto& [reason, count] : outcome.rejected) manifest["rejected"][reason] = count;
  manifest["bytes_skipped"] = outcome.source.bytes_skipped;
  manifest["skipped"] = ordered_json::array();
  for (const Damage& d : outcome.source.damages) {
    manifest["skipped"].push_back({{"offset", d.offset}, {"bytes", d.bytes}, {"reason", d.reason}});
  }
  for (const auto& file : outcome.files) manifest["files"].push_back(file.string());
  return manifest;
}

}  // namespace isobath
