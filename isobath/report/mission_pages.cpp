#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/report/mission_pages.hpp>
#include <isobath/report/plot/mission_plot.hpp>
#include <set>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr int kPlotPixels = 1100;
constexpr double kCaptureRadius = 5;  // m; within it a mission point counts as reached (S6-37), if it states no other
constexpr Colour kWater{0.91, 0.95, 0.985, 1};
constexpr Colour kCharted{0.62, 0.78, 0.90, 0.7}, kChartedEdge{0.20, 0.42, 0.62, 0.9};
constexpr Colour kMapped{0.93, 0.78, 0.50, 0.75}, kMappedEdge{0.66, 0.44, 0.08, 0.9};
constexpr Colour kBody{0.45, 0.42, 0.38, 1};
constexpr Colour kFence{0.65, 0.10, 0.45, 1};
constexpr Colour kWay{0.35, 0.20, 0.60, 1};
constexpr Colour kOldWay{0.35, 0.20, 0.60, 0.45};
constexpr Colour kReplan{0.84, 0.37, 0.0, 1};
constexpr Colour kSafety{0.75, 0.05, 0.10, 1};
constexpr Colour kReached{0.0, 0.50, 0.36, 1};

bool overrules(const Decision& d) { return d.agent == "safety officer"; }
bool changes_the_way(const Decision& d) { return !d.way.empty(); }

bool gives_up_or_moves_a_point(const Decision& d) { return d.what == "drop point" || d.what == "move point"; }

double radius_of(const MissionPoint& point) { return point.radius_m > 0 ? point.radius_m : kCaptureRadius; }

/// "mission point, radius 5 m"; without the number if the points have several.
std::string point_legend(const MissionPlan& plan) {
  if (plan.points.empty()) return "mission point";
  const double radius = radius_of(plan.points.front());
  const bool same = std::all_of(plan.points.begin(), plan.points.end(),
                                [&](const MissionPoint& p) { return radius_of(p) == radius; });
  return same ? fmt::format("mission point, radius {:g} m", radius) : "mission point with its radius";
}

/// Whether a decision gets a number on the chart. Refusals without an obstacle (such as: no scan yet), and refusals
/// that a dropped or moved point follows at once, stand in the table only.
bool stands_on_chart(const std::vector<Decision>& decisions, std::size_t i) {
  const Decision& d = decisions[i];
  if (d.what != "refuse") return overrules(d) || changes_the_way(d) || gives_up_or_moves_a_point(d);
  const bool answered =
      i + 1 < decisions.size() && decisions[i + 1].time == d.time && gives_up_or_moves_a_point(decisions[i + 1]);
  return d.obstacle.has_value() && !answered;
}

Colour colour_of(const Decision& d) { return overrules(d) ? kSafety : kReplan; }

// The chart ----------------------------------------------------------------------------------------------------------

/// Adds what stands within this distance of the frame, as far as it does; m.
void extend_to(const Polygon& outline, Eigen::AlignedBox2d& box, const Eigen::AlignedBox2d& frame) {
  constexpr double kNear = 15;
  Eigen::AlignedBox2d bounds;
  for (const Vector2d& p : outline) bounds.extend(p);
  const Eigen::AlignedBox2d near(frame.min().array() - kNear, frame.max().array() + kNear);
  const Eigen::AlignedBox2d shown = bounds.intersection(near);
  if (!shown.isEmpty()) box.extend(shown);
}

PlanExtent mission_extent(const MissionOutcome& outcome) {
  Eigen::AlignedBox2d box;
  for (const MissionPoint& p : outcome.plan.points) {
    box.extend(Vector2d(p.north_east.array() + radius_of(p))).extend(Vector2d(p.north_east.array() - radius_of(p)));
  }
  for (const BelievedPlace& p : outcome.believed) box.extend(p.north_east);
  for (const Decision& d : outcome.decisions) {
    for (const Vector2d& p : d.way) box.extend(p);
  }
  if (outcome.truth) {
    for (const TrueMotion& m : outcome.truth->track) box.extend(Vector2d(m.state.X_WB.translation.head<2>()));
  }
  if (const Eigen::AlignedBox2d sailed = box; !sailed.isEmpty()) {
    for (const TrueBody& body : outcome.bodies) extend_to(body.outline, box, sailed);
    for (const SeenObstacle& o : outcome.seen) {
      if (o.existence > 0.9) extend_to(o.outline, box, sailed);
    }
  }
  Eigen::AlignedBox2d with_fence = box;
  for (const Vector2d& p : outcome.plan.fence) with_fence.extend(p);
  if (with_fence.sizes().maxCoeff() < 3 * box.sizes().maxCoeff()) box = with_fence;
  // A narrow track is shown with the water beside it.
  const double least = std::max(0.55 * box.sizes().maxCoeff(), 20.0);
  const Vector2d half = (0.5 * box.sizes()).cwiseMax(0.5 * least) * 1.06;
  const Vector2d c = box.center();
  return {c.x() - half.x(), c.x() + half.x(), c.y() - half.y(), c.y() + half.y()};
}

