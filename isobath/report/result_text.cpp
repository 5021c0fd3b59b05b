#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/io/exports/geojson.hpp>
#include <isobath/map/occupancy/whole_obstacle.hpp>
#include <isobath/report/result_text.hpp>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using nlohmann::ordered_json;

/// Rounded to 1e-6, which is finer than any sonar and still readable.
double tidy(double value) { return std::round(value * 1e6) / 1e6; }

ordered_json outline_of(const Obstacle& o) {
  ordered_json points = ordered_json::array();
  for (const auto& p : o.outline) points.push_back({tidy(p.x()), tidy(p.y())});
  return points;
}

constexpr const char* kFrame =
    "level body frame at the time of the scan: x forward, y starboard, origin at the vehicle, metres; bearings "
    "clockwise "
    "from forward";

std::string dump(const ordered_json& json) {
  return json.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

void add_scan(ordered_json& json, const ScanRecord& scan) {
  if (scan.number > 0) {
    json["scan"] = scan.number;
    json["time"] = to_text(scan.time);
    json["time_ns"] = scan.time.time_since_epoch().count();
  }
  if (scan.posed) {
    json["north_m"] = tidy(scan.X_WB.translation.x());
    json["east_m"] = tidy(scan.X_WB.translation.y());
    json["depth_m"] = tidy(scan.X_WB.translation.z());
    json["heading_deg"] = tidy(scan.X_WB.rotation.heading().wrapped_positive().degrees());
  }
  json["obstacles"] = obstacle_list(scan.obstacles);
}

ordered_json sensors_json(const std::vector<SensorLearning::Sensor>& sensors) {
  ordered_json all = ordered_json::array();
  for (const SensorLearning::Sensor& s : sensors) {
    all.push_back({{"looks", aim_of(s.X_BS)},
                   {"confirming", s.counts.confirming},
                   {"conflicting", s.counts.conflicting},
                   {"irrelevant", s.counts.irrelevant},
                   {"reliability", tidy(s.counts.reliability())}});
  }
  return all;
}

const WholeObstacle& of_number(const std::vector<WholeObstacle>& whole, int number) {
  return *std::find_if(whole.begin(), whole.end(), [number](const WholeObstacle& w) { return w.number == number; });
}

double course_deg(const ObstacleMotion& motion) {
  return Angle::radians(std::atan2(motion.velocity_W.y(), motion.velocity_W.x())).wrapped_positive().degrees();
}

/// Velocity and its uncertainty; course clockwise from north.
ordered_json motion_json(const ObstacleMotion& motion) {
  const Eigen::Matrix2d& c = motion.velocity_covariance;
  return {{"track", motion.track},
          {"speed", tidy(motion.velocity_W.norm())},
          {"course_deg", tidy(course_deg(motion))},
          {"velocity_covariance", {tidy(c(0, 0)), tidy(c(0, 1)), tidy(c(1, 1))}}};
}

}  // namespace

std::string date_text(Time first, Time last) {
  const std::string from = to_text(first), to = to_text(last);
  constexpr std::size_t kDay = 10, kClock = 11, kMinutes = 5;  // of "2024-03-13T15:50:16.250Z"
  if (from.size() < kClock + kMinutes || from[kDay] != 'T') return {};
  if (from.substr(0, kDay) != to.substr(0, kDay)) {
    return fmt::format("{} to {}, UTC", from.substr(0, kDay), to.substr(0, kDay));
  }
  return fmt::format("{}, {} UTC", from.substr(0, kDay), from.substr(kClock, kMinutes));
}

