#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/studies/control_trial.hpp>
#include <isobath/vehicle/path_helm.hpp>
#include <isobath/vehicle/vehicle_parameters.hpp>
#include <limits>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTrialStep = 0.02, kGuidanceStep = 0.1;  // s
constexpr int kStepsAGuidance = 5;
constexpr double kLegs = 6, kChangeLeg = 3;  // length of a run; when the change comes
constexpr double kTrialDepth = 10;           // m
constexpr double kRecovered_m = 0.05;

/// What is in force from the change on.
struct Disturbance {
  PlantDifference plant = {};
  double density = 1;  ///< factor
  double current = 0;  ///< m/s
  bool loses_actuator = false, poor_navigation = false;
};

Disturbance disturbance_of(ControlChange change) {
  switch (change) {
    case ControlChange::kNone: return {};
    case ControlChange::kMass: return {.plant = {.mass = 1.5}};
    case ControlChange::kDrag: return {.plant = {.drag = 1.6}};
    case ControlChange::kBuoyant: return {.plant = {.buoyancy = 10}};
    case ControlChange::kHeavy: return {.plant = {.buoyancy = -10}};
    case ControlChange::kDensity: return {.density = 1.03};
    case ControlChange::kCurrent: return {.current = 0.5};
    case ControlChange::kStrongCurrent: return {.current = 1};
    case ControlChange::kActuator: return {.loses_actuator = true};
    case ControlChange::kNavigation: return {.poor_navigation = true};
    case ControlChange::kTether: return {.plant = {.tether_m = 20}, .current = 0.5};
  }
  return {};
}

/// How a vehicle does the tasks.
struct TaskScale {
  double speed, leg_s, radius;
  GuidanceConfig guidance;
  PathHelmConfig helm;
};

TaskScale scale_of(const VehicleModel& model) {
  const VehicleParameters parameters = parameters_of(model);
  TaskScale scale;
  const bool hovers = parameters.min_speed == 0;
  scale.speed = (hovers ? 0.5 : 0.6) * model.limits.max_speed;
  scale.leg_s = hovers ? 20 : 40;
  scale.radius = hovers ? 3 : 15;
  if (hovers) {
    scale.guidance.lookahead = 2;
    scale.guidance.acceptance_radius = 0.5;
    scale.helm.approach_m = 1;
  }
  scale.helm.heading_lag_s = parameters.heading_lag_s;
  return scale;
}

/// A task: set-points from the measured state, errors of the true one.
class TaskFlight {
 public:
  TaskFlight(ControlTask task, const VehicleModel& model, Angle heading)
      : task_(task),
        scale_(scale_of(model)),
        heading_(heading),
        keeper_({}, parameters_of(model)),
        spiral_([radius = scale_.radius, heading](double u) { return spiral(radius, heading, u); }, 0, kSpiralTurns) {
    const VehicleParameters parameters = parameters_of(model);
    switch (task) {
      case ControlTask::kStation:
        keeper_.hold({0, 0, kTrialDepth, scale_.speed}, heading);
        radius_ = keeper_.radius(scale_.speed);
        break;
      case ControlTask::kLine: begin_route({1e4 * ahead()}, parameters); break;
      case ControlTask::kSquare: begin_route(square_corners(), parameters); break;
      case ControlTask::kHelix:
        helm_.emplace(spiral_, scale_.helm, DepthLoop{parameters.depth_lag_s, 0}, scale_.speed);
        break;
    }
  }

  [[nodiscard]] VehicleState start() const {
    VehicleState state;
    state.X_WB = {Rotation::from_heading(heading_), {0, 0, kTrialDepth}};
    if (task_ == ControlTask::kStation && radius_ == 0) return state;
    state.v_B.x() = scale_.speed;
    if (task_ == ControlTask::kStation) state.X_WB.translation.head<2>() = -radius_ * starboard();  // on the circle
    return state;
  }
  [[nodiscard]] double leg_s() const { return scale_.leg_s; }