void draw_obstacles(MissionPlot& plot, const MissionOutcome& outcome) {
  for (const TrueBody& body : outcome.bodies) {
    plot.area(body.outline, {kBody.red, kBody.green, kBody.blue, 0.8}, {palette::kInk, 1.2, false});
  }
  for (const SeenObstacle& o : outcome.seen) {
    const Colour c = palette::kObstacle;
    plot.area(o.outline, {c.red, c.green, c.blue, 0.07 * o.existence},
              {{c.red, c.green, c.blue, 0.22 * o.existence}, 1, false});
  }
  for (const InjectedMap& map : outcome.plan.injected) {
    for (const Polygon& outline : map.outlines) plot.area(outline, {0.84, 0.37, 0.0, 0.15}, {kReplan, 2, true});
  }
}

void draw_shoals(MissionPlot& plot, const MissionOutcome& outcome) {
  const auto draw = [&plot](const Hazard& hazard, Colour filling, const Stroke& edge) {
    plot.area(hazard.outline, filling, edge);
    if (hazard.outline.size() > 2) return;
    for (const Vector2d& end : hazard.outline) plot.circle(end, std::max(hazard.margin_m, 0.0), edge);
  };
  for (const Hazard& hazard : outcome.charted) draw(hazard, kCharted, {kChartedEdge, 1.2, true});
  for (const Hazard& hazard : outcome.mapped) draw(hazard, kMapped, {kMappedEdge, 1.2, false});
}

void draw_ways(MissionPlot& plot, const MissionOutcome& outcome) {
  const auto last = std::find_if(outcome.decisions.rbegin(), outcome.decisions.rend(), changes_the_way);
  for (const Decision& d : outcome.decisions) {
    if (d.way.empty()) continue;
    std::vector<Vector2d> way = d.way;
    if (const auto from = place_at(outcome, d.time)) way.insert(way.begin(), from->north_east);
    const bool in_force = &d == &*last;
    plot.polyline(way, false, {in_force ? kWay : kOldWay, in_force ? 2.0 : 1.6, !in_force});
    for (const Vector2d& corner : d.way) plot.circle(corner, 3 * plot.metres_per_px(), {kOldWay, 1.5, false});
  }
}

void draw_tracks(MissionPlot& plot, const MissionOutcome& outcome) {
  std::vector<Vector2d> believed, went;
  for (const BelievedPlace& p : outcome.believed) believed.push_back(p.north_east);
  if (outcome.truth) {
    for (const TrueMotion& m : outcome.truth->track) went.emplace_back(m.state.X_WB.translation.head<2>());
  }
  if (went.size() > 1) plot.polyline(went, false, {palette::kTrack, 3.2, false});
  if (believed.size() > 1) plot.polyline(believed, false, {palette::kInk, 1.3, !went.empty()});
}

/// Whether a decision dropped this point.
bool was_dropped(const MissionOutcome& outcome, const MissionPoint& point) {
  return std::any_of(outcome.decisions.begin(), outcome.decisions.end(), [&](const Decision& d) {
    return d.what.find("drop") != std::string::npos && d.reason.find(point.name) != std::string::npos;
  });
}

void draw_points(MissionPlot& plot, const MissionOutcome& outcome) {
  for (const MissionPoint& p : outcome.plan.points) {
    const bool dropped = was_dropped(outcome, p);
    const Colour colour = dropped ? kSafety : kReached;
    plot.circle(p.north_east, radius_of(p), {colour, 2.4, false});
    if (dropped) plot.cross(p.north_east, {colour, 2.4, false});
    plot.name(p.north_east, p.name, colour);
  }
}

bool is_small(const TrueBody& body, double metres_per_px) {
  Eigen::AlignedBox2d box;
  for (const Vector2d& p : body.outline) box.extend(p);
  return box.diagonal().norm() < 12 * metres_per_px;
}

