#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/planning/helix.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;
using Jet = HelixPlanner::Jet;
using Shape = HelixPlanner::Shape;

// Arithmetic of numbers with three derivatives (Leibniz).
Jet operator+(const Jet& a, const Jet& b) { return {a.v + b.v, a.d1 + b.d1, a.d2 + b.d2, a.d3 + b.d3}; }
Jet operator-(const Jet& a, const Jet& b) { return {a.v - b.v, a.d1 - b.d1, a.d2 - b.d2, a.d3 - b.d3}; }
Jet operator+(const Jet& a, double b) { return {a.v + b, a.d1, a.d2, a.d3}; }
Jet operator*(double b, const Jet& a) { return {b * a.v, b * a.d1, b * a.d2, b * a.d3}; }
Jet operator*(const Jet& a, const Jet& b) {
  return {a.v * b.v, a.d1 * b.v + a.v * b.d1, a.d2 * b.v + 2 * a.d1 * b.d1 + a.v * b.d2,
          a.d3 * b.v + 3 * a.d2 * b.d1 + 3 * a.d1 * b.d2 + a.v * b.d3};
}
Jet operator/(const Jet& a, const Jet& b) {
  Jet q;
  q.v = a.v / b.v;
  q.d1 = (a.d1 - q.v * b.d1) / b.v;
  q.d2 = (a.d2 - 2 * q.d1 * b.d1 - q.v * b.d2) / b.v;
  q.d3 = (a.d3 - 3 * q.d2 * b.d1 - 3 * q.d1 * b.d2 - q.v * b.d3) / b.v;
  return q;
}
Jet root_of(const Jet& a) {
  Jet r;
  r.v = std::sqrt(a.v);
  r.d1 = a.d1 / (2 * r.v);
  r.d2 = (a.d2 - 2 * r.d1 * r.d1) / (2 * r.v);
  r.d3 = (a.d3 - 6 * r.d1 * r.d2) / (2 * r.v);
  return r;
}

/// a where it is above zero, else zero, smoothed over `width`.
Jet above_zero(const Jet& a, double width) { return 0.5 * (a + root_of(a * a + width * width)); }

/// Rises from 0 to 1 while t goes from 0 to 1, with three derivatives that are zero at both ends.
Jet smooth_rise(const Jet& t) {
  if (t.v <= 0) return {};
  if (t.v >= 1) return {1, 0, 0, 0};
  const Jet t2 = t * t;
  return t2 * t2 * (-20.0 * (t2 * t) + 70.0 * t2 + -84.0 * t + 35.0);
}

/// The polynomial of seventh degree that begins with `start` and vanishes, with three derivatives, from `length` on.
Jet fading(const Jet& start, const Jet& h, double length) {
  if (h.v >= length) return {};
  const Jet t = (1 / length) * h, rest = -1.0 * t + 1.0;
  const Jet t2 = t * t, h2 = h * h;
  const Jet bracket = start.v * (20.0 * (t2 * t) + 10.0 * t2 + 4.0 * t + 1.0) +
                      start.d1 * (h * (10.0 * t2 + 4.0 * t + 1.0)) + 0.5 * start.d2 * (h2 * (4.0 * t + 1.0)) +
                      start.d3 / 6 * (h2 * h);
  const Jet rest2 = rest * rest;
  return rest2 * rest2 * bracket;
}

/// A tan(atan(half / D) - half_beam), not below zero.
Jet amplitude_at(double half, const Jet& distance, double advance, double tan_half_beam) {
  constexpr double kRounding = 0.01;  // as a tangent: half a degree of swing
  const Jet tangent = (-tan_half_beam * distance + half) / (distance + half * tan_half_beam);
  return advance * above_zero(tangent, kRounding);
}

struct Offsets {
  Jet lateral, vertical;
};

/// Offsets beside and below the line, x metres along it.
Offsets nominal_at(const Shape& shape, double x) {
  const Jet along{x, 1, 0, 0};
  const Jet distance = -1.0 * along + shape.opening_x;
  // After the vehicle has left the helix, the helix no longer grows.
  const Jet held = above_zero(distance + -shape.leave, 2) + shape.leave;
  const Jet begun = smooth_rise((1 / shape.rise) * along);
  const Jet ended = smooth_rise((1 / shape.fall) * (along + (shape.leave - shape.opening_x)));
  const Jet share = shape.amplitude * (begun * (-1.0 * ended + 1.0));
  // Phase -pi/2 at the start: the view turns to starboard first.
  const double t = x / shape.advance, k = 1 / shape.advance;
  const Jet cosine{std::sin(t), k * std::cos(t), -k * k * std::sin(t), -k * k * k * std::cos(t)};
  const Jet sine{-std::cos(t), k * std::sin(t), k * k * std::cos(t), -k * k * k * std::sin(t)};
  const Jet lateral = amplitude_at(shape.half_width, held, shape.advance, shape.tan_half_beam);
  const Jet vertical = amplitude_at(shape.half_height, held, shape.advance, shape.tan_half_beam);
  return {share * lateral * cosine + shape.middle_y, -1.0 * (share * vertical * sine) + shape.middle_z};
}

