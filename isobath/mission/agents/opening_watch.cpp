#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/agents/opening_watch.hpp>
#include <isobath/planning/opening_view.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSame = 6;                       // m, between looks at one opening
constexpr double kMuchNarrower = 2;               // m
constexpr double kElsewhere = 1.5;                // m, that a helix is planned anew for
constexpr Angle kLeastSwing = Angle::degrees(5);  // a straight approach swings as much

Vector2d course_of(const Opening& opening) {
  const Angle heading = opening.X_WO.rotation.heading();
  return {cos(heading), sin(heading)};
}

Vector2d middle_of(const Opening& opening) { return opening.X_WO.translation.head<2>(); }

}  // namespace

std::vector<Field> fields(OpeningConfig& c) {
  using Mode = OpeningConfig::Mode;
  std::vector<Field> all = {
      Field::choice("mode", &c.mode, {{"off", Mode::kOff}, {"watch", Mode::kWatch}, {"helix", Mode::kHelix}},
                    "watch: the vehicle says how much of an opening on its route it knows to be free. helix: it also "
                    "flies a helix that looks round the opening. Both need a sonar that measures height."),
      Field::real("max_width_m", &c.max_width_m, {1, 1000}, "m", "Largest width of an opening between two bodies."),
      Field::real("max_side_m", &c.max_side_m, {0.1, 1000}, "m", "Largest extent of a body at its side."),
      Field::real("farthest_m", &c.farthest_m, {1, 1000}, "m", "Farthest distance at which an opening counts.")};
  for (Field& field : fields(c.helix)) all.push_back(std::move(field));
  return all;
}

OpeningWatch::OpeningWatch(const OpeningConfig& config, const VehicleParameters& vehicle)
    : config_(config), vehicle_(vehicle) {}

OpeningSearch OpeningWatch::search(double depth_m) const {
  OpeningSearch search;
  search.min_width_m = 2 * (vehicle_.half_width_m + config_.helix.margin_m);
  search.max_width_m = config_.max_width_m;
  search.max_side_m = config_.max_side_m;
  search.farthest_m = config_.farthest_m;
  search.depth_m = depth_m;
  search.least_height_m = search.min_width_m;
  return search;
}

/// The opening where it was last seen, as it is seen now.
void OpeningWatch::follow(std::span<const Hazard> bodies, const Vector2d& vehicle, double depth_m, double latest_m,
                          const OccupancySnapshot& map) {
  const Opening& last = tracked_->found.opening;
  const Vector2d middle = middle_of(last), course = course_of(last);
  const double reach = 0.5 * last.width_m;
  OpeningSearch near = search(depth_m);
  near.farthest_m = (middle - vehicle).norm() + reach;
  auto now = find_opening(bodies, vehicle, middle + reach * course, near, map);
  if (!now || (middle_of(now->opening) - middle).norm() > kSame) return;
  // Near the opening few columns are left that say where the bed is.
  if (tracked_->found.bed_known && (!now->bed_known || tracked_->said_known || tracked_->distance_m < latest_m)) {
    now->top_m = tracked_->found.top_m;
    now->bed_m = tracked_->found.bed_m;
    now->bed_known = true;
    now->opening.height_m = last.height_m;
  }
  tracked_->found = *now;
}

/// An opening to track from now on: the first, or one that is narrower than the one that is tracked.
std::optional<FoundOpening> OpeningWatch::ahead(std::span<const Hazard> bodies, std::span<const Vector2d> way,
                                                double latest_m, double depth_m, const OccupancySnapshot& map) const {
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    auto found = find_opening(bodies, way[i], way[i + 1], search(depth_m), map);
    if (!found) continue;
    const Vector2d middle = middle_of(found->opening);
    const double away_m = (middle - way.front()).norm();
    if (away_m < latest_m || away_m > config_.farthest_m) return {};
    if (!tracked_) return found;
    const Opening& last = tracked_->found.opening;
    const bool other =
        (middle - middle_of(last)).norm() > kSame && found->opening.width_m < last.width_m - kMuchNarrower;
    return other ? found : std::nullopt;
  }
  return {};
}

