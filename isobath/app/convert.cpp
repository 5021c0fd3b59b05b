#include <fmt/format.h>
#include <isobath/app/config_options.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/progress.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/error.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/base/printable_text.hpp>
#include <isobath/cameras/pair_source.hpp>
#include <isobath/io/mcap/native_log.hpp>
#include <isobath/map/depth/map_folder.hpp>
#include <isobath/run/map_from_prior.hpp>
#include <isobath/world/map_raster.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

struct ConvertOptions {
  ConfigOptions config;
  std::filesystem::path input, output;
  std::string origin;
  int pixels_a_cell = 0;
  bool json = false;
};

using nlohmann::ordered_json;

/// What was made, with the paths that every conversion has.
ordered_json conversion_json(const ConvertOptions& options, const char* what) {
  return {{"input", options.input.string()}, {"output", options.output.string()}, {"made", what}};
}

/// Writes a depth map as the bands of a raster.
int write_map(const ConvertOptions& options) {
  const StoredMap map = open_map(options.input);
  const PixelWindow known = known_extent(map.trees);
  if (known.width == 0) throw Error("the map has no depths, so there is nothing to write", {options.input.string()});
  const MapRaster raster = read_raster(*snapshot_of(map), known, options.pixels_a_cell);
  make_parent(options.output);
  write_map_geotiff(raster, map.facts, options.config.read().depth.evidence, options.output);
  if (options.json) {
    ordered_json json = conversion_json(options, "raster");
    json["damages"] = ordered_json::array();
    for (const MapDamage& damage : map.damages) json["damages"].push_back(map_damage_json(damage));
    json["width"] = raster.window.width;
    json["height"] = raster.window.height;
    json["cell_m"] = raster.grid.pixel_m;
    json["bands"] = {"depth", "confidence", "age", "source", "uncertainty"};
    print_json(json);
    return kSuccess;
  }
  for (const MapDamage& damage : map.damages) fmt::print("damaged: {}\n", to_text(damage));
  fmt::print("{} x {} cells of {} m written to {}: depth, confidence, age, source, uncertainty\n", raster.window.width,
             raster.window.height, raster.grid.pixel_m, options.output.string());
  return kSuccess;
}

/// Makes a depth map from a chart, for a mission to start from.
int make_map(const ConvertOptions& options) {
  std::optional<GeoOrigin> origin;
  if (!options.origin.empty()) {
    const Eigen::Vector2d p = pair_of(options.origin);
    origin = GeoOrigin{p.x(), p.y()};
    if (!valid(*origin))
      throw Error("\"" + options.origin + "\" is not a position on the globe", {}, "latitude,longitude");
  }
  const PriorMapOutcome made = make_map_of_prior(options.input, options.output, options.config.read(), origin);
  if (options.json) {
    ordered_json json = conversion_json(options, "map");
    const GeoOrigin& at = *made.facts.origin;
    json["origin"] = {{"latitude_deg", at.latitude_deg}, {"longitude_deg", at.longitude_deg}};
    json["read"] = made.read;
    json["left_out"] = made.left_out;
    json["details"] = made.details;
    json["known_pixels"] = made.known_pixels;
    json["objects_and_lines"] = made.features;
    print_json(json);
    return kSuccess;
  }
  for (const auto& [what, count] : made.read) fmt::print("  read {}: {}\n", what, count);
  for (const auto& [reason, count] : made.left_out) fmt::print("  left out {}: {}\n", count, printable_text(reason));
  for (const auto& [key, value] : made.details) fmt::print("  {}: {}\n", printable_text(key), printable_text(value));
  fmt::print("{} pixels with a depth, {} objects and lines; map written to {}\n", made.known_pixels, made.features,
             options.output.string());
  return kSuccess;
}

std::string ending_of(const std::filesystem::path& path) { return path.extension().string(); }

/// Writes a log as a native log, with every bin.
int write_log(const ConvertOptions& options) {
  const Configuration configuration = options.config.read();
  InputConfig input = configuration.input;
  input.max_bins = 0;  // the converted log keeps every bin
  std::vector<std::filesystem::path> inputs = files_of_input(options.input);
  inputs.emplace_back(input.navigation);
  check_output_is_no_input(options.output, inputs, "OUT");
  const auto source = open_input(options.input, input, configuration.cameras);
  make_parent(options.output);
  PendingFile pending(options.output);
  NativeLogWriter log(pending.beside());
  log.set_details(source->report().details);
  const bool place_known = source->report().origin.has_value();
  if (place_known) log.set_origin(*source->report().origin);
  ProgressLine progress;
  std::uint64_t events = 0;
  while (const auto event = source->next()) {
    if (log.write(*event)) ++events;
    progress.show(source->report().bytes_read, source->report().bytes_total, events);
  }
  if (!place_known && source->report().origin) log.set_origin(*source->report().origin);
  log.close();
  pending.complete();
  progress.clear();
  const SourceReport& report = source->report();
  if (options.json) {
    ordered_json json = conversion_json(options, "log");
    json["format"] = report.format;
    json["events"] = events;
    json["bytes"] = report.bytes_total;
    json["bytes_skipped"] = report.bytes_skipped;
    json["rejected"] = report.rejected;
    print_json(json);
    return kSuccess;
  }
  fmt::print("{} events written to {}\n", events, options.output.string());
  if (report.bytes_skipped > 0) fmt::print("{} bytes of the input were skipped\n", report.bytes_skipped);
  return kSuccess;
}

int act(const ConvertOptions& options) {
  if (looks_like_map(options.input) && (ending_of(options.output) == ".tif" || ending_of(options.output) == ".tiff")) {
    return write_map(options);
  }
  if (ending_of(options.output).empty() && !looks_like_map(options.input)) return make_map(options);
  if (ending_of(options.output) != ".mcap" || looks_like_map(options.input)) {
    throw Error("cannot write this kind of file", {options.output.string(), {}, {}, {}, {}},
                "a log as .mcap, a map as .tif, a chart as a folder without an extension");
  }
  return write_log(options);
}

}  // namespace

Action add_convert(CLI::App& program) {
  auto options = std::make_shared<ConvertOptions>();
  CLI::App* command = program.add_subcommand(
      "convert", "Convert a log to the native log (.mcap), a depth map to a raster (.tif), or a chart to a map");
  command->add_option("IN", options->input, "Log, folder of frames, depth map, or chart")->check(reads())->required();
  command->add_option("OUT", options->output, "File to write, .mcap or .tif; a folder for a map made from a chart")
      ->check(writes())
      ->required();
  add_json_flag(*command, options->json);
  command->add_option("--origin", options->origin, "Origin of a map made from a chart, degrees")
      ->type_name("LAT,LON")
      ->default_str("its centre")
      ->group("Maps");
  command
      ->add_option("--pixels-a-cell", options->pixels_a_cell,
                   "Pixels along the side of a raster cell; 0: as fine as 16 million cells allow")
      ->check(whole(0, 4096))
      ->capture_default_str()
      ->group("Maps");
  options->config.add_to(*command);
  add_example(*command, "convert dive.bin dive.mcap");
  add_example(*command, "convert lake lake.tif --pixels-a-cell 4");
  add_example(*command, "convert US5OH10M.000 erie --set prior.map_datum=MLLW --origin 41.66,-82.82");
  return [options] { return act(*options); };
}

}  // namespace isobath::app
