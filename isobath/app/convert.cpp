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
#include <isobath/base/text_file.hpp>
#include <isobath/cameras/pair_source.hpp>
#include <isobath/io/mcap/native_log.hpp>
#include <isobath/io/ros/ros_log_writer.hpp>
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
  std::string schema = "native";
  bool no_records = false;
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

/// Kinds of logs of ROS by the ending of their file.
struct RosFile {
  const char *ending, *name;
  std::unique_ptr<RosRecorder> (*record)(const std::filesystem::path& file);
};
constexpr RosFile kRosFiles[] = {{".bag", "ROS 1 bag", record_ros1_bag},
                                 {".db3", "ROS 2 bag (SQLite)", record_ros2_database},
                                 {".mcap", "ROS 2 bag (MCAP)", record_ros2_mcap}};

/// The kind of log of ROS that is asked for; null: the native log.
const RosFile* ros_file_of(const ConvertOptions& options) {
  const std::string ending = ending_of(options.output);
  for (const RosFile& kind : kRosFiles) {
    if (ending == kind.ending && (options.schema == "ros2" || ending != ".mcap")) return &kind;
  }
  return nullptr;
}

/// Reads every event of the input, with every bin, into a sink: set_origin, write.
struct LogInput {
  explicit LogInput(const ConvertOptions& options) {
    const Configuration configuration = options.config.read();
    InputConfig input = configuration.input;
    input.max_bins = 0;  // the converted log keeps every bin
    std::vector<std::filesystem::path> inputs = files_of_input(options.input);
    inputs.emplace_back(input.navigation);
    check_output_is_no_input(options.output, inputs, "OUT");
    source = open_input(options.input, input, configuration.cameras);
    ros = {!options.no_records, input.surface_pressure_pa, input.water_density};
  }

  template <class Sink>
  void copy_to(Sink& sink) {
    bool place_known = false;
    const auto tell_place = [&] {
      if (place_known || !source->report().origin) return;
      sink.set_origin(*source->report().origin);
      place_known = true;
    };
    ProgressLine progress;
    while (const auto event = source->next()) {
      tell_place();  // many inputs state it after their start
      if (sink.write(*event)) ++events;
      progress.show(source->report().bytes_read, source->report().bytes_total, events);
    }
    tell_place();
    progress.clear();
  }

  std::unique_ptr<Source> source;
  RosLogOptions ros;
  std::uint64_t events = 0;
};

ordered_json log_json(const ConvertOptions& options, const LogInput& log) {
  const SourceReport& report = log.source->report();
  ordered_json json = conversion_json(options, "log");
  json["format"] = report.format;
  json["events"] = log.events;
  json["bytes"] = report.bytes_total;
  json["bytes_skipped"] = report.bytes_skipped;
  json["rejected"] = report.rejected;
  json["topics"] = ordered_json::array();  // of a log of ROS, as the next two
  json["records_only"] = json["left_out"] = ordered_json::object();
  return json;
}

void print_skipped(const LogInput& log) {
  const std::uint64_t skipped = log.source->report().bytes_skipped;
  if (skipped > 0) fmt::print("{} bytes of the input were skipped\n", skipped);
}

/// Writes a log as a native log.
int write_log(const ConvertOptions& options) {
  LogInput log(options);
  make_parent(options.output);
  PendingFile pending(options.output);
  NativeLogWriter writer(pending.beside());
  writer.set_details(log.source->report().details);
  log.copy_to(writer);
  writer.close();
  pending.complete();
  if (options.json) {
    print_json(log_json(options, log));
    return kSuccess;
  }
  fmt::print("{} events written to {}\n", log.events, options.output.string());
  print_skipped(log);
  return kSuccess;
}

/// The metadata.yaml that ROS 2 needs beside a bag in SQLite. Throws Error where another bag has its own there.
std::filesystem::path metadata_beside(const std::filesystem::path& bag) {
  const std::filesystem::path file = bag.parent_path() / "metadata.yaml";
  const std::string name = bag.filename().string();
  if (std::filesystem::exists(file) && text_of_file(file).find("path: \"" + name + "\"") == std::string::npos) {
    throw Error("is the metadata of another bag, and a ROS 2 bag needs one of its own", {file.string()}, "",
                "give each bag a folder: " + (bag.parent_path() / bag.stem() / name).string());
  }
  return file;
}

