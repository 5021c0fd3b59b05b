#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/geometry/polygon.hpp>
#include <isobath/planning/feature_course.hpp>
#include <numbers>
#include <optional>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Line = std::vector<Vector2d>;

Vector2d starboard(const Vector2d& u) { return {-u.y(), u.x()}; }

double distance(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const double length2 = (b - a).squaredNorm();
  const double t = length2 > 0 ? std::clamp((p - a).dot(b - a) / length2, 0.0, 1.0) : 0;
  return (p - a - t * (b - a)).norm();
}

double distance(const Vector2d& p, std::span<const Vector2d> line) {
  double nearest = INFINITY;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) nearest = std::min(nearest, distance(p, line[i], line[i + 1]));
  return nearest;
}

Line without_repetition(std::span<const Vector2d> line) {
  Line out;
  for (const Vector2d& p : line) {
    if (out.empty() || (p - out.back()).norm() > 1e-9) out.push_back(p);
  }
  return out;
}

/// The joint at a corner between the unit directions before and behind it.
void add_joint(Line& out, const Vector2d& corner, const Vector2d& before, const Vector2d& behind, double shortest,
               double offset, double mitre_limit, double chord) {
  const Vector2d n0 = starboard(before), n1 = starboard(behind);
  const double turn = std::atan2(cross(before, behind), before.dot(behind));  // to starboard
  const double half = std::cos(turn / 2);
  const bool outside = turn * offset <= 0 || half < 1e-6;
  const bool mitre = outside ? half * mitre_limit >= 1 : std::abs(offset * std::tan(turn / 2)) <= shortest;
  if (mitre) {
    out.push_back(corner + (n0 + n1) * (offset / (1 + n0.dot(n1))));
  } else if (outside) {
    const double radius = std::abs(offset);
    const double step = radius > chord ? 2 * std::acos(1 - chord / radius) : 1.0;
    const double sweep_angle = half < 1e-6 ? -std::copysign(std::abs(turn), offset) : turn;
    const int parts = std::max(1, static_cast<int>(std::ceil(std::abs(sweep_angle) / step)));
    for (int i = 0; i <= parts; ++i) {
      const double angle = sweep_angle * i / parts;
      out.push_back(corner + offset * (std::cos(angle) * n0 + std::sin(angle) * starboard(n0)));
    }
  } else {  // the two offset legs cross before the corner: see without_loops
    out.push_back(corner + offset * n0);
    out.push_back(corner + offset * n1);
  }
}

std::optional<Vector2d> crossing(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  const double sine = cross(b - a, d - c);
  if (std::abs(sine) < 1e-12) return std::nullopt;
  const double s = cross(c - a, d - c) / sine, t = cross(c - a, b - a) / sine;
  if (s < 0 || s > 1 || t < 0 || t > 1) return std::nullopt;
  return Vector2d(a + s * (b - a));
}

/// Cuts off loops with points nearer to the line than the offset. A feature that crosses itself keeps its crossing: its
/// loop is longer than any that an offset makes.
Line without_loops(const Line& raw, std::span<const Vector2d> line, double offset, double chord) {
  Line out;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    out.push_back(raw[i]);
    if (i + 1 >= raw.size()) break;
    double length = (raw[i + 1] - raw[i]).norm();
    std::optional<std::pair<std::size_t, Vector2d>> cut;
    bool near = false;
    for (std::size_t j = i + 2; j + 1 < raw.size() && length < 4 * std::numbers::pi * std::abs(offset); ++j) {
      near = near || distance(raw[j - 1], line) < std::abs(offset) - chord;
      const auto x = crossing(raw[i], raw[i + 1], raw[j], raw[j + 1]);
      if (x && (near || distance(raw[j], line) < std::abs(offset) - chord)) cut = {j, *x};
      length += (raw[j] - raw[j - 1]).norm();
    }
    if (!cut) continue;
    out.push_back(cut->second);
    i = cut->first;
  }
  return out;
}

