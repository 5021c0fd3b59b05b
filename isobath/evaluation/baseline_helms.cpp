#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <isobath/evaluation/baseline_helms.hpp>
#include <isobath/geometry/polygon.hpp>
#include <limits>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kAvoided = 3;     ///< scans whose confirmed echoes are avoided
constexpr int kLevels = 128;            ///< of a histogram
constexpr double kMinSpeedShare = 0.3;  // of PotentialFieldHelm: a vehicle with fins needs flow to steer

GuidanceConfig guidance_for(const VehicleParameters& vehicle) {
  GuidanceConfig config;
  config.integral_gain = 0.3;
  config.acceptance_radius = std::max(3.0, 0.5 * vehicle.limits.turning_radius);
  return config;
}

bool any_within(const std::vector<Vector2d>& points, const Vector2d& p, double distance) {
  return std::any_of(points.begin(), points.end(),
                     [&](const Vector2d& q) { return (p - q).squaredNorm() <= distance * distance; });
}

}  // namespace

// Line of sight ------------------------------------------------------------------------------------------------------

LineOfSightHelm::LineOfSightHelm(const MissionPlan& mission, const VehicleParameters& vehicle)
    : mission_(mission), vehicle_(vehicle) {
  if (mission_.points.empty()) throw Error("the mission has no points", {}, "at least one");
  report_.phase = MissionPhase::kUnderWay;
  follow({point().north_east});
}

void LineOfSightHelm::follow(const std::vector<Vector2d>& way) {
  std::vector<Waypoint> points;
  for (const Vector2d& p : way) points.push_back({p.x(), p.y(), point().depth_m, speed()});
  way_ = way;
  guidance_.emplace(guidance_for(vehicle_), std::move(points));
}

std::vector<Vector2d> LineOfSightHelm::way_ahead() const {
  std::vector<Vector2d> way{here()};
  way.insert(way.end(), way_.begin() + static_cast<std::ptrdiff_t>(std::min(guidance_->next(), way_.size())),
             way_.end());
  return way;
}

void LineOfSightHelm::next_point() {
  ++report_.reached;
  if (point_ + 1 == mission_.points.size()) {
    report_.phase = MissionPhase::kFinished;
    return;
  }
  ++point_;
  follow({point().north_east});
}

void LineOfSightHelm::on_event(const Event& event) {
  const auto* fix = std::get_if<Navigation>(&event);
  if (!fix || !fix->X_WB.is_finite()) return;
  const double dt = fixed_ ? to_seconds(fix->time - now_) : 0;
  if (fixed_ && dt <= 0) return;
  now_ = fix->time;
  fixed_ = true;
  state_.X_WB = fix->X_WB;
  if (fix->v_WB) state_.v_B = fix->X_WB.rotation.inverse() * *fix->v_WB;
  if (report_.phase != MissionPhase::kUnderWay) {
    setpoint_.speed = 0;
    return;
  }
  Setpoint wanted = guidance_->step(state_, dt);
  if (guidance_->finished()) {
    next_point();
    wanted = report_.phase == MissionPhase::kUnderWay ? guidance_->step(state_, dt) : wanted;
  }
  setpoint_ = decide(wanted);
}

void LineOfSightHelm::give_up(const std::string& why) {
  report_.phase = MissionPhase::kAborted;
  report_.why = why;
  decided("abort", why);
}

void LineOfSightHelm::decided(const std::string& what, const std::string& why,
                              const std::optional<Vector2d>& obstacle) {
  Decision& decision = decisions_.emplace_back();
  decision.time = now_;
  decision.number = decisions_.size();
  decision.agent = "baseline";
  decision.what = what;
  decision.reason = why;
  decision.obstacle = obstacle;
}

// Potential field ----------------------------------------------------------------------------------------------------

PotentialFieldHelm::PotentialFieldHelm(const MissionPlan& mission, const VehicleParameters& vehicle,
                                       const PotentialFieldConfig& config)
    : LineOfSightHelm(mission, vehicle), config_(config) {}

std::vector<Polygon> outlines_of(const ScanResult& scan) {
  std::vector<Polygon> outlines;
  for (const Obstacle& o : scan.detection.obstacles) outlines.push_back(world_outline(o, scan.detection.X_WB));
  return outlines;
}

void PotentialFieldHelm::on_scan(const ScanResult& scan) { outlines_ = outlines_of(scan); }

