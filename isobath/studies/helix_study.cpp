#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/scenario/embedded_files.hpp>
#include <isobath/studies/helix_study.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector3d;

constexpr double kStep = 0.05;  // s, of the simulation
constexpr double kThrough = 8;  // m beyond the opening

VehicleModel vehicle_of(const HelixRequest& request) {
  if (!request.vehicle.empty()) return load_vehicle(request.vehicle);
  constexpr std::string_view kName = "vehicles/remus100.toml";
  for (const EmbeddedFile& file : embedded_files()) {
    if (file.name == kName) return parse_vehicle(file.text, std::string(kName));
  }
  throw Error("the program has no embedded vehicle", {}, {}, "name a vehicle file");
}

Opening opening_of(const HelixRequest& request) {
  const Rotation R_WO = Rotation::from_heading(request.course);
  const Vector3d start_W(0, 0, 0.5 * request.height_m);
  return {{R_WO, start_W + R_WO * Vector3d(request.from_m, 0, 0)}, request.width_m, request.height_m};
}

std::optional<Rock> rock_of(const HelixRequest& request, const Opening& opening) {
  if (!(request.rock_radius_m > 0)) return std::nullopt;
  return Rock{opening.X_WO * Vector3d(-request.rock_before_m, request.rock_aside_m, request.rock_down_m),
              request.rock_radius_m};
}

Convergence converge(const SpacePath& path, const PathFollowingConfig& config, const Vector3d& start_F, double speed) {
  Convergence c;
  c.start_F = start_F;
  const PathFrame frame = path.frame_at(0);
  const Vector3d tangent = frame.tangent();
  FollowedPoint at;
  at.vehicle = {frame.p_W + frame.R_WF * start_F, -std::asin(tangent.z()), std::atan2(tangent.y(), tangent.x())};
  for (double t = 0; t < 45; t += kStep) {
    const PathFrame now = path.frame_at(at.s);
    const PathErrors errors = path_errors(now, at.vehicle.p_W, at.vehicle.R_WV());
    const double v = follow_path(config, now, errors, speed).lyapunov;
    if (!c.lyapunov.empty()) c.greatest_rise = std::max(c.greatest_rise, v - c.lyapunov.back());
    c.time_s.push_back(t);
    c.off_m.push_back(errors.q_F.norm());
    c.lyapunov.push_back(v);
    c.way.push_back(at.vehicle.p_W);
    at = step_along(path, config, at, speed, kStep);
  }
  return c;
}

}  // namespace

std::vector<Section> sections(HelixRequest& r) {
  std::vector<Field> approach{
      Field::real("width", &r.width_m, {0.5, 1000}, "m", "Width of the opening."),
      Field::real("height", &r.height_m, {0.5, 1000}, "m", "Height of the opening, from the surface to the bed."),
      Field::real("from", &r.from_m, {2, 1000}, "m", "Distance of the start before the opening."),
      Field::degrees("course_deg", &r.course, {-360, 360}, "Course of the approach line, clockwise from north."),
      Field::real("speed", &r.speed, {0.1, 20}, "m/s", "Speed through the water."),
      Field::real("images", &r.images_per_s, {0.1, 20}, "1/s", "Image rate; each image plans the approach anew."),
      Field::choice("plant", &r.plant, {{"dynamic", PlantKind::kDynamic}, {"kinematic", PlantKind::kKinematic}},
                    "Vehicle model; dynamic has inertia and an autopilot."),
      Field::file("vehicle", &r.vehicle, "Vehicle file; empty: the embedded vehicle."),
      Field::real("rock_radius", &r.rock_radius_m, {0, 100}, "m", "Radius of a rock before the opening; 0: no rock."),
      Field::real("rock_before", &r.rock_before_m, {0, 1000}, "m", "Distance of the rock before the opening."),
      Field::real("rock_aside", &r.rock_aside_m, {-1000, 1000}, "m", "The rock to starboard of the middle line."),
      Field::real("rock_down", &r.rock_down_m, {-1000, 1000}, "m", "The rock below the middle line.")};
  return {{"approach", "The opening and the vehicle.", std::move(approach)},
          {"helix", "The helix and the decision.", fields(r.helix)},
          {"fans", "The pair of forward-looking fans.", fields(r.fans)},
          {"echoes", "What the looks of the fans give.", fields(r.echoes)},
          {"following", "The path-following law by pitch rate and turn rate.", fields(r.following)},
          {"helm", "Path following by set-points of heading and depth.", fields(r.helm)}};
}

