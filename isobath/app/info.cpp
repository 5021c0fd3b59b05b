#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <isobath/app/config_options.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/progress.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/base/printable_text.hpp>
#include <isobath/cameras/pair_source.hpp>
#include <isobath/map/depth/map_folder.hpp>
#include <isobath/report/result_text.hpp>
#include <isobath/studies/inspection.hpp>
#include <isobath/studies/tree_picture.hpp>
#include <isobath/world/map_changes.hpp>
#include <isobath/world/map_raster.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

using nlohmann::ordered_json;

ordered_json beams_json(const Inspection& facts) {
  return {{"azimuth_deg", {facts.azimuth_min_deg, facts.azimuth_max_deg}},
          {"width_deg", facts.beam_width_deg},
          {"height_deg", facts.beam_height_deg},
          {"intensity_counts", {facts.intensity_min, facts.intensity_max}},
          {"full_scale_counts", facts.full_scale}};
}

ordered_json soundings_json(const SwathFacts& s) {
  const bool known = s.sound_speed_max > 0;
  return {{"swaths", s.swaths},
          {"count", s.soundings},
          {"in_water", s.in_water},
          {"per_swath", {s.beams_min, s.beams_max}},
          {"below", s.level ? "water" : "body"},
          {"depth_m", {s.depth_min_m, s.depth_max_m}},
          {"sound_speed", known ? ordered_json{s.sound_speed_min, s.sound_speed_max} : ordered_json()}};
}

ordered_json source_json(const SourceReport& report, const Inspection& facts) {
  ordered_json json{{"format", report.format}, {"bytes", report.bytes_total}, {"bytes_skipped", report.bytes_skipped}};
  json["details"] = report.details;
  json["streams"] = ordered_json::array();
  for (const StreamFacts& s : facts.streams) {
    ordered_json stream{{"name", s.name}, {"events", s.events}};
    add_time(stream, "first", s.first);
    add_time(stream, "last", s.last);
    stream.update(ordered_json{{"rate_hz", s.rate()},
                               {"median_interval_s", s.median_interval_s},
                               {"gaps", s.gaps},
                               {"longest_gap_s", s.longest_gap_s}});
    if (s.gaps > 0) add_time(stream, "longest_gap_at", s.longest_gap_at);
    stream["steps_back"] = s.backwards;
    json["streams"].push_back(std::move(stream));
  }
  json["geometries"] = ordered_json::array();
  for (const PingGeometry& g : facts.geometries) {
    json["geometries"].push_back(
        {{"beams", g.beams}, {"bins", g.bins}, {"start_m", g.start_m}, {"end_m", g.end_m}, {"pings", g.pings}});
  }
  json["beams"] = facts.geometries.empty() ? ordered_json() : beams_json(facts);
  json["soundings"] = facts.swaths.swaths > 0 ? soundings_json(facts.swaths) : ordered_json();
  json["damage"] = ordered_json::array();
  for (const Damage& d : report.damages) {
    json["damage"].push_back({{"offset", d.offset}, {"bytes", d.bytes}, {"reason", d.reason}});
  }
  json["rejected"] = ordered_json::object();
  for (const auto& [reason, count] : report.rejected) json["rejected"][reason] = count;
  json["bad_pings"] = facts.bad_pings;
  json["bad_swaths"] = facts.bad_swaths;
  return json;
}

void print(const std::string& input, const SourceReport& report, const Inspection& facts) {
  fmt::print("{}: {}\n", input, report.format);
  for (const auto& [key, value] : report.details)
    fmt::print("  {:<12} {}\n", printable_text(key), printable_text(value));
  for (const StreamFacts& s : facts.streams) {
    fmt::print("  {:<12} {} from {} to {}, {:.2f}/s", printable_text(s.name), s.events, to_text(s.first),
               to_text(s.last), s.rate());
    if (s.gaps > 0) {
      fmt::print(", {} gaps, the longest {:.3f} s at {}", s.gaps, s.longest_gap_s, to_text(s.longest_gap_at));
    }
    if (s.backwards > 0) fmt::print(", {} steps back in time", s.backwards);
    fmt::print("\n");
  }
  for (const PingGeometry& g : facts.geometries) {
    fmt::print("  {:<12} {} beams x {} bins, {:.3f} .. {:.3f} m ({} pings)\n", "geometry", g.beams, g.bins, g.start_m,
               g.end_m, g.pings);
  }
  if (!facts.geometries.empty()) {
    fmt::print("  {:<12} azimuth {:.2f} .. {:.2f} deg, beam {:.2f} x {:.1f} deg, intensity {:g} .. {:g} of {:g}\n",
               "beams", facts.azimuth_min_deg, facts.azimuth_max_deg, facts.beam_width_deg, facts.beam_height_deg,
               facts.intensity_min, facts.intensity_max, facts.full_scale);
  }
  if (facts.swaths.swaths > 0) {
    const SwathFacts& s = facts.swaths;
    fmt::print("  {:<12} {} ({} .. {} a swath), {} in the water, {:.2f} .. {:.2f} m below the {}", "soundings",
               s.soundings, s.beams_min, s.beams_max, s.in_water, s.depth_min_m, s.depth_max_m,
               s.level ? "water" : "body");
    if (s.sound_speed_max > 0) fmt::print(", sound {:.1f} .. {:.1f} m/s", s.sound_speed_min, s.sound_speed_max);
    fmt::print("\n");
  }
  for (const auto& [reason, count] : report.rejected)
    fmt::print("  {:<12} {} x {}\n", "rejected", count, printable_text(reason));
  for (const Damage& d : report.damages)
    fmt::print("  {:<12} {} bytes at {}: {}\n", "damage", d.bytes, d.offset, d.reason);
}

