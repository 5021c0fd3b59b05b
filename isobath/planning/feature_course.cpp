#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/geometry/polygon.hpp>
#include <isobath/geometry/segment.hpp>
#include <isobath/planning/feature_course.hpp>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Line = std::vector<Vector2d>;

Vector2d starboard(const Vector2d& u) { return {-u.y(), u.x()}; }

double distance(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  return (nearest_on_segment(a, b, p) - p).norm();
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
      near = near || distance_from_line(line, raw[j - 1]) < std::abs(offset) - chord;
      const auto x = crossing(raw[i], raw[i + 1], raw[j], raw[j + 1]);
      if (x && (near || distance_from_line(line, raw[j]) < std::abs(offset) - chord)) cut = {j, *x};
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

/// The ends of pieces by place: those within `tolerance_m` of a point are in its cell or beside it.
class EndsOfPieces {
 public:
  struct End {
    std::size_t piece = 0;
    bool last = false;  ///< the piece is to be followed from its last point to its first
  };

  EndsOfPieces(const std::vector<Line>& pieces, double tolerance_m)
      : pieces_(pieces), tolerance_m_(tolerance_m), cell_m_(std::max(tolerance_m, 1e-3)) {
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      ends_[cell_of(pieces[i].front())].push_back({i, false});
      ends_[cell_of(pieces[i].back())].push_back({i, true});
    }
  }

  /// The free end at which the straightest piece begins that continues a line; empty if there is none.
  [[nodiscard]] std::optional<End> continuing(const Line& line, const std::vector<bool>& used) const {
    const Vector2d& end = line.back();
    const Vector2d along = end - line[line.size() - 2];
    std::optional<End> best;
    double best_cosine = -2;
    for (int north = -1; north <= 1; ++north) {
      for (int east = -1; east <= 1; ++east) {
        const auto found = ends_.find(cell_of(end + cell_m_ * Vector2d(north, east)));
        if (found == ends_.end()) continue;
        for (const End& candidate : found->second) {
          const Line& piece = pieces_[candidate.piece];
          const Vector2d& from = candidate.last ? piece.back() : piece.front();
          if (used[candidate.piece] || (from - end).norm() > tolerance_m_) continue;
          const Vector2d way = (candidate.last ? piece[piece.size() - 2] : piece[1]) - end;
          const double lengths = along.norm() * way.norm();
          const double cosine = lengths > 0 ? along.dot(way) / lengths : -1;
          const bool earlier = best && cosine == best_cosine && candidate.piece < best->piece;
          if (cosine <= best_cosine && !earlier) continue;
          best_cosine = cosine;
          best = candidate;
        }
      }
    }
    return best;
  }

 private:
  using Cell = std::pair<std::int64_t, std::int64_t>;
  [[nodiscard]] Cell cell_of(const Vector2d& p) const {
    return {std::llround(std::floor(p.x() / cell_m_)), std::llround(std::floor(p.y() / cell_m_))};
  }

  const std::vector<Line>& pieces_;
  double tolerance_m_, cell_m_;
  std::map<Cell, std::vector<End>> ends_;
};

struct Foot {
  std::size_t segment = 0;
  Vector2d at;
  double along_m = 0;  ///< from the start of the line
};

Foot foot_on(std::span<const Vector2d> line, const Vector2d& p) {
  Foot best{0, line.front(), 0};
  double nearest = (p - line.front()).norm(), along = 0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vector2d foot = nearest_on_segment(line[i], line[i + 1], p);
    if ((p - foot).norm() < nearest) {
      nearest = (p - foot).norm();
      best = {i, foot, along + (foot - line[i]).norm()};
    }
    along += (line[i + 1] - line[i]).norm();
  }
  return best;
}

double length_of(std::span<const Vector2d> line) {
  double length = 0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) length += (line[i + 1] - line[i]).norm();
  return length;
}

