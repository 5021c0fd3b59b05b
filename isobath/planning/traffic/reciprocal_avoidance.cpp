#include <algorithm>
#include <cmath>
#include <isobath/geometry/polygon.hpp>
#include <isobath/planning/traffic/reciprocal_avoidance.hpp>
#include <limits>
#include <optional>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kParallel = 1e-9;

double slack_of(const HalfPlane& plane, const Vector2d& v) { return plane.normal.dot(v - plane.point); }

/// On the border of `plane`, within the disc of radius `limit` and the planes given: the point nearest to `aim`, or,
/// with `extreme`, the farthest in the direction `aim`.
std::optional<Vector2d> best_on_border(const HalfPlane& plane, std::span<const HalfPlane> planes, double limit,
                                       const Vector2d& aim, bool extreme) {
  const Vector2d along(-plane.normal.y(), plane.normal.x());
  const double middle = -plane.point.dot(along), off = plane.point.dot(plane.normal);
  if (off * off > limit * limit) return std::nullopt;
  const double half = std::sqrt(limit * limit - off * off);
  double low = middle - half, high = middle + half;
  for (const HalfPlane& other : planes) {
    const double rate = other.normal.dot(along), slack = slack_of(other, plane.point);
    if (std::abs(rate) < kParallel) {
      if (slack < 0) return std::nullopt;
      continue;
    }
    const double border = -slack / rate;
    (rate > 0 ? low : high) = rate > 0 ? std::max(low, border) : std::min(high, border);
    if (low > high) return std::nullopt;
  }
  const double best =
      extreme ? (aim.dot(along) > 0 ? high : low) : std::clamp((aim - plane.point).dot(along), low, high);
  return plane.point + best * along;
}

/// The linear programme, one half plane after the other. `solved`: number of half planes that the result fulfils.
Vector2d best_within(std::span<const HalfPlane> planes, double limit, const Vector2d& aim, bool extreme,
                     std::size_t& solved) {
  Vector2d best = extreme ? Vector2d(aim.normalized() * limit) : aim;
  if (best.norm() > limit) best *= limit / best.norm();
  for (solved = 0; solved < planes.size(); ++solved) {
    if (slack_of(planes[solved], best) >= 0) continue;
    const auto next = best_on_border(planes[solved], planes.first(solved), limit, aim, extreme);
    if (!next) return best;
    best = *next;
  }
  return best;
}

/// From a velocity that fulfils the first `solved` half planes to the one whose greatest violation is least.
Vector2d least_violation(std::span<const HalfPlane> planes, double limit, std::size_t solved, Vector2d best) {
  double violation = 0;
  std::vector<HalfPlane> equal;  // where each earlier half plane is violated no more than this one
  for (std::size_t i = solved; i < planes.size(); ++i) {
    if (-slack_of(planes[i], best) <= violation) continue;
    equal.clear();
    for (std::size_t j = 0; j < i; ++j) {
      const Vector2d difference = planes[j].normal - planes[i].normal;
      const double length = difference.norm();
      if (length < kParallel) continue;  // of the same direction
      const Vector2d normal = difference / length;
      const double offset = (planes[j].normal.dot(planes[j].point) - planes[i].normal.dot(planes[i].point)) / length;
      equal.push_back({offset * normal, normal});
    }
    std::size_t fulfilled = 0;
    const Vector2d next = best_within(equal, limit, planes[i].normal, true, fulfilled);
    if (fulfilled == equal.size()) best = next;
    violation = -slack_of(planes[i], best);
  }
  return best;
}

}  // namespace

HalfPlane avoidance_half_plane(const AvoidedDisc& own, const AvoidedDisc& other, const ReciprocalConfig& config) {
  const Vector2d to_other = other.p - own.p, relative = own.velocity - other.velocity;
  const double contact = own.radius_m + other.radius_m, distance2 = to_other.squaredNorm();
  const bool overlap = distance2 <= contact * contact;
  // The forbidden relative velocities: a cone about the direction to the other disc, cut off by a disc.
  const double horizon_s = overlap ? config.step_s : config.horizon_s;
  const Vector2d from_cut = relative - to_other / horizon_s;
  const double before = from_cut.dot(to_other), length2 = from_cut.squaredNorm();
  Vector2d normal, change;
  if (overlap || (before < 0 && before * before > contact * contact * length2)) {
    const double length = std::sqrt(length2);
    normal = length > 0 ? Vector2d(from_cut / length) : Vector2d(1, 0);
    change = (contact / horizon_s - length) * normal;
  } else {
    const double leg = std::sqrt(distance2 - contact * contact);
    const double side = cross(to_other, from_cut) > 0 ? 1 : -1;
    const Vector2d along = Vector2d(to_other.x() * leg - side * to_other.y() * contact,
                                    side * to_other.x() * contact + to_other.y() * leg) /
                           distance2;
    normal = side * Vector2d(-along.y(), along.x());
    change = relative.dot(along) * along - relative;
  }
  return {own.velocity + config.share * change, normal};
}

Vector2d reciprocal_velocity(const AvoidedDisc& own, const Vector2d& wanted, std::span<const AvoidedDisc> others,
                             const ReciprocalConfig& config) {
  std::vector<HalfPlane> planes;
  planes.reserve(others.size());
  for (const AvoidedDisc& other : others) planes.push_back(avoidance_half_plane(own, other, config));
  std::size_t solved = 0;
  const Vector2d best = best_within(planes, config.max_speed, wanted, false, solved);
  return solved == planes.size() ? best : least_violation(planes, config.max_speed, solved, best);
}

}  // namespace isobath
