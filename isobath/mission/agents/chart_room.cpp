#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <isobath/geometry/segment.hpp>
#include <isobath/mission/agents/chart_room.hpp>
#include <isobath/mission/agents/shoal_outlines.hpp>
#include <isobath/planning/corridor.hpp>
#include <isobath/planning/spherical_hazards.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMaxPixels = 1000;  // from the vehicle to the edge of the area that is read
constexpr double kMaxPixelIndex = 0x1p29;

bool within_grid(const PixelGrid& grid, const Vector2d& north_east) {
  return ((north_east - grid.corner_m) / grid.pixel_m).cwiseAbs().maxCoeff() < kMaxPixelIndex;
}

/// The half side of the square around the place that holds all voxels.
double reach_to(const OccupancySnapshot& voxels, const Vector2d& from) {
  const Vector2d low = voxels.voxel_m() * voxels.least().head<2>().cast<double>();
  const Vector2d high = low + voxels.voxel_m() * voxels.size().head<2>().cast<double>();
  return std::max((low - from).cwiseAbs().maxCoeff(), (high - from).cwiseAbs().maxCoeff());
}

double distance(const ChartObstacle& o, const Vector2d& p) {
  return (nearest_on_segment(o.a, o.b, p) - p).norm() - o.radius_m;
}

Decision decision(Time now, const char* what, std::string reason) {
  return {now, "chart room", what, std::move(reason)};
}

}  // namespace

std::vector<Field> fields(ChartRoomConfig& c) {
  return {
      Field::real("reach_m", &c.reach_m, {1, 10000}, "m",
                  "Half the side of the square around the vehicle in which the chart is checked."),
      Field::real("recheck_share", &c.recheck_share, {0.01, 1}, "1",
                  "The chart is checked again when the vehicle has moved by this share of the reach.")
          .was("again_share"),
      Field::real("depth_step_m", &c.depth_step_m, {0.01, 100}, "m",
                  "The chart is checked again when the vehicle's depth has changed by this much."),
      Field::real("clearance_m", &c.clearance_m, {0, 1000}, "m", "Water required below the vehicle."),
      Field::real("half_width_m", &c.half_width_m, {0, 1000}, "m", "Half the width of the corridor along a leg."),
      Field::real("margin_m", &c.margin_m, {0, 1000}, "m", "How far hazards may reach beyond their outlines."),
      Field::real("overreach_m", &c.overreach_m, {0, 1000}, "m",
                  "How far outlines may reach over deep water; a larger value gives fewer outlines."),
      Field::integer("max_outlines", &c.max_outlines, {1, 100000}, "", "Maximum number of outlines of shallow water.")
          .was("most_outlines"),
      Field::flag("unknown_blocks", &c.unknown_blocks, "Whether water of unknown depth is blocked."),
      Field::real("live_s", &c.live_s, {0, 3600}, "s",
                  "Interval at which the growing depth map replaces the chart. 0: it never does."),
      Field::flag(
          "voxels", &c.voxels,
          "Whether occupied voxels within the clearance above and below the vehicle's depth are hazards of the "
          "plan view, too: for a vehicle whose only sonar ahead measures height. With a horizontal fan beside it, "
          "they repeat its obstacles and close narrow gaps."),
      Field::flag("sphere", &c.sphere,
                  "Whether the occupied cells of the spherical grid near the vehicle's depth are hazards, too."),
  };
}

void ChartRoom::on_message(const Message& message, Time now, Outbox& out) {
  if (const auto* world = std::get_if<WorldSnapshot>(&message)) {
    world_ = *world;
    if (!config_.sphere) world_.sphere = nullptr;
  } else if (const auto* fix = std::get_if<Navigation>(&message)) {
    if (!fix->X_WB.translation.allFinite()) return;
    p_WB_ = fix->X_WB.translation;
  } else if (const auto* order = std::get_if<MissionOrder>(&message)) {
    if (order->kind == MissionOrder::Kind::kStart && order->plan) check_legs(*order->plan, now, out);
    return;
  } else {
    return;
  }
  if (outdated(now)) return say_hazards(now, out);
  if (!said_ || said_->hazards.looked_ahead == world_.looked_ahead) return;
  said_->hazards.looked_ahead = world_.looked_ahead;
  out.say(said_->hazards);
}

