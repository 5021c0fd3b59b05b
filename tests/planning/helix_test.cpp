// The helix manoeuvre: closed forms, opening angles, planned approaches within limits, the decision.
#include <cmath>
#include <Eigen/QR>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/planning/opening_approach.hpp>
#include <isobath/planning/opening_view.hpp>
#include <isobath/vehicle/path_helm.hpp>
#include <isobath/vehicle/plant.hpp>
#include <numbers>
#include <tests/support/data.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr double kSpeed = 1.5;

VehicleModel torpedo() { return load_vehicle((test::source_folder() / "vehicles" / "remus100.toml").string()); }

Opening ahead(double distance, double width = 25, double height = 8, double course_deg = 0) {
  const Rotation R = Rotation::from_heading(Angle::degrees(course_deg));
  return {{R, R * Vector3d(distance, 0, 0) + Vector3d(0, 0, height / 2)}, width, height};
}

// ledger: S5-41
TEST(EllipticHelix, HasTheNumbersOfItsDefaults) {
  const EllipticHelix helix;
  EXPECT_NEAR(helix.turn_m(), 37.7, 0.05);
  EXPECT_NEAR(helix.heading_swing().degrees(), 33.7, 0.05);
  EXPECT_NEAR(helix.pitch_swing().degrees(), 18.4, 0.05);
  EXPECT_NEAR(Angle::radians(1.5 * helix.max_curvature()).degrees(), 8.6, 0.05);
  // The way, by chords.
  double way = 0, steepest = 0, widest = 0, tightest = 0;
  constexpr int kChords = 100000;
  for (int i = 0; i < kChords; ++i) {
    const double t = 2 * pi * i / kChords;
    const CurveJet a = helix.at(t);
    way += (helix.at(t + 2 * pi / kChords).p - a.p).norm();
    steepest = std::max(steepest, std::atan2(std::abs(a.d1.z()), a.d1.head<2>().norm()));
    widest = std::max(widest, std::atan2(a.d1.y(), a.d1.x()));
    tightest = std::max(tightest, frenet_frame(a)->k1);
  }
  EXPECT_NEAR(way, 42.6, 0.05);
  EXPECT_NEAR(helix.way_m(), way, 1e-6);
  EXPECT_NEAR(helix.pitch_swing().radians(), steepest, 1e-6);
  EXPECT_NEAR(helix.heading_swing().radians(), widest, 1e-6);
  EXPECT_NEAR(helix.max_curvature(), tightest, 1e-6);
}

// Height is C sin t, so depth falls where height grows. ledger: S5-41 S5-E08
TEST(EllipticHelix, LiesOnItsCylinderAtAnyHeading) {
  const EllipticHelix helix{6, 4, 2};
  for (const double course : {0.0, 77.0, 180.0, -130.0}) {
    const Pose X_WL{Rotation::from_heading(Angle::degrees(course)), {10, -20, 5}};
    for (double t = -3; t < 9; t += 0.31) {
      const Vector3d p_W = (X_WL * helix.at(t)).p;
      const Vector3d off = p_W - Vector3d(10, -20, 5);
      const double along = off.x() * cos(Angle::degrees(course)) + off.y() * sin(Angle::degrees(course));
      const double starboard = off.y() * cos(Angle::degrees(course)) - off.x() * sin(Angle::degrees(course));
      const double height = -off.z();
      EXPECT_NEAR(along, 6 * t, 1e-9);
      EXPECT_NEAR(starboard, 4 * std::cos(t), 1e-9);
      EXPECT_NEAR(height, 2 * std::sin(t), 1e-9);
      EXPECT_NEAR(std::pow(starboard / 4, 2) + std::pow(height / 2, 2), 1, 1e-12);
    }
  }
}

