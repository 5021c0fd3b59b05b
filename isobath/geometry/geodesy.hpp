// Geodesy: the local plane of a mission on the WGS 84 ellipsoid.
//
// W is north-east-down with its origin on the mean water surface. LocalPlane maps its north and east to latitude and
// longitude of points ON that surface, by the tangent plane at the origin (GeographicLib LocalCartesian, height 0).
// Depth is not part of the mapping: it is measured from the water, not from the plane, which departs from the water by
// 8 cm at 1 km. Accuracy: to_plane and to_geo are inverse to 1e-6 m within 100 km of the origin.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace isobath {

/// WGS 84.
struct GeoPoint {
  double latitude_deg = 0;
  double longitude_deg = 0;
  bool operator==(const GeoPoint&) const = default;
};

/// The geographic position of the local origin; logs without it have no geographic output.
using GeoOrigin = GeoPoint;

/// Finite, latitude within +-90 and longitude within +-180 degrees.
bool valid(const GeoPoint& point);

/// Length of the geodesic (Karney 2013), m; any two points, to 15 nm.
double distance_m(const GeoPoint& a, const GeoPoint& b);

class LocalPlane {
 public:
  /// The origin must be valid.
  explicit LocalPlane(GeoOrigin origin);

  [[nodiscard]] const GeoOrigin& origin() const { return origin_; }
  /// North and east of a point on the water, m. Invalid beyond 1000 km: the far side of the globe maps onto the near
  /// one.
  [[nodiscard]] Eigen::Vector2d to_plane(const GeoPoint& point) const;
  /// The point on the water below or above (north, east); both within 1000 km.
  [[nodiscard]] GeoPoint to_geo(const Eigen::Vector2d& north_east) const;

 private:
  GeoOrigin origin_;
};

/// The origin of the plane in which `point` lies at (north, east). Not within ten degrees of a pole, where the
/// direction of north changes fast.
GeoOrigin origin_from(const GeoPoint& point, const Eigen::Vector2d& north_east);

/// A point given in a zone 1 .. 60 of the Universal Transverse Mercator grid (WGS 84), m; empty outside the area of the
/// grid.
std::optional<GeoPoint> from_utm(int zone, bool northern, double easting, double northing);

}  // namespace isobath