Setpoint PotentialFieldHelm::decide(const Setpoint& wanted) {
  if (progress().phase != MissionPhase::kUnderWay) return wanted;
  const double c = config_.clearance_m, reach = config_.reach_m;
  const double eta = c * c / (1 / c - 1 / reach);
  Vector2d repulsion = Vector2d::Zero();
  for (const Polygon& outline : outlines_) {
    const Vector2d away = here() - nearest_point(outline, here());
    const double distance = away.norm();
    const double d = std::max(distance - vehicle().half_width_m, 0.1);
    if (d >= reach || distance < 1e-6) continue;
    repulsion += eta * (1 / d - 1 / reach) / (d * d) * away / distance;
  }
  if (repulsion.isZero()) return wanted;  // attraction alone: line of sight, which corrects for the current
  const Vector2d force = Vector2d(cos(wanted.heading), sin(wanted.heading)) + repulsion;
  Setpoint setpoint = wanted;
  setpoint.heading = Angle::radians(std::atan2(force.y(), force.x()));
  const double agreement = cos(setpoint.heading - state().X_WB.rotation.heading());
  setpoint.speed *= std::max(kMinSpeedShare, agreement);
  return setpoint;
}

// Image threshold ----------------------------------------------------------------------------------------------------

ImageThresholdHelm::ImageThresholdHelm(const MissionPlan& mission, const VehicleParameters& vehicle,
                                       const ImageThresholdConfig& config)
    : LineOfSightHelm(mission, vehicle), config_(config), believed_(1) {}

void ImageThresholdHelm::on_ping(const PosedPing& posed) {
  const Ping& ping = posed.ping;
  for (int b = 0; b < ping.fan->beams(); ++b) {
    Beam& beam = scan_.emplace_back();
    beam.samples.resize(static_cast<std::size_t>(ping.window.bins));
    ping.intensity.copy_beam(b, beam.samples.data());
    beam.window = ping.window;
    beam.blanking_m = ping.blanking_m;
    beam.X_WS = level(posed.X_WB) * ping.X_BS;
    beam.azimuth = ping.fan->azimuth[static_cast<std::size_t>(b)];
  }
  bin_m_ = ping.window.bin_m;
}

float threshold_between_modes(std::span<const float> samples) {
  const float most = samples.empty() ? 0 : *std::ranges::max_element(samples);
  if (!(most > 0) || !std::isfinite(most)) return std::numeric_limits<float>::infinity();
  std::vector<double> counts(kLevels), smooth(kLevels);
  for (const float sample : samples) {
    const auto level = static_cast<int>(kLevels * std::max(0.0F, sample) / most);
    ++counts[static_cast<std::size_t>(std::min(level, kLevels - 1))];
  }
  for (std::size_t i = 0; i < counts.size(); ++i) {
    smooth[i] = (counts[i == 0 ? 0 : i - 1] + 2 * counts[i] + counts[std::min(i + 1, counts.size() - 1)]) / 4;
  }
  std::vector<std::size_t> modes;
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    const bool rises = i == 0 || smooth[i] > smooth[i - 1],
               falls = i + 1 == smooth.size() || smooth[i] >= smooth[i + 1];
    if (rises && falls && smooth[i] > 0) modes.push_back(i);
  }
  if (modes.size() < 2) return std::numeric_limits<float>::infinity();
  std::ranges::partial_sort(modes, modes.begin() + 2, std::greater{}, [&](std::size_t i) { return smooth[i]; });
  const auto [low, high] = std::minmax(modes[0], modes[1]);
  const auto valley = std::min_element(smooth.begin() + static_cast<std::ptrdiff_t>(low),
                                       smooth.begin() + static_cast<std::ptrdiff_t>(high));
  return most * static_cast<float>(valley - smooth.begin()) / kLevels;
}

ImageThresholdHelm::Points ImageThresholdHelm::echoes() const {
  float most = 0;
  const auto for_each = [this](const auto& take) {
    for (const Beam& beam : scan_) {
      for (int k = 0; k < beam.window.bins; ++k) {
        if (beam.window.edge(k) >= beam.blanking_m) take(beam, k, beam.samples[static_cast<std::size_t>(k)]);
      }
    }
  };
  for_each([&most](const Beam&, int, float value) { most = std::max(most, value); });
  Points points;
  if (most <= 0) return points;
  auto least = static_cast<float>(config_.share) * most;
  if (config_.threshold == ImageThreshold::kBetweenModes) {
    std::vector<float> samples;
    for_each([&samples](const Beam&, int, float value) { samples.push_back(value); });
    least = threshold_between_modes(samples);
  }
  for_each([&](const Beam& beam, int k, float value) {
    if (value < least) return;
    const double r = beam.window.centre(k);
    points.emplace_back((beam.X_WS * Eigen::Vector3d(r * cos(beam.azimuth), r * sin(beam.azimuth), 0)).head<2>());
  });
  return points;
}

