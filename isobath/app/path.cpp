#include <fmt/format.h>
#include <isobath/app/commands.hpp>
#include <isobath/base/error.hpp>
#include <isobath/studies/check_path.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

struct Options {
  PathRequest request;
  std::vector<std::string> points;
  bool metres = false;
  bool json = false;
};

int act(Options& options) {
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
  const PathOutcome outcome = check_path(request);
  const Traversability& t = outcome.verdict;
  const bool clear = outcome.reason.empty();
  if (options.json) {
    const nlohmann::ordered_json json{{"clear", clear},
                                      {"reason", outcome.reason},
                                      {"least_water", outcome.least},
                                      {"length_m", outcome.length_m},
                                      {"pixels", t.pixels},
                                      {"share_clear", t.fraction},
                                      {"share_clear_weighted", t.weighted},
                                      {"unknown_pixels", t.unknown},
                                      {"map_version", t.map_version}};
    fmt::print("{}\n", json.dump(2));
  } else if (clear) {
    fmt::print("clear: {:.0f} m of path, {} pixels, all with enough water\n", outcome.length_m, t.pixels);
  } else {
    fmt::print("refused: {}\n{:.1f} % of {} pixels are clear, {} are unknown\n", outcome.reason, 100 * t.fraction,
               t.pixels, t.unknown);
  }
  if (!options.json && !outcome.least.empty()) fmt::print("{}\n", outcome.least);
  return clear ? kSuccess : kFailedChecks;
}

}  // namespace

Action add_path(CLI::App& program) {
  auto options = std::make_shared<Options>();
  PathRequest& request = options->request;
  CLI::App* command =
      program.add_subcommand("path", "Check whether a path over a map has the water that a vehicle needs");
  command->add_option("MAP", request.map, "Folder of a depth map")->required();
  command->add_option("POINT", options->points, "Way-points: latitude,longitude")->required()->expected(1, 10000);
  command->add_flag("--metres", options->metres, "Way-points are metres north,east of the map's origin");
  command->add_option("--draught", request.draught_m, "Depth of the vehicle's lowest part, m")->capture_default_str();
  command->add_option("--clearance", request.passage.clearance_m, "Water required below the vehicle, m")
      ->capture_default_str();
  command->add_option("--half-width", request.passage.half_width_m, "Half the width of the corridor, m")
      ->capture_default_str();
  command->add_option("--around-objects", request.obstacle_radius_m, "Distance to keep from charted objects, m")
      ->capture_default_str();
  command->add_flag("--json", options->json, "One JSON object on standard output");
  return [options] { return act(*options); };
}

}  // namespace isobath::app
