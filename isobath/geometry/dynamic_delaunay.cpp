#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/geometry/dynamic_delaunay.hpp>
#include <isobath/geometry/exact_predicates.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kFarthestPoint = 1e9;
constexpr int kSampled = 256;         // with more points than this a sample of them is kept
constexpr std::uint32_t kShare = 32;  // one in so many points is in the sample

bool is_in_sample(int point) { return (static_cast<std::uint32_t>(point) * 2654435761U >> 16) % kShare == 0; }

void check_finite(const Vector2d& at) {
  if (at.allFinite() && at.cwiseAbs().maxCoeff() <= kFarthestPoint) return;
  throw Error("a point of a triangulation is not finite or too far away", {}, "coordinates within 1e9 of the origin");
}

}  // namespace

DynamicDelaunay::DynamicDelaunay(int max_points, Order order) : max_points_(max_points) {
  if (max_points < 1 || max_points > 100'000'000) {
    throw Error("the maximum number of points of a triangulation is out of range", {}, "1 to 1e8");
  }
  const std::size_t count = index(max_points);
  points_.reserve(count);
  free_points_.reserve(count);
  triangles_.reserve(2 * count + 4);
  free_triangles_.reserve(2 * count + 4);
  row_.reserve(count);
  rim_.reserve(count);
  gaps_.reserve(count);
  edges_.reserve(256);
  changed_.reserve(256);
  around_.reserve(256);
  if (max_points > kSampled && order == Order::kAny) coarse_ = std::make_unique<DynamicDelaunay>(max_points / 16);
}

int DynamicDelaunay::insert(const Vector2d& at, int label) {
  check_finite(at);
  if (live_ >= max_points_)
    throw Error("a triangulation is full", {}, "no more points than stated at its construction");
  int id = static_cast<int>(points_.size());
  if (free_points_.empty()) {
    points_.emplace_back();
  } else {
    id = free_points_.back();
    free_points_.pop_back();
  }
  Point& p = points_[index(id)];
  p = Point{at, label, id, kNone, kNone, kNone, true};
  ++live_;
  changed_.clear();
  place(id);
  if (coarse_ && is_in_sample(id) && coarse_->live_ < coarse_->max_points_) p.coarse = coarse_->insert(at, id);
  return id;
}

void DynamicDelaunay::remove(int point) {
  ISOBATH_ASSERT(point >= 0 && index(point) < points_.size() && points_[index(point)].live);
  changed_.clear();
  take_out(point);
  Point& p = points_[index(point)];
  if (p.coarse != kNone) coarse_->remove(p.coarse);
  p.live = false;
  free_points_.push_back(point);
  --live_;
}

void DynamicDelaunay::move(int point, const Vector2d& to) {
  ISOBATH_ASSERT(point >= 0 && index(point) < points_.size() && points_[index(point)].live);
  check_finite(to);
  changed_.clear();
  Point& p = points_[index(point)];
  if (p.at == to) return;
  if (!shift(point, to)) {
    take_out(point);
    p.at = to;
    place(point);
  }
  if (p.coarse != kNone) coarse_->move(p.coarse, to);
}

/// The movement by flips; false where the point is on the hull, has twins, or would leave the polygon around it.
bool DynamicDelaunay::shift(int point, const Vector2d& to) {
  Point& p = points_[index(point)];
  if (triangles_.empty() || p.corner != point || p.twin != kNone) return false;
  for (const int t : around(point)) {
    const Triangle& here = tri(t);
    const int k = here.corner[0] == point ? 0 : here.corner[1] == point ? 1 : 2;
    const int a = here.corner[next_slot(k)], b = here.corner[previous_slot(k)];
    if (a == kNone || b == kNone || orientation(to, at(a), at(b)) <= 0) return false;
  }
  p.at = to;
  for (const int t : around_) {
    changed_.push_back(t);
    for (int k = 0; k < 3; ++k) edges_.emplace_back(t, k);
  }
  legalize();
  return true;
}

