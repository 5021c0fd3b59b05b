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

/// A chart in which unknown water is deep.
class KnownShoals final : public DepthField {
 public:
  explicit KnownShoals(const DepthField& chart) : chart_(chart) {}
  [[nodiscard]] PixelGrid grid() const override { return chart_.grid(); }
  [[nodiscard]] std::uint64_t version() const override { return chart_.version(); }
  void read(PixelWindow window, std::span<DepthPixel> out) const override {
    chart_.read(window, out);
    for (DepthPixel& p : out) {
      if (!p.known()) {
        p = {DepthPixel::word_of_depth(kDeep), DepthPixel::word_of_state(kFullConfidence, p.flags(), p.minute())};
      }
    }
  }
  static constexpr double kDeep = 20'000;

 private:
  const DepthField& chart_;
};

/// A chart without depths, for its objects alone.
class NoDepths final : public DepthField {
 public:
  [[nodiscard]] PixelGrid grid() const override { return {}; }
  [[nodiscard]] std::uint64_t version() const override { return 0; }
  void read(PixelWindow, std::span<DepthPixel> out) const override { std::fill(out.begin(), out.end(), DepthPixel{}); }
};

bool within_grid(const PixelGrid& grid, const Vector2d& north_east) {
  return ((north_east - grid.corner_m) / grid.pixel_m).cwiseAbs().maxCoeff() < kMaxPixelIndex;
}

std::span<const ChartObstacle> objects_of(const ChartUpdate& chart) {
  return chart.objects ? std::span<const ChartObstacle>(*chart.objects) : std::span<const ChartObstacle>();
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
      Field::flag("sphere", &c.sphere,
                  "Whether the occupied cells of the spherical grid near the vehicle's depth are hazards, too."),
  };
}

void ChartRoom::on_message(const Message& message, Time now, Outbox& out) {
  if (const auto* chart = std::get_if<ChartUpdate>(&message)) {
    chart_ = *chart;
  } else if (const auto* fix = std::get_if<Navigation>(&message)) {
    if (!fix->X_WB.translation.allFinite()) return;
    p_WB_ = fix->X_WB.translation;
  } else if (const auto* order = std::get_if<MissionOrder>(&message)) {
    if (order->kind == MissionOrder::Kind::kStart && order->plan) check_legs(*order->plan, now, out);
    return;
  } else {
    return;
  }
  if (outdated()) return say_hazards(out);
  if (!said_ || said_->hazards.looked_ahead == chart_.looked_ahead) return;
  said_->hazards.looked_ahead = chart_.looked_ahead;
  out.say(said_->hazards);
}

bool ChartRoom::outdated() const {
  if (!p_WB_ || (!chart_.depths && !chart_.objects && !chart_.sphere && !said_)) return false;
  if (!said_ || said_->version != version() || said_->objects != chart_.objects.get()) return true;
  if (said_->sphere != sphere_version()) return true;
  const Vector3d moved = *p_WB_ - said_->p_WB;
  return moved.head<2>().norm() >= config_.recheck_share * config_.reach_m ||
         std::abs(moved.z()) >= config_.depth_step_m;
}

void ChartRoom::say_hazards(Outbox& out) {
  ChartedHazards now{std::make_shared<const std::vector<Hazard>>(hazards()), chart_.looked_ahead};
  // A growing map that holds the same hazards changes nothing for a planner.
  if (said_ && said_->hazards.hazards && *said_->hazards.hazards == *now.hazards) now.hazards = said_->hazards.hazards;
  said_ = Said{*p_WB_, version(), chart_.objects.get(), sphere_version(), now};
  out.say(std::move(now));
}

std::vector<Hazard> ChartRoom::hazards() const {
  std::vector<Hazard> all;
  add_objects(all);
  add_shoals(all);
  add_sphere(all);
  for (std::size_t i = 0; i < all.size(); ++i) all[i].id = static_cast<std::uint32_t>(i);
  return all;
}

