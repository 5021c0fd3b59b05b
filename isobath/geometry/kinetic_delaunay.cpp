#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/geometry/kinetic_delaunay.hpp>
#include <isobath/geometry/polygon.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kMeetingDistance = 1e-6;
constexpr double kHorizon = 1e6;    // later failures of certificates are not foreseen
constexpr double kSlack = 1e-12;    // share of the size of a determinant that counts as zero
constexpr int kFlipsAPoint = 1000;  // more in one advance are taken for rounding, and the triangulation is repaired

/// A polynomial in time, of degree N: the coefficient of t^k at place k.
template <int N>
using Polynomial = std::array<double, static_cast<std::size_t>(N) + 1>;

template <int N, int M>
Polynomial<N + M> polynomial_product(const Polynomial<N>& a, const Polynomial<M>& b) {
  Polynomial<N + M> c{};
  for (std::size_t i = 0; i <= N; ++i) {
    for (std::size_t j = 0; j <= M; ++j) c[i + j] += a[i] * b[j];
  }
  return c;
}

template <std::size_t N>
std::array<double, N> polynomial_sum(const std::array<double, N>& a, const std::array<double, N>& b, double sign) {
  std::array<double, N> c{};
  for (std::size_t i = 0; i < N; ++i) c[i] = a[i] + sign * b[i];
  return c;
}

struct MovingVector {
  Polynomial<1> x, y;
};

MovingVector moving(const Vector2d& at, const Vector2d& velocity) {
  return {{at.x(), velocity.x()}, {at.y(), velocity.y()}};
}

Polynomial<2> moving_cross(const MovingVector& a, const MovingVector& b) {
  return polynomial_sum(polynomial_product<1, 1>(a.x, b.y), polynomial_product<1, 1>(a.y, b.x), -1);
}

Polynomial<2> moving_square(const MovingVector& a) {
  return polynomial_sum(polynomial_product<1, 1>(a.x, a.x), polynomial_product<1, 1>(a.y, a.y), 1);
}

template <std::size_t N>
double polynomial_value(const std::array<double, N>& p, double t) {
  double sum = 0;
  for (std::size_t i = N; i-- > 0;) sum = sum * t + p[i];
  return sum;
}

/// The root of a polynomial that has values of different sign, or zero, at both ends of an interval.
template <std::size_t N>
double bracketed_root(const std::array<double, N>& p, double low, double high) {
  const bool rises = polynomial_value(p, high) > polynomial_value(p, low);
  for (int i = 0; i < 200 && high - low > 1e-15 * std::abs(high); ++i) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) break;
    ((polynomial_value(p, middle) > 0) == rises ? high : low) = middle;
  }
  return high;
}

template <std::size_t N>
struct Roots {
  std::array<double, N> at{};
  std::size_t count = 0;
};

/// The roots in (0, end) at which a polynomial changes its sign, in order: between two roots of its derivative there is
/// at most one.
template <std::size_t N>
Roots<N> sign_changes(const std::array<double, N>& p, double end) {
  Roots<N> roots;
  if constexpr (N > 1) {
    std::array<double, N - 1> slope{};
    for (std::size_t i = 1; i < N; ++i) slope[i - 1] = static_cast<double>(i) * p[i];
    const auto turns = sign_changes(slope, end);
    double low = 0;
    for (std::size_t i = 0; i <= turns.count; ++i) {
      const double high = i < turns.count ? turns.at[i] : end;
      if ((polynomial_value(p, low) > 0) != (polynomial_value(p, high) > 0))
        roots.at[roots.count++] = bracketed_root(p, low, high);
      low = high;
    }
  }
  return roots;
}

/// When a polynomial first exceeds `slack`, from time 0 on; infinity if it does not until `end`.
template <std::size_t N>
double first_excess(std::array<double, N> p, double slack, double end) {
  p[0] -= slack;
  if (p[0] > 0) return 0;
  double largest = 0;
  for (std::size_t i = 1; i < N; ++i) largest = std::max(largest, std::abs(p[i]));
  if (largest == 0) return INFINITY;
  const auto roots = sign_changes(p, end);
  return roots.count > 0 ? roots.at[0] : INFINITY;
}

}  // namespace

KineticDelaunay::KineticDelaunay(int max_points)
    : delaunay_(max_points), queue_limit_(16 * static_cast<std::size_t>(max_points) + 64) {
  motions_.resize(static_cast<std::size_t>(max_points));
  places_.resize(static_cast<std::size_t>(max_points));
  stamps_.resize(2 * static_cast<std::size_t>(max_points) + 4, 0);
  queue_.reserve(queue_limit_);
}

Vector2d KineticDelaunay::place(int point, double time_s) const {
  const Motion& m = motions_[DynamicDelaunay::index(point)];
  return m.origin + (time_s - m.since_s) * m.velocity;
}

