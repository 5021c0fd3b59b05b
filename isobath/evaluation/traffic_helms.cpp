#include <algorithm>
#include <cmath>
#include <Eigen/Geometry>
#include <isobath/evaluation/traffic_helms.hpp>
#include <isobath/sim/world.hpp>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kBetween_s = 0.01;     // between the two places that give a velocity
constexpr double kSameVelocity = 1e-6;  // m/s
constexpr double kDriftTime_s = 4;      // of the filter on the drift across the hull, as in line of sight
constexpr double kStepAhead_m = 0.5;    // between the points of the way ahead that are checked

Eigen::AlignedBox2d box_around(const Polygon& outline) {
  Eigen::AlignedBox2d box;
  for (const Vector2d& corner : outline) box.extend(corner);
  return box;
}

}  // namespace

// Velocity obstacles -------------------------------------------------------------------------------------------------

AvoidedDisc SceneDisc::at(double t_s) const {
  const Vector2d now = displacement(body, t_s).head<2>(), soon = displacement(body, t_s + kBetween_s).head<2>();
  return {p_W + now, (soon - now) / kBetween_s, radius_m};
}

std::vector<SceneDisc> discs_of(const Scene& scene) {
  std::vector<SceneDisc> discs;
  const World world(scene);
  for (const WorldBody& body : world.bodies()) {
    std::vector<Polygon> parts = body.plan;
    if (std::holds_alternative<Box>(body.body->shape)) {  // the parts of its plan are its sides
      for (std::size_t i = 1; i < parts.size(); ++i) parts[0].insert(parts[0].end(), parts[i].begin(), parts[i].end());
      parts.resize(std::min<std::size_t>(parts.size(), 1));
    }
    for (const Polygon& part : parts) {
      const Eigen::AlignedBox2d box = box_around(part);
      SceneDisc& disc = discs.emplace_back();
      disc.body = *body.body;
      disc.p_W = box.center();
      disc.top_m = body.box.min().z();
      disc.bottom_m = body.box.max().z();
      for (const Vector2d& corner : part) disc.radius_m = std::max(disc.radius_m, (corner - disc.p_W).norm());
    }
  }
  return discs;
}

VelocityObstacleHelm::VelocityObstacleHelm(const MissionPlan& mission, const VehicleParameters& vehicle,
                                           std::vector<SceneDisc> discs, const VelocityObstacleConfig& config)
    : LineOfSightHelm(mission, vehicle), config_(config), discs_(std::move(discs)) {}

void VelocityObstacleHelm::find_nearest() {
  near_.clear();
  const double t_s = to_seconds(now()), depth = state().X_WB.translation.z(), reach = vehicle().hull_radius_m;
  for (const SceneDisc& disc : discs_) {
    const double deeper = displacement(disc.body, t_s).z();
    if (disc.top_m + deeper > depth + reach || disc.bottom_m + deeper < depth - reach) continue;
    near_.push_back(disc.at(t_s));
  }
  const auto nearer = [this](const AvoidedDisc& a, const AvoidedDisc& b) {
    return (a.p - here()).norm() - a.radius_m < (b.p - here()).norm() - b.radius_m;
  };
  std::stable_sort(near_.begin(), near_.end(), nearer);
  if (near_.size() > config_.nearest) near_.resize(config_.nearest);
}

Setpoint VelocityObstacleHelm::decide(const Setpoint& wanted) {
  if (progress().phase != MissionPhase::kUnderWay) return wanted;
  find_nearest();
  const Eigen::Vector3d v_W = state().X_WB.rotation * state().v_B;
  if (before_) drift_.update(state().X_WB.rotation.heading(), v_W, kDriftTime_s, to_seconds(now() - *before_));
  before_ = now();
  const Vector2d velocity = v_W.head<2>();
  const Angle course = wanted.heading + drift_.crab(wanted.heading, wanted.speed);
  const Vector2d straight = wanted.speed * Vector2d(cos(course), sin(course));
  const AvoidedDisc own{here(), velocity, own_radius_m()};
  const ReciprocalConfig config{.horizon_s = config_.horizon_s, .share = 1, .max_speed = wanted.speed};
  const Vector2d chosen = reciprocal_velocity(own, straight, near_, config);
  if ((chosen - straight).norm() < kSameVelocity) return wanted;
  Setpoint setpoint = wanted;
  if (chosen.norm() > kSameVelocity) {
    const Angle towards = Angle::radians(std::atan2(chosen.y(), chosen.x()));
    setpoint.heading = (towards - drift_.crab(towards, std::max(chosen.norm(), vehicle().min_speed))).wrapped();
  }
  setpoint.speed = std::max(chosen.norm(), vehicle().min_speed);
  return setpoint;
}

// Stop and wait ------------------------------------------------------------------------------------------------------

StopAndWaitHelm::StopAndWaitHelm(const MissionPlan& mission, const VehicleParameters& vehicle,
                                 const StopAndWaitConfig& config)
    : LineOfSightHelm(mission, vehicle), config_(config) {}

void StopAndWaitHelm::on_scan(const ScanResult& scan) { outlines_ = outlines_of(scan); }

std::optional<Vector2d> StopAndWaitHelm::obstruction(double look_m) const {
  const Vector2d to_point = point().north_east - here();
  const double length = std::min(look_m, to_point.norm());
  if (length <= 0) return std::nullopt;
  const Vector2d along = to_point.normalized();
  const double half = vehicle().half_width_m + config_.clearance_m;
  for (double ahead = 0; ahead <= length; ahead += kStepAhead_m) {
    const Vector2d p = here() + ahead * along;
    for (const Polygon& outline : outlines_) {
      const Vector2d nearest = nearest_point(outline, p);
      // What the vehicle has passed is not ahead of it.
      if ((nearest - p).norm() <= half && (nearest - here()).dot(along) >= 0) return nearest;
    }
  }
  return std::nullopt;
}

Setpoint StopAndWaitHelm::decide(const Setpoint& wanted) {
  if (progress().phase != MissionPhase::kUnderWay) return wanted;
  const auto obstacle = obstruction(std::max(config_.look_m, config_.look_s * wanted.speed));
  if (!obstacle) {
    if (stopped_) decided("resume", "the way ahead is clear");
    stopped_.reset();
    return wanted;
  }
  if (!stopped_) {
    stopped_ = now();
    decided("stop", "an obstacle lies in the way ahead", obstacle);
  }
  if (to_seconds(now() - *stopped_) > config_.patience_s) give_up("an obstacle stays in the way ahead");
  Setpoint setpoint = wanted;
  setpoint.speed = 0;
  return setpoint;
}

}  // namespace isobath