  Setpoint step(const VehicleState& measured) {
    if (helm_) return helm_->step(measured, kGuidanceStep);
    if (route_) return route_->step(measured, kGuidanceStep);
    return keeper_.step(measured.X_WB, measured.X_WB.rotation * measured.v_B, kGuidanceStep);
  }
  [[nodiscard]] ControlSample error(const VehicleState& truth, double time_s) const {
    const Vector3d& p = truth.X_WB.translation;
    if (helm_) {
      const Vector3d gap = p - helm_->target().p_W;
      const Vector2d along = helm_->target().tangent().head<2>().normalized();
      return {time_s, std::abs(along.x() * gap.y() - along.y() * gap.x()), std::abs(gap.z())};
    }
    const double deep = std::abs(p.z() - kTrialDepth);
    if (!route_) return {time_s, std::abs(p.head<2>().norm() - radius_), deep};
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < corners_.size(); ++i) {
      const Vector2d leg = corners_[i] - corners_[i - 1], to_p = p.head<2>() - corners_[i - 1];
      const double share = std::clamp(to_p.dot(leg) / leg.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (to_p - share * leg).norm());
    }
    return {time_s, nearest, deep};
  }

 private:
  static constexpr double kSpiralTurns = 200, kDescent = 0.05;  // rad; down per metre round

  static CurveJet spiral(double radius, Angle heading, double u) {
    const double c = std::cos(u), s = std::sin(u), down = kDescent * radius;
    const CurveJet jet_L{radius * Vector3d(s, 1 - c, kDescent * u), Vector3d(radius * c, radius * s, down),
                         radius * Vector3d(-s, c, 0), radius * Vector3d(-c, -s, 0)};
    return Pose{Rotation::from_heading(heading), {0, 0, kTrialDepth}} * jet_L;
  }
  [[nodiscard]] Vector2d ahead() const { return {cos(heading_), sin(heading_)}; }
  [[nodiscard]] Vector2d starboard() const { return {-sin(heading_), cos(heading_)}; }
  [[nodiscard]] std::vector<Vector2d> square_corners() const {
    const double side = scale_.speed * scale_.leg_s;
    std::vector<Vector2d> corners;
    for (int round = 0; round < 3; ++round) {
      for (const Vector2d& corner : {Vector2d(1, 0), Vector2d(1, 1), Vector2d(0, 1), Vector2d(0, 0)}) {
        corners.push_back(side * (corner.x() * ahead() + corner.y() * starboard()));
      }
    }
    return corners;
  }
  void begin_route(const std::vector<Vector2d>& corners, const VehicleParameters& parameters) {
    corners_.assign(1, Vector2d::Zero());
    std::vector<Waypoint> waypoints;
    for (const Vector2d& corner : corners) {
      corners_.push_back(corner);
      waypoints.push_back({corner.x(), corner.y(), kTrialDepth, scale_.speed});
    }
    route_.emplace(scale_.guidance, std::move(waypoints), parameters);
  }

  ControlTask task_;
  TaskScale scale_;
  Angle heading_;
  StationKeeper keeper_;
  double radius_ = 0;  ///< of the circle round the station
  SpacePath spiral_;
  std::optional<PathHelm> helm_;
  std::optional<LineOfSight> route_;
  std::vector<Vector2d> corners_;  ///< of the route, with its start
};

/// What the control gets of a state: noise, and a delay in whole steps of place and speeds; attitude and rates come
/// from its own gyroscopes.
class MeasuredState {
 public:
  explicit MeasuredState(Random random) : random_(random) {}

  /// `flow`: true speed ahead through the water; returns the measured one.
  double measure(const VehicleState& truth, double flow, const NavigationNoise& noise) {
    VehicleState& now = past_[next_ % past_.size()];
    now = truth;
    now.X_WB.translation +=
        Vector3d(noise.position * random_.normal(), noise.position * random_.normal(), noise.depth * random_.normal());
    now.X_WB.rotation = truth.X_WB.rotation * Rotation::exp(noise.attitude.radians() * normal3());
    now.v_B += noise.speed * normal3();
    now.w_B += noise.rate.radians() * normal3();
    flows_[next_ % past_.size()] = flow + noise.speed * random_.normal();
    const auto back = std::min(next_, static_cast<std::size_t>(std::lround(noise.delay_s / kTrialStep)));
    const std::size_t then = (next_ - back) % past_.size();
    state_ = {{now.X_WB.rotation, past_[then].X_WB.translation}, past_[then].v_B, now.w_B};
    ++next_;
    return flows_[then];
  }
  [[nodiscard]] const VehicleState& state() const { return state_; }

 private:
  Vector3d normal3() { return {random_.normal(), random_.normal(), random_.normal()}; }

  Random random_;
  std::array<VehicleState, 64> past_;
  std::array<double, 64> flows_ = {};
  std::size_t next_ = 0;
  VehicleState state_;
};

double rms(double squares, int count) { return std::sqrt(squares / std::max(1, count)); }

}  // namespace

const char* to_text(ControlTask task) {
  switch (task) {
    case ControlTask::kStation: return "station";
    case ControlTask::kLine: return "line";
    case ControlTask::kSquare: return "square";
    case ControlTask::kHelix: return "helix";
  }
  return "";
}

const char* to_text(ControlChange change) {
  switch (change) {
    case ControlChange::kNone: return "none";
    case ControlChange::kMass: return "mass";
    case ControlChange::kDrag: return "drag";
    case ControlChange::kBuoyant: return "buoyant";
    case ControlChange::kHeavy: return "heavy";
    case ControlChange::kDensity: return "density";
    case ControlChange::kCurrent: return "current";
    case ControlChange::kStrongCurrent: return "strong-current";
    case ControlChange::kActuator: return "actuator";
    case ControlChange::kNavigation: return "navigation";
    case ControlChange::kTether: return "tether";
  }
  return "";
}