bool ChartRoom::outdated(Time now) const {
  if (!p_WB_ || (!world_.depths && !world_.objects && !world_.sphere && !config_.voxels && !said_)) return false;
  if (!said_ || said_->version != version() || said_->objects != world_.objects) return true;
  if (said_->sphere != sphere_version()) return true;
  // Voxels change with each scan; their hazards are looked for as often as those of the depth map.
  if (config_.voxels && said_->voxels != world_.voxels && now - said_->time >= seconds(config_.live_s)) return true;
  const Vector3d moved = *p_WB_ - said_->p_WB;
  return moved.head<2>().norm() >= config_.recheck_share * config_.reach_m ||
         std::abs(moved.z()) >= config_.depth_step_m;
}

void ChartRoom::say_hazards(Time time, Outbox& out) {
  ChartedHazards now{std::make_shared<const std::vector<Hazard>>(hazards()), world_.looked_ahead};
  // A growing map that holds the same hazards changes nothing for a planner.
  if (said_ && said_->hazards.hazards && *said_->hazards.hazards == *now.hazards) now.hazards = said_->hazards.hazards;
  said_ = Said{*p_WB_, version(), time, world_.objects, world_.voxels, sphere_version(), now};
  out.say(std::move(now));
}

std::vector<Hazard> ChartRoom::hazards() const {
  std::vector<Hazard> all;
  add_objects(all);
  add_shoals(all);
  add_voxels(all);
  add_sphere(all);
  for (std::size_t i = 0; i < all.size(); ++i) all[i].id = static_cast<std::uint32_t>(i);
  return all;
}

void ChartRoom::add_objects(std::vector<Hazard>& all) const {
  for (const ChartObstacle& o : world_.all_objects()) {
    if (o.top_m - p_WB_->z() >= config_.clearance_m) continue;
    if (distance(o, p_WB_->head<2>()) > std::sqrt(2.0) * config_.reach_m) continue;
    Hazard& hazard = all.emplace_back();
    hazard.kind = HazardKind::kCharted;
    hazard.outline = {o.a};
    if (o.b != o.a) hazard.outline.push_back(o.b);
    hazard.margin_m = o.radius_m + config_.margin_m;
  }
}

/// The cells lie around the place and in the axes of the snapshot.
void ChartRoom::add_sphere(std::vector<Hazard>& all) const {
  if (!world_.sphere) return;
  const GridSnapshot& sphere = *world_.sphere;
  const double c = cos(sphere.grid.turned()), s = sin(sphere.grid.turned());
  const Vector2d origin = sphere.X_WB.translation.head<2>();
  for (Hazard& hazard : hazards_of(sphere.grid, config_.clearance_m)) {
    for (Vector2d& p : hazard.outline) p = origin + Vector2d(c * p.x() - s * p.y(), s * p.x() + c * p.y());
    hazard.kind = HazardKind::kMapped;
    hazard.margin_m += config_.margin_m;
    all.push_back(std::move(hazard));
  }
}

void ChartRoom::add_shoals(std::vector<Hazard>& all) const {
  if (!world_.depths || !within_grid(world_.depths->grid(), p_WB_->head<2>())) return;
  const double too_shallow_m = p_WB_->z() + config_.clearance_m;
  const PixelWindow window = window_around(world_.depths->grid(), config_.reach_m);
  if (!config_.unknown_blocks && !world_.depths->may_be_shallower(window, too_shallow_m)) return;
  const ShoalRule rule{too_shallow_m, config_.unknown_blocks, config_.overreach_m, config_.max_outlines};
  ShoalOutlines outlines = shoal_outlines(*world_.depths, window, rule);
  add(std::move(outlines.charted), HazardKind::kCharted, all);
  add(std::move(outlines.sensed), HazardKind::kMapped, all);
}

