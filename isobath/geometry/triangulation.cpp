#include <algorithm>
#include <cmath>
#include <cstdint>
#include <isobath/base/error.hpp>
#include <isobath/geometry/dynamic_delaunay.hpp>
#include <isobath/geometry/exact_predicates.hpp>
#include <isobath/geometry/triangulation.hpp>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Triangle = Triangulation::Triangle;

int after(int k) { return k == 2 ? 0 : k + 1; }
int before(int k) { return k == 0 ? 2 : k - 1; }

/// Position along a Hilbert curve through 2^16 x 2^16 cells.
std::uint32_t hilbert(std::uint32_t x, std::uint32_t y) {
  std::uint32_t place = 0;
  for (std::uint32_t s = 1U << 15; s > 0; s >>= 1) {
    const std::uint32_t right = (x & s) ? 1 : 0, up = (y & s) ? 1 : 0;
    place += s * s * ((3 * right) ^ up);
    if (!up) {
      if (right) {
        x = 0xffffU - x;
        y = 0xffffU - y;
      }
      std::swap(x, y);
    }
  }
  return place;
}

std::vector<int> hilbert_order(const std::vector<Vector2d>& points, const Vector2d& low, double extent) {
  const double scale = extent > 0 ? 65535 / extent : 0;
  std::vector<std::pair<std::uint32_t, int>> keys(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector2d q = (points[i] - low) * scale;
    keys[i] = {hilbert(static_cast<std::uint32_t>(q.x()), static_cast<std::uint32_t>(q.y())), static_cast<int>(i)};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<int> order(points.size());
  std::transform(keys.begin(), keys.end(), order.begin(), [](const auto& k) { return k.second; });
  return order;
}

/// The triangles without a corner at infinity, with points by their place in `order`, which lists them as inserted.
std::vector<Triangle> finite_triangles(const DynamicDelaunay& grown, const std::vector<int>& order) {
  const auto all = grown.triangles();
  std::vector<int> renamed(all.size(), Triangulation::kNone);
  int count = 0;
  for (std::size_t t = 0; t < all.size(); ++t) {
    if (DynamicDelaunay::is_finite(all[t])) renamed[t] = count++;
  }
  std::vector<Triangle> kept(static_cast<std::size_t>(count));
  for (std::size_t t = 0; t < all.size(); ++t) {
    if (renamed[t] < 0) continue;
    Triangle& to = kept[static_cast<std::size_t>(renamed[t])];
    for (int k = 0; k < 3; ++k) {
      to.corner[k] = order[static_cast<std::size_t>(all[t].corner[k])];
      to.neighbour[k] = renamed[static_cast<std::size_t>(all[t].neighbour[k])];
    }
  }
  return kept;
}

[[noreturn]] void refuse(const char* problem) {
  throw Error(problem, {}, "three points or more that do not lie on one line");
}

}  // namespace