Offsets offsets_at(const Shape& shape, double x) {
  Offsets o = nominal_at(shape, x);
  const Jet h{x - shape.from, 1, 0, 0};
  o.lateral = o.lateral + fading(shape.lateral_gap, h, shape.settle);
  o.vertical = o.vertical + fading(shape.vertical_gap, h, shape.settle);
  return o;
}

/// `next`, changed so that it begins where and as `last` is there.
Shape taking_over_from(const Shape& last, Shape next) {
  const Offsets old = offsets_at(last, next.from), nominal = nominal_at(next, next.from);
  next.lateral_gap = old.lateral - nominal.lateral;
  next.vertical_gap = old.vertical - nominal.vertical;
  return next;
}

CurveJet jet_of(const Shape& shape, double x) {
  const Offsets o = offsets_at(shape, x);
  return {{x, o.lateral.v, o.vertical.v},
          {1, o.lateral.d1, o.vertical.d1},
          {0, o.lateral.d2, o.vertical.d2},
          {0, o.lateral.d3, o.vertical.d3}};
}

void add_demand(PathDemand& demand, const CurveJet& jet, double speed) {
  const Vector3d t = jet.d1.normalized();
  const double level = t.head<2>().norm(), w2 = jet.d1.squaredNorm();
  const Vector3d bend = (jet.d2 - jet.d1.dot(jet.d2) / w2 * jet.d1) / w2;
  demand.swing = std::max(demand.swing, Angle::radians(std::abs(std::atan2(t.y(), t.x()))));
  demand.pitch = std::max(demand.pitch, Angle::radians(std::atan2(std::abs(t.z()), level)));
  demand.climb_rate = std::max(demand.climb_rate, speed * std::abs(t.z()));
  demand.turn_rate = std::max(demand.turn_rate, speed * bend.norm());
  const double turn = std::abs(t.x() * bend.y() - t.y() * bend.x()) / (level * level * level);
  if (turn > 0) demand.min_radius = std::min(demand.min_radius, 1 / turn);
}

PathDemand demand_of(const Shape& shape, double to, double speed) {
  PathDemand demand;
  for (double x = shape.from; x < to; x += 0.25) add_demand(demand, jet_of(shape, x), speed);
  return demand;
}

bool within(const PathDemand& d, const HelixConfig& config, const VehicleLimits& limits) {
  return d.swing <= config.max_swing && d.pitch <= config.max_pitch && d.turn_rate <= limits.max_yaw_rate.radians() &&
         d.climb_rate <= limits.max_climb_rate && d.min_radius >= limits.turning_radius;
}

}  // namespace

CurveJet EllipticHelix::at(double phase) const {
  const double c = std::cos(phase), s = std::sin(phase);
  return {{advance_m * phase, lateral_m * c, -vertical_m * s},
          {advance_m, -lateral_m * s, -vertical_m * c},
          {0, -lateral_m * c, vertical_m * s},
          {0, lateral_m * s, vertical_m * c}};
}

double EllipticHelix::metres_per_radian(double phase) const {
  return std::hypot(advance_m, lateral_m * std::sin(phase), vertical_m * std::cos(phase));
}

PathFrame EllipticHelix::frame(double phase) const {
  const double A = advance_m, B = lateral_m, C = vertical_m, c = std::cos(phase), s = std::sin(phase);
  const double w = metres_per_radian(phase);
  const double q2 = B * B * C * C + A * A * (C * C * s * s + B * B * c * c);
  ISOBATH_ASSERT(q2 > 0);
  const Vector3d tangent = Vector3d(A, -B * s, -C * c) / w;
  const Vector3d binormal = Vector3d(-B * C, -A * C * s, -A * B * c) / std::sqrt(q2);
  PathFrame frame;
  frame.p_W = {A * phase, B * c, -C * s};
  frame.R_WF << tangent, binormal.cross(tangent), binormal;
  frame.k1 = std::sqrt(q2) / (w * w * w);
  frame.torsion = -A * B * C / q2;  // in axes with z down (S5-E08)
  return frame;
}

double EllipticHelix::turn_m() const { return 2 * pi * advance_m; }

double EllipticHelix::way_m() const {
  // The trapezoidal rule is exact to rounding for a smooth periodic function.
  constexpr int kParts = 128;
  double sum = 0;
  for (int i = 0; i < kParts; ++i) sum += metres_per_radian(2 * pi * i / kParts);
  return 2 * pi * sum / kParts;
}

