#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/display/decision_json.hpp>
#include <isobath/display/live_page.hpp>
#include <isobath/io/gdal/geotiff.hpp>
#include <isobath/map/occupancy/whole_obstacle.hpp>
#include <isobath/onboard/onboard.hpp>
#include <isobath/report/contact_text.hpp>
#include <isobath/report/corner_fix_text.hpp>
#include <isobath/report/fan_calibration.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/report/report_sections.hpp>
#include <isobath/report/result_text.hpp>
#include <isobath/report/sphere_pictures.hpp>
#include <isobath/run/run_folder.hpp>
#include <isobath/run/run_manifest.hpp>
#include <isobath/run/run_outputs.hpp>
#include <limits>

namespace isobath {
namespace {

constexpr double kSphereBand_m = 2;  // of the picture from above

std::string sentence(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string degrees(Angle a) { return fmt::format("{:.1f}", a.wrapped_positive().degrees()); }

/// The name of a log or a folder, with or without a slash at the end.
std::string input_name(const std::filesystem::path& input) {
  return (input.has_filename() ? input : input.parent_path()).filename().string();
}

std::string lead_text(const RunOutcome& outcome, bool pinged, std::size_t obstacles) {
  const PipelineCounts& n = outcome.counts;
  const bool swaths_alone = n.pings == 0 && n.swaths > 0 && !outcome.depth;
  const std::string data =
      swaths_alone ? fmt::format("{} · {} swaths in {} · {} scans · {} obstacles at the end", outcome.source.format,
                                 n.swaths, span_text(outcome.log_s), n.scans, obstacles)
      : pinged     ? fmt::format("{} · {} pings in {:.1f} s of log · {} scans · {} obstacles at the end",
                                 outcome.source.format, n.pings, outcome.log_s, n.scans, obstacles)
               : fmt::format("{} · {} ranges and {} swaths within {} · depth map", outcome.source.format, n.ranges,
                             n.swaths, span_text(outcome.log_s));
  return outcome.mission ? mission_summary(*outcome.mission).front() + " · " + data : data;
}

void add_warnings(HtmlReport& page, const RunOutcome& outcome) {
  if (!outcome.problem.empty()) page.warning(outcome.problem);
  if (!outcome.warning.empty()) page.warning(outcome.warning);
  for (const Alarm& alarm : outcome.alarms) page.warning("Alarm: " + to_text(alarm) + ".");
  if (!outcome.undecided.empty()) page.warning("At the end no bin could be decided: " + outcome.undecided + ".");
  if (outcome.corner_fix) page.paragraph(sentence(corner_fix_text(*outcome.corner_fix)) + ".");
  if (outcome.contacts) page.paragraph(contact_paragraph(*outcome.contacts));
  if (outcome.fan) page.paragraph("Sensor model: " + to_text(*outcome.fan) + ".");
  if (outcome.counts.pings > 0 && outcome.counts.unposed == outcome.counts.pings)
    page.paragraph("The log has no navigation: the vehicle is assumed to stand still.");
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

void add_truth(HtmlReport& page, const TruthScore& score) {
  page.heading("Comparison with ground truth");
  page.paragraph(fmt::format(
      "In {} scans, {} pieces of obstacles were reported: {} on bodies, {} on the bottom, {} on the surface, {} mirror "
      "images, and {} false alarms, in {} scans. An obstacle counts in every scan that shows it. Range errors refer to "
      "the nearest point of a body; only bodies below 6 m across have them.",
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
  const MotionScore& m = score.motion;
  if (m.scans == 0) return;
  page.paragraph(fmt::format(
      "Bodies that move: {} of {} that were heard became known to move; half of them {:.1f} s after their first echo, "
      "95 "
      "% within {:.1f} s. In {} scans the tracks and the bodies were {:.2f} m apart (OSPA, cut-off {:g} m). The tracks "
      "were off by {:.2f} m and {:.2f} m/s (root mean square); {:.1f} a scan had no body; {} times another track took "
      "a "
      "body over.",
      m.known, m.bodies, m.known_after_s, m.known_after_95_s, m.scans, m.ospa_m, MotionScorer::kCutOff_m,
      m.position_rms_m, m.velocity_rms, m.false_tracks, m.switches));
}

std::vector<HtmlReport::Row> time_rows(const RunOutcome& outcome, bool pinged, bool timings) {
  const PipelineCounts& n = outcome.counts;
  const double log_s = outcome.log_s;
  std::vector<HtmlReport::Row> rows{{"log, first event to last", fmt::format("{:.3f} s", log_s)}};
  if (pinged) {
    const double rate = log_s > 0 ? static_cast<double>(n.pings) / log_s : 0;
    rows.push_back({"pings", fmt::format("{:.2f} per second of log", rate)});
    const double interval_s = n.scans ? log_s / static_cast<double>(n.scans) : 0;
    rows.push_back({"scans", fmt::format("one every {:.2f} s of log", interval_s)});
  }
  if (!timings) return rows;
  const RunTimings& took = outcome.timings;
  if (pinged) {
    rows.push_back({"time per ping, median", fmt::format("{:.3f} ms", took.ping_median_ms)});
    rows.push_back({"time per ping, 99th percentile", fmt::format("{:.3f} ms", took.ping_p99_ms)});
  }
  rows.push_back({"speed", fmt::format("{:.0f} x real time", took.wall_s > 0 ? log_s / took.wall_s : 0)});
  return rows;
}

void add_rejected(HtmlReport& page, const RunOutcome& outcome) {
  page.heading("Rejected and skipped");
  std::vector<HtmlReport::Row> rows;
  for (const auto& [reason, count] : outcome.rejected) rows.push_back({reason, fmt::format("{}", count)});
  for (const Damage& d : outcome.source.damages) {
    rows.push_back(
        {fmt::format("{} (bytes {} to {})", d.reason, d.offset, d.offset + d.bytes), fmt::format("{} bytes", d.bytes)});
  }
  if (rows.empty()) return page.paragraph("Nothing was rejected or skipped.");
  page.table({"reason", "count"}, rows);
}

/// The items that the replay shows less often than the rest, with their intervals.
std::string rarer_in(const EmbeddedReplay& replay, const ReportConfig& config) {
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
                                                            {DisplayKind::kCubes, "voxels in larger cubes"},
                                                            {DisplayKind::kSphere, "the spherical grid"},
                                                            {DisplayKind::kSounds, "sounds"}};
  std::string rarer;
  for (const auto& [kind, name] : kNames) {
    if (replay.interval_s(kind) <= config.replay_s) continue;
    rarer += fmt::format("{}{} every {:g} s", rarer.empty() ? "" : ", ", name, replay.interval_s(kind));
  }
  return rarer;
}

}  // namespace

RunFolder::RunFolder(std::filesystem::path folder, Configuration configuration)
    : folder_(std::move(folder)), configuration_(std::move(configuration)) {
  make_folder(folder_);
  // Not every run writes all files, and those of an earlier run must not remain.
  for (const char* name : kRunFiles) std::filesystem::remove(folder_ / name);
}

void RunFolder::on_ping(const PosedPing& posed) { sweep_.push_back({posed.ping, posed.X_WB}); }

void RunFolder::on_jump(const Eigen::Vector3d& by_W) {
  for (ScanPing& kept : sweep_) kept.X_WB.translation += by_W;
}

void RunFolder::on_scan(const ScanResult& scan) {
  const Detection& found = scan.detection;
  obstacles_ = found.obstacles;
  scans_.push_back({scan.number, found.time, found.X_WB, scan.posed, found.obstacles});
  // A sweep that the end of the log cuts short does not replace a complete one.
  if (last_sweep_.empty() || sweep_.size() * 2 > last_sweep_.size()) last_sweep_.swap(sweep_);
  sweep_.clear();
}

void RunFolder::write_text(const std::string& name, const std::string& bytes, RunOutcome& outcome) const {
  write_whole_file(folder_ / name, bytes);
  outcome.files.emplace_back(name);
}

// Pictures -----------------------------------------------------------------------------------------------------------

/// The pictures of scan and mission, and the files of the maps with theirs.
RunFolder::Pictures RunFolder::draw(const RunRequest& request, const Onboard& onboard, RunOutcome& outcome) const {
  const ScanRecord last = scans_.empty() ? ScanRecord{} : scans_.back();
  const std::optional<GeoOrigin> origin = last.posed ? outcome.source.origin : std::nullopt;
  ChartSource source{request.input.empty() ? "embedded scene" : input_name(request.input),
                     date_text(outcome.started, outcome.started + seconds(outcome.log_s))};
  const bool simulated = outcome.truth || (outcome.mission && outcome.mission->truth);
  if (simulated && source.date.empty()) source.date = "simulated";
  Pictures pictures;
  if (const BodyGrid* grid = onboard.pipeline().grid()) {
    ScanView view{last_sweep_, obstacles_, truth_, source};
    if (!scans_.empty()) view.heading = scans_.back().X_WB.rotation.heading();
    if (last.number > 0) view.source.survey += fmt::format(", scan {} of {}", last.number, scans_.size());
    pictures.occupancy = occupancy_picture(view, *grid);
    if (outcome.counts.pings > 0) pictures.sonar = echo_picture(view);  // a 3-D sonar tells soundings, not echoes
    pictures.detections = obstacle_picture(view);
    if (last.posed) pictures.track = track_picture(scans_, origin, source);
    write_text("occupancy.png", pictures.occupancy, outcome);
    if (!pictures.sonar.empty()) write_text("sonar.png", pictures.sonar, outcome);
    write_text("detections.png", pictures.detections, outcome);
  }
  if (const VoxelMap* voxels = onboard.voxels().map()) {
    pictures.voxels = write_voxel_files(*voxels, configuration_.voxels.vdb, source, outcome.source.origin, folder_,
                                        *outcome.voxels, outcome.files);
  }
  if (outcome.sphere) {
    const SphericalModel& sphere = onboard.sphere();
    const SphereView view{*sphere.grid(),     "Echoes around the vehicle, " + source.survey,
                          sphere.course(),    {},
                          sphere.course_up(), kSphereBand_m};
    pictures.sphere_above = sphere_above_picture(view);
    pictures.sphere_solid = sphere_solid_picture(view);
    write_text("sphere-above.png", pictures.sphere_above, outcome);
    write_text("sphere-solid.png", pictures.sphere_solid, outcome);
  }
  if (placement_ && outcome.sharpness) {
    PlacementView view = *placement_;
    view.source = source;
    pictures.placement = {placement_picture(view), sharpness_picture(*outcome.sharpness)};
    write_text("placed.png", pictures.placement.placed, outcome);
    write_text("sharpness.png", pictures.placement.sharpness, outcome);
  }
  if (outcome.depth) pictures.depth = write_depth_files(onboard.depths(), source, folder_, outcome.files);
  if (outcome.mission)
    pictures.mission = draw_mission(*outcome.mission, configuration_.mission.route.clearance_m, source);
  const auto depths = onboard.depths().snapshot();
  if (outcome.mission && outcome.depth && depths) {
    pictures.profile = draw_track_profile(outcome.mission->believed, *depths);
  }
  return pictures;
}

// The replay of the run ----------------------------------------------------------------------------------------------

void RunFolder::show_run(EmbeddedReplay& replay, Time last, const DisplayState& items) {
  const std::string recording = replay.finish(last, items);
  if (recording.empty()) {
    replay_text_ = "There is no replay of the run here: it would be larger than report.replay_mb.";
    return;
  }
  const ReportConfig& config = configuration_.report;
  replay_page_ = page_with_recording(live_page(), recording);
  replay_text_ =
      fmt::format("Replay of the whole run: detections, maps, routes and decisions, every {:g} s.", config.replay_s);
  const std::string rarer = rarer_in(replay, config);
  if (!rarer.empty()) replay_text_ += fmt::format(" Less often, to keep the report small: {}.", rarer);
}

// Files --------------------------------------------------------------------------------------------------------------

void RunFolder::write(const RunRequest& request, const Onboard& onboard, RunOutcome& outcome) {
  outcome.obstacles = obstacles_;
  const ScanRecord last = scans_.empty() ? ScanRecord{} : scans_.back();
  write_text("obstacles.json", obstacles_json(last), outcome);
  write_text("scans.json", scans_json(scans_), outcome);
  const std::optional<GeoOrigin> origin = last.posed ? outcome.source.origin : std::nullopt;
  if (origin) write_text("obstacles.geojson", obstacles_geojson(last, *origin), outcome);
  if (outcome.contacts && outcome.source.origin)
    write_text("contacts.geojson", contacts_geojson(*outcome.contacts, *outcome.source.origin), outcome);
  if (const BodyGrid* grid = onboard.pipeline().grid()) {
    write_occupancy(*grid, level(last.X_WB), origin);
    outcome.files.emplace_back("occupancy.tif");
  }
  const Pictures pictures = draw(request, onboard, outcome);
  if (outcome.mission) {
    write_text("mission.json", mission_text(*outcome.mission), outcome);
    write_text("decisions.json", decisions_text(outcome.mission->decisions), outcome);
    if (!pictures.mission.chart.empty()) write_text("mission.png", pictures.mission.chart, outcome);
    if (!pictures.mission.clearance.empty()) write_text("clearance.png", pictures.mission.clearance, outcome);
  }
  if (!pictures.profile.depths.empty()) {
    write_text("place-along-track.png", pictures.profile.place, outcome);
    write_text("depths-along-track.png", pictures.profile.depths, outcome);
  }
  if (outcome.truth) write_text("truth.json", truth_text(*outcome.truth), outcome);
  write_text("configuration.toml", to_toml(configuration_, true), outcome);
  write_text("report.html", report(request, outcome, pictures), outcome);
  outcome.files.emplace_back("manifest.json");
  write_whole_file(folder_ / "manifest.json", manifest_json(request, outcome));
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

void RunFolder::add_scan(HtmlReport& page, const Pictures& pictures) const {
  page.heading("Obstacles");
  if (!pictures.detections.empty()) {
    page.begin_row();
    page.figure(pictures.detections, "Obstacles over the echoes of the last scan, from above. Forward is up.");
    page.figure(pictures.occupancy, "Occupancy of the water around the vehicle. Unknown is not free.");
    page.figure(pictures.sonar, "The echoes of the last scan.");
    if (!pictures.track.empty()) page.figure(pictures.track, "Track of the vehicle, north up.");
    page.end_row();
  }
  std::vector<HtmlReport::Row> rows;
  for (const WholeObstacle& o : whole_obstacles(obstacles_)) {
    rows.push_back({std::to_string(o.number), degrees(o.nearest->bearing), fmt::format("{:.2f}", o.nearest->range_m),
                    fmt::format("{}, {:.1f} m", o.kind(), o.extent_m), fmt::format("{:.3f}", o.existence),
                    notes_on(o)});
  }
  if (rows.empty()) return page.paragraph("No obstacle at the end of the run.");
  page.table({"obstacle", "bearing (deg)", "nearest point (m)", "kind, extent", "existence", ""}, rows);
}

void RunFolder::add_sphere(HtmlReport& page, const SphericalOutcome& sphere, const Pictures& pictures) {
  page.heading("Echoes around the vehicle");
  std::string heard;
  const auto add = [&heard](std::uint64_t count, const char* what) {
    if (count > 0) heard += fmt::format("{}{} {}", heard.empty() ? "" : ", ", count, what);
  };
  add(sphere.pings, "pings");
  add(sphere.ranges, "ranges");
  add(sphere.swaths, "swaths");
  page.paragraph(
      fmt::format("{}. It holds echoes by direction and range, from {}.", sentence(sphere_text(sphere)), heard));
  if (!sphere.coarser.empty()) page.paragraph(sentence(sphere.coarser) + ".");
  page.begin_row();
  page.figure(pictures.sphere_above,
              fmt::format("From above, within {:g} m of the vehicle's depth. What was not observed is not clear.",
                          kSphereBand_m));
  page.figure(pictures.sphere_solid, "The same in three dimensions.");
  page.end_row();
}

void RunFolder::add_replay(HtmlReport& page) const {
  if (replay_text_.empty()) return;
  page.heading("Replay of the run");
  if (replay_page_.empty()) return page.paragraph(replay_text_);
  page.page_inside("Replay of the run", replay_page_, replay_text_);
}

std::string RunFolder::report(const RunRequest& request, const RunOutcome& outcome, const Pictures& pictures) const {
  const bool pinged = outcome.counts.pings > 0 || !outcome.depth;  // else the report is only about depths
  HtmlReport page("Isobath run: " + (request.input.empty() ? "embedded scene" : input_name(request.input)),
                  lead_text(outcome, pinged, whole_obstacles(obstacles_).size()));
  add_warnings(page, outcome);
  for (const ReportSection section : report_sections(outcome)) {
    switch (section) {
      case ReportSection::kMission: add_mission(page, *outcome.mission, pictures.mission); break;
      case ReportSection::kScan: add_scan(page, pictures); break;
      case ReportSection::kFan: add_placement(page, *outcome.sharpness, outcome.drift, pictures.placement); break;
      case ReportSection::kVoxels: add_voxels(page, *outcome.voxels, pictures.voxels); break;
      case ReportSection::kSphere: add_sphere(page, *outcome.sphere, pictures); break;
      case ReportSection::kDepth:
        add_depth(page, *outcome.depth, pictures.depth);
        add_track_profile(page, pictures.profile);
        break;
      case ReportSection::kReplay: add_replay(page); break;
    }
  }
  if (outcome.truth) add_truth(page, *outcome.truth);
  page.heading("Counts");
  page.table({"what", "count"}, count_rows(outcome.counts, pinged));
  page.heading("Times");
  page.table({"what", "value"}, time_rows(outcome, pinged, request.timings));
  add_rejected(page, outcome);
  if (!outcome.source.details.empty()) {
    page.heading("Input");
    std::vector<HtmlReport::Row> rows;
    for (const auto& [key, value] : outcome.source.details) rows.push_back({key, value});
    page.table({"what", "value"}, rows);
  }
  page.folded("Configuration in force", to_toml(configuration_, true));
  return page.html();
}

}  // namespace isobath