// Closed forms against finite differences of the place, frame by frame. ledger: S5-49 S5-E08
TEST(EllipticHelix, FrameCurvatureAndTorsionAgreeWithFiniteDifferences) {
  for (const EllipticHelix& helix : {EllipticHelix{6, 4, 2}, EllipticHelix{3, 1, 2.5}, EllipticHelix{5, 3, 3}}) {
    for (double t = -2; t < 5; t += 0.17) {
      const PathFrame at = helix.frame(t);
      const double h = 1e-4, w = helix.metres_per_radian(t);
      const Vector3d tangent = (helix.at(t + h).p - helix.at(t - h).p) / (2 * h * w);
      EXPECT_NEAR((tangent - at.R_WF.col(0)).norm(), 0, 1e-6);
      const Eigen::Matrix3d slope = (helix.frame(t + h).R_WF - helix.frame(t - h).R_WF) / (2 * h * w);
      const Eigen::Matrix3d turn = at.R_WF.transpose() * slope;
      EXPECT_NEAR(turn(1, 0), at.k1, 1e-6);
      EXPECT_NEAR(turn(2, 0), 0, 1e-6);
      EXPECT_NEAR(turn(2, 1), at.torsion, 1e-6);
      EXPECT_LT(at.torsion, 0);  // left-handed in north-east-down
      EXPECT_NEAR((at.R_WF.transpose() * at.R_WF - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
      EXPECT_NEAR(at.R_WF.determinant(), 1, 1e-12);
    }
  }
  const EllipticHelix round{5, 3, 3};
  EXPECT_NEAR(round.frame(1).k1, 3 / 34.0, 1e-12);
  EXPECT_NEAR(round.frame(1).torsion, -5 / 34.0, 1e-12);
}

Pose looking(const CurveJet& jet) {
  const Angle heading = Angle::radians(std::atan2(jet.d1.y(), jet.d1.x()));
  const Angle pitch = Angle::radians(std::atan2(-jet.d1.z(), jet.d1.head<2>().norm()));
  return {Rotation::from_heading_pitch_roll(heading, pitch, Angle()), jet.p};
}

// ledger: S5-42 S5-E05
TEST(EllipticHelix, PointsAtStarboardSurfacePortAndBedInThisOrder) {
  const EllipticHelix helix{6, 4, 2};
  const FanPair fans;
  // Far away, a degree inside of what the swing brings into the common beam.
  const double wide = helix.heading_swing().radians() + fans.thickness.radians() / 2 - 0.02;
  const double high = helix.pitch_swing().radians() + fans.thickness.radians() / 2 - 0.02;
  const std::vector<std::pair<const char*, Vector3d>> targets{{"starboard", {std::cos(wide), std::sin(wide), 0}},
                                                              {"surface", {std::cos(high), 0, -std::sin(high)}},
                                                              {"port", {std::cos(wide), -std::sin(wide), 0}},
                                                              {"bed", {std::cos(high), 0, std::sin(high)}}};
  std::vector<std::string> order;
  for (double t = -0.75 * pi; t < 1.25 * pi; t += 0.01) {
    const Rotation R_BW = looking(helix.at(t)).rotation.inverse();
    for (const auto& [name, u_W] : targets) {
      const Vector3d u_B = R_BW * u_W;
      const bool seen = in_horizontal_fan(fans, u_B) && in_vertical_fan(fans, u_B);
      if (seen && std::find(order.begin(), order.end(), name) == order.end()) order.emplace_back(name);
    }
  }
  EXPECT_EQ(order, (std::vector<std::string>{"starboard", "surface", "port", "bed"}));
  // The view leads the place by a quarter turn, counter-clockwise seen from behind: starboard, up, port, down.
  const EllipticHelix round{6, 3, 3};
  for (double t = 0; t < 6; t += 0.5) {
    const CurveJet jet = round.at(t);
    const double place = std::atan2(-jet.p.z(), jet.p.y()), view = std::atan2(-jet.d1.z(), jet.d1.y());
    EXPECT_NEAR(std::remainder(view - place, 2 * pi), pi / 2, 1e-12);
  }
}

/// v(x) = (a + b x) cos(x / A) + (c + d x) sin(x / A) + e by least squares.
struct GrowingSine {
  Eigen::Matrix<double, 5, 1> parts;
  [[nodiscard]] double phase(double x) const { return std::atan2(-(parts(2) + parts(3) * x), parts(0) + parts(1) * x); }
  [[nodiscard]] double amplitude(double x) const {
    return std::hypot(parts(0) + parts(1) * x, parts(2) + parts(3) * x);
  }
};
GrowingSine fitted(const std::vector<double>& x, const std::vector<double>& v, double advance) {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(x.size()), 5);
  Eigen::VectorXd right(static_cast<Eigen::Index>(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double c = std::cos(x[i] / advance), s = std::sin(x[i] / advance);
    const auto row = static_cast<Eigen::Index>(i);
    rows.row(row) << c, x[i] * c, s, x[i] * s, 1;
    right(row) = v[i];
  }
  return {rows.colPivHouseholderQr().solve(right)};
}

// Rudder and planes work on heading and pitch; the beam's edge reaches the pylons at the end of the swing, by the angle
// between them as seen from there. ledger: S5-43 S5-44 S5-D07 S5-E04 S5-E06 S5-E16
TEST(HelixPlan, CommandsAreAQuarterTurnApartAndGrow) {
  HelixConfig config;
  config.advance_m = 4;
  const Opening opening = ahead(60, 30, 26);
  HelixPlanner planner(config, parameters_of(torpedo()), kSpeed, {0, 0, 13}, opening);
  const HelixPlan plan = planner.plan(opening, 0);
  std::vector<double> x, heading, pitch;
  for (double s = 0; s < plan.path.length(); s += 0.25) {
    const PathFrame frame = plan.path.frame_at(s);
    if (frame.p_W.x() < config.rise_m + 1 || frame.p_W.x() > 60 - plan.leave_m - 4) continue;
    x.push_back(frame.p_W.x());
    heading.push_back(std::atan2(frame.tangent().y(), frame.tangent().x()));
    pitch.push_back(-std::asin(frame.tangent().z()));
  }
  const GrowingSine h = fitted(x, heading, config.advance_m), p = fitted(x, pitch, config.advance_m);
  double last_h = 0, last_p = 0;
  for (double at = x.front(); at < x.back(); at += 2) {
    EXPECT_NEAR(std::abs(std::remainder(h.phase(at) - p.phase(at), 2 * pi)), pi / 2, Angle::degrees(5).radians()) << at;
    const double half_opening = std::atan(0.5 * opening.width_m / (60 - at));
    EXPECT_NEAR(h.amplitude(at), half_opening - config.half_beam.radians(), Angle::degrees(3).radians()) << at;
    EXPECT_GT(h.amplitude(at), last_h);
    EXPECT_GT(p.amplitude(at), last_p);
    last_h = h.amplitude(at);
    last_p = p.amplitude(at);
  }
}

// The tangent of a growing helix is that of its places: derivatives of B and C are in it. ledger: S5-44 S5-47
TEST(HelixPlan, DerivativesAreThoseOfItsPlaces) {
  const Opening opening = ahead(60, 25, 16, 40);
  HelixPlanner planner({}, parameters_of(torpedo()), kSpeed, {0, 0, 6}, opening);  // two metres above the middle
  const HelixPlan plan = planner.plan(opening, 0);
  const double h = 1e-3;
  for (double s = 0.5; s < plan.path.length() - 0.5; s += 0.37) {
    const double u = plan.path.parameter_at(s);
    const auto jet = [&](double at) { return plan.path.jet_at(s + at); };
    const CurveJet here = jet(0);
    const double du = plan.path.parameter_at(s + h) - plan.path.parameter_at(s - h);
    EXPECT_GT(du, 0) << u;
    EXPECT_NEAR(((jet(h).p - jet(-h).p) / du - here.d1).norm(), 0, 1e-5);
    EXPECT_NEAR(((jet(h).d1 - jet(-h).d1) / du - here.d2).norm(), 0, 1e-5);
    EXPECT_NEAR(((jet(h).d2 - jet(-h).d2) / du - here.d3).norm(), 0, 1e-5);
  }
  EXPECT_NEAR((plan.path.frame_at(0).p_W - Vector3d(0, 0, 6)).norm(), 0, 1e-9);
  // Ends on the middle line, straight.
  const PathFrame end = plan.path.frame_at(plan.path.length());
  EXPECT_NEAR((opening.X_WO.inverse() * end.p_W - Vector3d(10, 0, 0)).norm(), 0, 1e-9);
}

struct Demand {
  double swing = 0, pitch = 0, turn = 0, climb = 0, radius = INFINITY;
};

/// By chords of the path alone.
Demand demand_by_chords(const SpacePath& path, double line) {
  Demand d;
  const double h = 0.05;
  for (double s = h; s < path.length() - h; s += 0.1) {
    const Vector3d a = path.frame_at(s - h).p_W, b = path.frame_at(s).p_W, c = path.frame_at(s + h).p_W;
    const Vector3d t = (c - a).normalized(), bend = (a - 2 * b + c) / (h * h);
    d.swing = std::max(d.swing, std::abs(std::remainder(std::atan2(t.y(), t.x()) - line, 2 * pi)));
    d.pitch = std::max(d.pitch, std::asin(std::abs(t.z())));
    d.climb = std::max(d.climb, kSpeed * std::abs(t.z()));
    d.turn = std::max(d.turn, kSpeed * bend.norm());
    const double level = t.head<2>().norm(), turn = std::abs(t.x() * bend.y() - t.y() * bend.x()) / std::pow(level, 3);
    d.radius = std::min(d.radius, 1 / std::max(turn, 1e-12));
  }
  return d;
}

// Opening and vehicle of many kinds: where it says that it keeps within the limits, it does. ledger: S5-45 S5-47
TEST(HelixPlan, KeepsWithinTheLimitsOfTheVehicle) {
  ISOBATH_NOT_SANITIZED();
  const HelixConfig config;
  int helices = 0;
  Random random(11);
  for (int trial = 0; trial < 40; ++trial) {
    VehicleParameters parameters = parameters_of(torpedo());
    parameters.limits.max_yaw_rate = Angle::degrees(random.uniform(6, 20));
    parameters.limits.max_climb_rate = random.uniform(0.2, 0.6);
    const double from = random.uniform(45, 90);
    const double width = random.uniform(8, 40);
    const double height = random.uniform(5, 25);
    const double course = random.uniform(-180, 180);
    const double above = random.uniform(-1, 1);
    const Opening opening = ahead(from, width, height, course);
    HelixPlanner planner(config, parameters, kSpeed, {0, 0, height / 2 + above}, opening);
    const HelixPlan plan = planner.plan(opening, 0);
    EXPECT_GE(plan.leave_m, std::min(planner.latest_m(), from) - 1e-9);
    if (!plan.within_limits) continue;
    helices += plan.leave_m < from - 15;
    const Demand d = demand_by_chords(plan.path, Angle::degrees(course).radians());
    EXPECT_LT(d.swing, config.max_swing.radians() + 1e-3);
    EXPECT_LT(d.pitch, config.max_pitch.radians() + 1e-3);
    EXPECT_LT(d.turn, 1.02 * parameters.limits.max_yaw_rate.radians() + 1e-3);
    EXPECT_LT(d.climb, 1.01 * parameters.limits.max_climb_rate);
    EXPECT_GT(d.radius, 0.98 * parameters.limits.turning_radius);
    EXPECT_NEAR(plan.demand.swing.radians(), d.swing, 0.01);
    EXPECT_NEAR(plan.demand.turn_rate, d.turn, 0.03 * d.turn + 1e-3);
  }
  EXPECT_GT(helices, 25);
}

// Each image tells another opening, scattered as pylon fixes are; each plan goes on where the last one was. ledger:
// S5-47
TEST(HelixPlanner, PlansAnewEachImageWithoutAJump) {
  const VehicleParameters parameters = parameters_of(torpedo());
  HelixPlanner planner({}, parameters, kSpeed, {0, 0, 4}, ahead(60));
  Random random(2);
  std::optional<HelixPlan> last;
  Opening believed = ahead(60);
  int within = 0, plans = 0;
  for (double along = 0; along < 36; along += 0.3) {
    // A fix of 1 m is believed by a tenth.
    const double scatter = random.normal();
    const double wider = random.normal();
    believed.X_WO.translation.y() += 0.1 * (scatter - believed.X_WO.translation.y());
    believed.width_m += 0.1 * (25 + wider - believed.width_m);
    HelixPlan plan = planner.plan(believed, along);
    if (last) {
      double low = 0, high = 1;  // where the last plan is as far along
      for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (last->path.parameter_at(middle) < along ? low : high) = middle;
      }
      const CurveJet a = last->path.jet_at(low), b = plan.path.jet_at(0);
      EXPECT_NEAR((a.p - b.p).norm(), 0, 1e-7);
      EXPECT_NEAR((a.d1 - b.d1).norm(), 0, 1e-7);
      EXPECT_NEAR((a.d2 - b.d2).norm(), 0, 1e-6);
      EXPECT_NEAR((a.d3 - b.d3).norm(), 0, 1e-5);
    }
    within += plan.within_limits;
    ++plans;
    last = std::move(plan);
  }
  EXPECT_GT(within, plans * 9 / 10);
}

// ledger: S5-45
TEST(LatestDecision, LeavesRoomToTurnAwayFromTheWorstHeading) {
  const HelixConfig config;
  const VehicleParameters parameters = parameters_of(torpedo());
  const double latest = latest_decision_m(config, parameters, kSpeed);
  EXPECT_GT(latest, 20);
  EXPECT_LT(latest, 30);
  // Reacts late, then turns with all it has, from a heading that swings the other way.
  double x = -latest + kSpeed * config.reaction_s, psi = -config.max_swing.radians(), nearest = INFINITY;
  const double rate = std::min(parameters.limits.max_yaw_rate.radians(), kSpeed / parameters.limits.turning_radius);
  for (; psi < pi; psi += rate * 1e-3) {
    x += kSpeed * std::cos(psi) * 1e-3;
    nearest = std::min(nearest, -x);
  }
  EXPECT_NEAR(nearest, config.clearance_m, 0.01);
}

struct Flight {
  std::optional<double> left_m;
  double nearest_m = 1e9;
  bool through = false;
  ApproachPhase phase = ApproachPhase::kHelix;
};

Flight fly(const Opening& opening, double known_share, const VoxelMap* map) {
  const VehicleModel model = torpedo();
  OpeningApproach approach({}, parameters_of(model), kSpeed, {0, 0, opening.height_m / 2}, opening);
  VehicleState state;
  state.X_WB = {opening.X_WO.rotation, {0, 0, opening.height_m / 2}};
  state.v_B.x() = kSpeed;
  KinematicVehicle vehicle(model, state);
  PathHelmConfig config;
  config.heading_lag_s = 0;
  PathHelm helm(approach.plan().path, config, {}, kSpeed);
  Flight flight;
  const double from = opening.X_WO.translation.head<2>().norm();
  for (int i = 0; i < 2000; ++i) {
    const Vector3d p_O = opening.X_WO.inverse() * vehicle.state().X_WB.translation;
    flight.nearest_m = std::min(flight.nearest_m, -p_O.x());
    flight.through = p_O.x() > 2;
    if (flight.through || (flight.phase == ApproachPhase::kTurnAway && -p_O.x() > from - 10)) break;
    if (i % 4 == 0 && flight.phase != ApproachPhase::kTurnAway) {
      flight.phase = approach.step(vehicle.state().X_WB.translation, opening, known_share, map);
      if (flight.phase != ApproachPhase::kTurnAway) helm.follow(approach.plan().path, 0);
    }
    Setpoint order = helm.step(vehicle.state(), 0.1);
    if (flight.phase == ApproachPhase::kTurnAway)
      order.heading = approach.away(vehicle.state().X_WB.rotation.heading());
    vehicle.step(order, {1025, {0, 0, 0}}, 0.1);
  }
  flight.left_m = approach.left_at_m();
  return flight;
}

// ledger: S5-45 S5-D09
TEST(OpeningApproach, LeavesTheHelixAt20To30MetresAndGoesThroughOrTurnsAway) {
  ISOBATH_NOT_SANITIZED();
  for (const double course : {0.0, 130.0}) {
    const Opening opening = ahead(60, 25, 8, course);
    const Flight known = fly(opening, 0.98, nullptr), unknown = fly(opening, 0.6, nullptr);
    ASSERT_TRUE(known.left_m && unknown.left_m);
    EXPECT_GT(*known.left_m, 20);
    EXPECT_LT(*known.left_m, 30);
    EXPECT_EQ(known.phase, ApproachPhase::kPass);
    EXPECT_TRUE(known.through);
    EXPECT_EQ(unknown.phase, ApproachPhase::kTurnAway);
    EXPECT_FALSE(unknown.through);
    EXPECT_GT(unknown.nearest_m, HelixConfig().clearance_m);
  }
  EXPECT_EQ(fly(ahead(60, 2, 8), 1, nullptr).phase, ApproachPhase::kTurnAway) << "too narrow for hull and margin";
}

// ledger: S5-45 S5-47
TEST(OpeningApproach, TurnsAwayFromWhatTheMapHasInTheWay) {
  ISOBATH_NOT_SANITIZED();
  const Opening opening = ahead(60);
  VoxelMap map({0.5, 0.5, 0.98, 0.2, 6.9});
  const auto put = [&](const Vector3d& p) {
    for (int i = 0; i < 3; ++i) map.layer("any").add(map.voxel_at(p), to_evidence(3));
  };
  put({45, 12, 4});  // beside all ways
  EXPECT_EQ(fly(opening, 1, &map).phase, ApproachPhase::kPass);
  // On the helix, off the line: flown at a smaller amplitude.
  put({30, -3, 4});
  const Flight narrow = fly(opening, 1, &map);
  EXPECT_TRUE(narrow.through);
  put({58, 0, 4});
  const Flight blocked = fly(opening, 1, &map);
  EXPECT_EQ(blocked.phase, ApproachPhase::kTurnAway);
  EXPECT_GT(blocked.nearest_m, HelixConfig().clearance_m);
}

// By all the path's points and all voxels. ledger: S5-47
TEST(FirstOccupied, AgreesWithBruteForce) {
  Random random(4);
  const SpacePath path([](double t) { return EllipticHelix{6, 4, 2}.at(t); }, 0, 5);
  int found = 0;
  for (int trial = 0; trial < 60; ++trial) {
    VoxelMap map({0.5, 0.5, 0.98, 0.2, 6.9});
    const double s = random.uniform(1, 30);
    const double y = random.uniform(-2.5, 2.5);
    const double z = random.uniform(-2.5, 2.5);
    const VoxelIndex v = map.voxel_at(path.frame_at(s).p_W + Vector3d(0, y, z));
    map.layer("any").add(v, to_evidence(6));
    double nearest = INFINITY, where = 0;
    for (double at = 0; at <= path.length(); at += 0.02) {
      const double off = (path.frame_at(at).p_W - map.centre_of(v)).norm();
      if (off < nearest) {
        nearest = off;
        where = at;
      }
    }
    const auto first = first_occupied(map, path, 1);
    const double reach = 1 + 0.25 * std::sqrt(3.0);
    if (nearest < reach - 0.05) {
      ASSERT_TRUE(first.has_value());
      EXPECT_LE(*first, where + 0.5);
      ++found;
    }
    if (nearest > reach) {
      EXPECT_FALSE(first.has_value());
    }
  }
  EXPECT_GT(found, 5);
}

TEST(HelixPlanner, RefusesWhatMakesNoSense) {
  EXPECT_THROW(HelixPlanner({}, {}, 0, {0, 0, 4}, ahead(60)), Error);
  EXPECT_THROW(HelixPlanner({}, {}, 1, {60, 0, 4}, ahead(60)), Error);
}

}  // namespace
}  // namespace isobath