void KineticDelaunay::check(const Vector2d& velocity) const {
  if (velocity.allFinite() && velocity.cwiseAbs().maxCoeff() <= 1e6) return;
  throw Error("the velocity of a point is not finite or too large", {}, "up to 1e6");
}

int KineticDelaunay::insert(const Vector2d& at, const Vector2d& velocity, int label) {
  check(velocity);
  const int id = delaunay_.insert(at, label);
  motions_[DynamicDelaunay::index(id)] = {at, velocity, now_s_};
  certify_changed();
  return id;
}

void KineticDelaunay::remove(int point) {
  delaunay_.remove(point);
  certify_changed();
}

void KineticDelaunay::set_motion(int point, const Vector2d& at, const Vector2d& velocity) {
  check(velocity);
  delaunay_.move(point, at);
  motions_[DynamicDelaunay::index(point)] = {at, velocity, now_s_};
  certify_changed();
  const auto star = delaunay_.around(delaunay_.points_[DynamicDelaunay::index(point)].corner);
  todo_.assign(star.begin(), star.end());
  for (const int t : todo_) ++stamps_[DynamicDelaunay::index(t)];
  for (const int t : todo_) {
    for (int k = 0; k < 3; ++k) certify(t, k);
  }
}

void KineticDelaunay::advance(double to_s) {
  if (!std::isfinite(to_s) || to_s < now_s_) {
    throw Error("the time of moving points is not finite or before the present", {}, "times that rise");
  }
  flips_.clear();
  bool foreseen = true;  // the queue holds what follows
  const std::int64_t limit = std::int64_t{kFlipsAPoint} * (delaunay_.size() + 1);
  for (std::int64_t events = 0; !queue_.empty() && queue_.front().time_s <= to_s; ++events) {
    if (events >= limit) {
      foreseen = false;
      break;
    }
    std::pop_heap(queue_.begin(), queue_.end(), later);
    const Event event = queue_.back();
    queue_.pop_back();
    if (!is_current(event)) continue;
    now_s_ = std::max(now_s_, event.time_s);
    if (event.meeting) {
      foreseen = event.until_s <= to_s;
      if (!foreseen) break;
      settle(event.until_s);
      certify_all();
    } else {
      flip(event);
    }
  }
  const std::int64_t before = repairs_;
  settle(to_s);
  if (!foreseen || repairs_ > before) certify_all();
}

/// Puts all points where they are at a time and restores what rounding or a meeting has spoilt.
void KineticDelaunay::settle(double time_s) {
  for (std::size_t i = 0; i < delaunay_.points_.size(); ++i) places_[i] = place(static_cast<int>(i), time_s);
  delaunay_.changed_.clear();
  const bool kept = delaunay_.place_all(std::span(places_).first(delaunay_.points_.size()));
  if (!kept && !delaunay_.triangles_.empty()) ++repairs_;
  now_s_ = time_s;
  certify_changed();
}

bool KineticDelaunay::is_current(const Event& event) const {
  const auto t = DynamicDelaunay::index(event.triangle);
  if (t >= delaunay_.triangles_.size() || stamps_[t] != event.stamp) return false;
  const int n = delaunay_.triangles_[t].neighbour[event.slot];
  return stamps_[DynamicDelaunay::index(n)] == event.other_stamp;
}

void KineticDelaunay::flip(const Event& event) {
  const auto& t = delaunay_.tri(event.triangle);
  const int n = t.neighbour[event.slot];
  const int k = event.slot, j = delaunay_.slot_of(n, event.triangle);
  const DelaunayFlip flip{event.time_s, t.corner[(k + 1) % 3], t.corner[(k + 2) % 3], t.corner[k],
                          delaunay_.tri(n).corner[j]};
  delaunay_.changed_.clear();
  if (!delaunay_.flip(event.triangle,
                      k)) {  // three points in a row, and nothing beside: repaired when they have parted
    Event parted = event;
    parted.meeting = true;
    parted.until_s = now_s_ + kMeetingDistance;
    parted.time_s = now_s_;
    push(parted);
    return;
  }
  flips_.push_back(flip);
  certify_changed();
}

void KineticDelaunay::certify_changed() {
  todo_.assign(delaunay_.changed_.begin(), delaunay_.changed_.end());
  std::sort(todo_.begin(), todo_.end());
  todo_.erase(std::unique(todo_.begin(), todo_.end()), todo_.end());
  for (const int t : todo_) ++stamps_[DynamicDelaunay::index(t)];
  for (const int t : todo_) {
    if (DynamicDelaunay::index(t) >= delaunay_.triangles_.size()) continue;
    for (int k = 0; k < 3; ++k) certify(t, k);
  }
}