void ChartRoom::add_objects(std::vector<Hazard>& all) const {
  for (const ChartObstacle& o : objects_of(chart_)) {
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
  if (!config_.sphere || !chart_.sphere) return;
  const GridSnapshot& sphere = *chart_.sphere;
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
  if (!chart_.depths) return;
  const PixelGrid grid = chart_.depths->grid();
  if (!within_grid(grid, p_WB_->head<2>())) return;
  const Pixel middle = grid.at(p_WB_->head<2>());
  const auto reach = static_cast<std::int32_t>(std::min(kMaxPixels, std::ceil(config_.reach_m / grid.pixel_m)));
  const PixelWindow window{middle.column - reach, middle.row - reach, 2 * reach + 1, 2 * reach + 1};
  const double too_shallow_m = p_WB_->z() + config_.clearance_m;
  const bool shoals = chart_.depths->may_be_shallower(window, too_shallow_m);
  for (const bool sensed : {false, true}) {
    const bool unknown_blocks = config_.unknown_blocks && !sensed;
    if (!shoals && !unknown_blocks) continue;
    const ShoalRule rule{too_shallow_m, unknown_blocks, config_.overreach_m, config_.max_outlines, sensed};
    for (Polygon& outline : shoal_outlines(*chart_.depths, window, rule)) {
      Hazard& hazard = all.emplace_back();
      hazard.kind = sensed ? HazardKind::kMapped : HazardKind::kCharted;
      hazard.outline = std::move(outline);
      hazard.margin_m = config_.margin_m;
    }
  }
}

void ChartRoom::check_legs(const MissionPlan& plan, Time now, Outbox& out) const {
  if (!chart_.depths && !chart_.objects) return;
  std::size_t shallow = 0;
  for (std::size_t i = 0; i < plan.points.size(); ++i) {
    const Vector2d vehicle = p_WB_ ? Vector2d(p_WB_->head<2>()) : plan.points[i].north_east;
    if (auto d = check_leg(plan, i, i > 0 ? plan.points[i - 1].north_east : vehicle, now)) {
      out.say(std::move(*d));
      ++shallow;
    }
  }
  if (shallow > 0) return;
  out.say(decision(now, "legs deep enough",
                   fmt::format("{} legs keep {:.2f} m over the chart{}", plan.points.size(), config_.clearance_m,
                               config_.unknown_blocks ? "" : ", where it knows the depth")));
}

std::optional<Decision> ChartRoom::check_leg(const MissionPlan& plan, std::size_t point, const Vector2d& from,
                                             Time now) const {
  const MissionPoint& to = plan.points[point];
  const double depth = to.altitude_m ? plan.limits.min_depth_m : to.depth_m;
  const PassageConfig passage{config_.half_width_m, to.altitude_m ? *to.altitude_m : config_.clearance_m};
  const std::array<Vector3d, 2> leg{Vector3d(from.x(), from.y(), depth),
                                    Vector3d(to.north_east.x(), to.north_east.y(), depth)};
  const NoDepths none;
  const DepthField& chart = chart_.depths ? *chart_.depths : static_cast<const DepthField&>(none);
  const KnownShoals known(chart);
  const bool as_it_is = config_.unknown_blocks && chart_.depths;
  const auto verdict = traversability(as_it_is ? chart : known, leg, passage, objects_of(chart_));
  const auto number = static_cast<int>(point) + 1;
  Decision d = decision(now, "leg too shallow", "");
  d.leg = number;
  if (!verdict) {
    d.what = "leg not checked";
    d.reason = fmt::format("leg {} to {}: {}", number, to.name, to_text(verdict.error()));
    return d;
  }
  if (!verdict->blocking) return std::nullopt;
  const PassagePlace& place = *verdict->blocking;
  const std::string reason = verdict->reason();  // begins with "leg 1: ", which counts the legs of the path above
  d.reason = fmt::format("leg {} to {}{}", number, to.name, reason.substr(std::min(reason.find(':'), reason.size())));
  d.obstacle = verdict->grid.centre(place.pixel);
  if (place.depth_m && !place.obstacle) d.margin_m = *place.depth_m - place.vehicle_z - passage.clearance_m;
  return d;
}

}  // namespace isobath