/// Gives all points new places at once. The triangles are kept, with flips, where none of them is turned over and the
/// hull stays convex; then the result is true. Else everything is inserted again.
bool DynamicDelaunay::place_all(std::span<const Vector2d> at_now) {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (points_[i].live) check_finite(at_now[i]);
  }
  bool valid = !triangles_.empty();
  for (std::size_t i = 0; i < points_.size(); ++i) points_[i].at = at_now[i];
  for (const Point& p : points_) valid = valid && (!p.live || p.at == at(p.corner));
  for (std::size_t i = 0; valid && i < triangles_.size(); ++i) {
    const Triangle& t = triangles_[i];
    if (is_finite(t)) {
      valid = orientation(at(t.corner[0]), at(t.corner[1]), at(t.corner[2])) > 0;
    } else if (t.corner[0] != kUnused) {
      const int k = t.corner[0] == kNone ? 0 : t.corner[1] == kNone ? 1 : 2;
      const int a = t.corner[next_slot(k)], b = t.corner[previous_slot(k)];
      const Triangle& beyond = tri(t.neighbour[next_slot(k)]);
      const int j = slot_of(t.neighbour[next_slot(k)], static_cast<int>(i));
      valid = !is_outside(at(a), at(b), at(beyond.corner[j]));
    }
  }
  if (!valid) {
    rebuild();
    return false;
  }
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    if (!is_finite(triangles_[i])) continue;
    for (int k = 0; k < 3; ++k) {
      if (triangles_[i].neighbour[k] > static_cast<int>(i)) edges_.emplace_back(static_cast<int>(i), k);
    }
  }
  legalize();
  for (const Point& p : points_) {
    if (p.live && p.coarse != kNone) coarse_->move(p.coarse, p.at);
  }
  return true;
}

void DynamicDelaunay::rebuild() {
  triangles_.clear();
  free_triangles_.clear();
  row_.clear();
  corners_ = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    points_[i].corner = static_cast<int>(i);
    points_[i].twin = points_[i].triangle = kNone;
  }
  for (Point& p : points_) {
    if (!p.live) continue;
    place(p.corner);
    if (p.coarse != kNone) coarse_->move(p.coarse, p.at);
  }
}

// --- insertion -------------------------------------------------------------------------------------------------------

/// Makes the point a corner, or the twin of one.
void DynamicDelaunay::place(int point) {
  const Vector2d& p = at(point);
  if (triangles_.empty()) {
    place_in_row(point);
    return;
  }
  const int t = walk(p, start_for(p));
  for (const int corner : tri(t).corner) {
    if (corner != kNone && at(corner) == p) {
      join(corner, point);
      return;
    }
  }
  ++corners_;
  split(t, point);
  legalize();
}

void DynamicDelaunay::join(int corner, int point) {
  Point& first = points_[index(corner)];
  Point& p = points_[index(point)];
  p.corner = corner;
  p.twin = first.twin;
  p.triangle = kNone;
  first.twin = point;
}

void DynamicDelaunay::place_in_row(int point) {
  const Vector2d& p = at(point);
  const auto less = [&](int a, const Vector2d& b) { return precedes(at(a), b); };
  const auto where = std::lower_bound(row_.begin(), row_.end(), p, less);
  if (where != row_.end() && at(*where) == p) {
    join(*where, point);
    return;
  }
  ++corners_;
  if (row_.size() < 2 || orientation(at(row_.front()), at(row_.back()), p) == 0) {
    row_.insert(where, point);
    return;
  }
  raise(point);
}

