#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/plan/mission_plan.hpp>
#include <numeric>

namespace isobath {
namespace {

constexpr std::size_t kMaxKinds = 200;  // kinds of left-out items that a report names

[[noreturn]] void refuse(Place place, const std::string& key, const std::string& problem, const std::string& allowed,
                         const std::string& advice = {}) {
  place.key += (place.key.empty() ? "" : ".") + key;
  throw Error(problem, std::move(place), allowed, advice);
}

void check_range(const Place& place, const std::string& key, double value, double low, double high,
                 const std::string& unit) {
  if (value >= low && value <= high) return;  // false for what is not a number
  refuse(place, key, fmt::format("{} is out of range", value), fmt::format("{} .. {}{}", low, high, unit));
}

bool on_the_plane(const Eigen::Vector2d& p) { return p.cwiseAbs().maxCoeff() <= kMaxMetres && p.allFinite(); }

std::string far_text() { return fmt::format("within {} m of the origin", kMaxMetres); }

void check_limits(const MissionPlan& plan) {
  Place place = plan.place;
  place.key = "mission_limits";
  const MissionLimits& l = plan.limits;
  check_range(place, "min_depth_m", l.min_depth_m, 0, 12000, " m");
  check_range(place, "max_depth_m", l.max_depth_m, 0, 12000, " m");
  check_range(place, "min_altitude_m", l.min_altitude_m, 0, 1000, " m");
  check_range(place, "max_position_sigma_m", l.max_position_sigma_m, 0, 1e5, " m");
  check_range(place, "max_duration_s", l.max_duration_s, 0, 1e8, " s");
  check_range(place, "low_battery_share", l.low_battery_share, 0, 1, "");
  if (l.max_depth_m <= l.min_depth_m) {
    refuse(place, "max_depth_m", fmt::format("{} m does not lie below min_depth_m", l.max_depth_m),
           fmt::format("more than {} m", l.min_depth_m));
  }
}

void check_fence(const MissionPlan& plan) {
  if (plan.fence.empty()) return;
  const Place& place = plan.fence_place;
  if (plan.fence.size() < 3) refuse(place, "corners", "fewer than 3 corners", "3 corners or more, or none");
  if (plan.fence.size() > kMaxFenceCorners) {
    refuse(place, "corners", fmt::format("{} corners", plan.fence.size()), fmt::format("up to {}", kMaxFenceCorners));
  }
  for (const Eigen::Vector2d& p : plan.fence) {
    if (!on_the_plane(p)) refuse(place, "corners", fmt::format("a corner at {}, {}", p.x(), p.y()), far_text());
  }
  if (!is_simple(plan.fence)) {
    refuse(place, "corners", "the fence crosses or touches itself", "a simple polygon",
           "list its corners in order, each once");
  }
}

void check_place(const MissionPlan& plan, const MissionPoint& p) {
  if (!on_the_plane(p.north_east)) {
    refuse(p.place, "north", fmt::format("{} at {}, {}", p.name, p.north_east.x(), p.north_east.y()), far_text());
  }
  if (!plan.fence.empty() && !encloses(plan.fence, p.north_east)) {
    refuse(p.place, "north",
           fmt::format("{} at {:.2f}, {:.2f} lies {:.2f} m outside the fence", p.name, p.north_east.x(),
                       p.north_east.y(), -inner_distance(plan.fence, p.north_east)),
           "inside the fence or on it", "move the point or the fence");
  }
}

void check_point(const MissionPlan& plan, const MissionPoint& p) {
  check_place(plan, p);
  check_range(p.place, "speed", p.speed, 0, kMaxSpeed, " m/s");
  check_range(p.place, "hold_s", p.hold_s, 0, 1e7, " s");
  check_range(p.place, "radius_m", p.radius_m, 0, 1000, " m");
  check_range(p.place, "drop_distance_m", p.drop_distance_m, 0, 1000, " m");
  check_range(p.place, "move_m", p.move_m, 0, 1e4, " m");
  if (p.altitude_m) {
    if (*p.altitude_m > 0 && *p.altitude_m >= plan.limits.min_altitude_m && *p.altitude_m <= 12000) return;
    refuse(p.place, "altitude_m", fmt::format("{} at {} m above the bottom", p.name, *p.altitude_m),
           fmt::format("{} .. 12000 m", plan.limits.min_altitude_m), "see mission_limits.min_altitude_m");
  }
  if (p.depth_m >= plan.limits.min_depth_m && p.depth_m <= plan.limits.max_depth_m) return;
  refuse(p.place, "depth_m", fmt::format("{} at {} m of depth", p.name, p.depth_m),
         fmt::format("{} .. {} m", plan.limits.min_depth_m, plan.limits.max_depth_m), "see mission_limits");
}

}  // namespace

const char* to_text(MissionEnd end) {
  switch (end) {
    case MissionEnd::kHold: return "hold";
    case MissionEnd::kSurface: return "surface";
    case MissionEnd::kReturn: return "return";
  }
  return "";
}

void ImportReport::leave_out(const std::string& what, const std::string& why) {
  for (LeftOut& l : left_out) {
    if (l.what != what || l.why != why) continue;
    ++l.count;
    return;
  }
  if (left_out.size() < kMaxKinds) {
    left_out.push_back({what, why, 1});
  } else {
    left_out.back() = {"items of other kinds", "too many to name", left_out.back().count + 1};
  }
}

std::size_t ImportReport::left_out_count() const {
  std::size_t count = 0;
  for (const LeftOut& l : left_out) count += l.count;
  return count;
}

std::string ImportReport::text() const {
  if (format.empty()) return {};
  std::string text = fmt::format("{}: {} taken, {} left out", format, taken, left_out_count());
  for (std::size_t i = 0; i < left_out.size(); ++i) {
    const LeftOut& l = left_out[i];
    text += fmt::format("{} {} x {} ({})", i == 0 ? ":" : ",", l.count, l.what, l.why);
  }
  return text;
}

MissionPlan on_plane_of(MissionPlan plan, const GeoOrigin& origin) {
  if (!plan.origin) return plan;
  const double apart_m = distance_m(*plan.origin, origin);
  if (apart_m <= 1) return plan;
  if (apart_m > kMaxMetres) {
    throw Error(fmt::format("the origin of the mission is {:.0f} km away from the origin of the input", apart_m / 1000),
                plan.place, fmt::format("at most {:.0f} km", kMaxMetres / 1000));
  }
  const LocalPlane from(*plan.origin), to(origin);
  const auto move = [&](Eigen::Vector2d& p) { p = to.to_plane(from.to_geo(p)); };
  for (MissionPoint& point : plan.points) move(point.north_east);
  std::for_each(plan.fence.begin(), plan.fence.end(), move);
  move(plan.search.corner);
  for (GroupMember& member : plan.group) move(member.start);
  for (InjectedMap& map : plan.injected) {
    for (Polygon& outline : map.outlines) std::for_each(outline.begin(), outline.end(), move);
  }
  for (RiskArea& risk : plan.risks) move(risk.centre_W);
  for (GroupPassage& passage : plan.passages) std::for_each(passage.outline.begin(), passage.outline.end(), move);
  plan.origin = origin;
  return plan;
}

void check_outline(const Polygon& outline, const Place& place) {
  const bool near = std::all_of(outline.begin(), outline.end(), on_the_plane);
  if (!near) refuse(place, "outline", "a corner that is not on the plane", far_text());
  if (outline.size() < 3) refuse(place, "outline", "fewer than 3 corners", "3 corners or more");
  if (outline.size() > kMaxFenceCorners || !is_convex(outline)) {
    refuse(place, "outline", "not convex", fmt::format("a convex polygon of up to {} corners", kMaxFenceCorners),
           "cut it into convex pieces");
  }
}

void check_mission(const MissionPlan& plan) {
  check_range(plan.place, "speed", plan.speed, 0.01, kMaxSpeed, " m/s");
  if (plan.origin && !valid(*plan.origin))
    refuse(plan.place, "latitude_deg", "not a place on the globe", "-90 .. 90 deg");
  check_limits(plan);
  check_fence(plan);
  if (plan.points.empty()) {
    throw Error("the mission has no points", plan.place, "one [[mission_point]] or more, or a [search_area]");
  }
  for (const MissionPoint& p : plan.points) check_point(plan, p);
  for (const InjectedMap& map : plan.injected) {
    check_range(map.place, "at_s", map.at_s, 0, 1e7, " s");
    for (const Polygon& outline : map.outlines) check_outline(outline, map.place);
  }
  check_steps(plan.steps);
  if (plan.passages.size() > kMaxPassages) {
    refuse(plan.passages.back().place, "outline", fmt::format("{} passages", plan.passages.size()),
           fmt::format("up to {}", kMaxPassages));
  }
  for (const GroupPassage& passage : plan.passages) check_outline(passage.outline, passage.place);
}

constexpr double kBetweenCircles_m = 12;
constexpr double kWayPast_m = 20;  ///< between the lanes and the circles, for vehicles on their way

void add_waiting_places(MissionPlan& plan) {
  const SearchArea& area = plan.search;
  const Eigen::Vector2d ahead(cos(area.heading), sin(area.heading)), aside(-ahead.y(), ahead.x());
  std::vector<std::size_t> order(plan.group.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t v) { return plan.group[v].start.dot(aside); });
  const double pitch_m = 2 * kWaitingCircle_m + kBetweenCircles_m;
  const double out_m = area.run_out_m + kWayPast_m + kWaitingCircle_m;
  for (std::size_t v = 0; v < plan.group.size(); ++v) {
    const auto rank = static_cast<double>(std::ranges::find(order, v) - order.begin());
    const double along_row_m = area.breadth_m / 2 + pitch_m * (rank - static_cast<double>(order.size() - 1) / 2);
    for (const double along_lane_m : {-out_m, area.length_m + out_m}) {
      MissionPoint& point = plan.points.emplace_back();
      point.place = area.place;
      point.name = "waiting place of " + plan.group[v].name;
      point.north_east = area.corner + along_lane_m * ahead + along_row_m * aside;
      point.depth_m = area.depth_m;
      point.drop_distance_m = area.drop_distance_m;
    }
  }
}

}  // namespace isobath