const char* explained(ControlChange change) {
  switch (change) {
    case ControlChange::kNone: return "nothing changes";
    case ControlChange::kMass: return "mass, inertia and added mass +50 %, trimmed";
    case ControlChange::kDrag: return "drag +60 %";
    case ControlChange::kBuoyant: return "10 N more buoyancy";
    case ControlChange::kHeavy: return "10 N more weight";
    case ControlChange::kDensity: return "water 3 % denser";
    case ControlChange::kCurrent: return "current 0.5 m/s";
    case ControlChange::kStrongCurrent: return "current 1 m/s";
    case ControlChange::kActuator: return "one thruster or fin lost, unknown to the control";
    case ControlChange::kNavigation: return "place and speeds 0.14 s late, all four times as noisy";
    case ControlChange::kTether: return "20 m of tether in a current of 0.5 m/s";
  }
  return "";
}

ControlTrial fly_trial(const VehicleModel& file, const ControlTrialRequest& request) {
  VehicleModel model = file;
  model.autopilot.control = request.control;
  Random random(0x9e3779b9u + static_cast<std::uint64_t>(request.run));
  const Angle heading = Angle::radians(random.uniform(-std::numbers::pi, std::numbers::pi));
  const Angle towards = Angle::radians(random.uniform(-std::numbers::pi, std::numbers::pi));
  const double shift = random.uniform(-0.25, 0.25);
  MeasuredState measured(random.fork());

  TaskFlight flight(request.task, model, heading);
  ControlTrial trial{(kChangeLeg + shift) * flight.leg_s(), flight.leg_s(), {}};
  VehicleDynamics dynamics(model, flight.start());
  const auto autopilot = make_autopilot(model);
  const Disturbance disturbance = disturbance_of(request.change);
  WaterConditions water{model.reference_density, Vector3d::Zero()};
  NavigationNoise noise = kNavigationNoise;
  double tether_m = 0;
  Setpoint setpoint;
  const auto steps = static_cast<int>(kLegs * flight.leg_s() / kTrialStep);
  const auto change_step = static_cast<int>(trial.change_s / kTrialStep);
  for (int i = 0; i < steps; ++i) {
    if (i == change_step) {
      dynamics.set_model(different_plant(model, disturbance.plant));
      tether_m = disturbance.plant.tether_m;
      water = {model.reference_density * disturbance.density,
               disturbance.current * Vector3d(cos(towards), sin(towards), 0)};
      // The first thruster, or the first fin of a vehicle with one thruster.
      if (disturbance.loses_actuator) dynamics.set_effectiveness(model.thrusters.size() > 1 ? 0 : 1, 0);
      if (disturbance.poor_navigation) noise = kPoorNavigation;
    }
    const VehicleState& truth = dynamics.state();
    const double flow = (truth.v_B - truth.X_WB.rotation.inverse() * water.current_W).x();
    const double measured_flow = measured.measure(truth, flow, noise);
    if (i % kStepsAGuidance == 0) {
      setpoint = flight.step(measured.state());
      trial.samples.push_back(flight.error(truth, i * kTrialStep));
    }
    const ActuatorVector commands = autopilot->update(setpoint, measured.state(), measured_flow, kTrialStep);
    dynamics.step(commands, water, kTrialStep, tether_wrench(tether_m, truth, water));
  }
  return trial;
}

ControlScore score(const ControlTrial& trial) {
  ControlScore s;
  double before = 0, at = 0, after = 0;
  int n_before = 0, n_at = 0, n_after = 0;
  const double end = trial.samples.back().time_s;
  for (const ControlSample& x : trial.samples) {
    const double off = x.off_m();
    if (x.time_s >= trial.change_s - trial.leg_s && x.time_s < trial.change_s) {
      before += off * off;
      ++n_before;
      s.before_max_m = std::max(s.before_max_m, off);
    } else if (x.time_s >= trial.change_s && x.time_s < trial.change_s + trial.leg_s) {
      at += off * off;
      ++n_at;
      s.at_max_m = std::max(s.at_max_m, off);
      s.at_depth_max_m = std::max(s.at_depth_max_m, x.depth_m);
      s.at_level_max_m = std::max(s.at_level_max_m, x.level_m);
    }
    if (x.time_s > end - trial.leg_s) {
      after += off * off;
      ++n_after;
      s.after_max_m = std::max(s.after_max_m, off);
    }
    if (x.time_s > end - 0.5 * trial.leg_s) {
      s.final_depth_m = std::max(s.final_depth_m, x.depth_m);
      s.final_level_m = std::max(s.final_level_m, x.level_m);
    }
  }
  s.before_rms_m = rms(before, n_before);
  s.at_rms_m = rms(at, n_at);
  s.after_rms_m = rms(after, n_after);
  const double level = std::max(s.before_max_m, kRecovered_m);
  for (const ControlSample& x : trial.samples) {
    if (x.time_s >= trial.change_s && x.off_m() > level) s.recovery_s = x.time_s - trial.change_s;
  }
  if (s.recovery_s > end - trial.change_s - 1) s.recovery_s = std::numeric_limits<double>::infinity();
  return s;
}

}  // namespace isobath