/// Maximum depth that the rule allows on a leg.
Result<double, CourseRefusal> safe_depth(const Vector2d& a, const Vector2d& b, const FeatureCourseConfig& config,
                                         const DepthField& map) {
  const std::array<Eigen::Vector3d, 2> leg = {Eigen::Vector3d(a.x(), a.y(), 0), Eigen::Vector3d(b.x(), b.y(), 0)};
  const auto swept = sweep(map.grid(), leg, config.half_width_m);
  if (!swept) return tl::unexpected(CourseRefusal::kTooLarge);
  double deepest = config.max_depth_m;
  for (const SweptPixel& s : *swept) {
    const DepthPixel p = map.at(s.pixel);
    deepest = std::min(deepest, p.known() ? p.depth_m() - config.altitude_m : config.unknown_depth_m);
  }
  return std::max(0.0, deepest);
}

Line divided(const Line& course, double leg_m) {
  Line out = {course.front()};
  for (std::size_t i = 0; i + 1 < course.size(); ++i) {
    const Vector2d leg = course[i + 1] - course[i];
    const int parts = std::max(1, static_cast<int>(std::ceil(std::min(leg.norm() / leg_m, 1e6))));
    for (int k = 1; k <= parts; ++k) out.push_back(course[i] + leg * (static_cast<double>(k) / parts));
  }
  return out;
}

/// For each way-point a depth that its leg and the next allow, and from which the vehicle can climb by the end of the
/// next.
Result<std::vector<double>, CourseRefusal> depths_over_bottom(const Line& course, const FeatureCourseConfig& config,
                                                              const DepthField& map) {
  std::vector<double> depths(course.size(), config.max_depth_m);
  for (std::size_t i = 0; i + 1 < course.size(); ++i) {
    const auto safe = safe_depth(course[i], course[i + 1], config, map);
    if (!safe) return tl::unexpected(safe.error());
    depths[i] = std::min(depths[i], *safe);
    depths[i + 1] = *safe;
  }
  for (std::size_t i = course.size() - 1; i > 0; --i) {
    depths[i - 1] = std::min(depths[i - 1], depths[i] + config.slope * (course[i] - course[i - 1]).norm());
  }
  return depths;
}

/// Moves from `rest` to the line the segment that best continues its end.
bool extend(Line& line, std::vector<FeatureSegment>& rest, double tolerance) {
  const Vector2d end = line.back(), along = end - line[line.size() - 2];
  std::size_t best = rest.size();
  double best_cosine = -2;
  Vector2d next = end;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    for (const bool turned : {false, true}) {
      const Vector2d &from = turned ? rest[i].b : rest[i].a, &to = turned ? rest[i].a : rest[i].b;
      if ((from - end).norm() > tolerance) continue;
      const double lengths = along.norm() * (to - end).norm();
      const double cosine = lengths > 0 ? along.dot(to - end) / lengths : -1;
      if (cosine <= best_cosine) continue;
      best_cosine = cosine;
      best = i;
      next = to;
    }
  }
  if (best == rest.size()) return false;
  rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(best));
  line.push_back(next);
  return true;
}

}  // namespace