ordered_json obstacle_list(const std::vector<Obstacle>& obstacles) {
  ordered_json list = ordered_json::array();
  const std::vector<WholeObstacle> whole = whole_obstacles(obstacles);
  for (const Obstacle& o : obstacles) {
    const WholeObstacle& of = of_number(whole, o.number);
    list.push_back({{"number", o.number},
                    {"kind", of.kind()},
                    {"extent_m", tidy(of.extent_m)},
                    {"bearing_deg", tidy(o.bearing.wrapped_positive().degrees())},
                    {"range_m", tidy(o.range_m)},
                    {"existence", tidy(o.existence)},
                    {"outline_m", outline_of(o)},
                    {"behind", o.behind},
                    {"possible_multiple", o.possible_multiple},
                    {"label", to_text(o.label)},
                    {"centre_m", {tidy(o.centre.x()), tidy(o.centre.y())}},
                    {"covariance_m2", {tidy(o.covariance(0, 0)), tidy(o.covariance(0, 1)), tidy(o.covariance(1, 1))}},
                    {"echoes", o.hits},
                    {"last_echo", to_text(o.last_hit)}});
    if (o.moves()) list.back()["motion"] = motion_json(o.motion);
  }
  return list;
}

std::string obstacles_json(const ScanRecord& scan) {
  ordered_json json{{"frame", kFrame}};
  add_scan(json, scan);
  return dump(json);
}

std::string scans_json(std::span<const ScanRecord> scans) {
  ordered_json json{{"frame", kFrame}, {"scans", ordered_json::array()}};
  for (const ScanRecord& scan : scans) {
    ordered_json one = ordered_json::object();
    add_scan(one, scan);
    json["scans"].push_back(std::move(one));
  }
  return dump(json);
}

std::string obstacles_geojson(const ScanRecord& scan, const GeoOrigin& origin) {
  std::vector<GeoFeature> features;
  const std::vector<WholeObstacle> whole = whole_obstacles(scan.obstacles);
  for (const Obstacle& o : scan.obstacles) {
    GeoFeature feature;
    feature.outline = world_outline(o, scan.X_WB);
    feature.properties = {{"number", o.number},
                          {"kind", of_number(whole, o.number).kind()},
                          {"existence", tidy(o.existence)},
                          {"range_m", tidy(o.range_m)},
                          {"bearing_deg", tidy(o.bearing.wrapped_positive().degrees())},
                          {"behind", o.behind},
                          {"possible_multiple", o.possible_multiple},
                          {"label", to_text(o.label)}};
    if (o.moves()) {
      feature.properties.emplace_back("speed", tidy(o.motion.velocity_W.norm()));
      feature.properties.emplace_back("course_deg", tidy(course_deg(o.motion)));
    }
    features.push_back(std::move(feature));
  }
  return geojson_text(features, origin);
}

std::string motion_text(const Obstacle& obstacle) {
  if (!obstacle.moves()) return "";
  const ObstacleMotion& motion = obstacle.motion;
  return fmt::format("moves at {:.2f} m/s towards {:03.0f} deg", motion.velocity_W.norm(), course_deg(motion));
}

std::string notes_on(const WholeObstacle& o) {
  std::string text;
  if (o.behind) text = "behind a nearer obstacle";
  const auto add = [&](const char* note) { text += std::string(text.empty() ? "" : "; ") + note; };
  if (o.possible_multiple) add("possible multiple echo");
  if (const std::string moving = motion_text(*o.nearest); !moving.empty()) add(moving.c_str());
  const WaterLabel label = o.nearest->label;
  if (label == WaterLabel::kStanding) add("stands in the water");
  if (label == WaterLabel::kBottom) add("bottom");
  if (label == WaterLabel::kSurface) add("surface");
  return text;
}

ordered_json counts_json(const RunOutcome& outcome) {
  const PipelineCounts& n = outcome.counts;
  return {{"pings", n.pings},
          {"pings_without_pose", n.unposed},
          {"tracked_bodies", n.bodies.confirmed},
          {"slow_bodies", n.bodies.slow},
          {"moving_bodies", n.bodies.moving},
          {"tracks_left_out", n.bodies.left_out},
          {"echoes_of_moving_bodies", n.of_moving},
          {"pings_without_altitude", n.no_bottom},
          {"pings_dead_reckoned", n.dead_reckoned},
          {"navigation", n.navigation},
          {"position_jumps", n.jumps},
          {"farthest_jump_m", tidy(n.farthest_jump_m)},
          {"ranges", n.ranges},
          {"swaths", n.swaths},
          {"scans", n.scans},
          {"bins", n.bins},
          {"hits", n.hits},
          {"dim_bins", n.dim},
          {"blind_bins", n.blind},
          {"obstacles", whole_obstacles(outcome.obstacles).size()},
          {"obstacle_pieces", outcome.obstacles.size()},
          {"bytes_skipped", outcome.source.bytes_skipped}};
}