/// Even where the depth map says deep water: the more dangerous map stands.
void ChartRoom::add_voxels(std::vector<Hazard>& all) const {
  if (!config_.voxels) return;
  const std::array<Vector3d, 1> here{*p_WB_};
  const WorldField field({.voxels = world_.voxels}, band_of(here, config_.clearance_m));
  if (!field.has_solid() || !within_grid(field.grid(), p_WB_->head<2>())) return;
  const PixelWindow window =
      window_around(field.grid(), std::min(config_.reach_m, reach_to(*world_.voxels, p_WB_->head<2>())));
  const ShoalRule rule{p_WB_->z() + config_.clearance_m, false, config_.overreach_m, config_.max_outlines};
  add(shoal_outlines(field, window, rule).sensed, HazardKind::kVoxels, all);
}

PixelWindow ChartRoom::window_around(const PixelGrid& grid, double reach_m) const {
  const Pixel middle = grid.at(p_WB_->head<2>());
  const auto reach = static_cast<std::int32_t>(std::min(kMaxPixels, std::ceil(reach_m / grid.pixel_m)));
  return {middle.column - reach, middle.row - reach, 2 * reach + 1, 2 * reach + 1};
}

void ChartRoom::add(std::vector<Polygon> outlines, HazardKind kind, std::vector<Hazard>& all) const {
  for (Polygon& outline : outlines) {
    Hazard& hazard = all.emplace_back();
    hazard.kind = kind;
    hazard.outline = std::move(outline);
    hazard.margin_m = config_.margin_m;
  }
}

void ChartRoom::check_legs(const MissionPlan& plan, Time now, Outbox& out) const {
  if (!world_.depths && !world_.objects) return;
  bool clear = true;
  std::size_t pixels = 0, unknown = 0;
  for (std::size_t i = 0; i < plan.points.size(); ++i) {
    const Vector2d vehicle = p_WB_ ? Vector2d(p_WB_->head<2>()) : plan.points[i].north_east;
    const Vector2d from = i > 0 ? plan.points[i - 1].north_east : vehicle;
    const auto verdict = check_leg(plan, plan.points[i], from);
    if (verdict) {
      pixels += verdict->pixels;
      unknown += verdict->unknown;
    }
    if (auto d = objection(plan.points[i], i, verdict, now)) {
      out.say(std::move(*d));
      clear = false;
    }
  }
  if (!clear) return;
  const double share = pixels > 0 ? static_cast<double>(pixels - unknown) / static_cast<double>(pixels) : 0;
  out.say(
      decision(now, "legs deep enough",
               fmt::format("{} legs keep {:.2f} m over the bottom, where the maps know the depth: on {:.0f} % of the "
                           "way",
                           plan.points.size(), config_.clearance_m, 100 * share)));
}

Result<Traversability, CorridorRefusal> ChartRoom::check_leg(const MissionPlan& plan, const MissionPoint& to,
                                                             const Vector2d& from) const {
  const double depth = to.altitude_m ? plan.limits.min_depth_m : to.depth_m;
  const PassageConfig passage{config_.half_width_m, to.altitude_m ? *to.altitude_m : config_.clearance_m};
  const std::array<Vector3d, 2> leg{Vector3d(from.x(), from.y(), depth),
                                    Vector3d(to.north_east.x(), to.north_east.y(), depth)};
  return check_passage(world_, leg, passage);
}

/// Empty where nothing speaks against the leg; unknown water does so only where it is to block.
std::optional<Decision> ChartRoom::objection(const MissionPoint& to, std::size_t point,
                                             const Result<Traversability, CorridorRefusal>& verdict, Time now) const {
  const auto number = static_cast<int>(point) + 1;
  Decision d = decision(now, "leg too shallow", "");
  d.leg = number;
  if (!verdict) {
    d.what = "leg not checked";
    d.reason = fmt::format("leg {} to {}: {}", number, to.name, to_text(verdict.error()));
    return d;
  }
  const auto& blocking = config_.unknown_blocks && world_.depths ? verdict->blocking : verdict->known_blocking;
  if (!blocking) return std::nullopt;
  d.reason = fmt::format("leg {} to {}: {}", number, to.name, verdict->reason_of(*blocking));
  d.obstacle = verdict->grid.centre(blocking->pixel);
  if (blocking->depth_m && !blocking->obstacle) {
    d.margin_m = *blocking->depth_m - blocking->vehicle_z - verdict->passage.clearance_m;
  }
  return d;
}

}  // namespace isobath