/// The first triangles: from each side of the row to the first point beside it. No circle holds another point, because
/// a circle through two neighbours of a row holds no other point of the row.
void DynamicDelaunay::raise(int point) {
  if (orientation(at(row_.front()), at(row_.back()), at(point)) < 0) std::reverse(row_.begin(), row_.end());
  const int sides = static_cast<int>(row_.size()) - 1;
  free_triangles_.clear();
  triangles_.resize(index(2 * sides + 2));
  const int left = 2 * sides, right = left + 1;  // the ghosts beside the point; side i has triangle i, ghost sides + i
  for (int i = 0; i < sides; ++i) {
    const int a = row_[index(i)], b = row_[index(i) + 1];
    const bool first = i == 0, last = i + 1 == sides;
    set(i, {a, b, point}, {last ? right : i + 1, first ? left : i - 1, sides + i});
    set(sides + i, {b, a, kNone}, {first ? left : sides + i - 1, last ? right : sides + i + 1, i});
  }
  set(right, {point, row_.back(), kNone}, {2 * sides - 1, left, sides - 1});
  set(left, {row_.front(), point, kNone}, {right, sides, 0});
  row_.clear();
  last_ = 0;
}

void DynamicDelaunay::split(int t, int point) {
  const Triangle old = tri(t);
  const int b = new_triangle(), c = new_triangle();
  const std::array<int, 3> part{t, b, c};
  std::array<int, 3> back{};
  for (int k = 0; k < 3; ++k) back[k] = slot_of(old.neighbour[k], t);
  for (int k = 0; k < 3; ++k) {
    set(part[k], {point, old.corner[next_slot(k)], old.corner[previous_slot(k)]},
        {old.neighbour[k], part[next_slot(k)], part[previous_slot(k)]});
    tri(old.neighbour[k]).neighbour[back[k]] = part[k];
    edges_.emplace_back(part[k], 0);
  }
  last_ = t;
}

/// Flips edges until all that are listed, and those that flips change, are legal.
void DynamicDelaunay::legalize() {
  while (!edges_.empty()) {
    const auto [t, k] = edges_.back();
    edges_.pop_back();
    const int n = tri(t).neighbour[k];
    const int c = tri(t).corner[k];
    bool illegal = false;
    if (c != kNone) {
      illegal = in_conflict(tri(n), at(c));
    } else {
      illegal = in_conflict(tri(t), at(tri(n).corner[slot_of(n, t)]));
    }
    if (!illegal || !flip(t, k)) continue;
    for (const int outer : {0, 2}) edges_.emplace_back(t, outer);
    for (const int outer : {0, 1}) edges_.emplace_back(n, outer);
  }
}

/// Replaces the side that faces corner k by the other diagonal, from that corner (then corner 0 of both triangles).
/// False, and nothing changed, where that is impossible.
bool DynamicDelaunay::flip(int t, int k) {
  const Triangle one = tri(t);
  const int n = one.neighbour[k];
  const int j = slot_of(n, t);
  const Triangle two = tri(n);
  const int c = one.corner[k], a = one.corner[next_slot(k)], b = one.corner[previous_slot(k)], d = two.corner[j];
  const int beyond_ad = two.neighbour[next_slot(j)], beyond_db = two.neighbour[previous_slot(j)];
  const int beyond_bc = one.neighbour[next_slot(k)], beyond_ca = one.neighbour[previous_slot(k)];
  // an end of the side has three triangles only, or, while points move, the diagonal has no length
  if (beyond_ad == beyond_ca || beyond_db == beyond_bc || c == d) return false;
  const int slot_ad = slot_of(beyond_ad, n), slot_bc = slot_of(beyond_bc, t);
  set(t, {c, a, d}, {beyond_ad, n, beyond_ca});
  set(n, {c, d, b}, {beyond_db, beyond_bc, t});
  tri(beyond_ad).neighbour[slot_ad] = t;
  tri(beyond_bc).neighbour[slot_bc] = n;
  return true;
}

// --- parts -----------------------------------------------------------------------------------------------------------

int DynamicDelaunay::new_triangle() {
  if (free_triangles_.empty()) {
    triangles_.emplace_back();
    return static_cast<int>(triangles_.size()) - 1;
  }
  const int t = free_triangles_.back();
  free_triangles_.pop_back();
  return t;
}

void DynamicDelaunay::set(int t, const std::array<int, 3>& corner, const std::array<int, 3>& neighbour) {
  tri(t) = {corner, neighbour};
  for (const int c : corner) {
    if (c != kNone) points_[index(c)].triangle = t;
  }
  changed_.push_back(t);
}