ordered_json rejected_json(const RunOutcome& outcome) {
  ordered_json rejected = ordered_json::object();
  for (const auto& [reason, count] : outcome.rejected) rejected[reason] = count;
  return rejected;
}

ordered_json alarms_json(const RunOutcome& outcome) {
  ordered_json alarms = ordered_json::array();
  for (const Alarm& a : outcome.alarms) {
    alarms.push_back(
        {{"what", a.what}, {"first", to_text(a.first)}, {"lasting", a.lasting}, {"acknowledged", a.acknowledged}});
  }
  return alarms;
}

ordered_json truth_json(const TruthScore& score) {
  ordered_json bodies = ordered_json::array();
  for (const BodyScore& b : score.bodies) {
    ordered_json one{{"name", b.name}, {"pings_heard", b.pings_heard}, {"scans_found", b.scans_found}};
    if (b.scans_found > 0) {
      one["delay_pings"] = b.delay_pings;
      one["delay_s"] = tidy(b.delay_s);
      one["first_range_m"] = tidy(b.first_range_m);
      if (!b.compact) {
        bodies.push_back(std::move(one));
        continue;
      }
      one["range_error_mean_m"] = tidy(b.range_error_mean_m);
      one["range_error_rms_m"] = tidy(b.range_error_rms_m);
      one["range_error_worst_m"] = tidy(b.range_error_worst_m);
      one["fix_offset_m"] = tidy(b.fix_offset_m);
      one["fix_spread_m"] = tidy(b.fix_spread_m);
    }
    bodies.push_back(std::move(one));
  }
  ordered_json mapped = ordered_json::array();
  for (const MappedBody& b : score.mapped) {
    ordered_json one{{"name", b.name}, {"first_echo_s", tidy(b.first_echo_s)}, {"first_echo_m", tidy(b.first_echo_m)}};
    if (b.in_map_s >= 0) one["in_map_s"] = tidy(b.in_map_s);
    mapped.push_back(std::move(one));
  }
  ordered_json truth{{"scans", score.scans},
                     {"bodies", bodies},
                     {"mapped", mapped},
                     {"obstacles",
                      {{"all", score.obstacles},
                       {"of_bodies", score.of_bodies},
                       {"of_bottom", score.of_bottom},
                       {"of_surface", score.of_surface},
                       {"of_mirrors", score.of_mirrors},
                       {"false_alarms", score.false_alarms}}},
                     {"scans_with_false_alarms", score.scans_with_false_alarms}};
  const MotionScore& m = score.motion;
  truth["motion"] = {{"scans", m.scans},
                     {"ospa_m", tidy(m.ospa_m)},
                     {"bodies", m.bodies},
                     {"known", m.known},
                     {"switches", m.switches},
                     {"held_share", tidy(m.held_share)},
                     {"false_tracks", tidy(m.false_tracks)},
                     {"velocity_rms", tidy(m.velocity_rms)},
                     {"position_rms_m", tidy(m.position_rms_m)},
                     {"known_after_s", tidy(m.known_after_s)},
                     {"known_after_95_s", tidy(m.known_after_95_s)}};
  return truth;
}

