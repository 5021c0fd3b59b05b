#include <algorithm>
#include <cmath>
#include <isobath/mission/agents/mission_preview.hpp>
#include <isobath/mission/agents/way_keeping.hpp>
#include <isobath/mission/messages/reason_text.hpp>
#include <utility>

namespace isobath {

using Eigen::Vector2d;

void MissionKnowledge::on_message(const Message& message, Time now) {
  now_ = std::max(now_, now);
  if (const auto* fix = std::get_if<Navigation>(&message)) {
    if (fix->X_WB.is_finite()) here_ = *fix;
  } else if (const auto* scan = std::get_if<ObstacleScan>(&message)) {
    if (!scan->posed || !scan->X_WL.is_finite()) return;
    scan_ = std::make_shared<const ObstacleScan>(*scan);
    scanned_ = now;
  } else if (const auto* sweep = std::get_if<Sweep>(&message)) {
    if (sweep->posed) seen_ = sweep->map;
  } else if (const auto* chart = std::get_if<ChartedHazards>(&message)) {
    chart_ = *chart;
  } else if (const auto* group = std::get_if<GroupHazards>(&message)) {
    group_ = *group;
  } else if (const auto* world = std::get_if<WorldSnapshot>(&message)) {
    world_ = *world;
  }
}

void MissionKnowledge::check_place(const MissionPlan& plan) const {
  if (plan.fence.empty() || !here_ || encloses(plan.fence, here_->X_WB.translation.head<2>())) return;
  throw Error("the vehicle is outside the fence", {}, "a fence round the vehicle", "move the fence");
}

/// One preview: its state from leg to leg.
class MissionPreviewSearch {
 public:
  MissionPreviewSearch(const MissionKnowledge& known, std::shared_ptr<const MissionPlan> plan,
                       const MissionConfig& config, const VehicleParameters& vehicle)
      : known_(known), plan_(std::move(plan)), config_(config), vehicle_(vehicle), hazards_(hazards()) {
    if (!known_.here_) throw Error("the position of the vehicle is not known yet");
    here_ = *known_.here_;
  }

  PreviewLeg leg(std::size_t point) {
    PreviewLeg leg = route(point);
    if (leg.way.empty()) return leg;
    const Vector2d& place = plan_->points[point].north_east;
    if (hazards_.distance(place) < vehicle_.half_width_m) {  // the Navigator finds out when it is near
      return {.why = text_of(hazards_.hazards()[*hazards_.nearest(place)]) + " stands on the point"};
    }
    leg.length_m = length_of(leg.way);
    leg.unknown_m = unknown_m(leg.way);
    measure(leg);
    const MissionPoint& target = plan_->points[point];
    const double drop_m = target.drop_distance_m > 0 ? target.drop_distance_m : config_.navigator.drop_distance_m;
    leg.may_drop = distance_from_hazards(target.north_east) < drop_m;
    go_to_end_of(leg.way, target.depth_m);
    return leg;
  }

 private:
  /// Asks a Navigator that knows what the vehicle's own does.
  PreviewLeg route(std::size_t point) {
    Navigator navigator(config_.navigator, config_.route, vehicle_, config_.space_route, config_.opening,
                        config_.timing);
    Outbox out;
    const Time now = known_.now_;
    if (known_.scan_) navigator.on_message(*known_.scan_, known_.scanned_, out);
    navigator.on_message(MissionOrder{MissionOrder::Kind::kStart, plan_, MissionEnd::kHold, {}}, now, out);
    navigator.on_message(known_.world_, now, out);
    navigator.on_message(known_.chart_, now, out);
    navigator.on_message(known_.group_, now, out);
    navigator.on_message(here_, now, out);
    out.said().clear();
    RouteRequest request{1, point, plan_->points[point], point + 1 == plan_->points.size()};
    navigator.on_message(request, now, out);
    PreviewLeg leg;
    leg.why = "no answer of the planner";
    for (const Message& said : out.said()) {
      if (const auto* refused = std::get_if<RouteRefused>(&said)) leg.why = refused->why;
      const auto* planned = std::get_if<RoutePlanned>(&said);
      if (!planned) continue;
      leg.why = planned->why;
      leg.way = {here_.X_WB.translation.head<2>()};
      for (const Waypoint& w : planned->waypoints) leg.way.emplace_back(w.north, w.east);
    }
    return leg;
  }