/// Bodies that are too small to be seen are drawn with the chart symbol of a danger.
void draw_dangers(MissionPlot& plot, const MissionOutcome& outcome) {
  for (const TrueBody& body : outcome.bodies) {
    if (is_small(body, plot.metres_per_px())) plot.danger(body.outline.front(), body.name);
  }
}

void draw_nearest(MissionPlot& plot, const MissionOutcome& outcome) {
  if (!outcome.truth || outcome.bodies.empty() || !std::isfinite(outcome.truth->min_clearance_m)) return;
  const TrackTruth& truth = *outcome.truth;
  const auto least = std::min_element(truth.clearance_m.begin(), truth.clearance_m.end());
  const TrueMotion& there = truth.track[static_cast<std::size_t>(least - truth.clearance_m.begin())];
  const Vector2d here = there.state.X_WB.translation.head<2>();
  // A body that moves is drawn where it was last; it was nearest somewhere else.
  Vector2d nearest = here;
  for (const TrueBody& body : outcome.bodies) {
    if (body.name != truth.nearest_body) continue;
    const Vector2d back = body.moved - truth.nearest_moved;
    const Vector2d p = nearest_point(body.outline, here + back) - back;
    if (nearest == here || (p - here).norm() < (nearest - here).norm()) nearest = p;
  }
  plot.measure(here, nearest, fmt::format("{:.1f} m clear", truth.min_clearance_m));
}

void draw_numbers(MissionPlot& plot, const MissionOutcome& outcome) {
  for (std::size_t i = 0; i < outcome.decisions.size(); ++i) {
    const Decision& d = outcome.decisions[i];
    const auto place = place_at(outcome, d.time);
    if (place && stands_on_chart(outcome.decisions, i))
      plot.numbered(place->north_east, static_cast<int>(d.number), colour_of(d));
  }
}

/// The obstacles that decisions name, by their numbers; each once, where the first decision met it.
void draw_obstacle_numbers(MissionPlot& plot, const MissionOutcome& outcome) {
  std::set<int> named;
  for (const Decision& d : outcome.decisions) {
    if (d.obstacle_number == 0 || !d.obstacle || !named.insert(d.obstacle_number).second) continue;
    plot.name(*d.obstacle, fmt::format("obstacle {}", d.obstacle_number), kReplan);
  }
}

std::string how_it_ended(const MissionOutcome& outcome) {
  const MissionReport& r = outcome.report;
  std::string text =
      fmt::format("Mission {}: {} of {} points reached", to_text(r.phase), r.reached, outcome.plan.points.size());
  if (r.dropped > 0) text += fmt::format(", {} dropped", r.dropped);
  return text + ".";
}

std::string how_clear(const TrackTruth& truth) {
  if (truth.contact_s >= 0) return fmt::format("CONTACT with {} at {:.1f} s.", truth.contact_with, truth.contact_s);
  if (!std::isfinite(truth.min_clearance_m)) return "There were no bodies in the water.";
  return fmt::format("Minimum clearance {:.1f} m, to {}.", truth.min_clearance_m, truth.nearest_body);
}

/// "Minimum clearance 3.1 m, to the pile. 120 m travelled. Navigation error 0.3 m at the end, 0.9 m at most."
std::string by_the_truth(const MissionOutcome& outcome) {
  std::string text = fmt::format("{} {:.0f} m travelled.", how_clear(*outcome.truth), outcome.truth->length_m);
  if (const auto error = navigation_error(outcome)) {
    text += fmt::format(" Navigation error {:.2f} m at the end, {:.2f} m at most.", error->last_m, error->largest_m);
  }
  return text;
}