ordered_json changes_json(const MapChanges& changes, const std::optional<GeoOrigin>& origin) {
  std::optional<LocalPlane> plane;
  if (origin) plane.emplace(*origin);
  ordered_json regions = ordered_json::array();
  for (const ChangedRegion& r : changes.regions) {
    ordered_json one{{"kind", kind_of(r)},
                     {"by", to_text(r.source())},
                     {"north_m", tidy(r.shoalest_at.x())},
                     {"east_m", tidy(r.shoalest_at.y())},
                     {"shoalest_m", tidy(r.shoalest_m)},
                     {"charted_m", tidy(r.charted_m)},
                     {"confidence", r.confidence},
                     {"extent_m",
                      {{"south", tidy(r.south_west.x())},
                       {"west", tidy(r.south_west.y())},
                       {"north", tidy(r.north_east.x())},
                       {"east", tidy(r.north_east.y())}}},
                     {"area_m2", tidy(r.area_m2)},
                     {"pixels",
                      {{"all", r.pixels},
                       {"by_forward_sonar", r.by_obstacle_sonar},
                       {"by_depth_sonar", r.by_depth_sonar},
                       {"by_both", r.by_both}}}};
    if (plane) {
      const GeoPoint place = plane->to_geo(r.shoalest_at);
      one["latitude_deg"] = place.latitude_deg;
      one["longitude_deg"] = place.longitude_deg;
    }
    regions.push_back(std::move(one));
  }
  return {{"obstacles", changes.obstacles()},
          {"sensed_pixels", changes.sensed_pixels},
          {"uncharted_pixels", changes.uncharted_pixels},
          {"changed_pixels", changes.changed_pixels},
          {"track_pixels", changes.track_pixels},
          {"regions", regions}};
}

ordered_json track_json(const MapChanges& changes, const PixelGrid& grid) {
  ordered_json track = ordered_json::array();
  for (const PixelWindow& run : changes.track) {
    const Eigen::Vector2d west = grid.centre({run.column, run.row});
    track.push_back({tidy(west.x()), tidy(west.y()), tidy((run.width - 1) * grid.pixel_m)});
  }
  return track;
}

ordered_json uncertainty_json(const std::optional<RevisitRecord::Uncertainty>& u) {
  if (!u) return nullptr;
  const double margin = ReadingEvidenceConfig{}.margin_m;
  return {{"flat_m", u->tvu_m(margin, 0.0)},
          {"slope_0_1_m", u->tvu_m(margin, 0.1)},
          {"slope_0_3_m", u->tvu_m(margin, 0.3)},
          {"slope_unknown_m", u->tvu_m(margin, std::nullopt)},
          {"from", u->apart == RevisitRecord::kSurvey ? "surveys" : "passes"},
          {"revisits", u->n}};
}

ordered_json depth_json(const DepthOutcome& depth) {
  const DepthCounts& n = depth.counts;
  ordered_json refused = ordered_json::object(), prior = ordered_json::object(), left_out = ordered_json::object();
  for (const auto& [reason, count] : depth.refused) refused[reason] = count;
  for (const auto& [what, count] : depth.prior_read) prior[what] = count;
  for (const auto& [reason, count] : depth.prior_left_out) left_out[reason] = count;
  return {{"readings", n.readings},
          {"soundings", n.soundings},
          {"merged", n.merged},
          {"applied", n.applied},
          {"pixels_examined", n.examined},
          {"pixels_per_reading", tidy(n.pixels_per_reading())},
          {"pixels_affirmed", n.affirmed},
          {"pixels_contradicted", n.conflicted},
          {"pixels_replaced", n.replaced},
          {"explained", n.explained},
          {"silent", n.silent},
          {"lost", n.lost()},
          {"shifts", n.shifts},
          {"shift_gap_least_s", n.shifts > 1 ? ordered_json(tidy(n.least_shift_gap_s)) : ordered_json()},
          {"shift_gap_mean_s", n.shifts > 1 ? ordered_json(tidy(to_seconds(n.last_shift - n.first_shift) /
                                                                static_cast<double>(n.shifts - 1)))
                                            : ordered_json()},
          {"refused", refused},
          {"known_pixels", depth.known_pixels},
          {"sensed_pixels", depth.sensed_pixels},
          {"confirmed_pixels", depth.confirmed_pixels},
          {"sensed_by_confidence", depth.sensed_by_confidence},
          {"pixels_lost", depth.pixels_lost},
          {"leaves", depth.leaves},
          {"bytes", depth.bytes},
          {"generation", depth.generation},
          {"continued", depth.continued},
          {"changes", changes_json(depth.changes, depth.origin)},
          {"objects",
           {{"met_first", depth.found.met_first}, {"met_again", depth.found.met_again}, {"gone", depth.found.gone}}},
          {"sensors", sensors_json(depth.sensors)},
          {"damages", depth.damages},
          {"priors", depth.priors},
          {"prior", prior},
          {"prior_left_out", left_out}};
}

