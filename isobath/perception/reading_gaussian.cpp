#include <algorithm>
#include <cmath>
#include <Eigen/Geometry>
#include <isobath/perception/reading_gaussian.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector3d;

/// Probability of a standard normal number between a and b.
double normal_between(double a, double b) {
  return 0.5 * (std::erf(b / std::numbers::sqrt2) - std::erf(a / std::numbers::sqrt2));
}

/// Offset of a beam from a bucket of directions: `across` and `up` are the angles from its middle to the beam's axis.
struct BucketOffset {
  SphericalDirection direction;  ///< in the turned table
  Vector3d middle;
  double across, up, half_wide, half_high;
};

/// Calls `visit` for each bucket within `reach` of the beam's axis.
template <class Visit>
void each_bucket_of_beam(const SphericalGrid& grid, const Vector3d& axis, double reach, const Visit& visit) {
  const DirectionBuckets& buckets = grid.buckets();
  const double step = buckets.step().radians();
  const SphericalDirection at = buckets.at(axis);
  const int rows = static_cast<int>(reach / step) + 1, n = buckets.azimuths();
  const int turned = grid.cells().directions().turned();
  for (int e = std::max(0, at.elevation - rows); e <= std::min(buckets.elevations() - 1, at.elevation + rows); ++e) {
    const double level = buckets.cos_elevation(e);
    const int columns = static_cast<int>(std::min(reach / (step * level) + 2, 0.5 * n));
    for (int i = -columns; i <= std::min(columns, n - 1 - columns); ++i) {
      const SphericalDirection d{(at.azimuth + i + n) % n, e};
      const Vector3d middle = buckets.middle(d);
      const double ahead = middle.dot(axis);
      if (ahead < 0.5) continue;
      const double sine = middle.z(), wide = level;
      const Vector3d to_east{-middle.y() / wide, middle.x() / wide, 0};
      const Vector3d to_up{-sine * middle.x() / wide, -sine * middle.y() / wide, wide};
      const double x = axis.dot(to_east), y = axis.dot(to_up);
      // converts from the tangent plane at the middle to angles
      const double sideways = std::hypot(x, y), stretch = sideways > 1e-9 ? std::atan2(sideways, ahead) / sideways : 1;
      const BucketOffset offset{
          {(d.azimuth + turned) % n, e}, middle, x * stretch, y * stretch, 0.5 * step * wide, 0.5 * step};
      if (std::abs(offset.across) - offset.half_wide >= reach || std::abs(offset.up) - offset.half_high >= reach) {
        continue;
      }
      visit(offset);
    }
  }
}

}  // namespace

void touched_cells(const SphericalGrid& grid, const ReadingGaussian& reading, double factor, int most,
                   std::vector<TouchedCell>& touched) {
  touched.clear();
  const SphericalLayers& layers = grid.layers();
  const double near = std::max(0.0, reading.range_m - factor * reading.sigma_m);
  const double far = std::min(layers.range_m(), reading.range_m + factor * reading.sigma_m);
  if (near >= layers.range_m()) return;
  const int first = layers.layer_at(near), last = layers.layer_at(far);
  const double reach = factor * reading.sigma_rad;
  each_bucket_of_beam(grid, reading.axis, reach, [&](const BucketOffset& o) {
    const double angular =
        normal_between((o.across - o.half_wide) / reading.sigma_rad, (o.across + o.half_wide) / reading.sigma_rad) *
        normal_between((o.up - o.half_high) / reading.sigma_rad, (o.up + o.half_high) / reading.sigma_rad);
    const double from_axis = std::hypot(o.across, o.up) / reading.sigma_rad;
    for (int layer = first; layer <= last; ++layer) {
      const double a = (layers.inner(layer) - reading.range_m) / reading.sigma_m;
      const double b = (layers.outer(layer) - reading.range_m) / reading.sigma_m;
      const double middle = 0.5 * (a + b);
      touched.push_back({{o.direction, layer},
                         angular * normal_between(a, b),
                         std::exp(-0.5 * (middle * middle + from_axis * from_axis))});
    }
  });
  if (touched.size() > static_cast<std::size_t>(most)) {
    const auto heavier = [](const TouchedCell& a, const TouchedCell& b) {
      return a.mass != b.mass ? a.mass > b.mass : a.place < b.place;
    };
    std::nth_element(touched.begin(), touched.begin() + most, touched.end(), heavier);
    touched.resize(static_cast<std::size_t>(most));
  }
  std::sort(touched.begin(), touched.end(),
            [](const TouchedCell& a, const TouchedCell& b) { return a.place < b.place; });
}

void touched_directions(const SphericalGrid& grid, const ReadingGaussian& reading, double factor,
                        std::vector<TouchedDirection>& touched) {
  touched.clear();
  each_bucket_of_beam(grid, reading.axis, factor * reading.sigma_rad, [&](const BucketOffset& o) {
    const double s = reading.sigma_rad;
    const auto mean_over = [&](double offset, double half) {
      const double low = (offset - half) / s, high = (offset + half) / s;
      return normal_between(std::numbers::sqrt2 * low, std::numbers::sqrt2 * high) /
             (std::numbers::sqrt2 * normal_between(low, high));
    };
    touched.push_back({o.direction, mean_over(o.across, o.half_wide) * mean_over(o.up, o.half_high)});
  });
}

}  // namespace isobath
