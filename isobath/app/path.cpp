#include <algorithm>
#include <fmt/format.h>
#include <isobath/app/commands.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/base/printable_text.hpp>
#include <isobath/studies/check_path.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

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
  for (const Eigen::Vector3d& p : outcome.way) {
    add_place(way.emplace_back(), outcome, p.head<2>());
    way.back()["vehicle_depth_m"] = p.z();
  }
  return way;
}

nlohmann::ordered_json object_json(const PathOutcome& outcome, const ObjectNear& object) {
  nlohmann::ordered_json json{{"kind", object.kind}, {"name", object.name}, {"distance_m", object.distance_m}};
  add_place(json, outcome, object.north_east);
  json["depth_m"] = object.depth_m;
  json["shapes"] = nlohmann::ordered_json::array();
  for (const ShapeReference& shape : object.shapes) {
    const Eigen::Vector3d& c = shape.centroid;
    json["shapes"].push_back({{"file", shape.file},
                              {"volume_m3", shape.volume_m3},
                              {"holes", shape.holes},
                              {"centroid_m", {c.x(), c.y(), c.z()}}});
  }
  return json;
}

nlohmann::ordered_json nearest_json(const PathOutcome& outcome) {
  if (!outcome.nearest_object) return {};
  return object_json(outcome, *outcome.nearest_object);
}

nlohmann::ordered_json objects_json(const PathOutcome& outcome) {
  auto objects = nlohmann::ordered_json::array();
  for (const ObjectNear& object : outcome.objects) objects.push_back(object_json(outcome, object));
  return objects;
}

void print_objects(const PathOutcome& outcome, bool listed) {
  if (!outcome.nearest_object) return;
  const auto print = [](const char* title, const ObjectNear& object) {
    const std::string name = object.name.empty() ? "" : " \"" + printable_text(object.name) + "\"";
    fmt::print("{}: {}{}, {:.1f} m from the first point, top at {:.1f} m\n", title, printable_text(object.kind), name,
               object.distance_m, object.depth_m);
    for (const ShapeReference& shape : object.shapes) {
      fmt::print("  shape: {}, {:.1f} m3, holes: {}\n", printable_text(shape.file), shape.volume_m3, shape.holes);
    }
  };
  if (!listed) print("nearest object", *outcome.nearest_object);
  for (const ObjectNear& object : outcome.objects) print("object", object);
}

nlohmann::ordered_json abreast_json(const PathRequest& request, const PathOutcome& outcome) {
  if (!outcome.abreast) return {};
  const AbreastOutcome& a = *outcome.abreast;
  return {{"wanted", request.formation.vehicles},
          {"vehicles", a.vehicles},
          {"sure_by_blocks", a.blocks.sure},
          {"possible_by_blocks", a.blocks.possible},
          {"mixed_share", a.mixed_share}};
}

nlohmann::ordered_json threats_json(const PathOutcome& outcome) {
  if (!outcome.threats) return {};
  const ThreatOutcome& t = *outcome.threats;
  return {{"areas", t.areas},
          {"detection", t.detection.probability()},
          {"destruction", t.destruction.probability()},
          {"straight_detection", t.straight_detection.probability()},
          {"straight_destruction", t.straight_destruction.probability()}};
}

void print_abreast(const PathRequest& request, const AbreastOutcome& a) {
  fmt::print("abreast: {} of {} vehicles\n", a.vehicles, request.formation.vehicles);
}

void print_threats(const PathRequest& request, const ThreatOutcome& t) {
  const auto share = [](const PathRisk& risk) { return 100 * risk.probability(); };
  fmt::print("threats: {:.1f} % to be detected, {:.1f} % to be destroyed", share(t.detection), share(t.destruction));
  if (request.find || request.line.any()) {
    fmt::print("; on the straight legs {:.1f} % and {:.1f} %", share(t.straight_detection),
               share(t.straight_destruction));
  }
  fmt::print("\n");
}