ordered_json voxels_json(const VoxelOutcome& voxels) {
  ordered_json layers = ordered_json::array(), said = ordered_json::array();
  for (const auto& layer : voxels.layers) layers.push_back({{"sensor", layer.sensor}, {"pings", layer.pings}});
  ordered_json json{{"voxel_m", voxels.voxel_m},   {"seen", voxels.seen},     {"occupied", voxels.occupied},
                    {"free", voxels.free},         {"blocks", voxels.blocks}, {"megabytes", voxels.megabytes},
                    {"left_out", voxels.left_out}, {"layers", layers}};
  if (voxels.moved > 0) json["moved_with_jumps"] = voxels.moved;
  if (voxels.spilled) json["spilled"] = *voxels.spilled;
  if (!voxels.truth) return json;
  const VoxelTruth& truth = *voxels.truth;
  for (const VoxelTruth::Said& s : truth.by_probability) {
    said.push_back({{"said", tidy(s.probability)}, {"voxels", s.voxels}, {"surface", s.surface}});
  }
  json["truth"] = {
      {"judged", truth.judged},         {"surface", truth.surface},         {"precision", tidy(truth.precision())},
      {"recall", tidy(truth.recall())}, {"log_loss", tidy(truth.log_loss)}, {"by_probability", said}};
  return json;
}

ordered_json sphere_json(const SphericalOutcome& sphere) {
  return {{"pings", sphere.pings},
          {"ranges", sphere.ranges},
          {"swaths", sphere.swaths},
          {"scans", sphere.scans},
          {"range_m", tidy(sphere.range_m)},
          {"cells", sphere.cells},
          {"occupied", sphere.occupied},
          {"locked", sphere.locked},
          {"bytes", sphere.bytes},
          {"ahead", to_text(sphere.ahead.verdict)},
          {"clear_ahead_m", tidy(sphere.ahead.clear_m)},
          {"empty_directions", tidy(sphere.empty_directions)},
          {"coarser", sphere.coarser}};
}

std::string sphere_text(const SphericalOutcome& sphere) {
  const WayAhead& ahead = sphere.ahead;
  std::string way = fmt::format("ahead clear for {:.0f} m", ahead.clear_m);
  if (ahead.verdict == WayAhead::Verdict::kBlocked) way = fmt::format("ahead blocked after {:.1f} m", ahead.blocked_m);
  if (ahead.verdict == WayAhead::Verdict::kUnknown) {
    way = ahead.clear_m > 0 ? way + ", then unknown" : "unknown ahead";
  }
  return fmt::format("spherical grid: {} cells to {:g} m, {} occupied; {}", sphere.cells, sphere.range_m,
                     sphere.occupied, way);
}

std::string live_text(const LiveOutcome& live) {
  std::string text = fmt::format("live: {} pings dropped before mapping", live.lost_pings);
  if (live.unshown_pings + live.unshown_notes > 0) {
    text += fmt::format("; neither shown nor recorded: {} pings and scans, {} events and messages", live.unshown_pings,
                        live.unshown_notes);
  }
  if (!live.display_problem.empty()) text += "; the display failed: " + live.display_problem;
  return text;
}

std::string span_text(double seconds) {
  if (seconds < 7200) return fmt::format("{:.1f} s", seconds);
  if (seconds < 48 * 3600) return fmt::format("{:.1f} h", seconds / 3600);
  return fmt::format("{:.1f} days", seconds / (24 * 3600));
}

std::string truth_text(const TruthScore& score) { return dump(truth_json(score)); }

}  // namespace isobath
