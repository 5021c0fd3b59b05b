#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/report/plot/picture.hpp>
#include <isobath/studies/traffic_pictures.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr int kTrackSteps = 100;  ///< before and after the least gap
constexpr int kDotSteps = 100;
constexpr Colour kStructure{0.75, 0.75, 0.77, 1};

std::vector<Vector2d> ring_of(const Vector2d& middle, double radius_m) {
  std::vector<Vector2d> ring;
  for (int k = 0; k < 36; ++k) {
    const double angle = k * std::numbers::pi / 18;
    ring.push_back(middle + radius_m * Vector2d(std::cos(angle), std::sin(angle)));
  }
  return ring;
}

/// The outline of a structure at a time of the run.
std::vector<Vector2d> outline_at(const MovingBody& structure, double time_s) {
  const double c = std::cos(structure.turn_rate * time_s), s = std::sin(structure.turn_rate * time_s);
  std::vector<Vector2d> outline;
  for (const Vector2d& corner : structure.outline) {
    outline.push_back(structure.p_W + Vector2d(c * corner.x() - s * corner.y(), s * corner.x() + c * corner.y()));
  }
  return outline;
}

}  // namespace

std::string traffic_picture(const TrafficRequest& request, int run, int discs, double max_speed) {
  LatencyHistogram times;
  const TrafficRun flown = run_traffic(request, TrafficMethod::kPlanner, run, discs, max_speed, times, true);
  // Beside it the same run without a road map, where that is something else.
  const bool has_search = std::ranges::find(request.methods, TrafficMethod::kSearch) != request.methods.end();
  const TrafficRun searched =
      has_search ? run_traffic(request, TrafficMethod::kSearch, run, discs, max_speed, times, true) : TrafficRun{};
  std::size_t nearest = 0;
  double least_m = 1e9;
  std::vector<std::vector<Vector2d>> tracks(discs);
  TrafficScene scene(request.scenery, run, discs, max_speed);
  for (std::size_t step = 0; step < flown.track.size(); ++step, scene.step()) {
    const double gap = scene.gap(flown.track[step].own.p_W);
    if (gap < least_m) {
      least_m = gap;
      nearest = step;
    }
    for (int i = 0; i < discs; ++i) tracks[i].push_back(scene.discs()[i].p_W);
  }
  PlanPicture picture({-20, 160, -60, 60}, 900,
                      {fmt::format("Run {}: {} bodies of up to {:g} m/s, {:.1f} s; least gap {:.2f} m at {:.1f} s", run,
                                   discs, max_speed, flown.time_s, least_m, flown.track[nearest].time_s),
                       "north (m)", "east (m)"});
  const Colour body = palette::kObstacle, faint{body.red, body.green, body.blue, 0.25};
  for (int i = 0; i < discs; ++i) {
    const std::vector<Vector2d>& track = tracks[i];
    const std::size_t from = nearest < kTrackSteps ? 0 : nearest - kTrackSteps;
    const std::size_t to = std::min(track.size(), nearest + kTrackSteps + 1);
    picture.polyline(std::span(track).subspan(from, to - from), {body, 0.8, true});
    picture.polygon(ring_of(track[nearest], scene.discs()[i].radius_m), {body, 1, false}, faint);
  }
  for (const MovingBody& structure : scene.structures()) {
    picture.polygon(outline_at(structure, flown.track[nearest].time_s), {palette::kInk, 1, false}, kStructure);
  }
  std::vector<Vector2d> path;
  for (const TrafficMoment& moment : searched.track) path.push_back(moment.own.p_W);
  if (has_search) picture.polyline(path, {palette::kHidden, 1.5, true});
  path.clear();
  for (const TrafficMoment& moment : flown.track) path.push_back(moment.own.p_W);
  picture.polyline(path, {palette::kTrack, 2, false});
  for (std::size_t step = 0; step < path.size(); step += kDotSteps) picture.dot(path[step], 3, palette::kTrack);
  picture.vehicle(path[nearest], flown.track[nearest].own.heading);
  std::vector<PlanPicture::LegendEntry> legend = {{palette::kTrack, "vehicle, a dot every 10 s"},
                                                  {body, "bodies, tracks of 20 s"}};
  if (has_search) legend.push_back({palette::kHidden, "vehicle without a road map"});
  picture.finish(legend);
  return picture.png();
}

std::string traffic_table(const TrafficStudy& study) {
  std::string text =
      fmt::format("{:<9}  {:>6}  {:>3}  {:>4}  {:<20}  {:<20}  {:>5}  {:>5}  {:>6} {:>7}  {:>6} {:>6}  {:>7} {:>7}\n",
                  "method", "bodies", "m/s", "runs", "contact", "deep contact", "time", "95 %", "gap, m", "least",
                  "way, m", "5 %", "step ms", "99 %");
  for (const TrafficRow& row : study.rows) {
    const auto share = [&](int count, const Interval& of) {
      return fmt::format("{:4.1f} % ({:.1f} .. {:.1f})", 100.0 * count / row.runs, 100 * of.low, 100 * of.high);
    };
    text += fmt::format(
        "{:<9}  {:6}  {:3.1f}  {:4}  {:<20}  {:<20}  {:.3f}  {:.3f}  {:6.2f} {:7.2f}  {:6.2f} {:6.2f}  {:7.3f} "
        "{:7.2f}\n",
        to_text(row.method), row.discs, row.max_speed, row.runs, share(row.contacts, row.contact_share),
        share(row.deep_contacts, row.deep_share), row.time_median, row.time_p95, row.gap_median_m, row.gap_least_m,
        row.water_median_m, row.water_p05_m, row.step.median_ms, row.step.p99_ms);
  }
  return text;
}

std::string traffic_road_table(const TrafficStudy& study) {
  std::string text =
      fmt::format("{:<9}  {:>6}  {:>3}  {:<20}  {:>6}  {:>14}  {:>5} {:>7} {:>6}  {:>7}  {:>7}\n", "method", "bodies",
                  "m/s", "arrived", "length", "detail 1, 2, 3", "plans", "on road", "mended", "refused", "no path");
  for (const TrafficRow& row : study.rows) {
    const auto mean = [&](int count) { return static_cast<double>(count) / row.runs; };
    text +=
        fmt::format("{:<9}  {:6}  {:3.1f}  {:<20}  {:6.3f}  {:>14}  {:5.1f} {:7.1f} {:6.1f}  {:7.1f}  {:7}\n",
                    to_text(row.method), row.discs, row.max_speed,
                    fmt::format("{:5.1f} % ({:.1f} .. {:.1f})", 100.0 * row.arrived / row.runs,
                                100 * row.arrived_share.low, 100 * row.arrived_share.high),
                    row.length_median, fmt::format("{}, {}, {}", row.at_detail[0], row.at_detail[1], row.at_detail[2]),
                    mean(row.plans), mean(row.road_plans), mean(row.mended), mean(row.refused_paths), row.without_path);
  }
  return text;
}

}  // namespace isobath