std::vector<Obstacle> ImageThresholdHelm::obstacles_at(const Pose& X_WL) const {
  const Pose X_LW = X_WL.inverse();
  Points left = believed_.back();
  std::vector<Obstacle> obstacles;
  while (!left.empty()) {
    Points group{left.back()};
    left.pop_back();
    for (std::size_t i = 0; i < group.size(); ++i) {
      const auto is_far = [&](const Vector2d& p) {
        return (p - group[i]).squaredNorm() > config_.same_m * config_.same_m;
      };
      const auto near = std::partition(left.begin(), left.end(), is_far);
      group.insert(group.end(), near, left.end());
      left.erase(near, left.end());
    }
    for (Vector2d& p : group) p = (X_LW * Eigen::Vector3d(p.x(), p.y(), X_WL.translation.z())).head<2>();
    Obstacle& one = obstacles.emplace_back();
    one.centre = Vector2d::Zero();
    for (const Vector2d& p : group) one.centre += p / static_cast<double>(group.size());
    one.covariance = Eigen::Matrix2d::Zero();
    one.outline = convex_hull(group);
    one.nearest = nearest_point(one.outline, Vector2d::Zero());
    one.range_m = one.nearest.norm();
    one.bearing = Angle::radians(std::atan2(one.nearest.y(), one.nearest.x())).wrapped_positive();
    one.existence = 1;
    one.hits = static_cast<std::uint32_t>(group.size());
    one.number = static_cast<int>(obstacles.size());
  }
  return obstacles;
}

void ImageThresholdHelm::on_scan(const ScanResult& result) {
  Points points = echoes();
  scan_.clear();
  Points believed;
  if (echoes_.size() + 1 >= config_.scans) {
    for (const Vector2d& p : points) {
      const bool before = std::all_of(echoes_.end() - static_cast<std::ptrdiff_t>(config_.scans - 1), echoes_.end(),
                                      [&](const Points& scan) { return any_within(scan, p, config_.same_m); });
      if (before && !any_within(believed, p, bin_m_)) believed.push_back(p);
    }
  }
  echoes_.push_back(std::move(points));
  believed_.push_back(std::move(believed));
  if (echoes_.size() >= config_.scans) echoes_.pop_front();
  if (believed_.size() > kAvoided) believed_.pop_front();
  found_ = obstacles_at(level(result.detection.X_WB));
  if (progress().phase == MissionPhase::kUnderWay) replan();
}

void ImageThresholdHelm::replan() {
  std::vector<Hazard> hazards;
  for (const Points& scan : believed_) {
    for (const Vector2d& p : scan) hazards.push_back({{p}, bin_m_, HazardKind::kSeen, 0});
  }
  const HazardMap map(std::move(hazards));
  const std::vector<Vector2d> way = way_ahead();
  const double room = config_.route.clearance_m + vehicle().half_width_m;
  const auto conflict = map.conflict(way, room);
  if (!conflict && !stopped_) return;
  RouteTask task;
  task.start = here();
  task.heading = state().X_WB.rotation.heading().radians();
  task.goal = point().north_east;
  task.half_width_m = vehicle().half_width_m;
  task.turning_radius_m = vehicle().limits.turning_radius;
  const auto route = plan_route(map, task, config_.route);
  if (!route) {
    if (!stopped_) {
      stopped_ = now();
      decided("stop", std::string("no route around the confirmed echoes: ") + to_text(route.error()));
    }
    return;
  }
  stopped_.reset();
  follow({route->points.begin() + 1, route->points.end()});
  decided("replan", fmt::format("{} confirmed echoes", map.hazards().size()),
          conflict ? std::optional<Vector2d>(conflict->place) : std::nullopt);
}

Setpoint ImageThresholdHelm::decide(const Setpoint& wanted) {
  if (!stopped_) return wanted;
  if (to_seconds(now() - *stopped_) > config_.patience_s) give_up("no route around the confirmed echoes");
  Setpoint setpoint = wanted;
  setpoint.speed = 0;
  return setpoint;
}

}  // namespace isobath
