#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/geometry/segment.hpp>
#include <isobath/planning/corridor.hpp>
#include <isobath/planning/hazard_map.hpp>
#include <utility>

namespace isobath {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

constexpr double kTouch = 1e-9;    // m: shapes that touch count as meeting
constexpr double kFarthest = 1e7;  // m

/// Whether the insides of both segments cross at a point; segments that only touch are found by the distances of their
/// ends.
bool cross_each_other(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  const Vector2d ab = b - a, cd = d - c;
  const bool c_left = cross(ab, c - a) > 0, d_left = cross(ab, d - a) > 0;
  const bool a_left = cross(cd, a - c) > 0, b_left = cross(cd, b - c) > 0;
  return c_left != d_left && a_left != b_left;
}

/// Lower bound of the distance from a point to anything in a box; minus infinity for a point in the box.
double bound_of(const AlignedBox2d& box, const Vector2d& p) {
  const double outside = box.exteriorDistance(p);
  return outside > 0 ? outside : -INFINITY;
}

/// The same for a leg.
struct LegBound {
  Vector2d a, normal;
  AlignedBox2d box;

  LegBound(const Vector2d& from, const Vector2d& to) : a(from), normal(from.y() - to.y(), to.x() - from.x()) {
    box.extend(from);
    box.extend(to);
    const double length = normal.norm();
    if (length > 0) normal /= length;
  }
  [[nodiscard]] double to(const AlignedBox2d& other) const {
    const Vector2d half = other.sizes() / 2;
    const double aside = std::abs(normal.dot(other.center() - a)) - normal.cwiseAbs().dot(half);
    const double apart = std::max(aside, box.exteriorDistance(other));
    return apart > 0 ? apart : -INFINITY;
  }
};

/// Where the leg first comes within `reach` of the outline, m from a.
std::optional<double> first_within(const Polygon& convex, const Vector2d& a, const Vector2d& b, double reach) {
  if (contains(convex, a)) return 0;
  std::optional<double> first;
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const auto stretch = within_reach_of_segment(a, b, convex[i], convex[(i + 1) % convex.size()], reach);
    if (stretch && (!first || stretch->from < *first)) first = stretch->from;
  }
  return first;
}

bool usable(const Hazard& h) {
  return !h.outline.empty() && std::abs(h.margin_m) <= kFarthest &&
         std::all_of(h.outline.begin(), h.outline.end(),
                     [](const Vector2d& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() <= kFarthest; });
}

}  // namespace

const char* to_text(HazardKind kind) {
  switch (kind) {
    case HazardKind::kSeen: return "seen";
    case HazardKind::kRemembered: return "remembered";
    case HazardKind::kCharted: return "charted";
    case HazardKind::kMapped: return "mapped";
    case HazardKind::kVoxels: return "voxels";
    case HazardKind::kFence: return "fence";
    case HazardKind::kInjected: return "injected";
    case HazardKind::kMoving: return "moving";
    case HazardKind::kVehicle: return "vehicle of the group";
    case HazardKind::kBlocked: return "blocked passage";
  }
  return "";
}

double signed_distance(const Polygon& convex, const Vector2d& p) {
  ISOBATH_ASSERT(!convex.empty());
  bool inside = convex.size() >= 3;
  double least2 = INFINITY;
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Vector2d& a = convex[i];
    const Vector2d& b = convex[i + 1 < convex.size() ? i + 1 : 0];
    if (cross(b - a, p - a) < 0) inside = false;
    least2 = std::min(least2, (nearest_on_segment(a, b, p) - p).squaredNorm());
  }
  return inside ? -std::sqrt(least2) : std::sqrt(least2);
}

LegDistance leg_distance(const Polygon& convex, const Vector2d& a, const Vector2d& b) {
  ISOBATH_ASSERT(!convex.empty());
  if (contains(convex, a)) return {0, a};
  double least2 = INFINITY;
  Vector2d place = convex.front();
  const auto offer = [&](const Vector2d& on_outline, const Vector2d& on_leg) {
    const double d2 = (on_outline - on_leg).squaredNorm();
    if (d2 >= least2) return;
    least2 = d2;
    place = on_outline;
  };
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Vector2d& c = convex[i];
    const Vector2d& d = convex[i + 1 < convex.size() ? i + 1 : 0];
    offer(c, nearest_on_segment(a, b, c));
    offer(nearest_on_segment(c, d, a), a);
    offer(nearest_on_segment(c, d, b), b);
    if (!cross_each_other(a, b, c, d)) continue;
    const Vector2d side = d - c;
    const double along = cross(c - a, side) / cross(b - a, side);
    return {0, a + std::clamp(along, 0.0, 1.0) * (b - a)};
  }
  return {std::sqrt(least2), place};
}