OpeningWatch::News OpeningWatch::see(std::span<const Hazard> bodies, std::span<const Vector2d> way, double depth_m,
                                     double speed, const OccupancySnapshot& map) {
  if (!on() || way.size() < 2) return News::kNone;
  const Vector2d& vehicle = way.front();
  const double latest_m = latest_decision_m(config_.helix, vehicle_, speed);
  News news = News::kNone;
  if (tracked_) follow(bodies, vehicle, depth_m, latest_m, map);
  if (auto found = ahead(bodies, way, latest_m, depth_m, map)) {
    tracked_ = Tracked{*std::move(found)};
    leave();
    news = News::kFound;
  }
  if (!tracked_) return News::kNone;
  Tracked& t = *tracked_;
  t.from = vehicle;
  t.distance_m = (middle_of(t.found.opening) - vehicle).dot(course_of(t.found.opening));
  t.free_share = free_share(t.found, config_.helix.margin_m, map);
  if (t.distance_m < 0) {
    forget();
    return News::kNone;
  }
  if (news != News::kNone || t.said_known) return news;
  if (t.free_share >= config_.helix.pass_share) {
    t.said_known = true;
    return News::kKnown;
  }
  if (!t.said_unknown && t.distance_m < latest_m) {
    t.said_unknown = true;
    return News::kUnknown;
  }
  return News::kNone;
}

std::optional<HelixPlan> OpeningWatch::begin(const Vector3d& p_W, double speed,
                                             const std::function<bool(const SpacePath&)>& clear) {
  if (config_.mode != OpeningConfig::Mode::kHelix || !tracked_ || flies()) return {};
  if (tracked_->free_share >= config_.helix.pass_share) return {};
  for (const double amplitude : {1.0, 0.5}) {
    HelixPlanner planner(config_.helix, vehicle_, speed, p_W, tracked_->found.opening);
    HelixPlan plan = planner.plan(tracked_->found.opening, 0, amplitude);
    if (!plan.within_limits || plan.leave_m >= tracked_->distance_m || plan.demand.swing < kLeastSwing) return {};
    if (!clear(plan.path)) continue;
    flight_ = Flight{planner, tracked_->found.opening, amplitude};
    return plan;
  }
  return {};
}

std::optional<HelixPlan> OpeningWatch::improved(const Vector3d& p_W) {
  if (!flies() || !tracked_ || tracked_->distance_m < flight_->planner.latest_m()) return {};
  const Opening& now = tracked_->found.opening;
  const bool elsewhere = (middle_of(now) - middle_of(flight_->planned)).norm() > kElsewhere ||
                         std::abs(now.width_m - flight_->planned.width_m) > kElsewhere;
  if (!elsewhere) return {};
  flight_->planned = now;
  return flight_->planner.plan(now, flight_->planner.along(p_W), flight_->amplitude);
}

void OpeningWatch::forget() {
  tracked_.reset();
  leave();
}

void OpeningWatch::move(const Vector2d& by) {
  leave();  // its line of approach belongs to the position before
  if (!tracked_) return;
  FoundOpening& found = tracked_->found;
  found.port += by;
  found.starboard += by;
  found.opening.X_WO.translation.head<2>() += by;
}

OpeningSighting OpeningWatch::sighting() const {
  const Tracked& t = *tracked_;
  return {t.distance_m, t.found.opening.width_m, t.found.bed_known ? t.found.bed_m - t.found.top_m : 0, t.free_share};
}

std::string OpeningWatch::text() const {
  const Tracked& t = *tracked_;
  const auto bearing = [&](const Vector2d& p) {
    return Angle::radians(std::atan2(p.y() - t.from.y(), p.x() - t.from.x()));
  };
  const double depth_m = t.found.opening.X_WO.translation.z();
  const auto elevation = [&](double at_m) { return Angle::radians(std::atan2(depth_m - at_m, t.distance_m)); };
  const OpeningAngles angles = opening_angles(bearing(t.found.port), bearing(t.found.starboard),
                                              elevation(t.found.top_m), elevation(t.found.bed_m));
  const auto side = [](int number) { return number > 0 ? fmt::format("obstacle {}", number) : "an obstacle"; };
  return fmt::format(
      "the opening between {} and {}, {:.1f} m ahead, is {:.1f} m wide and {} ({:.0f} by {:.0f} "
      "degrees); {:.0f} % of it is known to be free",
      side(t.found.port_number), side(t.found.starboard_number), t.distance_m, t.found.opening.width_m,
      t.found.bed_known ? fmt::format("{:.1f} m high", t.found.bed_m - t.found.top_m) : "of unknown height",
      angles.horizontal.degrees(), angles.vertical.degrees(), 100 * t.free_share);
}

}  // namespace isobath
