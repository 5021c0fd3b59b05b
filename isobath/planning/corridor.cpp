#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/planning/corridor.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kTouch = 1e-9;  // m: shapes that touch count as meeting

/// Grows to hold the interval [from, to] of parameters; ignores it where from > to.
struct Hull {
  double from = INFINITY;
  double to = -INFINITY;
  void add(double low, double high) {
    if (low > high) return;
    from = std::min(from, low);
    to = std::max(to, high);
  }
};

/// Adds the part of the line p + t u, t any number, |u| = 1, that lies in a disc.
void add_disc(Hull& hull, const Vector2d& p, const Vector2d& u, const Vector2d& centre, double radius) {
  const double middle = u.dot(centre - p);
  const double off2 = (centre - p).squaredNorm() - middle * middle;
  const double rest = radius * radius - off2;
  if (rest < 0) return;
  hull.add(middle - std::sqrt(rest), middle + std::sqrt(rest));
}

/// Adds the part that lies in the rectangle centre +- half_x axis_x +- half_y axis_y.
void add_box(Hull& hull, const Vector2d& p, const Vector2d& u, const Vector2d& centre, const Vector2d& axis_x,
             double half_x, double half_y) {
  const Vector2d axis_y(-axis_x.y(), axis_x.x());
  double from = -INFINITY, to = INFINITY;
  for (const auto& [axis, half] : {std::pair(axis_x, half_x), std::pair(axis_y, half_y)}) {
    const double start = axis.dot(p - centre), slope = axis.dot(u);
    if (std::abs(slope) < 1e-12) {
      if (std::abs(start) > half) return;
      continue;
    }
    const double one = (-half - start) / slope, other = (half - start) / slope;
    from = std::max(from, std::min(one, other));
    to = std::min(to, std::max(one, other));
  }
  hull.add(from, to);
}

struct Leg {
  Vector2d p;
  Vector2d u = Vector2d::UnitX();
  double length = 0;

  Leg(const Vector2d& a, const Vector2d& b) : p(a), length((b - a).norm()) {
    if (length > 0) u = (b - a) / length;
  }
  [[nodiscard]] std::optional<Stretch> cut(const Hull& hull) const {
    if (hull.from > length + kTouch || hull.to < -kTouch || hull.from > hull.to) return std::nullopt;
    return Stretch{std::clamp(hull.from, 0.0, length), std::clamp(hull.to, 0.0, length)};
  }
};

std::optional<Stretch> within_box(const Leg& leg, const Vector2d& low, const Vector2d& high, double reach) {
  const Vector2d centre = (low + high) / 2, half = (high - low) / 2;
  const double grown = reach + kTouch;
  Hull hull;
  add_box(hull, leg.p, leg.u, centre, Vector2d::UnitX(), half.x() + grown, half.y() + kTouch);
  add_box(hull, leg.p, leg.u, centre, Vector2d::UnitX(), half.x() + kTouch, half.y() + grown);
  for (const double x : {low.x(), high.x()}) {
    for (const double y : {low.y(), high.y()}) add_disc(hull, leg.p, leg.u, {x, y}, grown);
  }
  return leg.cut(hull);
}

class Sweeper {
 public:
  Sweeper(const PixelGrid& grid, double half_width) : grid_(grid), half_width_(half_width) {}

  /// Estimated number of pixels, correct to a factor of two.
  [[nodiscard]] double estimate(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
    const double wide = 2 * half_width_ / grid_.pixel_m + 1;
    return ((to - from).head<2>().norm() / grid_.pixel_m + wide) * wide;
  }
  void add(std::int32_t number, const Eigen::Vector3d& from, const Eigen::Vector3d& to, double before_m) {
    const Leg leg(from.head<2>(), to.head<2>());
    const Vector2d low = from.head<2>().cwiseMin(to.head<2>()), high = from.head<2>().cwiseMax(to.head<2>());
    const std::int32_t first = grid_.at({high.x() + reach(), low.y()}).row;
    const std::int32_t last = grid_.at({low.x() - reach(), low.y()}).row;
    for (std::int32_t row = first; row <= last; ++row) {
      const double north = grid_.corner_m.x() - row * grid_.pixel_m, south = north - grid_.pixel_m;
      const auto [west, east] = easts(leg, south - reach(), north + reach());
      const std::int32_t end = grid_.at({north, east + reach()}).column;
      for (std::int32_t column = grid_.at({north, west - reach()}).column; column <= end; ++column) {
        const double left = grid_.corner_m.y() + column * grid_.pixel_m;
        const auto near = within_box(leg, {south, left}, {north, left + grid_.pixel_m}, half_width_);
        if (!near) continue;
        const double slope = leg.length > 0 ? (to.z() - from.z()) / leg.length : 0;
        const double z =
            leg.length > 0 ? from.z() + slope * (slope > 0 ? near->to : near->from) : std::max(from.z(), to.z());
        pixels_.push_back({{column, row}, number, before_m + near->from, z});
      }
    }
  }

