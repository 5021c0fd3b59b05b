#include <array>
#include <cmath>
#include <isobath/geometry/exact_predicates.hpp>
#include <limits>

namespace isobath {
namespace {

using Eigen::Vector2d;

/// A value as an exact sum of doubles: no zeros, magnitudes rising, bits not overlapping.
template <int Capacity>
class Expansion {
 public:
  [[nodiscard]] int size() const { return size_; }
  double operator[](int i) const { return terms_[static_cast<std::size_t>(i)]; }
  void append(double term) {
    if (term != 0) terms_[static_cast<std::size_t>(size_++)] = term;
  }
  /// The largest term; it has the sign of the sum.
  [[nodiscard]] double leading() const { return size_ > 0 ? (*this)[size_ - 1] : 0; }

 private:
  std::array<double, Capacity> terms_;  // the first size_ are set
  int size_ = 0;
};

struct Pair {
  double high, low;  // high + low is exact
};

Pair two_sum(double a, double b) {
  const double high = a + b;
  const double b_virtual = high - a;
  return {high, (a - (high - b_virtual)) + (b - b_virtual)};
}

Pair fast_two_sum(double large, double small) {
  const double high = large + small;
  return {high, small - (high - large)};
}

Pair two_product(double a, double b) {
  const double high = a * b;
  return {high, std::fma(a, b, -high)};
}

Expansion<2> difference(double a, double b) {
  const Pair d = two_sum(a, -b);
  Expansion<2> e;
  e.append(d.low);
  e.append(d.high);
  return e;
}

/// Shewchuk's linear-time sum of two expansions, with zeros left out.
template <int Result, int N, int M>
Expansion<Result> sum(const Expansion<N>& a, const Expansion<M>& b, double sign_of_b = 1) {
  Expansion<Result> result;
  int i = 0, j = 0;
  const auto next = [&] {
    if (j >= b.size() || (i < a.size() && std::abs(a[i]) < std::abs(b[j]))) return a[i++];
    return sign_of_b * b[j++];
  };
  const int count = a.size() + b.size();
  if (count == 0) return result;
  double carried = next();
  for (int k = 1; k < count; ++k) {
    const Pair s = two_sum(carried, next());
    result.append(s.low);
    carried = s.high;
  }
  result.append(carried);
  return result;
}

template <int N>
Expansion<2 * N> scaled(const Expansion<N>& a, double factor) {
  Expansion<2 * N> result;
  if (a.size() == 0) return result;
  Pair p = two_product(a[0], factor);
  result.append(p.low);
  double carried = p.high;
  for (int i = 1; i < a.size(); ++i) {
    p = two_product(a[i], factor);
    const Pair s = two_sum(carried, p.low);
    result.append(s.low);
    const Pair t = fast_two_sum(p.high, s.high);
    result.append(t.low);
    carried = t.high;
  }
  result.append(carried);
  return result;
}

template <int N, int M>
Expansion<2 * N * M> product(const Expansion<N>& a, const Expansion<M>& b) {
  Expansion<2 * N * M> result;
  for (int i = 0; i < b.size(); ++i) result = sum<2 * N * M>(result, scaled(a, b[i]));
  return result;
}

using Coordinate = Expansion<2>;

/// a x b of two vectors whose components are exact differences.
Expansion<16> exact_cross(const Coordinate& ax, const Coordinate& ay, const Coordinate& bx, const Coordinate& by) {
  return sum<16>(product(ax, by), product(ay, bx), -1);
}

double exact_orientation(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return exact_cross(difference(a.x(), c.x()), difference(a.y(), c.y()), difference(b.x(), c.x()),
                     difference(b.y(), c.y()))
      .leading();
}

double exact_in_circle(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  const Coordinate ax = difference(a.x(), d.x()), ay = difference(a.y(), d.y());
  const Coordinate bx = difference(b.x(), d.x()), by = difference(b.y(), d.y());
  const Coordinate cx = difference(c.x(), d.x()), cy = difference(c.y(), d.y());
  const auto lifted = [](const Coordinate& x, const Coordinate& y, const Expansion<16>& minor) {
    return product(minor, sum<16>(product(x, x), product(y, y)));
  };
  const auto ab = sum<1024>(lifted(ax, ay, exact_cross(bx, by, cx, cy)), lifted(bx, by, exact_cross(cx, cy, ax, ay)));
  return sum<1536>(ab, lifted(cx, cy, exact_cross(ax, ay, bx, by))).leading();
}

constexpr double kUnit = std::numeric_limits<double>::epsilon() / 2;
constexpr double kOrientationBound = (3 + 16 * kUnit) * kUnit;
constexpr double kInCircleBound = (10 + 96 * kUnit) * kUnit;

}  // namespace

double orientation(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const double left = (a.x() - c.x()) * (b.y() - c.y());
  const double right = (a.y() - c.y()) * (b.x() - c.x());
  const double det = left - right;
  if (std::abs(det) >= kOrientationBound * (std::abs(left) + std::abs(right)) && det != 0) return det;
  if (left == 0 && right == 0) return 0;  // each product has a factor that is exactly zero
  return exact_orientation(a, b, c);
}

double in_circle(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  const Vector2d u = a - d, v = b - d, w = c - d;
  const double vw = v.x() * w.y(), wv = v.y() * w.x();
  const double wu = w.x() * u.y(), uw = w.y() * u.x();
  const double uv = u.x() * v.y(), vu = u.y() * v.x();
  const double u2 = u.squaredNorm(), v2 = v.squaredNorm(), w2 = w.squaredNorm();
  const double det = u2 * (vw - wv) + v2 * (wu - uw) + w2 * (uv - vu);
  const double permanent =
      (std::abs(vw) + std::abs(wv)) * u2 + (std::abs(wu) + std::abs(uw)) * v2 + (std::abs(uv) + std::abs(vu)) * w2;
  if (std::abs(det) > kInCircleBound * permanent) return det;
  return exact_in_circle(a, b, c, d);
}

}  // namespace isobath