std::vector<Field> fields(FeatureCourseConfig& c) {
  return {
      Field::real("offset_m", &c.offset_m, {-10000, 10000}, "m",
                  "Distance of the route to starboard of the feature; negative: to port."),
      Field::real("mitre_limit", &c.mitre_limit, {1, 10}, "1",
                  "Mitres that reach beyond this many offsets become round."),
      Field::real("chord_m", &c.chord_m, {0.001, 100}, "m", "How far a round joint may cut its arc short."),
      Field::real("speed", &c.speed, {0, 20}, "m/s", "Speed along the route."),
      Field::choice("rule", &c.rule, {{"constant", DepthRule::kConstant}, {"altitude", DepthRule::kAltitude}},
                    "Constant depth, or altitude above the bottom."),
      Field::real("depth_m", &c.depth_m, {0, 11000}, "m", "Constant depth."),
      Field::real("altitude_m", &c.altitude_m, {0, 1000}, "m", "Altitude above the shallowest bottom of a leg."),
      Field::real("max_depth_m", &c.max_depth_m, {0, 11000}, "m", "Maximum depth."),
      Field::real("unknown_depth_m", &c.unknown_depth_m, {0, 11000}, "m", "Maximum depth over unknown bottom."),
      Field::real("half_width_m", &c.half_width_m, {0, 1000}, "m",
                  "Half the width of the corridor whose bottom counts."),
      Field::real("slope", &c.slope, {0.001, 10}, "1", "Maximum climb, metres per metre of route."),
      Field::real("leg_m", &c.leg_m, {0.1, 10000}, "m", "Longer legs are divided to follow the bottom."),
  };
}

std::vector<Vector2d> chain_segments(std::span<const FeatureSegment> segments, const Vector2d& start,
                                     double tolerance_m) {
  std::vector<FeatureSegment> rest(segments.begin(), segments.end());
  const auto nearest = std::min_element(rest.begin(), rest.end(), [&](const auto& s, const auto& t) {
    return distance(start, s.a, s.b) < distance(start, t.a, t.b);
  });
  if (nearest == rest.end()) return {};
  Line line = {nearest->a, nearest->b};
  rest.erase(nearest);
  for (int ends = 0; ends < 2; ++ends) {
    while (extend(line, rest, tolerance_m)) {
    }
    std::reverse(line.begin(), line.end());
  }
  if ((line.back() - start).norm() < (line.front() - start).norm()) std::reverse(line.begin(), line.end());
  return line;
}

std::vector<Vector2d> offset_line(std::span<const Vector2d> line, double offset_m, double mitre_limit, double chord_m) {
  const Line clean = without_repetition(line);
  if (clean.size() < 2 || offset_m == 0) return clean;
  Line raw;
  std::vector<Vector2d> along;
  for (std::size_t i = 0; i + 1 < clean.size(); ++i) along.push_back((clean[i + 1] - clean[i]).normalized());
  raw.push_back(clean.front() + offset_m * starboard(along.front()));
  for (std::size_t i = 1; i + 1 < clean.size(); ++i) {
    const double shortest = std::min((clean[i] - clean[i - 1]).norm(), (clean[i + 1] - clean[i]).norm());
    add_joint(raw, clean[i], along[i - 1], along[i], shortest / 2, offset_m, mitre_limit, chord_m);
  }
  raw.push_back(clean.back() + offset_m * starboard(along.back()));
  return without_repetition(without_loops(raw, clean, offset_m, chord_m));
}

Result<std::vector<Waypoint>, CourseRefusal> feature_course(std::span<const Vector2d> line,
                                                            const FeatureCourseConfig& config, const DepthField* map) {
  for (const Vector2d& p : line) {
    if (!p.allFinite()) return tl::unexpected(CourseRefusal::kNotFinite);
  }
  Line course = offset_line(line, config.offset_m, config.mitre_limit, config.chord_m);
  if (course.size() < 2) return tl::unexpected(CourseRefusal::kNoFeature);
  std::vector<double> depths(course.size(), config.depth_m);
  if (config.rule == DepthRule::kAltitude) {
    ISOBATH_ASSERT(map != nullptr);
    course = divided(course, config.leg_m);
    auto over_bottom = depths_over_bottom(course, config, *map);
    if (!over_bottom) return tl::unexpected(over_bottom.error());
    depths = std::move(*over_bottom);
  }
  std::vector<Waypoint> waypoints;
  for (std::size_t i = 0; i < course.size(); ++i) {
    waypoints.push_back({course[i].x(), course[i].y(), depths[i], config.speed});
  }
  return waypoints;
}

}  // namespace isobath