double EllipticHelix::max_curvature() const {
  const double A2 = advance_m * advance_m;
  return std::max(lateral_m / (A2 + vertical_m * vertical_m), vertical_m / (A2 + lateral_m * lateral_m));
}

Angle EllipticHelix::heading_swing() const { return Angle::radians(std::atan2(lateral_m, advance_m)); }
Angle EllipticHelix::pitch_swing() const { return Angle::radians(std::atan2(vertical_m, advance_m)); }

std::vector<Field> fields(HelixConfig& c) {
  return {
      Field::real("advance", &c.advance_m, {0.1, 100}, "m", "Advance of the helix per radian of its phase."),
      Field::degrees("half_beam_deg", &c.half_beam, {0, 45}, "Half the width of the common beam of both fans."),
      Field::degrees("max_swing_deg", &c.max_swing, {1, 80}, "Maximum swing of the heading off the approach line."),
      Field::degrees("max_pitch_deg", &c.max_pitch, {1, 80}, "Maximum pitch, up and down."),
      Field::real("rise", &c.rise_m, {0.5, 1000}, "m", "Length over which the helix begins."),
      Field::real("fall", &c.fall_m, {0.5, 1000}, "m", "Length over which the helix ends."),
      Field::real("settle", &c.settle_m, {0.5, 1000}, "m", "Length over which a new plan takes over from the old one."),
      Field::real("reaction", &c.reaction_s, {0, 60}, "s",
                  "Time from an echo until it is believed and the vehicle is on a new heading."),
      Field::real("clearance", &c.clearance_m, {0, 100}, "m", "Distance from the opening's plane when turning away."),
      Field::real("pass_share", &c.pass_share, {0, 1}, "1",
                  "Share of the opening from which on it counts as known to be free."),
      Field::real("margin", &c.margin_m, {0, 100}, "m", "Free water round the hull that is required to go through.")};
}

double latest_decision_m(const HelixConfig& config, const VehicleParameters& parameters, double speed) {
  const double radius = std::max(parameters.limits.turning_radius, speed / parameters.limits.max_yaw_rate.radians());
  return radius * (1 + sin(config.max_swing)) + speed * config.reaction_s + config.clearance_m;
}

HelixPlanner::HelixPlanner(const HelixConfig& config, const VehicleParameters& parameters, double speed,
                           const Vector3d& start_W, const Opening& opening)
    : config_(config), parameters_(parameters), speed_(speed), latest_m_(latest_decision_m(config, parameters, speed)) {
  if (!(speed > 0)) throw Error("a helix needs a forward speed", {}, "above 0 m/s");
  const Eigen::Vector2d way = (opening.X_WO.translation - start_W).head<2>();
  if (!(way.norm() > 1)) throw Error("the opening must lie ahead of the start of its approach", {}, "1 m or more");
  const Rotation R_WL = Rotation::from_heading(Angle::radians(std::atan2(way.y(), way.x())));
  X_WL_ = {R_WL, start_W};
  last_ = Shape{config.advance_m,
                std::tan(config.half_beam.radians()),
                0,
                0,
                0,
                0,
                0,
                0,
                config.rise_m,
                config.fall_m,
                0,
                0,
                config.settle_m,
                {},
                {}};
}

double HelixPlanner::phase(double along_m) const { return along_m / config_.advance_m - pi / 2; }

HelixPlan HelixPlanner::plan(const Opening& opening, double along_m, double amplitude, double beyond_m) {
  const Vector3d middle = X_WL_.inverse() * opening.X_WO.translation;
  Shape shape = last_;
  shape.opening_x = middle.x();
  shape.middle_y = middle.y();
  shape.middle_z = middle.z();
  shape.half_width = 0.5 * opening.width_m;
  shape.half_height = std::max(0.0, 0.5 * opening.height_m);
  shape.amplitude = std::clamp(amplitude, 0.0, 1.0);
  shape.from = along_m;
  shape.settle = config_.settle_m;
  const double distance = middle.x() - along_m;

  shape.leave = left_ ? last_.leave : std::min(latest_m_, distance);
  // The whole path with its end counts: the nearest place to leave the helix is found by trial.
  const auto fits = [&] {
    const Shape tried = taking_over_from(last_, shape);
    return within(demand_of(tried, tried.opening_x + beyond_m, speed_), config_, parameters_.limits);
  };
  while (!left_ && shape.leave < distance && !fits()) shape.leave = std::min(shape.leave + 0.25, distance);

  last_ = taking_over_from(last_, shape);
  const Shape planned = last_;
  const Pose X_WL = X_WL_;
  SpacePath path([planned, X_WL](double x) { return X_WL * jet_of(planned, x); }, planned.from,
                 planned.opening_x + beyond_m);
  const PathDemand demand = demand_of(planned, planned.opening_x + beyond_m, speed_);
  return {std::move(path), planned.leave, demand, within(demand, config_, parameters_.limits)};
}

}  // namespace isobath