  /// Each pixel once: with its first contact and its greatest depth.
  std::vector<SweptPixel> take() {
    std::stable_sort(pixels_.begin(), pixels_.end(), [](const SweptPixel& a, const SweptPixel& b) {
      return a.pixel.row != b.pixel.row ? a.pixel.row < b.pixel.row : a.pixel.column < b.pixel.column;
    });
    std::size_t kept = 0;
    for (const SweptPixel& p : pixels_) {
      if (kept > 0 && pixels_[kept - 1].pixel == p.pixel) {
        pixels_[kept - 1].vehicle_z = std::max(pixels_[kept - 1].vehicle_z, p.vehicle_z);
      } else {
        pixels_[kept++] = p;
      }
    }
    pixels_.resize(kept);
    return std::move(pixels_);
  }

 private:
  [[nodiscard]] double reach() const { return half_width_ + 2 * kTouch; }

  /// Minimum and maximum east of the part of the leg between two norths.
  static std::pair<double, double> easts(const Leg& leg, double south, double north) {
    double from = 0, to = leg.length;
    if (std::abs(leg.u.x()) > 1e-12) {
      const double one = (south - leg.p.x()) / leg.u.x(), other = (north - leg.p.x()) / leg.u.x();
      from = std::clamp(std::min(one, other), 0.0, leg.length);
      to = std::clamp(std::max(one, other), 0.0, leg.length);
    }
    const double a = leg.p.y() + from * leg.u.y(), b = leg.p.y() + to * leg.u.y();
    return {std::min(a, b), std::max(a, b)};
  }

  PixelGrid grid_;
  double half_width_;
  std::vector<SweptPixel> pixels_;
};

}  // namespace

std::optional<Stretch> within_reach_of_segment(const Vector2d& a, const Vector2d& b, const Vector2d& c,
                                               const Vector2d& d, double reach) {
  const Leg leg(a, b), other(c, d);
  Hull hull;
  add_disc(hull, leg.p, leg.u, c, reach + kTouch);
  add_disc(hull, leg.p, leg.u, d, reach + kTouch);
  if (other.length > 0) {
    add_box(hull, leg.p, leg.u, (c + d) / 2, other.u, other.length / 2, reach + kTouch);
  }
  return leg.cut(hull);
}

std::optional<Stretch> within_reach_of_box(const Vector2d& a, const Vector2d& b, const Vector2d& low,
                                           const Vector2d& high, double reach) {
  return within_box(Leg(a, b), low, high, reach);
}

const char* to_text(CorridorRefusal refusal) {
  switch (refusal) {
    case CorridorRefusal::kNoPath: return "a path without points";
    case CorridorRefusal::kNotFinite: return "a path that is not finite";
    case CorridorRefusal::kTooLarge: return "a path too long or too wide for the map's pixels";
  }
  return "";
}

Result<std::vector<SweptPixel>, CorridorRefusal> sweep(const PixelGrid& grid, std::span<const Eigen::Vector3d> path,
                                                       double half_width_m) {
  ISOBATH_ASSERT(grid.pixel_m > 0 && half_width_m >= 0);
  if (path.empty()) return tl::unexpected(CorridorRefusal::kNoPath);
  const double farthest = 0x1p29 * grid.pixel_m;
  for (const Eigen::Vector3d& p : path) {
    if (!p.allFinite()) return tl::unexpected(CorridorRefusal::kNotFinite);
    const bool inside = (p.head<2>() - grid.corner_m).cwiseAbs().maxCoeff() + half_width_m < farthest;
    if (!inside) return tl::unexpected(CorridorRefusal::kTooLarge);
  }
  Sweeper sweeper(grid, half_width_m);
  double before = 0, estimate = 0;
  const std::size_t legs = std::max<std::size_t>(1, path.size() - 1);
  for (std::size_t i = 0; i < legs; ++i) {
    const Eigen::Vector3d& to = path[std::min(i + 1, path.size() - 1)];
    estimate += sweeper.estimate(path[i], to);
    if (estimate > kMaxSweptPixels) return tl::unexpected(CorridorRefusal::kTooLarge);
    sweeper.add(static_cast<std::int32_t>(i), path[i], to, before);
    before += (to - path[i]).head<2>().norm();
  }
  return sweeper.take();
}

}  // namespace isobath