void DynamicDelaunay::link(int t, int slot, int other, int other_slot) {
  tri(t).neighbour[slot] = other;
  tri(other).neighbour[other_slot] = t;
}

int DynamicDelaunay::slot_of(int t, int neighbour) const {
  const Triangle& here = tri(t);
  return here.neighbour[0] == neighbour ? 0 : here.neighbour[1] == neighbour ? 1 : 2;
}

bool DynamicDelaunay::precedes(const Vector2d& a, const Vector2d& b) {
  return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
}

bool DynamicDelaunay::is_outside(const Vector2d& a, const Vector2d& b, const Vector2d& p) {
  const double side = orientation(a, b, p);
  if (side != 0) return side > 0;
  return precedes(a, b) ? precedes(a, p) && precedes(p, b) : precedes(b, p) && precedes(p, a);
}

bool DynamicDelaunay::in_conflict(const Triangle& t, const Vector2d& p) const {
  for (int k = 0; k < 3; ++k) {
    if (t.corner[k] == kNone) return is_outside(at(t.corner[next_slot(k)]), at(t.corner[previous_slot(k)]), p);
  }
  return in_circle(at(t.corner[0]), at(t.corner[1]), at(t.corner[2]), p) > 0;
}

int DynamicDelaunay::start_for(const Vector2d& p) const {
  if (coarse_) {
    const int near = coarse_->nearest(p);
    if (near != kNone) {
      const int t = points_[index(points_[index(coarse_->label(near))].corner)].triangle;
      if (t != kNone) return t;
    }
  }
  return tri(last_).corner[0] == kUnused ? kNone : last_;
}

/// Walks towards p across the sides that separate it from p; in a Delaunay triangulation this always ends. The
/// triangle that holds p, or one with a corner at infinity.
int DynamicDelaunay::walk(const Vector2d& p, int start) const {
  int t = start;
  if (t == kNone) {
    t = 0;
    while (tri(t).corner[0] == kUnused) ++t;
  }
  for (int k = 0; k < 3; ++k) {
    if (tri(t).corner[k] != kNone) continue;
    t = tri(t).neighbour[k];
    break;
  }
  int from = kNone;
  while (!is_ghost(tri(t))) {
    const Triangle& here = tri(t);
    int next = kNone;
    for (int k = 0; k < 3 && next == kNone; ++k) {
      if (here.neighbour[k] == from) continue;
      if (orientation(at(here.corner[next_slot(k)]), at(here.corner[previous_slot(k)]), p) < 0) {
        next = here.neighbour[k];
      }
    }
    if (next == kNone) return t;
    from = t;
    t = next;
  }
  return t;
}

int DynamicDelaunay::nearest(const Vector2d& p) const {
  if (triangles_.empty()) return kNone;
  int best = kNone;
  double best2 = INFINITY;
  const auto consider = [&](int corner) {
    if (corner == kNone) return false;
    const double d2 = (at(corner) - p).squaredNorm();
    if (d2 >= best2) return false;
    best = corner;
    best2 = d2;
    return true;
  };
  for (const int corner : tri(walk(p, start_for(p))).corner) consider(corner);
  for (bool nearer = true; nearer;) {  // a corner without a nearer neighbour is the nearest: p is in its Voronoi cell
    nearer = false;
    for (const int t : around(best)) {
      for (const int corner : tri(t).corner) nearer = consider(corner) || nearer;
    }
  }
  return best;
}

std::span<const int> DynamicDelaunay::around(int point) const {
  around_.clear();
  const int first = triangles_.empty() ? kNone : points_[index(point)].triangle;
  if (first == kNone) return around_;
  int t = first;
  do {
    around_.push_back(t);
    const Triangle& here = tri(t);
    const int k = here.corner[0] == point ? 0 : here.corner[1] == point ? 1 : 2;
    t = here.neighbour[next_slot(k)];
  } while (t != first);
  return around_;
}

}  // namespace isobath
