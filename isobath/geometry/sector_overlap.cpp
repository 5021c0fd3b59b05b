#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/geometry/polygon.hpp>
#include <isobath/geometry/sector_overlap.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;

// Sutherland-Hodgman: the part of a convex polygon where normal . p >= 0.
Wedge::Piece clip(const Wedge::Piece& in, const Vector2d& normal) {
  Wedge::Piece out;
  for (int i = 0; i < in.count; ++i) {
    const Vector2d& a = in.corners[i];
    const Vector2d& b = in.corners[i + 1 < in.count ? i + 1 : 0];
    const double da = normal.dot(a);
    const double db = normal.dot(b);
    if (da >= 0) out.corners[out.count++] = a;
    if ((da >= 0) != (db >= 0)) out.corners[out.count++] = a + (da / (da - db)) * (b - a);
  }
  return out;
}

// Angle from a to b. Pieces of a bin are narrow; for them the series to t^11 is exact in double precision, and much
// faster.
double angle_between(const Vector2d& a, const Vector2d& b) {
  const double y = cross(a, b);
  const double x = a.dot(b);
  if (!(std::abs(y) < 0.05 * x)) return std::atan2(y, x);
  const double t = y / x;
  const double t2 = t * t;
  return t * (1 - t2 * (1.0 / 3 - t2 * (1.0 / 5 - t2 * (1.0 / 7 - t2 * (1.0 / 9 - t2 / 11)))));
}

double sector_area(const Vector2d& a, const Vector2d& b, double radius2) { return radius2 / 2 * angle_between(a, b); }

// Signed area between the origin and the side a-b, within the disc.
double side_area(const Vector2d& a, const Vector2d& b, double radius2) {
  const double a2 = a.squaredNorm();
  const double b2 = b.squaredNorm();
  if (a2 <= radius2 && b2 <= radius2) return cross(a, b) / 2;
  const Vector2d side = b - a;
  const double length2 = side.squaredNorm();
  const double foot = -a.dot(side) / length2;  // parameter of the point nearest to the origin
  const double gap2 = radius2 - (a2 - foot * foot * length2);
  if (!(gap2 > 0)) return sector_area(a, b, radius2);
  const double half = std::sqrt(gap2 / length2);
  const double enter = std::max(foot - half, 0.0);
  const double leave = std::min(foot + half, 1.0);
  if (enter >= leave) return sector_area(a, b, radius2);
  double total = 0;
  const Vector2d p = a + enter * side;
  const Vector2d q = a + leave * side;
  if (enter > 0) total += sector_area(a, p, radius2);
  total += cross(p, q) / 2;
  if (leave < 1) total += sector_area(q, b, radius2);
  return total;
}

}  // namespace

Wedge::Wedge(Angle centre, Angle width) {
  ISOBATH_ASSERT(width.radians() >= 0 && width.radians() <= std::numbers::pi);
  const Angle right = centre - width / 2;
  const Angle left = centre + width / 2;
  right_ = {-sin(right), cos(right)};
  left_ = {sin(left), -cos(left)};
}

Wedge::Piece Wedge::clip(const Vector2d& low, const Vector2d& high) const {
  Piece rectangle;
  rectangle.corners = {low, Vector2d(high.x(), low.y()), high, Vector2d(low.x(), high.y())};
  rectangle.count = 4;
  return isobath::clip(isobath::clip(rectangle, right_), left_);
}

double disc_overlap(std::span<const Vector2d> polygon, double radius) {
  double total = 0;
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    total += side_area(polygon[i], polygon[i + 1 < n ? i + 1 : 0], radius * radius);
  }
  return std::max(total, 0.0);
}

double overlap_area(const AnnularSector& sector, const Square& square) {
  if (sector.width.radians() > std::numbers::pi) {
    AnnularSector half{sector.inner, sector.outer, sector.centre - sector.width / 4, sector.width / 2};
    const double first = overlap_area(half, square);
    half.centre = sector.centre + sector.width / 4;
    return first + overlap_area(half, square);
  }
  const Vector2d high = square.low + Vector2d::Constant(square.side);
  const Wedge::Piece piece = Wedge(sector.centre, sector.width).clip(square.low, high);
  return std::max(disc_overlap(piece.polygon(), sector.outer) - disc_overlap(piece.polygon(), sector.inner), 0.0);
}

}  // namespace isobath