void print_way(const PathOutcome& outcome) {
  for (std::size_t i = 0; i < outcome.way.size(); ++i) {
    const Eigen::Vector3d& p = outcome.way[i];
    fmt::print("  {:2}  north {:9.2f} m  east {:9.2f} m  depth {:6.2f} m {}\n", i + 1, p.x(), p.y(), p.z(),
               place_text(outcome.origin, p.head<2>()));
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
  if (!options.mission.empty() && !request.find && !request.line.any()) {
    throw Error("--mission needs --find, --along or --contour", {.key = "--mission"});
  }
  if ((request.altitude_m || request.offset_m != 0) && !request.line.any()) {
    throw Error("--offset and --altitude need --along or --contour", {.key = "--altitude"});
  }
  if (std::filesystem::is_regular_file(request.line.feature)) {
    request.line.file = std::exchange(request.line.feature, {});
  }
  request.line.cell_m = std::max(1.0, 2 * request.search.passage.half_width_m);
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
                {"obstacles_examined", outcome.obstacles},
                {"nearest_object", nearest_json(outcome)},
                {"objects", objects_json(outcome)},
                {"abreast", abreast_json(request, outcome)},
                {"threats", threats_json(outcome)},
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
  if (!options.json) {
    if (!outcome.least.empty()) fmt::print("{}\n", outcome.least);
    print_objects(outcome, request.objects_within_m.has_value());
    if (outcome.abreast) print_abreast(request, *outcome.abreast);
    if (outcome.threats) print_threats(request, *outcome.threats);
  }
  return clear ? kSuccess : kFailedChecks;
}

void add_following(CLI::App& command, PathRequest& request, CLI::Option* find) {
  const char* kFollowing = "Following a line";
  CLI::Option* along =
      command
          .add_option("--along", request.line.feature,
                      "Follow a line from the first point to the second, or to the line's end: name or kind of a "
                      "line of the map, the nearest one, or a file of lines (GeoJSON, shapefile, GeoPackage)")
          ->check(such_as(
              [] {
                return std::vector<std::string>{"nearest", "pipeline", "contour", "coast"};
              },
              true))
          ->excludes(find)
          ->group(kFollowing);
  command
      .add_option("--contour", request.line.contour_m, "Follow the contour line of this depth of the map instead, m")
      ->check(number(-INFINITY, INFINITY))
      ->excludes(along)
      ->excludes(find)
      ->group(kFollowing);
  command.add_option("--offset", request.offset_m, "Distance of the course from the line, to starboard, m")
      ->check(number(-INFINITY, INFINITY))
      ->capture_default_str()
      ->group(kFollowing);
  command
      .add_option("--altitude", request.altitude_m,
                  "Altitude above the bottom of the map, m; without it the depth is the draught")
      ->check(number(0, 1000))
      ->group(kFollowing);
}

void add_abreast(CLI::App& command, PathRequest& request) {
  const char* kAbreast = "Several vehicles abreast";
  CLI::Option* vehicles = command.add_option("--vehicles", request.formation.vehicles, "How many")
                              ->check(whole(1, 100))
                              ->capture_default_str()
                              ->group(kAbreast);
  const auto of_vehicles = [&](const char* name, double& value, const char* text) {
    command.add_option(name, value, text)->check(number(0, 10000))->needs(vehicles)->group(kAbreast);
  };
  of_vehicles("--spacing", request.formation.spacing_m, "Distance between neighbours, m");
  of_vehicles("--depth-spread", request.formation.depth_spread_m, "How much deeper the deepest vehicle may be, m");
}

void add_threats(CLI::App& command, PathRequest& request) {
  const char* kThreats = "Threats";
  CLI::Option* threats =
      command
          .add_option("--threats", request.threats,
                      "Areas with the probability of detection or destruction (GeoJSON, shapefile, GeoPackage)")
          ->check(reads())
          ->group(kThreats);
  command
      .add_option("--threat-weight", request.search.threat_weight_m,
                  "Detour that one e-fold less chance of passing unharmed is worth to --find, m")
      ->check(number(0, 1e6))
      ->needs(threats)
      ->capture_default_str()
      ->group(kThreats);
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
  command
      ->add_option("--objects-within", request.objects_within_m,
                   "List the objects of the map within this distance of the first point, m")
      ->check(number(0, 1e6))
      ->group("Path");
  const char* kFinding = "Finding a way";
  CLI::Option* find = command
                          ->add_flag("--find", request.find,
                                     "Find the safest short way from point to point; without it, straight legs are "
                                     "checked")
                          ->group(kFinding);
  length("--risk-weight", request.search.risk_weight,
         "Detour that one e-fold of shallow water nearby is worth, m per m of way", kFinding);
  length("--risk-reach", request.search.risk_reach_m, "Shallow water within this distance is a risk, m", kFinding);
  length("--margin", request.search.margin_m, "How far to search around the box of the points, m", kFinding);
  add_following(*command, request, find);
  add_abreast(*command, request);
  add_threats(*command, request);
  command->add_option("--mission", options->mission, "Write the way that was found, or the course, as a mission file")
      ->check(writes_file())
      ->group("Output");
  add_json_flag(*command, options->json);
  add_example(*command, "path lake 54.2861,10.1512 54.2874,10.1555 --draught 1.2");
  add_example(*command, "path lake 0,0 150,40 --metres --half-width 5 --json");
  add_example(*command, "path lake 54.2861,10.1512 54.2874,10.1555 --draught 1.2 --find --mission way.toml");
  add_example(*command, "path lake 54.2861,10.1512 --along pipeline --offset 4 --altitude 3 --mission pipe.toml");
  add_example(*command, "path lake 54.2861,10.1512 54.2874,10.1555 --vehicles 3 --spacing 10 --threats patrol.geojson");
  return [options] { return act(*options); };
}

}  // namespace isobath::app