HazardMap::HazardMap(std::vector<Hazard> hazards) : hazards_(std::move(hazards)) {
  std::vector<AlignedBox2d> boxes;
  boxes.reserve(hazards_.size());
  for (std::size_t i = 0; i < hazards_.size(); ++i) {
    Hazard& h = hazards_[i];
    if (!usable(h)) {
      throw Error("hazard " + std::to_string(i) + " has no outline, or its outline or margin is not finite", {},
                  "one corner or more, within 1e7 m of the origin; margin within 1e7 m");
    }
    h.outline = convex_hull(std::move(h.outline));
    AlignedBox2d box;
    for (const Vector2d& p : h.outline) box.extend(p);
    const Vector2d grown = Vector2d::Constant(std::max(0.0, h.margin_m));
    boxes.emplace_back(box.min() - grown, box.max() + grown);
  }
  tree_ = BoxTree(boxes);
}

std::optional<HazardMap::Near> HazardMap::near(const Vector2d& p) const {
  if (hazards_.empty()) return std::nullopt;
  Near best{INFINITY, 0};
  tree_.visit([&](const AlignedBox2d& box) { return bound_of(box, p) <= best.distance_m; },
              [&](std::size_t i) {
                const double d = signed_distance(hazards_[i].outline, p) - hazards_[i].margin_m;
                if (d < best.distance_m || (d == best.distance_m && i < best.hazard)) best = {d, i};
              });
  return best;
}

double HazardMap::distance(const Vector2d& p) const {
  const auto found = near(p);
  return found ? found->distance_m : INFINITY;
}

std::optional<std::size_t> HazardMap::nearest(const Vector2d& p) const {
  const auto found = near(p);
  return found ? std::optional(found->hazard) : std::nullopt;
}

std::optional<std::size_t> HazardMap::holding(const Vector2d& p) const {
  std::optional<std::size_t> first;
  tree_.visit([&](const AlignedBox2d& box) { return box.contains(p); },
              [&](std::size_t i) {
                if (first && i >= *first) return;
                if (signed_distance(hazards_[i].outline, p) <= kTouch) first = i;
              });
  return first;
}

double HazardMap::leg_distance(const Vector2d& a, const Vector2d& b) const {
  double least = INFINITY;
  const LegBound bound(a, b);
  tree_.visit([&](const AlignedBox2d& box) { return bound.to(box) < least; },
              [&](std::size_t i) {
                least =
                    std::min(least, isobath::leg_distance(hazards_[i].outline, a, b).distance_m - hazards_[i].margin_m);
              });
  return least;
}

bool HazardMap::leg_is_clear(const Vector2d& a, const Vector2d& b, double clearance_m) const {
  bool clear = true;
  const LegBound bound(a, b);
  const double least = std::max(clearance_m, kTouch);
  tree_.visit([&](const AlignedBox2d& box) { return clear && bound.to(box) <= least; },
              [&](std::size_t i) {
                if (!clear) return;
                const double d = isobath::leg_distance(hazards_[i].outline, a, b).distance_m - hazards_[i].margin_m;
                clear = d >= clearance_m && d > kTouch;
              });
  return clear;
}

std::optional<Conflict> HazardMap::leg_conflict(const Vector2d& a, const Vector2d& b, double clearance_m) const {
  std::optional<Conflict> first;
  const LegBound bound(a, b);
  const double least = std::max(clearance_m, kTouch);
  tree_.visit([&](const AlignedBox2d& box) { return bound.to(box) <= least; },
              [&](std::size_t i) {
                const Hazard& h = hazards_[i];
                const LegDistance to = isobath::leg_distance(h.outline, a, b);
                const double d = to.distance_m - h.margin_m;
                if (d >= clearance_m && d > kTouch) return;
                const double along = first_within(h.outline, a, b, h.margin_m + least).value_or(0);
                const bool sooner = !first || along < first->along_m || (along == first->along_m && i < first->hazard);
                if (sooner) first = Conflict{0, along, d, i, to.place};
              });
  return first;
}

std::optional<Conflict> HazardMap::conflict(std::span<const Vector2d> way, double clearance_m) const {
  double before = 0;
  for (std::size_t i = 0; i < way.size(); ++i) {
    if (i + 1 == way.size() && i > 0) break;
    const Vector2d& to = way[std::min(i + 1, way.size() - 1)];
    ISOBATH_ASSERT(way[i].allFinite() && to.allFinite());
    if (auto found = leg_conflict(way[i], to, clearance_m)) {
      found->leg = static_cast<int>(i);
      found->along_m += before;
      return found;
    }
    before += (to - way[i]).norm();
  }
  return std::nullopt;
}

}  // namespace isobath