namespace {

VehicleState state_at_start(const Opening& opening, const Vector3d& start_W, double speed) {
  VehicleState start;
  start.X_WB = {opening.X_WO.rotation, start_W};
  start.v_B.x() = speed;
  return start;
}

void take_image(const Pose& X_WB, double distance_m, OpeningMap& seen, ApproachLog& log) {
  log.view.look(X_WB);
  log.look_distance_m.push_back(distance_m);
  seen.look(X_WB);
}

/// Decides anew with an image, and follows the new plan.
ApproachPhase step_approach(OpeningApproach& approach, const Opening& opening, const Vector3d& p_W, double way,
                            const OpeningMap& seen, PathHelm& helm, ApproachLog& log) {
  const ApproachPhase phase = approach.step(p_W, opening, seen.free_share(), &seen.map());
  if (phase != ApproachPhase::kTurnAway) helm.follow(approach.plan().path, 0);
  if (log.leave_m == 0 && approach.left_at_m()) {
    log.leave_m = *approach.left_at_m();
    log.way_m = way;
  }
  return phase;
}

/// The set-point of the helm, or that of the turn away from the opening.
Setpoint order_of(PathHelm& helm, const OpeningApproach& approach, ApproachPhase phase, const Opening& opening,
                  const VehicleState& state) {
  Setpoint order = helm.step(state, kStep);
  if (phase == ApproachPhase::kTurnAway) {
    order.heading = approach.away(state.X_WB.rotation.heading());
    order.depth = opening.X_WO.translation.z();
  }
  return order;
}

}  // namespace

ApproachLog fly_approach(const HelixRequest& request, const VehicleModel& model, const DepthLoop& loop, double share) {
  const Opening opening = opening_of(request);
  const Vector3d start_W(0, 0, 0.5 * request.height_m);
  const VehicleParameters parameters = parameters_of(model);
  OpeningApproach approach(request.helix, parameters, request.speed, start_W, opening);
  HelixPlanner line(request.helix, parameters, request.speed, start_W, opening);
  const SpacePath straight = line.plan(opening, 0, 0, kThrough + 10).path;

  const auto plant = make_plant(model, request.plant, state_at_start(opening, start_W, request.speed));
  PathHelmConfig steering = request.helm;
  if (request.plant == PlantKind::kKinematic) steering.heading_lag_s = 0;  // it follows set-points without lag
  PathHelm helm(share > 0 ? approach.plan().path : straight, steering,
                request.plant == PlantKind::kDynamic ? loop : DepthLoop{}, request.speed);

  OpeningMap seen(opening, start_W, request.fans, request.echoes, rock_of(request, opening));
  ApproachLog log{{}, OpeningView(opening, request.fans), {}};
  log.nearest_m = request.from_m;
  const Pose X_OW = opening.X_WO.inverse();
  const int steps_an_image = std::max(1, static_cast<int>(std::lround(1 / (request.images_per_s * kStep))));
  const double longest_s = 4 * (request.from_m + 60) / request.speed;
  double way = 0;
  Vector3d squares_O = Vector3d::Zero();  // of the deviations from the target during the helix
  int helical = 0;
  ApproachPhase phase = ApproachPhase::kHelix;
  for (int i = 0; i * kStep < longest_s; ++i) {
    const Pose& X_WB = plant->state().X_WB;
    const Vector3d p_O = X_OW * X_WB.translation;
    if (i % steps_an_image == 0) {
      if (p_O.x() < 0) take_image(X_WB, -p_O.x(), seen, log);
      if (share > 0 && p_O.x() < 0) phase = step_approach(approach, opening, X_WB.translation, way, seen, helm, log);
      const Rotation R_OB = X_OW.rotation * X_WB.rotation;
      const double bits =
          i % (5 * steps_an_image) == 0 || log.samples.empty() ? seen.bits_a_voxel() : log.samples.back().bits_a_voxel;
      log.samples.push_back({i * kStep, -p_O.x(), p_O, X_OW * helm.target().p_W, R_OB.heading(), R_OB.pitch(),
                             log.view.known_share(), seen.free_share(), bits, phase});
    }
    if (p_O.x() > kThrough) break;
    if (phase == ApproachPhase::kTurnAway && -p_O.x() > request.from_m / 2 && log.nearest_m < request.from_m / 2) break;
    const Setpoint order = order_of(helm, approach, phase, opening, plant->state());
    plant->step(order, {model.reference_density, Vector3d::Zero()}, kStep);
    way += kStep * plant->state().v_B.norm();
    log.nearest_m = std::max(0.0, std::min(log.nearest_m, -p_O.x()));
    const Vector3d off_O = X_OW * plant->state().X_WB.translation - X_OW * helm.target().p_W;
    if (phase == ApproachPhase::kHelix && log.leave_m == 0) {
      squares_O += off_O.cwiseAbs2();
      ++helical;
    }
  }
  log.vertical_rms_m = std::sqrt(squares_O.z() / std::max(1, helical));
  log.lateral_rms_m = std::sqrt(squares_O.y() / std::max(1, helical));
  return log;
}