/// From one foot to another that lies at or behind it.
Line between(std::span<const Vector2d> line, const Foot& from, const Foot& to) {
  Line out{from.at};
  for (std::size_t i = from.segment + 1; i <= to.segment; ++i) out.push_back(line[i]);
  out.push_back(to.at);
  return without_repetition(out);
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

const char* to_text(CourseRefusal refusal) {
  switch (refusal) {
    case CourseRefusal::kNoFeature: return "it is a single point";
    case CourseRefusal::kNotFinite: return "it has a point that is not finite";
    case CourseRefusal::kTooLarge: return "it is too long for the map's pixels";
  }
  return "";
}

double distance_from_line(std::span<const Vector2d> line, const Vector2d& point) {
  double nearest = (line.front() - point).norm();
  for (std::size_t i = 0; i + 1 < line.size(); ++i) nearest = std::min(nearest, distance(point, line[i], line[i + 1]));
  return nearest;
}

std::vector<Vector2d> chain_lines(std::span<const Line> given, const Vector2d& start, double tolerance_m) {
  std::vector<Line> pieces;
  for (const Line& line : given) {
    Line piece = without_repetition(line);
    if (piece.size() >= 2) pieces.push_back(std::move(piece));
  }
  const auto nearest = std::min_element(pieces.begin(), pieces.end(), [&](const Line& a, const Line& b) {
    return distance_from_line(a, start) < distance_from_line(b, start);
  });
  if (nearest == pieces.end()) return {};
  std::vector<bool> used(pieces.size(), false);
  used[static_cast<std::size_t>(nearest - pieces.begin())] = true;
  const EndsOfPieces ends(pieces, tolerance_m);
  Line line = *nearest;
  for (int side = 0; side < 2; ++side) {
    while (const auto next = ends.continuing(line, used)) {
      const Line& piece = pieces[next->piece];
      used[next->piece] = true;
      if (next->last) {
        line.insert(line.end(), piece.rbegin() + 1, piece.rend());
      } else {
        line.insert(line.end(), piece.begin() + 1, piece.end());
      }
    }
    std::reverse(line.begin(), line.end());
  }
  if ((line.back() - start).norm() < (line.front() - start).norm()) std::reverse(line.begin(), line.end());
  if (line.size() > 3 && (line.back() - line.front()).norm() <= tolerance_m) line.back() = line.front();
  return line;
}

std::vector<Vector2d> part_of_line(std::span<const Vector2d> line, const Vector2d& from,
                                   const std::optional<Vector2d>& to) {
  if (line.size() < 2) return {line.begin(), line.end()};
  const Foot first = foot_on(line, from);
  const double length = length_of(line);
  if (line.front() == line.back()) {
    Line ring{first.at};  // turned so that it begins at the foot
    for (std::size_t i = 1; i < line.size(); ++i) ring.push_back(line[(first.segment + i) % (line.size() - 1)]);
    ring.push_back(first.at);
    ring = without_repetition(ring);
    if (!to) return ring;
    const Foot last = foot_on(ring, *to);
    if (last.along_m <= length / 2) return between(ring, {0, first.at, 0}, last);
    std::reverse(ring.begin(), ring.end());
    return between(ring, {0, first.at, 0}, foot_on(ring, *to));
  }
  const Foot end = {line.size() - 2, line.back(), length};
  const Foot last = to ? foot_on(line, *to) : first.along_m <= length / 2 ? end : Foot{0, line.front(), 0};
  if (last.along_m >= first.along_m) return between(line, first, last);
  Line back = between(line, last, first);
  std::reverse(back.begin(), back.end());
  return back;
}

std::vector<Vector2d> simplified(std::span<const Vector2d> line, double tolerance_m) {
  if (line.size() < 3) return {line.begin(), line.end()};
  std::vector<bool> kept(line.size(), false);
  kept.front() = kept.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> parts{{0, line.size() - 1}};
  while (!parts.empty()) {
    const auto [first, last] = parts.back();
    parts.pop_back();
    std::size_t farthest = first;
    double most = tolerance_m;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double off = distance(line[i], line[first], line[last]);
      if (off <= most) continue;
      most = off;
      farthest = i;
    }
    if (farthest == first) continue;
    kept[farthest] = true;
    parts.emplace_back(first, farthest);
    parts.emplace_back(farthest, last);
  }
  Line out;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (kept[i]) out.push_back(line[i]);
  }
  return out;
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