void KineticDelaunay::certify_all() {
  queue_.clear();
  for (std::size_t t = 0; t < delaunay_.triangles_.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      if (delaunay_.triangles_[t].neighbour[k] > static_cast<int>(t)) certify(static_cast<int>(t), k);
    }
  }
}

/// Finds when an edge fails: its in-circle determinant, or its turn at the hull, becomes positive.
void KineticDelaunay::certify(int triangle, int slot) {
  const auto& t = delaunay_.tri(triangle);
  if (t.corner[0] == DynamicDelaunay::kUnused) return;
  const int n = t.neighbour[slot];
  const std::array<int, 4> corner{t.corner[slot], t.corner[(slot + 1) % 3],
                                  delaunay_.tri(n).corner[delaunay_.slot_of(n, triangle)], t.corner[(slot + 2) % 3]};
  int infinite = DynamicDelaunay::kNone;  // c, a, d, b: the quadrilateral in the positive sense
  for (int i = 0; i < 4; ++i) infinite = corner[i] == DynamicDelaunay::kNone ? i : infinite;
  const auto relative = [&](int point, int to) {
    const Vector2d at = place(point, now_s_) - place(to, now_s_);
    return moving(at, motions_[DynamicDelaunay::index(point)].velocity - motions_[DynamicDelaunay::index(to)].velocity);
  };
  double after = INFINITY;
  if (infinite == DynamicDelaunay::kNone) {
    const auto [c, a, d, b] = corner;  // d inside the circle through c, a, b
    const MovingVector u = relative(c, d), v = relative(a, d), w = relative(b, d);
    const auto u2 = moving_square(u), v2 = moving_square(v), w2 = moving_square(w);
    const auto one = polynomial_product<2, 2>(u2, moving_cross(v, w)),
               two = polynomial_product<2, 2>(v2, moving_cross(w, u));
    const auto three = polynomial_product<2, 2>(w2, moving_cross(u, v));
    const double size = std::max({u2[0], v2[0], w2[0]});
    after = first_excess(polynomial_sum(polynomial_sum(one, two, 1), three, 1), kSlack * size * size, kHorizon);
  } else {  // the three finite corners from the one after infinity on: a right turn, or the end of a triangle
    const int p = corner[(infinite + 1) % 4], q = corner[(infinite + 2) % 4], r = corner[(infinite + 3) % 4];
    const MovingVector u = relative(q, p), v = relative(r, p);
    const double size = std::max(moving_square(u)[0], moving_square(v)[0]);
    auto turn = moving_cross(u, v);
    if (infinite % 2 == 0) {  // q lies opposite infinity: the edge is a side of the hull, and its triangle turns over
      for (double& x : turn) x = -x;
    }
    after = first_excess(turn, kSlack * size, kHorizon);
  }
  if (std::isfinite(after)) {
    push({now_s_ + after, triangle, slot, stamps_[DynamicDelaunay::index(triangle)], stamps_[DynamicDelaunay::index(n)],
          false, 0});
  }
  certify_meeting(triangle, slot, n);
}

void KineticDelaunay::certify_meeting(int triangle, int slot, int other) {
  const auto& t = delaunay_.tri(triangle);
  const int a = t.corner[(slot + 1) % 3], b = t.corner[(slot + 2) % 3];
  if (a == DynamicDelaunay::kNone || b == DynamicDelaunay::kNone) return;
  const Vector2d apart = place(b, now_s_) - place(a, now_s_);
  const Vector2d rate = motions_[DynamicDelaunay::index(b)].velocity - motions_[DynamicDelaunay::index(a)].velocity;
  const double approach = -apart.dot(rate), rate2 = rate.squaredNorm();
  if (approach <= 0) return;  // they part
  const double miss2 = apart.squaredNorm() - approach * approach / rate2;
  const double near2 = kMeetingDistance * kMeetingDistance - miss2;
  if (near2 <= 0) return;
  const double half = std::sqrt(near2 / rate2), middle = approach / rate2;
  push({now_s_ + std::max(0.0, middle - half), triangle, slot, stamps_[DynamicDelaunay::index(triangle)],
        stamps_[DynamicDelaunay::index(other)], true, now_s_ + middle + half});
}

void KineticDelaunay::push(const Event& event) {
  if (queue_.size() >= queue_limit_) {
    std::erase_if(queue_, [&](const Event& e) { return !is_current(e); });
    std::make_heap(queue_.begin(), queue_.end(), later);
    if (queue_.size() >= queue_limit_) return;  // the check at the end of the advance makes up for it
  }
  queue_.push_back(event);
  std::push_heap(queue_.begin(), queue_.end(), later);
}

}  // namespace isobath
