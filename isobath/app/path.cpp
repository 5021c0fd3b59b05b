#include <fmt/format.h>
#include <isobath/app/commands.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/studies/check_path.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

struct PathOptions {
  PathRequest request;
  std::vector<std::string> points;
  std::filesystem::path mission;
  bool metres = false;
  bool json = false;
};

/// The place as "north_m" and "east_m", with latitude and longitude if the map has an origin.
void add_place(nlohmann::ordered_json& json, const PathOutcome& outcome, const Eigen::Vector2d& place) {
  json["north_m"] = place.x();
  json["east_m"] = place.y();
  if (!outcome.origin) return;
  const GeoPoint point = LocalPlane(*outcome.origin).to_geo(place);
  json["latitude_deg"] = point.latitude_deg;
  json["longitude_deg"] = point.longitude_deg;
}

/// A place on the path that decides the result; null if there is none.
nlohmann::ordered_json decisive_json(const PathOutcome& outcome, const std::optional<PassagePlace>& place) {
  if (!place) return {};
  nlohmann::ordered_json json{{"leg", place->leg + 1}, {"along_m", place->along_m}};
  add_place(json, outcome, outcome.verdict.grid.centre(place->pixel));
  json["depth_m"] = nullptr;
  json["water_m"] = nullptr;
  if (place->depth_m) {
    json["depth_m"] = *place->depth_m;
    json["water_m"] = *place->depth_m - place->vehicle_z;
  }
  json["confidence"] = place->confidence;
  json["charted_object"] = place->obstacle.has_value();
  return json;
}

nlohmann::ordered_json way_json(const PathOutcome& outcome) {
  auto way = nlohmann::ordered_json::array();
  for (const Eigen::Vector2d& p : outcome.way) add_place(way.emplace_back(), outcome, p);
  return way;
}

void print_way(const PathOutcome& outcome) {
  for (std::size_t i = 0; i < outcome.way.size(); ++i) {
    const Eigen::Vector2d& p = outcome.way[i];
    fmt::print("  {:2}  north {:9.2f} m  east {:9.2f} m {}\n", i + 1, p.x(), p.y(), place_text(outcome.origin, p));
  }
}

int act(PathOptions& options) {
  PathRequest& request = options.request;
  for (const std::string& text : options.points) {
    const Eigen::Vector2d p = pair_of(text);
    if (options.metres) {
      request.local_m.push_back(p);
      continue;
    }
    const GeoPoint point{p.x(), p.y()};
    if (!valid(point))
      throw Error("\"" + text + "\" is not a position on the globe", {}, "latitude,longitude in degrees");
    request.points.push_back(point);
  }
  if (!options.mission.empty() && !request.find) throw Error("--mission needs --find", {.key = "--mission"});
  const PathOutcome outcome = check_path(request);
  const Traversability& t = outcome.verdict;
  const bool clear = outcome.reason.empty();
  if (clear && !options.mission.empty()) write_whole_file(options.mission, mission_along(request, outcome));
  if (options.json) {
    print_json({{"clear", clear},
                {"reason", outcome.reason},
                {"shoalest", decisive_json(outcome, t.worst)},
                {"blocking", decisive_json(outcome, t.blocking)},
                {"length_m", outcome.length_m},
                {"pixels", t.pixels},
                {"share_clear", t.fraction},
                {"share_clear_weighted", t.weighted},
                {"unknown_pixels", t.unknown},
                {"unsure_pixels", t.unsure},
                {"way", way_json(outcome)},
                {"queries", outcome.queries},
                {"map_version", t.map_version}});
  } else if (clear) {
    fmt::print("clear: {:.0f} m of path, {} pixels, all with enough water\n", outcome.length_m, t.pixels);
    print_way(outcome);
    if (!options.mission.empty()) fmt::print("written to {}\n", options.mission.string());
  } else {
    fmt::print("refused: {}\n{:.1f} % of {} pixels are clear, {} are unknown, {} too unsure\n", outcome.reason,
               100 * t.fraction, t.pixels, t.unknown, t.unsure);
  }
  if (!options.json && !outcome.least.empty()) fmt::print("{}\n", outcome.least);
  return clear ? kSuccess : kFailedChecks;
}

}  // namespace

Action add_path(CLI::App& program) {
  auto options = std::make_shared<PathOptions>();
  PathRequest& request = options->request;
  CLI::App* command =
      program.add_subcommand("path", "Check whether a path over a map has the water that a vehicle needs");
  command->add_option("MAP", request.map, "Folder of a depth map")->check(reads_folder())->required();
  command->add_option("POINT", options->points, "Way-points: latitude,longitude in degrees")
      ->required()
      ->expected(1, 10000);
  command->add_flag("--metres", options->metres, "Way-points are metres north,east of the map's origin")->group("Path");
  const auto length = [&](const char* name, double& value, const char* text, const char* group = "Path") {
    command->add_option(name, value, text)->check(number(-INFINITY, INFINITY))->capture_default_str()->group(group);
  };
  length("--draught", request.draught_m, "Depth of the vehicle's lowest part, m");
  length("--clearance", request.search.passage.clearance_m, "Water required below the vehicle, m");
  length("--half-width", request.search.passage.half_width_m, "Half the width of the corridor, m");
  length("--around-objects", request.obstacle_radius_m, "Distance to keep from charted objects, m");
  const char* kFinding = "Finding a way";
  command
      ->add_flag("--find", request.find,
                 "Find the safest short way from point to point; without it, straight legs are checked")
      ->group(kFinding);
  length("--risk-weight", request.search.risk_weight,
         "Detour that one e-fold of shallow water nearby is worth, m per m of way", kFinding);
  length("--risk-reach", request.search.risk_reach_m, "Shallow water within this distance is a risk, m", kFinding);
  length("--margin", request.search.margin_m, "How far to search around the box of the points, m", kFinding);
  command->add_option("--mission", options->mission, "Write the way as a mission file")
      ->check(writes_file())
      ->group(kFinding);
  add_json_flag(*command, options->json);
  add_example(*command, "path lake 54.2861,10.1512 54.2874,10.1555 --draught 1.2");
  add_example(*command, "path lake 0,0 150,40 --metres --half-width 5 --json");
  add_example(*command, "path lake 54.2861,10.1512 54.2874,10.1555 --draught 1.2 --find --mission way.toml");
  return [options] { return act(*options); };
}

}  // namespace isobath::app