void legend(MissionPlot& plot, const MissionOutcome& outcome) {
  plot.north_arrow_and_scale();
  const bool true_way = outcome.truth && !outcome.truth->track.empty();
  if (true_way) plot.legend_line({palette::kTrack, 3.2, false}, "true track");
  plot.legend_line({palette::kInk, 1.3, true_way}, true_way ? "estimated track" : "track of the vehicle");
  plot.legend_line({kWay, 2, false}, "last planned route");
  plot.legend_line({kOldWay, 1.6, true}, "earlier routes");
  if (!outcome.plan.fence.empty()) plot.legend_line({kFence, 2, true}, "fence");
  plot.legend_circle({kReached, 2.4, false}, point_legend(outcome.plan));
  if (outcome.report.dropped > 0) plot.legend_circle({kSafety, 2.4, false}, "dropped point", true);
  const auto small = [&](const TrueBody& body) { return is_small(body, plot.metres_per_px()); };
  if (!std::all_of(outcome.bodies.begin(), outcome.bodies.end(), small)) {
    plot.legend_fill({kBody.red, kBody.green, kBody.blue, 0.8}, "true bodies");
  }
  if (std::any_of(outcome.bodies.begin(), outcome.bodies.end(), small)) {
    plot.legend_danger("small body, true position");
  }
  plot.legend_fill({0.84, 0.37, 0.0, 0.35}, "detected obstacles");
  if (!outcome.charted.empty()) plot.legend_fill(kCharted, "hazards of the chart, at the start");
  if (!outcome.mapped.empty()) plot.legend_fill(kMapped, "measured hazards, at the end");
  plot.legend_number(kReplan, "decision, number as in table");
  if (std::any_of(outcome.decisions.begin(), outcome.decisions.end(), overrules)) {
    plot.legend_number(kSafety, "the same, of the Safety Officer");
  }
  plot.gap();
  plot.note(how_it_ended(outcome), true);
  if (outcome.truth) {
    plot.note(how_clear(*outcome.truth), outcome.truth->contact_s >= 0);
    plot.note(fmt::format("{:.0f} m travelled.", outcome.truth->length_m));
  }
}

std::string chart_png(const MissionOutcome& outcome, const ChartSource& source) {
  const std::string title = outcome.plan.title.empty() ? "Mission" : outcome.plan.title;
  MissionPlot plot(mission_extent(outcome), kPlotPixels, title, outcome.plan.origin);
  plot.water(kWater);
  draw_shoals(plot, outcome);
  draw_obstacles(plot, outcome);
  if (!outcome.plan.fence.empty()) plot.polyline(outcome.plan.fence, true, {kFence, 2, true});
  draw_ways(plot, outcome);
  draw_tracks(plot, outcome);
  draw_points(plot, outcome);
  draw_dangers(plot, outcome);
  draw_numbers(plot, outcome);
  draw_obstacle_numbers(plot, outcome);
  draw_nearest(plot, outcome);
  if (outcome.truth && !outcome.truth->track.empty()) {
    const Pose& X_WB = outcome.truth->track.back().state.X_WB;
    plot.vehicle(X_WB.translation.head<2>(), X_WB.rotation.heading().radians());
  }
  legend(plot, outcome);
  plot.gap();
  plot.about(source, "No geographic position: metres from the origin of the mission.");
  plot.finish();
  return plot.png();
}

// Clearance over time ------------------------------------------------------------------------------------------------

std::string clearance_png(const MissionOutcome& outcome, double planned_clearance_m) {
  const TrackTruth& truth = *outcome.truth;
  std::vector<double> time, clear;
  for (std::size_t i = 0; i < truth.track.size(); ++i) {
    time.push_back(to_seconds(truth.track[i].time));
    clear.push_back(truth.clearance_m[i]);
  }
  const double top = std::clamp(1.1 * *std::max_element(clear.begin(), clear.end()), 10.0, 40.0);
  for (double& c : clear) c = c > top ? std::nan("") : c;
  ChartPicture picture(1000, 400, "Clearance from the hull to the nearest body",
                       {"time (s)", 0, std::max(time.back(), 1.0)},
                       {"clearance (m)", std::min(0.0, truth.min_clearance_m), top});
  const std::vector<double> ends{0, time.back()};
  const auto limit = [&](double value, Colour colour, const std::string& name) {
    picture.curve(ends, std::vector<double>{value, value}, {colour, 1.5, true}, name);
  };
  picture.curve(time, clear, {palette::kTrack, 2, false}, "clearance, true");
  limit(planned_clearance_m, kReplan, fmt::format("planned with: {:g} m", planned_clearance_m));
  limit(0, kSafety, "contact");
  for (std::size_t i = 0; i < outcome.decisions.size(); ++i) {
    const Decision& d = outcome.decisions[i];
    if (stands_on_chart(outcome.decisions, i)) picture.mark(to_seconds(d.time), std::to_string(d.number), colour_of(d));
  }
  picture.finish();
  return picture.png();
}

std::string number_or_dash(const std::optional<double>& value) { return value ? fmt::format("{:.1f}", *value) : "-"; }

}  // namespace