HelixStudy study_helix(const HelixRequest& request) {
  if (!(request.from_m > 1) || !(request.speed > 0) || !(request.images_per_s > 0)) {
    throw Error("an approach needs a distance, a speed and images", {}, "all above 0, the distance above 1 m");
  }
  const VehicleModel model = vehicle_of(request);
  if (request.speed > model.limits.max_speed || request.speed < model.autopilot.min_flow) {
    throw Error("the vehicle cannot go at this speed", {}, "above the flow that its fins need, up to its maximum");
  }
  const EllipticHelix reference;
  const DepthLoop loop = measured_depth_loop(model, request.speed, reference.way_m() / request.speed);
  HelixStudy study{opening_of(request),
                   parameters_of(model),
                   0,
                   loop,
                   fly_approach(request, model, loop, 1),
                   fly_approach(request, model, loop, 0),
                   {},
                   reference,
                   {}};
  study.latest_decision_m = latest_decision_m(request.helix, study.parameters, request.speed);
  const SpacePath path([reference](double t) { return reference.at(t); }, 0, 20);
  for (const Vector3d& start : {Vector3d(2, -3, 1.5), Vector3d(-5, 4, -2)})
    study.convergence.push_back(converge(path, request.following, start, request.speed));
  const double nearest = std::max(study.latest_decision_m, 1.0);
  for (const double lift : {0.0, 0.5, 1.0}) {
    for (double lateral = 0; lateral <= 6; lateral += 0.5) {
      const EllipticHelix helix{request.helix.advance_m, lateral, lift * lateral};
      study.worth.push_back({helix, helix_worth(helix, study.opening, nearest, request.fans)});
    }
  }
  return study;
}

Swing swing_of(const ApproachLog& log) {
  std::vector<Eigen::Vector2d> flown;  // heading, pitch, rad
  for (const ApproachSample& sample : log.samples) {
    if (sample.phase == ApproachPhase::kHelix) flown.emplace_back(sample.heading.radians(), sample.pitch.radians());
  }
  Swing swing;
  if (flown.size() < 4) return swing;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& one : flown) mean += one / static_cast<double>(flown.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < flown.size(); ++i) {
    const Eigen::Vector2d off = flown[i] - mean;
    spread += off * off.transpose();
    const bool second = i >= flown.size() / 2;
    Angle& heading = second ? swing.heading_second : swing.heading_first;
    Angle& pitch = second ? swing.pitch_second : swing.pitch_first;
    heading = std::max(heading, Angle::radians(std::abs(flown[i].x())));
    pitch = std::max(pitch, Angle::radians(std::abs(flown[i].y())));
  }
  const double scale = std::sqrt(spread(0, 0) * spread(1, 1));
  swing.correlation = scale > 0 ? spread(0, 1) / scale : 0;
  return swing;
}

