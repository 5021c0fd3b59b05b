#include <algorithm>
#include <cmath>
#include <cstdint>
#include <isobath/base/error.hpp>
#include <isobath/geometry/exact_predicates.hpp>
#include <isobath/geometry/triangulation.hpp>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Triangle = Triangulation::Triangle;

constexpr int kInfinity = -1;  // the corner of the triangles outside the hull during growth

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

/// Whether p, which is on the line through a and b, lies strictly between them.
bool between(const Vector2d& a, const Vector2d& b, const Vector2d& p) {
  const int axis = a.x() != b.x() ? 0 : 1;
  return std::min(a[axis], b[axis]) < p[axis] && p[axis] < std::max(a[axis], b[axis]);
}

/// Builds the triangulation point by point. Triangles with a corner at infinity cover the outside of the hull, so that
/// every side has two triangles and there are no special cases.
class Growth {
 public:
  explicit Growth(const std::vector<Vector2d>& points) : points_(points), spoke_(points.size() + 1, -1) {
    triangles_.reserve(2 * points.size() + 4);
  }
  void start(int a, int b, int c);
  void insert(int p);
  /// The triangles without a corner at infinity.
  [[nodiscard]] std::vector<Triangle> finite() const;

 private:
  [[nodiscard]] bool holds_infinity(const Triangle& t) const {
    return t.corner[0] == kInfinity || t.corner[1] == kInfinity || t.corner[2] == kInfinity;
  }
  [[nodiscard]] int walk(const Vector2d& p) const;
  [[nodiscard]] bool in_conflict(const Triangle& t, const Vector2d& p) const;
  void dig(int seed, const Vector2d& p);
  void fill(int p);
  [[nodiscard]] const Vector2d& at(int point) const { return points_[static_cast<std::size_t>(point)]; }
  [[nodiscard]] int& spoke(int point) { return spoke_[static_cast<std::size_t>(point) + 1]; }

  struct Rim {  ///< a side of the hole, seen from inside
    int a, b;
    int outside;
  };
  const std::vector<Vector2d>& points_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint8_t> dug_;
  std::vector<int> hole_;  ///< triangles whose circles contain the point
  std::vector<Rim> rim_;
  std::vector<int> spoke_;  ///< by corner of the rim: the new triangle whose side on the rim starts there
  int last_ = 0;            ///< a finite triangle near the last point
};

void Growth::start(int a, int b, int c) {
  if (orientation(at(a), at(b), at(c)) < 0) std::swap(b, c);
  triangles_ = {{{a, b, c}, {2, 3, 1}},           //
                {{b, a, kInfinity}, {3, 2, 0}},   // beyond side a b
                {{c, b, kInfinity}, {1, 3, 0}},   // beyond side b c
                {{a, c, kInfinity}, {2, 1, 0}}};  // beyond side c a
  dug_.assign(4, 0);
}

/// Walks towards p across the sides that separate it from p; in a Delaunay triangulation this always ends.
int Growth::walk(const Vector2d& p) const {
  int t = last_;
  while (true) {
    const Triangle& here = triangles_[static_cast<std::size_t>(t)];
    if (holds_infinity(here)) return t;
    int next = -1;
    for (int k = 0; k < 3 && next < 0; ++k) {
      if (orientation(at(here.corner[after(k)]), at(here.corner[before(k)]), p) < 0) next = here.neighbour[k];
    }
    if (next < 0) return t;
    t = next;
  }
}

bool Growth::in_conflict(const Triangle& t, const Vector2d& p) const {
  for (int k = 0; k < 3; ++k) {
    if (t.corner[k] != kInfinity) continue;
    const Vector2d &a = at(t.corner[after(k)]), &b = at(t.corner[before(k)]);
    const double side = orientation(a, b, p);
    return side > 0 || (side == 0 && between(a, b, p));
  }
  return in_circle(at(t.corner[0]), at(t.corner[1]), at(t.corner[2]), p) > 0;
}

void Growth::dig(int seed, const Vector2d& p) {
  hole_.assign(1, seed);
  rim_.clear();
  dug_[static_cast<std::size_t>(seed)] = 1;
  for (std::size_t i = 0; i < hole_.size(); ++i) {
    const Triangle here = triangles_[static_cast<std::size_t>(hole_[i])];
    for (int k = 0; k < 3; ++k) {
      const int other = here.neighbour[k];
      if (dug_[static_cast<std::size_t>(other)]) continue;
      if (in_conflict(triangles_[static_cast<std::size_t>(other)], p)) {
        dug_[static_cast<std::size_t>(other)] = 1;
        hole_.push_back(other);
      } else {
        rim_.push_back({here.corner[after(k)], here.corner[before(k)], other});
      }
    }
  }
}

/// Makes a fan of triangles from the rim to p: two more than the hole had.
void Growth::fill(int p) {
  while (hole_.size() < rim_.size()) {
    hole_.push_back(static_cast<int>(triangles_.size()));
    triangles_.push_back({});
    dug_.push_back(0);
  }
  for (std::size_t i = 0; i < rim_.size(); ++i) {
    const Rim& side = rim_[i];
    const int id = hole_[i];
    triangles_[static_cast<std::size_t>(id)] = {{side.a, side.b, p}, {-1, -1, side.outside}};
    dug_[static_cast<std::size_t>(id)] = 0;
    spoke(side.a) = id;
    Triangle& outside = triangles_[static_cast<std::size_t>(side.outside)];
    for (int k = 0; k < 3; ++k) {
      if (outside.corner[after(k)] == side.b && outside.corner[before(k)] == side.a) outside.neighbour[k] = id;
    }
    if (side.a != kInfinity && side.b != kInfinity) last_ = id;
  }
  for (std::size_t i = 0; i < rim_.size(); ++i) {
    const int next = spoke(rim_[i].b);
    triangles_[static_cast<std::size_t>(hole_[i])].neighbour[0] = next;
    triangles_[static_cast<std::size_t>(next)].neighbour[1] = hole_[i];
  }
}

void Growth::insert(int p) {
  const int seed = walk(at(p));
  for (const int corner : triangles_[static_cast<std::size_t>(seed)].corner) {
    if (corner != kInfinity && at(corner) == at(p)) return;
  }
  dig(seed, at(p));
  fill(p);
}

std::vector<Triangle> Growth::finite() const {
  std::vector<int> renamed(triangles_.size(), Triangulation::kNone);
  int count = 0;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    if (!holds_infinity(triangles_[t])) renamed[t] = count++;
  }
  std::vector<Triangle> kept(static_cast<std::size_t>(count));
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    if (renamed[t] < 0) continue;
    Triangle& to = kept[static_cast<std::size_t>(renamed[t])] = triangles_[t];
    for (int& n : to.neighbour) n = renamed[static_cast<std::size_t>(n)];
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
  const auto at = [&](std::size_t i) -> const Vector2d& { return points_[static_cast<std::size_t>(order[i])]; };
  std::size_t second = 1;
  while (second < order.size() && at(second) == at(0)) ++second;
  std::size_t third = second + 1;
  while (third < order.size() && orientation(at(0), at(second), at(third)) == 0) ++third;
  if (third >= order.size()) refuse("all points lie on one line");
  Growth growth(points_);
  growth.start(order[0], order[second], order[third]);
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (i != second && i != third) growth.insert(order[i]);
  }
  triangles_ = growth.finite();
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