void print(const MapChanges& changes) {
  fmt::print("  {:<12} {} obstacles and {} other regions; {} of {} measured pixels changed, {} are uncharted\n",
             "changes", changes.obstacles(), changes.regions.size() - changes.obstacles(), changes.changed_pixels,
             changes.sensed_pixels, changes.uncharted_pixels);
  for (const ChangedRegion& r : changes.regions) {
    const Eigen::Vector2d size = r.north_east - r.south_west;
    fmt::print(
        "  {:<12} by {}: {:.2f} m at north {:.1f} m, east {:.1f} m, charted {:.2f} m; {:.1f} m x {:.1f} m; "
        "confidence {} of 20\n",
        kind_of(r), to_text(r.source()), r.shoalest_m, r.shoalest_at.x(), r.shoalest_at.y(), r.charted_m, size.x(),
        size.y(), r.confidence);
  }
  fmt::print("  {:<12} {} pixels\n", "track", changes.track_pixels);
}

std::vector<std::pair<std::string, RegionQuadtree::Statistics>> trees_of(const StoredMap& map) {
  return {{"prior", map.trees.prior().statistics()},
          {"sensed", map.trees.sensed().statistics()},
          {"state", map.trees.state().statistics()}};
}

ordered_json map_json(const StoredMap& map, const std::optional<MapChanges>& changes) {
  const MapFacts& f = map.facts;
  const PixelWindow known = known_extent(map.trees);
  const double pixel = f.area.grid.pixel_m;
  ordered_json out{{"format", "Isobath depth map"},
                   {"generation", f.generation},
                   {"pixel_m", pixel},
                   {"area_m", std::ldexp(pixel, f.area.levels)},
                   {"datum", f.datum},
                   {"known_m", {known.height * pixel, known.width * pixel}},
                   {"origin", nullptr}};
  add_time(out, "epoch", f.epoch);
  if (f.origin) out["origin"] = {{"latitude_deg", f.origin->latitude_deg}, {"longitude_deg", f.origin->longitude_deg}};
  out["priors"] = f.priors;
  out["visits"] = ordered_json::array();
  for (const MapVisit& v : f.visits) {
    ordered_json visit{{"input", v.input}};
    add_time(visit, "first", v.first);
    add_time(visit, "last", v.last);
    visit["counts"] = v.counts;
    out["visits"].push_back(std::move(visit));
  }
  for (const auto apart : {RevisitRecord::kPass, RevisitRecord::kSurvey}) {
    ordered_json classes = ordered_json::array();
    for (int k = 0; k < RevisitRecord::kClasses; ++k) {
      const RevisitRecord::Agreement& a = f.revisits.agreement(apart, k);
      classes.push_back({{"n", a.n}, {"agreed", a.agreed}});
    }
    out["revisits"][apart == RevisitRecord::kPass ? "passes" : "surveys"] = std::move(classes);
  }
  out["uncertainty"] = uncertainty_json(f.revisits.uncertainty());
  for (const auto& [name, s] : trees_of(map)) {
    out["trees"][name] = {{"leaves", s.leaves}, {"words", s.words}, {"pages", s.pages}, {"bytes", s.bytes}};
  }
  out["damage"] = ordered_json::array();
  for (const MapDamage& d : map.damages) out["damage"].push_back(map_damage_json(d));
  if (changes) {
    out["changes"] = changes_json(*changes, f.origin);
    out["changes"]["track_m"] = track_json(*changes, f.area.grid);
  }
  return out;
}

/// How well later soundings agreed with the map, and the uncertainty that it states.
void print_revisits(const RevisitRecord& revisits) {
  for (const auto apart : {RevisitRecord::kSurvey, RevisitRecord::kPass}) {
    if (revisits.count(apart) == 0) continue;
    std::string shares;
    for (int k = 0; k < RevisitRecord::kClasses; ++k) {
      const RevisitRecord::Agreement& a = revisits.agreement(apart, k);
      if (a.n == 0) continue;
      const double share = 100 * static_cast<double>(a.agreed) / static_cast<double>(a.n);
      shares += fmt::format("{}{:.0f} % of {} at confidence {}", shares.empty() ? "" : ", ", share, a.n,
                            k + 1 == RevisitRecord::kClasses ? "20" : fmt::format("{}-{}", 5 * k, 5 * k + 4));
    }
    fmt::print("  {:<12} soundings of a later {} that agreed: {}\n", "revisits",
               apart == RevisitRecord::kSurvey ? "survey" : "pass", shares);
  }
  if (const auto u = revisits.uncertainty())
    fmt::print("  {:<12} at 95 %, {}\n", "uncertainty", to_text(*u, ReadingEvidenceConfig{}.margin_m));
}

