#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/display/decision_json.hpp>
#include <isobath/display/live_page.hpp>
#include <isobath/io/gdal/geotiff.hpp>
#include <isobath/map/occupancy/whole_obstacle.hpp>
#include <isobath/report/fan_calibration.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/report/result_text.hpp>
#include <isobath/run/run_folder.hpp>
#include <isobath/run/run_manifest.hpp>
#include <limits>

namespace isobath {
namespace {

using Eigen::Vector2d;
constexpr int kPlotPixels = 640;

double ring_step(const PlanExtent& extent) {
  const auto steps = ticks(0, std::max(extent.x_max, extent.y_max), 4);
  return steps.size() > 1 ? steps[1] : 1;
}

std::string degrees(Angle a) { return fmt::format("{:.1f}", a.wrapped_positive().degrees()); }

std::string notes(const WholeObstacle& o) {
  std::string text;
  if (o.behind) text = "behind a nearer obstacle";
  const auto add = [&](const char* note) { text += std::string(text.empty() ? "" : "; ") + note; };
  if (o.possible_multiple) add("possible multiple echo");
  const WaterLabel label = o.nearest->label;
  if (label == WaterLabel::kStanding) add("stands in the water");
  if (label == WaterLabel::kBottom) add("bottom");
  if (label == WaterLabel::kSurface) add("surface");
  return text;
}

/// The name of a log or a folder, with or without a slash at the end.
std::string input_name(const std::filesystem::path& input) {
  return (input.has_filename() ? input : input.parent_path()).filename().string();
}

std::vector<HtmlReport::Row> count_rows(const PipelineCounts& n, bool pinged) {
  const auto number = [](std::uint64_t count) { return fmt::format("{}", count); };
  std::vector<HtmlReport::Row> rows;
  if (pinged) {
    rows.push_back({"pings mapped", number(n.pings)});
    if (n.vertical > 0) rows.push_back({"pings of vertical fans, for the voxel map", number(n.vertical)});
    rows.push_back({"mapped pings without a pose", number(n.unposed)});
    rows.push_back({"mapped pings by dead reckoning: the map blurs as the vehicle moves", number(n.dead_reckoned)});
    rows.push_back(
        {"mapped pings without an altitude: bottom echoes are not separated from obstacles", number(n.no_bottom)});
  }
  rows.push_back({"navigation fixes", number(n.navigation)});
  if (n.jumps > 0) {
    rows.push_back({"of these, jumps of the position: the maps around the vehicle moved along",
                    fmt::format("{}, by up to {:.1f} m", n.jumps, n.farthest_jump_m)});
  }
  rows.push_back({"range readings", number(n.ranges)});
  rows.push_back({"swaths", number(n.swaths)});
  if (!pinged) return rows;
  const double share = n.bins ? 100.0 * static_cast<double>(n.hits) / static_cast<double>(n.bins) : 0.0;
  rows.push_back({"scans", number(n.scans)});
  rows.push_back({"bins decided", number(n.bins)});
  rows.push_back({"of these in echoes of bottom or surface, which may hide a target", number(n.dim)});
  rows.push_back({"of these without information, because a target would be hidden", number(n.blind)});
  rows.push_back({"bins with an echo", fmt::format("{} ({:.2f} %)", n.hits, share)});
  return rows;
}

}  // namespace

RunFolder::RunFolder(std::filesystem::path folder, Configuration configuration)
    : folder_(std::move(folder)), configuration_(std::move(configuration)) {
  make_folder(folder_);
  for (const char* name : {"obstacles.geojson", "occupancy.tif",   "occupancy.png",
                           "sonar.png",         "detections.png",  "truth.json",
                           "depth.tif",         "chart.png",       "confidence.png",
                           "contours.geojson",  "decisions.json",  "mission.json",
                           "mission.png",       "clearance.png",   "voxels.bt",
                           "voxels.ply",        "voxels.sqlite",   "voxels.sqlite-journal",
                           "voxels.vdb",        "voxels.png",      "voxels-south.png",
                           "voxels-east.png",   "voxels-depth.png"}) {
    std::filesystem::remove(folder_ /
                            name);  // not every run writes these files, and those of an earlier run must not remain
  }
}

void RunFolder::on_ping(const PosedPing& posed) { sweep_.push_back({posed.ping, posed.X_WB}); }

void RunFolder::on_jump(const Eigen::Vector3d& by_W) {
  for (KeptPing& kept : sweep_) kept.X_WB.translation += by_W;
}

void RunFolder::on_scan(const ScanResult& scan) {
  const Detection& found = scan.detection;
  obstacles_ = found.obstacles;
  scans_.push_back({scan.number, found.time, found.X_WB, scan.posed, found.obstacles});
  track_.push_back(found.X_WB.translation.head<2>());
  // A sweep that the end of the log cuts short does not replace a complete one.
  if (last_sweep_.empty() || sweep_.size() * 2 > last_sweep_.size()) last_sweep_.swap(sweep_);
  sweep_.clear();
}

void RunFolder::write_text(const std::string& name, const std::string& bytes, RunOutcome& outcome) const {
  write_file(folder_ / name, bytes);
  outcome.files.emplace_back(name);
}

PlanExtent RunFolder::extent() const {
  double reach = 1;
  for (const KeptPing& kept : last_sweep_) reach = std::max(reach, kept.ping.window.end_m());
  return {-reach, reach, -reach, reach};
}

// Pictures -----------------------------------------------------------------------------------------------------------

namespace {

PlanPicture::Labels body_labels(const std::string& title) { return {title, "forward (m)", "starboard (m)"}; }

void draw_obstacles(PlanPicture& picture, const std::vector<Obstacle>& obstacles) {
  for (const Obstacle& o : obstacles) {
    const Colour colour = o.behind ? palette::kHidden : palette::kObstacle;
    picture.polygon(o.outline, {colour, 2, o.possible_multiple}, {colour.red, colour.green, colour.blue, 0.15});
  }
  for (const Obstacle& o : obstacles) {
    if (o.behind) continue;
    picture.dot(o.nearest, 2.5, palette::kObstacle);
  }
}

std::vector<PlanPicture::LegendEntry> obstacle_legend() {
  return {{palette::kObstacle, "obstacle"}, {palette::kHidden, "hidden obstacle (dashed: possible multiple)"}};
}

}  // namespace

std::string RunFolder::sonar_picture() const {
  PlanPicture picture(extent(), kPlotPixels, body_labels("Echoes of the last sweep"));
  const double pixel = (extent().x_max - extent().x_min) / kPlotPixels;
  PlanImage image(extent(), pixel);
  const Pose X_BW = last_sweep_.empty() ? Pose{} : level(last_sweep_.back().X_WB).inverse();
  for (const KeptPing& kept : last_sweep_) image.add(kept.ping, X_BW * kept.X_WB * kept.ping.X_BS);
  picture.raster([&image](double x, double y) {
    const auto share = image.share(x, y);
    return share ? intensity_colour(std::sqrt(*share)) : Colour{0.93, 0.93, 0.93, 1};
  });
  picture.range_rings({0, 0}, ring_step(extent()));
  picture.vehicle({0, 0}, 0);
  picture.finish(
      {{intensity_colour(1), "strongest echo"}, {intensity_colour(0), "none"}, {{0.93, 0.93, 0.93, 1}, "no data"}});
  return picture.png();
}

std::string RunFolder::detections_picture() const {
  PlanPicture picture(extent(), kPlotPixels,
                      body_labels(fmt::format("Obstacles ({})", whole_obstacles(obstacles_).size())));
  const double pixel = (extent().x_max - extent().x_min) / kPlotPixels;
  PlanImage image(extent(), pixel);
  const Pose X_BW = last_sweep_.empty() ? Pose{} : level(last_sweep_.back().X_WB).inverse();
  for (const KeptPing& kept : last_sweep_) image.add(kept.ping, X_BW * kept.X_WB * kept.ping.X_BS);
  picture.raster([&image](double x, double y) {
    const double shade = 1 - 0.75 * std::sqrt(image.share(x, y).value_or(0.0));
    return Colour{shade, shade, shade, 1};
  });
  picture.range_rings({0, 0}, ring_step(extent()));
  for (const Polygon& outline : truth_) picture.polygon(outline, {palette::kTruth, 2, false});
  draw_obstacles(picture, obstacles_);
  picture.vehicle({0, 0}, 0);
  auto legend = obstacle_legend();
  if (!truth_.empty()) legend.insert(legend.begin(), {palette::kTruth, "truth"});
  picture.finish(legend);
  return picture.png();
}

std::string RunFolder::occupancy_picture(const BodyGrid& grid) const {
  PlanPicture picture(extent(), kPlotPixels, body_labels("Occupancy"));
  picture.raster([&grid](double x, double y) {
    const auto cell = grid.cell_at({x, y});
    return cell ? occupancy_colour(grid.probability(*cell), grid.config().prior) : Colour{0.7, 0.7, 0.7, 1};
  });
  picture.range_rings({0, 0}, ring_step(extent()));
  picture.vehicle({0, 0}, 0);
  picture.finish({{occupancy_colour(0.98, 0.01), "occupied"},
                  {occupancy_colour(0.3, 0.01), "likely"},
                  {occupancy_colour(0.001, 0.01), "free"},
                  {occupancy_colour(0.01, 0.01), "unknown"}});
  return picture.png();
}

std::string RunFolder::track_picture() const {
  Vector2d low = track_.front(), high = track_.front();
  for (const Vector2d& p : track_) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  std::vector<std::pair<std::vector<Vector2d>, double>> outlines;
  for (const ScanRecord& scan : scans_) {
    const Pose X_WL = level(scan.X_WB);
    for (const Obstacle& o : scan.obstacles) {
      if (o.behind) continue;
      std::vector<Vector2d> outline;
      for (const Vector2d& p : o.outline) {
        outline.push_back((X_WL * Eigen::Vector3d(p.x(), p.y(), 0)).head<2>());
        low = low.cwiseMin(outline.back());
        high = high.cwiseMax(outline.back());
      }
      outlines.emplace_back(std::move(outline), o.existence);
    }
  }
  const double margin = 0.05 * (high - low).maxCoeff() + 0.5;
  PlanPicture picture({low.x() - margin, high.x() + margin, low.y() - margin, high.y() + margin}, kPlotPixels,
                      {"Track and obstacles of all scans", "north (m)", "east (m)"});
  for (const auto& [outline, existence] : outlines) {
    picture.polygon(outline, {{0.84, 0.37, 0.0, 0.25 * existence}, 1, false}, {0.84, 0.37, 0.0, 0.05 * existence});
  }
  picture.polyline(track_, {palette::kTrack, 2, false});
  picture.vehicle(track_.back(), scans_.back().X_WB.rotation.heading().radians());
  picture.finish({{palette::kTrack, "track"}, {palette::kObstacle, "obstacles; darker where seen again"}});
  return picture.png();
}

void add_truth(HtmlReport& page, const TruthScore& score) {
  page.heading("Comparison with ground truth");
  page.paragraph(fmt::format(
      "In {} scans, {} pieces of obstacles were reported: {} on bodies, {} on the bottom, {} on the surface, {} mirror "
      "images, "
      "and {} false alarms, in {} scans. An obstacle counts in every scan that shows it. Range errors refer to the "
      "nearest point of a body; only bodies below 6 m across have them.",
      score.scans, score.obstacles, score.of_bodies, score.of_bottom, score.of_surface, score.of_mirrors,
      score.false_alarms, score.scans_with_false_alarms));
  std::vector<HtmlReport::Row> rows;
  for (const BodyScore& b : score.bodies) {
    const bool found = b.scans_found > 0;
    const auto number = [found](double value) { return found ? fmt::format("{:.2f}", value) : std::string("-"); };
    const auto error = [&](double value) { return b.compact ? number(value) : std::string("-"); };
    rows.push_back({b.name, fmt::format("{}", b.pings_heard), found ? fmt::format("{} scans", b.scans_found) : "missed",
                    found ? fmt::format("{}", b.delay_pings) : "-", number(b.delay_s), number(b.first_range_m),
                    error(b.range_error_mean_m), error(b.range_error_rms_m), error(b.range_error_worst_m)});
  }
  page.table({"body", "pings with its echo", "found in", "pings until found", "s until found", "first found at (m)",
              "range error, mean (m)", "rms (m)", "worst (m)"},
             rows);
}

// The replay of the run ----------------------------------------------------------------------------------------------

namespace {

/// The items that the replay shows less often than the rest, with their intervals.
std::string rarer_in(const EmbeddedReplay& film, const ReportConfig& config) {
  constexpr std::pair<DisplayKind, const char*> kNames[] = {{DisplayKind::kEchoes, "echoes"},
                                                            {DisplayKind::kGrid, "occupancy"},
                                                            {DisplayKind::kDepth, "the depth map"},
                                                            {DisplayKind::kVoxels, "voxels"},
                                                            {DisplayKind::kVehicle, "the vehicle"},
                                                            {DisplayKind::kTrack, "the track"},
                                                            {DisplayKind::kObstacles, "obstacles"},
                                                            {DisplayKind::kWay, "the route"},
                                                            {DisplayKind::kScene, "the scene"},
                                                            {DisplayKind::kHealth, "counts"},
                                                            {DisplayKind::kCubes, "voxels in larger cubes"}};
  std::string rarer;
  for (const auto& [kind, name] : kNames) {
    if (film.interval_s(kind) <= config.film_s) continue;
    rarer += fmt::format("{}{} every {:g} s", rarer.empty() ? "" : ", ", name, film.interval_s(kind));
  }
  return rarer;
}

}  // namespace

void RunFolder::show_run(EmbeddedReplay& film, Time last, const DisplayState& items) {
  const std::string recording = film.finish(last, items);
  if (recording.empty()) {
    film_words_ = "There is no replay of the run here: it would be larger than report.film_mb.";
    return;
  }
  const ReportConfig& config = configuration_.report;
  film_page_ = page_with_recording(live_page(), recording);
  film_words_ =
      fmt::format("Replay of the whole run: detections, maps, routes and decisions, every {:g} s.", config.film_s);
  const std::string rarer = rarer_in(film, config);
  if (!rarer.empty()) film_words_ += fmt::format(" Less often, to keep the report small: {}.", rarer);
}

// Files --------------------------------------------------------------------------------------------------------------

void RunFolder::write(const RunRequest& request, const BodyGrid* grid, const VoxelMap* voxels, const DepthModel& depths,
                      RunOutcome& outcome) {
  outcome.obstacles = obstacles_;
  const ScanRecord last = scans_.empty() ? ScanRecord{} : scans_.back();
  write_text("obstacles.json", obstacles_json(last), outcome);
  write_text("scans.json", scans_json(scans_), outcome);
  const std::optional<GeoOrigin> origin = last.posed ? outcome.source.origin : std::nullopt;
  if (origin) write_text("obstacles.geojson", obstacles_geojson(last, *origin), outcome);
  Pictures pictures;
  if (grid) {
    write_occupancy(*grid, level(last.X_WB), origin);
    outcome.files.emplace_back("occupancy.tif");
    pictures.occupancy = occupancy_picture(*grid);
    pictures.sonar = sonar_picture();
    pictures.detections = detections_picture();
    write_text("occupancy.png", pictures.occupancy, outcome);
    write_text("sonar.png", pictures.sonar, outcome);
    write_text("detections.png", pictures.detections, outcome);
  }
  if (voxels)
    pictures.voxels = write_voxel_files(*voxels, configuration_.voxels.vdb, folder_, *outcome.voxels, outcome.files);
  if (outcome.depth) pictures.depth = write_depth_files(depths, folder_, outcome.files);
  if (outcome.mission) {
    pictures.mission = draw_mission(*outcome.mission, configuration_.mission.route.clearance_m);
    write_text("mission.json", mission_text(*outcome.mission), outcome);
    write_text("decisions.json", decisions_text(outcome.mission->decisions), outcome);
    if (!pictures.mission.chart.empty()) write_text("mission.png", pictures.mission.chart, outcome);
    if (!pictures.mission.clearance.empty()) write_text("clearance.png", pictures.mission.clearance, outcome);
  }
  if (outcome.truth) write_text("truth.json", truth_text(*outcome.truth), outcome);
  write_text("configuration.toml", to_toml(configuration_, true), outcome);
  write_text("report.html", report(request, outcome, pictures), outcome);
  outcome.files.emplace_back("manifest.json");
  write_file(folder_ / "manifest.json", manifest_json(request, outcome));
}

/// Cells that were never observed are "no data". Rows run from the top; x of the grid, forward at the start, is up.
void RunFolder::write_occupancy(const BodyGrid& grid, const Pose& X_WL, const std::optional<GeoOrigin>& origin) const {
  const CartesianGrid& cells = grid.cells();
  const auto corner = grid.to_level_body({cells.cells_x * cells.cell_m, 0});
  const RasterFrame frame{.columns = cells.cells_y,
                          .rows = cells.cells_x,
                          .cell_m = cells.cell_m,
                          .corner_m = (X_WL * Eigen::Vector3d(corner.x(), corner.y(), 0)).head<2>(),
                          .up = (X_WL.rotation.heading() - grid.heading()).wrapped(),
                          .origin = origin};
  std::vector<float> raster;
  raster.reserve(cells.size());
  for (int x = cells.cells_x - 1; x >= 0; --x) {
    for (int y = 0; y < cells.cells_y; ++y) {
      const bool unseen = std::abs(grid.log_odds()[cells.index({x, y})] - grid.log_odds_prior()) < 1e-9;
      raster.push_back(unseen ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(grid.probability({x, y})));
    }
  }
  write_geotiff(folder_ / "occupancy.tif", frame, {.name = "occupancy probability", .unit = ""}, raster);
}

void RunFolder::add_obstacles(HtmlReport& page) const {
  page.heading("Obstacles");
  std::vector<HtmlReport::Row> rows;
  for (const WholeObstacle& o : whole_obstacles(obstacles_)) {
    rows.push_back({std::to_string(o.number), degrees(o.nearest->bearing), fmt::format("{:.2f}", o.nearest->range_m),
                    fmt::format("{}, {:.1f} m", o.kind(), o.extent_m), fmt::format("{:.3f}", o.existence), notes(o)});
  }
  page.table({"obstacle", "bearing (deg)", "nearest point (m)", "extent", "existence", ""}, rows);
}

std::string RunFolder::report(const RunRequest& request, const RunOutcome& outcome, const Pictures& pictures) const {
  const PipelineCounts& n = outcome.counts;
  const bool pinged = n.pings > 0 || !outcome.depth;  // else the report is only about depths
  const std::string lead =
      pinged ? fmt::format("{} · {} pings in {:.1f} s of log · {} scans · {} obstacles at the end",
                           outcome.source.format, n.pings, outcome.log_s, n.scans, whole_obstacles(obstacles_).size())
             : fmt::format("{} · {} ranges and {} swaths within {} · depth map", outcome.source.format, n.ranges,
                           n.swaths, span_text(outcome.log_s));
  HtmlReport page("Isobath run: " + (request.input.empty() ? "embedded scene" : input_name(request.input)), lead);
  if (!outcome.problem.empty()) page.warning(outcome.problem);
  for (const Alarm& alarm : outcome.alarms) page.warning("Alarm: " + to_text(alarm) + ".");
  if (!outcome.undecided.empty()) page.warning("At the end no bin could be decided: " + outcome.undecided + ".");
  if (outcome.fan) page.paragraph("Sensor model: " + to_text(*outcome.fan) + ".");
  if (n.pings > 0 && n.unposed == n.pings) {
    page.paragraph("The log has no navigation: the vehicle is assumed to stand still.");
  }
  if (!film_page_.empty()) {
    page.page_inside("Replay of the run", film_page_, film_words_);
  } else if (!film_words_.empty()) {
    page.paragraph(film_words_);
  }
  if (outcome.mission) {
    add_mission(page, *outcome.mission, pictures.mission);
    page.heading("Detections");
  }
  if (!pictures.detections.empty()) {
    page.begin_row();
    page.figure(pictures.detections, "Obstacles over the echoes of the last sweep, from above. Forward is up.");
    page.figure(pictures.occupancy, "Occupancy of the water around the vehicle. Unknown is not free.");
    page.figure(pictures.sonar, "The raw echoes of the last sweep.");
    if (!track_.empty() && scans_.back().posed) page.figure(track_picture(), "Track of the vehicle, north up.");
    page.end_row();
  }
  if (outcome.voxels) add_voxels(page, *outcome.voxels, pictures.voxels);
  if (outcome.depth) add_depth(page, *outcome.depth, pictures.depth);
  std::vector<HtmlReport::Row> rows;
  if (pinged) add_obstacles(page);
  if (outcome.truth) add_truth(page, *outcome.truth);
  page.heading("Counts");
  page.table({"what", "count"}, count_rows(n, pinged));
  page.heading("Times");
  rows = {{"log, first event to last", fmt::format("{:.3f} s", outcome.log_s)}};
  if (pinged) {
    rows.push_back({"pings", fmt::format("{:.2f} per second of log",
                                         outcome.log_s > 0 ? static_cast<double>(n.pings) / outcome.log_s : 0)});
    rows.push_back({"scans", fmt::format("one every {:.2f} s of log",
                                         n.scans ? outcome.log_s / static_cast<double>(n.scans) : 0)});
  }
  if (request.timings) {
    if (pinged) {
      rows.push_back({"time per ping, median", fmt::format("{:.3f} ms", outcome.timings.ping_median_ms)});
      rows.push_back({"time per ping, 99th percentile", fmt::format("{:.3f} ms", outcome.timings.ping_p99_ms)});
    }
    rows.push_back({"speed", fmt::format("{:.0f} x real time",
                                         outcome.timings.wall_s > 0 ? outcome.log_s / outcome.timings.wall_s : 0)});
  }
  page.table({"what", "value"}, rows);
  page.heading("Rejected and skipped");
  rows.clear();
  for (const auto& [reason, count] : outcome.rejected) rows.push_back({reason, fmt::format("{}", count)});
  for (const Damage& d : outcome.source.damages) {
    rows.push_back(
        {fmt::format("{} (bytes {} to {})", d.reason, d.offset, d.offset + d.bytes), fmt::format("{} bytes", d.bytes)});
  }
  if (rows.empty()) {
    page.paragraph("Nothing was rejected or skipped.");
  } else {
    page.table({"reason", "count"}, rows);
  }
  if (!outcome.source.details.empty()) {
    page.heading("Input");
    rows.clear();
    for (const auto& [key, value] : outcome.source.details) rows.push_back({key, value});
    page.table({"what", "value"}, rows);
  }
  page.folded("Configuration in force", to_toml(configuration_, true));
  return page.html();
}

}  // namespace isobath