void print_ros_log(const ConvertOptions& options, const RosFile& kind, const LogInput& log, const RosRecorder& bag,
                   const RosLogWriter& writer) {
  if (options.json) {
    ordered_json json = log_json(options, log);
    for (const RecordedTopic& t : bag.topics()) {
      json["topics"].push_back({{"topic", t.name}, {"type", t.type}, {"messages", t.messages}});
    }
    json["records_only"] = writer.records_only();
    json["left_out"] = writer.left_out();
    print_json(json);
    return;
  }
  fmt::print("{} events written to {}: {}\n", log.events, options.output.string(), kind.name);
  for (const RecordedTopic& t : bag.topics()) fmt::print("  {}: {} of {}\n", t.name, t.messages, t.type);
  for (const auto& [what, count] : writer.records_only()) {
    fmt::print("  {} {}: no message of ROS fits, so they are in /isobath only\n", count, what);
  }
  for (const auto& [reason, count] : writer.left_out()) fmt::print("  left out {}: {}\n", count, reason);
  print_skipped(log);
}

/// Writes a log as a log of ROS.
int write_ros_log(const ConvertOptions& options, const RosFile& kind) {
  LogInput log(options);
  make_parent(options.output);
  const bool has_metadata = kind.record == record_ros2_database;
  const std::filesystem::path metadata = has_metadata ? metadata_beside(options.output) : std::filesystem::path();
  PendingFile pending(options.output);
  const std::unique_ptr<RosRecorder> bag = kind.record(pending.beside());
  RosLogWriter writer(*bag, log.ros);
  log.copy_to(writer);
  bag->close();
  pending.complete();
  if (has_metadata) write_whole_file(metadata, metadata_yaml(*bag, options.output.filename().string()));
  print_ros_log(options, kind, log, *bag, writer);
  return kSuccess;
}

int act(const ConvertOptions& options) {
  if (looks_like_map(options.input) && (ending_of(options.output) == ".tif" || ending_of(options.output) == ".tiff")) {
    return write_map(options);
  }
  if (ending_of(options.output).empty() && !looks_like_map(options.input)) return make_map(options);
  const RosFile* const ros = ros_file_of(options);
  if (options.schema == "ros2" && ending_of(options.output) != ".mcap") {
    throw Error("--schema is for .mcap: the other kinds of file have their messages by their ending",
                {options.output.string()});
  }
  if (options.no_records && !ros) {
    throw Error("--no-records is for logs of ROS", {options.output.string()},
                ".bag, .db3, or .mcap with --schema ros2");
  }
  if ((ending_of(options.output) != ".mcap" && !ros) || looks_like_map(options.input)) {
    throw Error("cannot write this kind of file", {options.output.string(), {}, {}, {}, {}},
                "a log as .mcap, .bag or .db3, a map as .tif, a chart as a folder without an extension");
  }
  return ros ? write_ros_log(options, *ros) : write_log(options);
}

}  // namespace

Action add_convert(CLI::App& program) {
  auto options = std::make_shared<ConvertOptions>();
  CLI::App* command = program.add_subcommand(
      "convert",
      "Convert a log to the native log (.mcap) or a log of ROS (.bag, .db3, .mcap), a depth map to a raster (.tif), or "
      "a chart to a map");
  command->add_option("IN", options->input, "Log, folder of frames, depth map, or chart")->check(reads())->required();
  command
      ->add_option("OUT", options->output,
                   "File to write: .mcap, .bag, .db3 or .tif; a folder for a map made from a chart")
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
  command->add_option("--schema", options->schema, "Messages of an .mcap file: those of the native log, or of ROS 2")
      ->check(one_of({"native", "ros2"}))
      ->capture_default_str()
      ->group("Logs of ROS");
  command
      ->add_flag("--no-records", options->no_records,
                 "Leave out the records of the native log that a log of ROS has beside the messages of ROS, so that "
                 "every number is as exact as those are")
      ->group("Logs of ROS");
  options->config.add_to(*command);
  add_example(*command, "convert dive.bin dive.mcap");
  add_example(*command, "convert dive.mcap dive.bag");
  add_example(*command, "convert dive.mcap dive-ros2.mcap --schema ros2");
  add_example(*command, "convert lake lake.tif --pixels-a-cell 4");
  add_example(*command, "convert US5OH10M.000 erie --set prior.map_datum=MLLW --origin 41.66,-82.82");
  return [options] { return act(*options); };
}

}  // namespace isobath::app