double ApproachLog::free_share_at(double distance_m) const {
  double share = 0;
  for (const ApproachSample& sample : samples) {
    if (sample.distance_m >= distance_m) share = sample.free_share;
  }
  return share;
}

std::vector<SeenOpening> seen_openings(const HelixStudy& study) {
  std::vector<SeenOpening> seen;
  double next_m = INFINITY;
  for (const ApproachSample& sample : study.straight.samples) {
    if (sample.distance_m > next_m || sample.distance_m < 1) continue;
    seen.push_back({sample.distance_m, opening_angles(study.opening, study.opening.X_WO * sample.p_O)});
    next_m = 10 * (std::ceil(sample.distance_m / 10) - 1);
  }
  return seen;
}

std::vector<std::pair<std::string, std::string>> helix_facts(const HelixStudy& s) {
  const ApproachLog &helix = s.helix, &straight = s.straight;
  const auto percent = [](double share) { return fmt::format("{:.1f} %", 100 * share); };
  const double left = helix.leave_m;
  const OpeningAngles first = seen_openings(s).front().angles;
  std::vector<std::pair<std::string, std::string>> facts{
      {"opening seen by both fans, helix", percent(helix.view.known_share())},
      {"opening seen by both fans, straight", percent(straight.view.known_share())},
      {"opening free in the map at the decision", percent(helix.free_share_at(left))},
      {"the same on the straight approach", percent(straight.free_share_at(left))},
      {"opening from the start",
       fmt::format("{:.1f} deg wide, {:.1f} deg high", first.horizontal.degrees(), first.vertical.degrees())},
      {"entropy of the water, helix", fmt::format("{:.3f} bits per voxel", helix.samples.back().bits_a_voxel)},
      {"entropy of the water, straight", fmt::format("{:.3f} bits per voxel", straight.samples.back().bits_a_voxel)},
      {"decision", fmt::format("{}, {:.1f} m before it", to_text(helix.samples.back().phase), helix.leave_m)},
      {"latest decision", fmt::format("{:.1f} m before it", s.latest_decision_m)},
      {"closest to the opening", helix.nearest_m > 0 ? fmt::format("{:.1f} m", helix.nearest_m) : "went through"},
      {"path length to the decision over the line's",
       fmt::format("{:.3f}", helix.way_m / (helix.samples.front().distance_m - helix.leave_m))},
      {"deviation from the planned helix, rms",
       fmt::format("{:.2f} m vertically, {:.2f} m across", helix.vertical_rms_m, helix.lateral_rms_m)},
      {"identified depth loop",
       fmt::format("commanded = z + {:.2f} s z' + {:.2f} s2 z''", s.depth_loop.lag_s, s.depth_loop.lag2_s2)},
      {"helix of A, B, C = 6, 4, 2 m",
       fmt::format("{:.1f} m per turn, path {:.1f} m, heading {:.1f} deg, pitch {:.1f} deg, {:.1f} deg/s at 1.5 m/s",
                   s.reference.turn_m(), s.reference.way_m(), s.reference.heading_swing().degrees(),
                   s.reference.pitch_swing().degrees(), Angle::radians(1.5 * s.reference.max_curvature()).degrees())}};
  for (const Convergence& c : s.convergence) {
    facts.emplace_back(
        fmt::format("path following from ({:g}, {:g}, {:g}) m", c.start_F.x(), c.start_F.y(), c.start_F.z()),
        fmt::format("{:.1e} m off after {:.0f} s; greatest rise of V {:.0e}", c.off_m.back(), c.time_s.back(),
                    c.greatest_rise));
  }
  return facts;
}

}  // namespace isobath
