#include <algorithm>
#include <isobath/geometry/polygon.hpp>
#include <isobath/studies/traffic_gaps.hpp>
#include <limits>
#include <numeric>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kApart_m = 5;
constexpr int kSide = -1;  // label of the points on the sides of the field
constexpr int kSidePoints = 100;

struct Gap {
  double width_m;
  int triangle, other;
};

}  // namespace

TrafficGaps::TrafficGaps(const TrafficScene& scene) : kinetic_(static_cast<int>(scene.discs().size()) + kSidePoints) {
  const Eigen::AlignedBox2d field = TrafficScene::field();
  for (double x = field.min().x(); x <= field.max().x(); x += kApart_m) {
    for (const double y : {field.min().y(), field.max().y()}) kinetic_.insert({x, y}, Vector2d::Zero(), kSide);
  }
  radius_m_.assign(static_cast<std::size_t>(kinetic_.triangulation().size()), 0);
  int label = 0;
  for (const MovingBody& disc : scene.discs()) {
    points_.push_back(kinetic_.insert(disc.p_W, disc.velocity_W, label++));
    velocities_.push_back(disc.velocity_W);
    radius_m_.push_back(disc.radius_m);
  }
}

void TrafficGaps::follow(const TrafficScene& scene) {
  kinetic_.advance(to_seconds(scene.now()));
  flips_ += static_cast<std::int64_t>(kinetic_.flips().size());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const MovingBody& disc = scene.discs()[i];
    if (disc.velocity_W == velocities_[i]) continue;
    kinetic_.set_motion(points_[i], disc.p_W, disc.velocity_W);
    velocities_[i] = disc.velocity_W;
  }
}

int TrafficGaps::triangle_at(const Vector2d& p) const {
  const DynamicDelaunay& all = kinetic_.triangulation();
  const auto triangles = all.triangles();
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!DynamicDelaunay::is_finite(triangles[t])) continue;
    const auto& corner = triangles[t].corner;
    bool inside = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector2d &a = all.at(corner[k]), &b = all.at(corner[(k + 1) % 3]);
      inside = inside && cross(Vector2d(b - a), Vector2d(p - a)) >= 0;
    }
    if (inside) return static_cast<int>(t);
  }
  return DynamicDelaunay::kNone;
}

double TrafficGaps::widest_m(const Vector2d& from, const Vector2d& to) const {
  const DynamicDelaunay& all = kinetic_.triangulation();
  const auto triangles = all.triangles();
  const int first = triangle_at(from), last = triangle_at(to);
  if (first == DynamicDelaunay::kNone || last == DynamicDelaunay::kNone) return 0;
  if (first == last) return std::numeric_limits<double>::infinity();
  std::vector<Gap> gaps;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!DynamicDelaunay::is_finite(triangles[t])) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const int other = triangles[t].neighbour[k];
      if (other < static_cast<int>(t) || !DynamicDelaunay::is_finite(triangles[static_cast<std::size_t>(other)]))
        continue;
      const auto a = static_cast<std::size_t>(triangles[t].corner[(k + 1) % 3]);
      const auto b = static_cast<std::size_t>(triangles[t].corner[(k + 2) % 3]);
      const double apart = (all.at(static_cast<int>(a)) - all.at(static_cast<int>(b))).norm();
      gaps.push_back({apart - radius_m_[a] - radius_m_[b], static_cast<int>(t), other});
    }
  }
  std::ranges::sort(gaps, std::greater{}, &Gap::width_m);
  std::vector<int> group(triangles.size());
  std::iota(group.begin(), group.end(), 0);
  const auto group_of = [&](int t) {
    while (group[static_cast<std::size_t>(t)] != t) {
      int& up = group[static_cast<std::size_t>(t)];
      up = group[static_cast<std::size_t>(up)];
      t = up;
    }
    return t;
  };
  for (const Gap& gap : gaps) {
    group[static_cast<std::size_t>(group_of(gap.triangle))] = group_of(gap.other);
    if (group_of(first) == group_of(last)) return gap.width_m;
  }
  return 0;
}

}  // namespace isobath
