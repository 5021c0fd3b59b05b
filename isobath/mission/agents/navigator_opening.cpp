// Openings on the route of the Navigator, and the helix that looks round them (ledger S5-40 to S5-46, S5-D09).
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/agents/navigator.hpp>
#include <isobath/mission/agents/way_keeping.hpp>

namespace isobath {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double kStep = 2.5;  // m between the way-points of a helix

std::vector<Vector3d> points_of(const SpacePath& path) {
  const int parts = std::max(1, static_cast<int>(std::ceil(path.length() / kStep)));
  std::vector<Vector3d> points;
  for (int i = 0; i <= parts; ++i) points.push_back(path.frame_at(path.length() * i / parts).p_W);
  return points;
}

}  // namespace

void Navigator::look_at_opening(View& view, Outbox& out) {
  if (!opening_.on() || !new_scan_ || !space_ || !request_ || way_.empty() || refused_) return;
  std::vector<Hazard> bodies = hazards_W(view);
  std::erase_if(bodies, [](const Hazard& h) { return h.kind == HazardKind::kFence; });
  const Vector3d& here = here_->X_WB.translation;
  Way way = {here.head<2>()};
  for (const Waypoint& w : way_) way.emplace_back(w.north, w.east);

  const double speed = wanted_speed();
  const auto news = opening_.see(bodies, way, request_->target.depth_m, speed, *space_);
  const auto clear = [&](const SpacePath& path) { return is_clear_helix(view, path); };
  const auto about_it = [&](const char* what, const std::string& more) {
    Decision d = decision(what, opening_.text() + more);
    d.opening = opening_.sighting();
    return d;
  };
  using News = OpeningWatch::News;
  if (news == News::kKnown) out.say(about_it("opening known", ""));
  if (news == News::kUnknown) {
    out.say(about_it("opening unknown", ", where the vehicle can turn away for the last time"));
  }
  if (news == News::kFound) {
    const auto plan = opening_.begin(here, speed, clear);
    if (!plan) return out.say(about_it("opening", ""));
    const std::string swing = fmt::format("{:.0f} degrees to each side", plan->demand.swing.degrees());
    return take_helix(view, plan->path, about_it("opening", "; a helix looks round it, " + swing), out);
  }
  const auto plan = opening_.improved(here);
  if (plan && clear(plan->path)) {
    take_helix(view, plan->path, about_it("helix", "; the helix is planned anew"), out);
  }
}

/// As a route in the plane, or through measured water.
bool Navigator::is_clear_helix(View& view, const SpacePath& path) const {
  const std::vector<Vector3d> points = points_of(path);
  Way way = {view.way.front()};
  for (const Vector3d& p : points) way.push_back(view.frame.to_local(p.head<2>()));
  return !conflict_ahead(view.map, way, least_clearance()) || is_clear_through(view, points);
}

void Navigator::take_helix(const View& view, const SpacePath& path, Decision d, Outbox& out) {
  const double before = length_of(view.way);
  const std::vector<Vector3d> points = points_of(path);
  std::vector<Waypoint> waypoints;
  Way way = {view.way.front()};
  for (std::size_t i = 1; i < points.size(); ++i) {
    waypoints.push_back({points[i].x(), points[i].y(), points[i].z(), wanted_speed(), points[i - 1].z()});
    way.push_back(view.frame.to_local(points[i].head<2>()));
  }
  const MissionPoint& target = request_->target;
  waypoints.push_back(
      {target.north_east.x(), target.north_east.y(), target.depth_m, wanted_speed(), points.back().z()});
  way.push_back(view.goal);
  through_ = conflict_ahead(view.map, way, least_clearance()).has_value();
  adopt(view, std::move(waypoints), length_of(way) - before, std::move(d), out);
}

}  // namespace isobath