Triangulation::Triangulation(std::vector<Vector2d> points) : points_(std::move(points)) {
  if (points_.size() < 3) refuse("fewer than three points cannot be triangulated");
  Vector2d high = low_ = points_.front();
  for (const Vector2d& p : points_) {
    ISOBATH_ASSERT(p.allFinite() && p.cwiseAbs().maxCoeff() <= 1e9);
    low_ = low_.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const std::vector<int> order = hilbert_order(points_, low_, (high - low_).maxCoeff());
  DynamicDelaunay grown(static_cast<int>(points_.size()), DynamicDelaunay::Order::kNear);
  for (const int i : order) grown.insert(points_[static_cast<std::size_t>(i)], 0);
  if (grown.triangles().empty()) refuse("all points lie on one line");
  triangles_ = finite_triangles(grown, order);
  const Vector2d span = high - low_;
  cell_ = std::max(std::sqrt(4 * span.x() * span.y() / static_cast<double>(points_.size())), span.maxCoeff() / 1024);
  cells_x_ = 1 + static_cast<int>(span.x() / cell_);
  cells_y_ = 1 + static_cast<int>(span.y() / cell_);
  list_neighbours();
  list_starts();
}

void Triangulation::list_neighbours() {
  // each triangle gives each corner the next one; a corner on the hull has one more, after its last triangle
  std::vector<int> next_on_hull(points_.size(), kNone), previous_on_hull(points_.size(), kNone);
  first_.assign(points_.size() + 1, 0);
  int from = kNone;
  for (const Triangle& t : triangles_) {
    for (int k = 0; k < 3; ++k) {
      ++first_[static_cast<std::size_t>(t.corner[k]) + 1];
      if (t.neighbour[k] != kNone) continue;
      from = t.corner[after(k)];
      next_on_hull[static_cast<std::size_t>(from)] = t.corner[before(k)];
      previous_on_hull[static_cast<std::size_t>(t.corner[before(k)])] = from;
      ++first_[static_cast<std::size_t>(t.corner[before(k)]) + 1];
    }
  }
  for (std::size_t i = 0; i < points_.size(); ++i) first_[i + 1] += first_[i];
  around_.resize(static_cast<std::size_t>(first_.back()));
  std::vector<int> filled(first_.begin(), first_.end() - 1);
  const auto give = [&](int point, int other) {
    around_[static_cast<std::size_t>(filled[static_cast<std::size_t>(point)]++)] = other;
  };
  for (const Triangle& t : triangles_) {
    for (int k = 0; k < 3; ++k) give(t.corner[k], t.corner[after(k)]);
  }
  const int start = from;
  do {
    hull_.push_back(from);
    give(from, previous_on_hull[static_cast<std::size_t>(from)]);
    from = next_on_hull[static_cast<std::size_t>(from)];
  } while (from != start);
}

void Triangulation::list_starts() {
  starts_.assign(static_cast<std::size_t>(cells_x_) * static_cast<std::size_t>(cells_y_), kNone);
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const Vector2d c = (points_[static_cast<std::size_t>(triangles_[t].corner[0])] - low_) / cell_;
    starts_[static_cast<std::size_t>(c.x()) * static_cast<std::size_t>(cells_y_) + static_cast<std::size_t>(c.y())] =
        static_cast<int>(t);
  }
  int last = 0;
  for (int& start : starts_) last = start = start == kNone ? last : start;
}

std::span<const int> Triangulation::around(int point) const {
  const auto i = static_cast<std::size_t>(point);
  return std::span(around_).subspan(static_cast<std::size_t>(first_[i]),
                                    static_cast<std::size_t>(first_[i + 1] - first_[i]));
}

int Triangulation::start_for(const Vector2d& p) const {
  const Vector2d c = (p - low_) / cell_;
  const auto place = [](double at, int cells) {  // NaN maps to 0
    return static_cast<std::size_t>(at > 0 ? std::min(at, cells - 1.0) : 0.0);
  };
  const std::size_t x = place(c.x(), cells_x_), y = place(c.y(), cells_y_);
  return starts_[x * static_cast<std::size_t>(cells_y_) + y];
}

int Triangulation::triangle_at(const Vector2d& p) const { return triangle_at(p, start_for(p)); }

int Triangulation::triangle_at(const Vector2d& p, int start) const {
  if (!p.allFinite()) return kNone;
  int t = start;
  while (t != kNone) {
    const Triangle& here = triangles_[static_cast<std::size_t>(t)];
    int next = t;
    for (int k = 0; k < 3 && next == t; ++k) {
      if (orientation(points_[static_cast<std::size_t>(here.corner[after(k)])],
                      points_[static_cast<std::size_t>(here.corner[before(k)])], p) < 0) {
        next = here.neighbour[k];
      }
    }
    if (next == t) return t;
    t = next;
  }
  return kNone;
}

Eigen::Vector3d Triangulation::barycentric(int triangle, const Vector2d& p) const {
  const auto& corner = triangles_[static_cast<std::size_t>(triangle)].corner;
  const Vector2d& a = points_[static_cast<std::size_t>(corner[0])];
  const Vector2d u = points_[static_cast<std::size_t>(corner[1])] - a;
  const Vector2d v = points_[static_cast<std::size_t>(corner[2])] - a;
  const Vector2d q = p - a;
  const double whole = cross(u, v);
  const double second = cross(q, v) / whole, third = cross(u, q) / whole;
  return {1 - second - third, second, third};
}

int Triangulation::nearest_point(const Vector2d& p) const {
  int best = triangles_[static_cast<std::size_t>(start_for(p))].corner[0];
  double best2 = (points_[static_cast<std::size_t>(best)] - p).squaredNorm();
  for (bool nearer = true; nearer;) {  // a point with no nearer neighbour is the nearest: its Voronoi cell contains p
    nearer = false;
    for (const int other : around(best)) {
      const double other2 = (points_[static_cast<std::size_t>(other)] - p).squaredNorm();
      if (other2 < best2) {
        best = other;
        best2 = other2;
        nearer = true;
      }
    }
  }
  return best;
}

}  // namespace isobath