void add_command_levels(HtmlReport& page, const std::vector<LevelOutcome>& levels, const std::string& heading) {
  if (levels.empty()) return;
  page.heading(heading);
  std::vector<HtmlReport::Row> rows;
  for (const LevelOutcome& level : levels) {
    rows.push_back({to_text(level.level), fmt::format("{}", level.commands), fmt::format("{}", level.without_parent),
                    fmt::format("{:.2f}", level.mean_interval_s), fmt::format("{:.2f}", level.least_interval_s),
                    fmt::format("{:.2f}", level.longest_interval_s), fmt::format("{:.2f}", level.longest_stale_s)});
  }
  page.table({"level", "commands", "without a parent", "mean interval (s)", "shortest", "longest", "stale (s)"}, rows);
  page.paragraph(
      "Each command serves one of the level above; without a parent are reflexes of the Safety Officer and stops. "
      "Stale: the longest time for which a command served one that a level above had already replaced.");
  std::vector<HtmlReport::Row> plans;
  for (const LevelOutcome& level : levels) {
    const bool servo = level.level == CommandLevel::kServo;  // it plans nothing
    plans.push_back({to_text(level.level), servo ? "" : fmt::format("{}", level.plans),
                     servo ? "" : fmt::format("{}", level.changed_plans), fmt::format("{:g}", level.timing.replan_s),
                     fmt::format("{:.2f}", servo ? level.longest_interval_s : level.longest_replan_s),
                     level.in_time() ? "yes" : "no", fmt::format("{:g}", level.timing.horizon_s),
                     servo ? "" : fmt::format("{:.0f}", level.mean_horizon_s)});
  }
  page.table({"level", "plans", "changed", "wanted every (s)", "longest interval (s)", "in time", "wanted to reach (s)",
              "reached, mean (s)"},
             plans);
  page.paragraph(
      "Wanted: by the timing table of the configuration. The servo level plans nothing; its interval is that of its "
      "commands.");
}

MissionPictures draw_mission(const MissionOutcome& outcome, double planned_clearance_m, const ChartSource& source) {
  MissionPictures pictures;
  if (!outcome.believed.empty()) pictures.chart = chart_png(outcome, source);
  if (outcome.truth && outcome.truth->track.size() > 1 && std::isfinite(outcome.truth->min_clearance_m)) {
    pictures.clearance = clearance_png(outcome, planned_clearance_m);
  }
  return pictures;
}

void add_mission(HtmlReport& page, const MissionOutcome& outcome, const MissionPictures& pictures) {
  page.heading("Mission");
  if (const std::string failure = outcome.failure(); !failure.empty()) page.warning("Failed: " + failure + ".");
  std::string lead = how_it_ended(outcome);
  if (outcome.truth) lead += " " + by_the_truth(outcome);
  page.paragraph(lead);
  if (!outcome.report.why.empty()) page.paragraph(outcome.report.why);
  if (!pictures.chart.empty()) {
    page.figure(pictures.chart, "Track of the vehicle, north up. The numbers are those of the decisions below.");
  }
  if (!pictures.clearance.empty()) {
    page.figure(pictures.clearance, "Clearance from the hull to the nearest body, with the numbered decisions.");
  }
  add_command_levels(page, outcome.levels, "Levels of command");
  page.heading("Decisions");
  std::vector<HtmlReport::Row> rows;
  for (const Decision& d : outcome.decisions) {
    rows.push_back({fmt::format("{}", d.number), to_text(d.time), d.agent, d.what,
                    d.leg ? fmt::format("{}", *d.leg) : "-", number_or_dash(d.margin_m), d.reason});
  }
  page.table({"", "time", "by", "what", "leg", "margin (m)", "why"}, rows);
}

std::vector<std::string> mission_summary(const MissionOutcome& outcome) {
  std::vector<std::string> lines{how_it_ended(outcome)};
  if (outcome.truth) lines.push_back(by_the_truth(outcome));
  if (outcome.recorded) {
    lines.push_back(
        fmt::format("{} of {} decisions equal those of the recorded run.", outcome.as_recorded, *outcome.recorded));
  }
  for (std::size_t i = 0; i < outcome.decisions.size(); ++i) {
    const Decision& d = outcome.decisions[i];
    if (!stands_on_chart(outcome.decisions, i)) continue;
    lines.push_back(fmt::format("  {:>2}  {:>9}  {}: {}: {}", d.number, to_text(d.time), d.agent, d.what, d.reason));
  }
  return lines;
}

}  // namespace isobath