  /// The fence is not among them: it is no danger, and the check of the mission tells of it.
  [[nodiscard]] HazardMap hazards() const {
    std::vector<Hazard> all = known_.group_.hazards;
    if (known_.chart_.hazards) all.insert(all.end(), known_.chart_.hazards->begin(), known_.chart_.hazards->end());
    if (known_.scan_) {
      const PlanFrame frame = PlanFrame::of(known_.scan_->X_WL);
      for (const Hazard& seen : known_.scan_->hazards) {
        all.push_back(seen);
        for (Vector2d& p : all.back().outline) p = frame.to_world(p);
      }
    }
    std::erase_if(all, [](const Hazard& h) { return h.outline.empty() || h.kind == HazardKind::kFence; });
    return HazardMap(std::move(all));
  }

  void measure(PreviewLeg& leg) const {
    double nearest_m = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < leg.way.size(); ++i) {
      nearest_m = std::min(nearest_m, hazards_.leg_distance(leg.way[i - 1], leg.way[i]));
    }
    leg.clearance_m = nearest_m - vehicle_.half_width_m;
    constexpr double kNearer_m = 1e-3;
    if (!std::isfinite(nearest_m)) return;
    if (const auto conflict = hazards_.conflict(leg.way, nearest_m + kNearer_m)) {
      leg.nearest = text_of(hazards_.hazards()[conflict->hazard]) + " at " + text_of(conflict->place);
    }
  }

  [[nodiscard]] double distance_from_hazards(const Vector2d& p) const {
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const Hazard& h : hazards_.hazards()) nearest_m = std::min(nearest_m, signed_distance(h.outline, p));
    return nearest_m;
  }

  [[nodiscard]] double unknown_m(const std::vector<Vector2d>& way) const {
    constexpr double kSamples = 500;
    const double length_m = length_of(way), step_m = std::max(1.0, length_m / kSamples);
    double unknown = 0;
    for (double along = step_m / 2; along < length_m; along += step_m) {
      if (!is_known(point_at(way, along))) unknown += step_m;
    }
    return std::min(unknown, length_m);
  }

  [[nodiscard]] bool is_known(const Vector2d& p_W) const {
    if (known_.world_.depths && known_.world_.depths->at(known_.world_.depths->grid().at(p_W)).known()) return true;
    if (!known_.seen_) return false;
    const Detection& seen = *known_.seen_;
    const Vector2d away_W = p_W - seen.X_WB.translation.head<2>();
    const Angle turn = seen.X_WB.rotation.heading() - seen.heading;  // of directions in the grid into W
    const Vector2d away_G(cos(turn) * away_W.x() + sin(turn) * away_W.y(),
                          -sin(turn) * away_W.x() + cos(turn) * away_W.y());
    const auto cell = seen.cells.cell_at(seen.position + away_G);
    if (!cell) return false;
    const std::size_t at = seen.cells.index(*cell);
    const auto marked = [at](const std::vector<std::uint8_t>& cells) { return at < cells.size() && cells[at] != 0; };
    return marked(seen.free) || marked(seen.detected);
  }

  void go_to_end_of(const std::vector<Vector2d>& way, double depth_m) {
    const Vector2d last = way.back() - way[way.size() - 2];
    if (last.norm() > 0.01)
      here_.X_WB.rotation = Rotation::from_heading(Angle::radians(std::atan2(last.y(), last.x())));
    here_.X_WB.translation = {way.back().x(), way.back().y(), depth_m};
  }

  const MissionKnowledge& known_;
  const std::shared_ptr<const MissionPlan> plan_;
  const MissionConfig& config_;
  const VehicleParameters& vehicle_;
  const HazardMap hazards_;
  Navigation here_;  ///< where the next leg starts
};

std::vector<PreviewLeg> preview_of(const MissionKnowledge& known, const std::shared_ptr<const MissionPlan>& plan,
                                   const MissionConfig& config, const VehicleParameters& vehicle,
                                   const std::function<bool()>& give_up) {
  MissionPreviewSearch search(known, plan, config, vehicle);
  std::vector<PreviewLeg> legs;
  for (std::size_t i = 0; i < plan->points.size(); ++i) {
    if (give_up()) {
      legs.emplace_back().why = "the time for a preview has run out";
    } else {
      legs.push_back(search.leg(i));
    }
  }
  return legs;
}

}  // namespace isobath