void print(const std::string& folder, const StoredMap& map) {
  const MapFacts& f = map.facts;
  const PixelWindow known = known_extent(map.trees);
  const double pixel = f.area.grid.pixel_m;
  fmt::print("{}: Isobath depth map, generation {}\n", folder, f.generation);
  fmt::print("  {:<12} {} m pixels, {:.0f} m square, depths below {}\n", "area", pixel,
             std::ldexp(pixel, f.area.levels), printable_text(f.datum));
  if (f.origin) fmt::print("  {:<12} {:.7f}, {:.7f}\n", "origin", f.origin->latitude_deg, f.origin->longitude_deg);
  fmt::print("  {:<12} {:.0f} m north to south, {:.0f} m west to east\n", "known", known.height * pixel,
             known.width * pixel);
  for (const std::string& prior : f.priors) fmt::print("  {:<12} {}\n", "prior", printable_text(prior));
  for (const MapVisit& v : f.visits) {
    fmt::print("  {:<12} {}, {} to {}\n", "visit", printable_text(v.input), to_text(v.first), to_text(v.last));
  }
  print_revisits(f.revisits);
  for (const auto& [name, s] : trees_of(map)) {
    fmt::print("  {:<12} {} leaves, {} words, {:.2f} MB\n", name + " tree", s.leaves, s.words,
               static_cast<double>(s.bytes) / 1e6);
  }
  for (const MapDamage& d : map.damages) fmt::print("  {:<12} {}\n", "damage", to_text(d));
}

struct InfoOptions {
  ConfigOptions config;
  std::string input;
  bool json = false;
  bool changes = false;
  std::string tree = "prior";
  std::filesystem::path picture;
};

void draw_tree(const StoredMap& map, const InfoOptions& options) {
  const RegionQuadtree& tree = options.tree == "prior"    ? map.trees.prior()
                               : options.tree == "sensed" ? map.trees.sensed()
                                                          : map.trees.state();
  make_parent(options.picture);
  write_whole_file(options.picture,
                   tree_picture(tree, map.facts.area.grid, tree.outside(), "The " + options.tree + " tree"));
}

int describe_map(const InfoOptions& options) {
  const StoredMap map = open_map(options.input);
  std::optional<MapChanges> changes;
  if (options.changes) {
    changes = find_changes(map.trees, map.facts.area.grid, options.config.read().depth.evidence.margin_m);
  }
  if (!options.picture.empty()) draw_tree(map, options);
  if (options.json) {
    print_json(map_json(map, changes));
  } else {
    print(options.input, map);
    if (changes) print(*changes);
  }
  return kSuccess;
}

int describe_log(const InfoOptions& options) {
  const Configuration configuration = options.config.read();
  InputConfig input = configuration.input;
  input.max_bins = 0;  // describe the bins as they are in the file
  const auto source = open_input(options.input, input, configuration.cameras);
  ProgressLine progress;
  const Inspection facts = inspect(*source, [&](std::uint64_t events) {
    progress.show(source->report().bytes_read, source->report().bytes_total, events);
  });
  progress.clear();
  if (options.json) {
    print_json(source_json(source->report(), facts));
  } else {
    print(options.input, source->report(), facts);
  }
  return kSuccess;
}

}  // namespace

Action add_info(CLI::App& program) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* command = program.add_subcommand("info", "Describe a file: streams, rates, gaps, damage");
  command->add_option("FILE", options->input, "Log, folder of frames or of logs, or depth map")
      ->check(reads())
      ->required();
  add_json_flag(*command, options->json);
  command
      ->add_flag("--changes", options->changes,
                 "For a depth map: list what sonar changed against the chart, and the track")
      ->group("Output");
  command->add_option("--picture", options->picture, "For a depth map: draws the leaves of one of its trees (.png)")
      ->type_name("FILE")
      ->check(writes_file())
      ->group("Output");
  command->add_option("--tree", options->tree, "The tree that is drawn")
      ->type_name("NAME")
      ->capture_default_str()
      ->check(one_of({"prior", "sensed", "state"}))
      ->group("Output");
  options->config.add_to(*command);
  add_example(*command, "info dive.bin");
  add_example(*command, "info lake --changes");
  add_example(*command, "info dive.bin --json");
  return [options] { return looks_like_map(options->input) ? describe_map(*options) : describe_log(*options); };
}

}  // namespace isobath::app
