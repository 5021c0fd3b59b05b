#include <fmt/format.h>
#include <isobath/app/config_options.hpp>
#include <isobath/app/progress.hpp>
#include <isobath/base/error.hpp>
#include <isobath/io/mcap/native_log.hpp>
#include <isobath/io/open.hpp>
#include <isobath/map/depth/map_folder.hpp>
#include <isobath/run/map_from_prior.hpp>
#include <isobath/world/map_raster.hpp>
#include <memory>

namespace isobath::app {
namespace {

struct Options {
  ConfigOptions config;
  std::filesystem::path input, output;
  std::string origin;
  int pixels_a_cell = 0;
};

/// Writes a depth map as the bands of a raster.
int write_map(const Options& options) {
  const StoredMap map = open_map(options.input);
  for (const MapDamage& damage : map.damages) fmt::print("damaged: {}\n", to_text(damage));
  const PixelWindow known = known_extent(map.trees);
  if (known.width == 0) throw Error("the map has no depths, so there is nothing to write", {options.input.string()});
  const MapRaster raster = read_raster(*snapshot_of(map), known, options.pixels_a_cell);
  write_map_geotiff(raster, map.facts, options.output);
  fmt::print("{} x {} cells of {} m written to {}: depth, confidence, age, source\n", raster.window.width,
             raster.window.height, raster.grid.pixel_m, options.output.string());
  return kSuccess;
}

/// Makes a depth map from a chart, for a mission to start from.
int make_map(const Options& options) {
  std::optional<GeoOrigin> origin;
  if (!options.origin.empty()) {
    const Eigen::Vector2d p = pair_of(options.origin);
    origin = GeoOrigin{p.x(), p.y()};
    if (!valid(*origin))
      throw Error("\"" + options.origin + "\" is not a position on the globe", {}, "latitude,longitude");
  }
  const PriorMapOutcome made = make_map_of_prior(options.input, options.output, options.config.read(), origin);
  for (const auto& [what, count] : made.read) fmt::print("  read {}: {}\n", what, count);
  for (const auto& [reason, count] : made.left_out) fmt::print("  left out {}: {}\n", count, reason);
  for (const auto& [key, value] : made.details) fmt::print("  {}: {}\n", key, value);
  fmt::print("{} pixels with a depth, {} objects and lines; map written to {}\n", made.known_pixels, made.features,
             options.output.string());
  return kSuccess;
}

std::string ending_of(const std::filesystem::path& path) { return path.extension().string(); }

int act(const Options& options) {
  if (looks_like_map(options.input) && (ending_of(options.output) == ".tif" || ending_of(options.output) == ".tiff")) {
    return write_map(options);
  }
  if (ending_of(options.output).empty() && !looks_like_map(options.input)) return make_map(options);
  if (ending_of(options.output) != ".mcap" || looks_like_map(options.input)) {
    throw Error("cannot write this kind of file", {options.output.string(), {}, {}, {}, {}},
                "a log as .mcap, a map as .tif, a chart as a folder without an extension");
  }
  InputConfig input = options.config.read().input;
  input.most_bins = 0;  // the converted log keeps every bin
  const auto source = open_source(options.input, input);
  NativeLogWriter log(options.output);
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
  progress.clear();
  fmt::print("{} events written to {}\n", events, options.output.string());
  if (source->report().bytes_skipped > 0)
    fmt::print("{} bytes of the input were skipped\n", source->report().bytes_skipped);
  return kSuccess;
}

}  // namespace

Action add_convert(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand(
      "convert", "Convert a log to the native log (.mcap), a depth map to a raster (.tif), or a chart to a map");
  command->add_option("IN", options->input, "Log, folder of frames, depth map, or chart")->required();
  command->add_option("OUT", options->output, "File to write, .mcap or .tif; a folder for a map made from a chart")
      ->required();
  command->add_option("--origin", options->origin, "Origin of a map made from a chart; default: its centre")
      ->type_name("LAT,LON");
  command
      ->add_option("--pixels-a-cell", options->pixels_a_cell,
                   "Pixels along the side of a raster cell; 0: as fine as 16 million cells allow")
      ->check(CLI::Range(0, 4096));
  options->config.add_to(*command);
  return [options] { return act(*options); };
}

}  // namespace isobath::app
