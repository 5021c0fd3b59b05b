#include <cmath>
#include <GeographicLib/Geodesic.hpp>
#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/UTMUPS.hpp>
#include <isobath/base/error.hpp>
#include <isobath/geometry/geodesy.hpp>

namespace isobath {

bool valid(const GeoPoint& point) { return std::abs(point.latitude_deg) <= 90 && std::abs(point.longitude_deg) <= 180; }

double distance_m(const GeoPoint& a, const GeoPoint& b) {
  double distance = 0;
  GeographicLib::Geodesic::WGS84().Inverse(a.latitude_deg, a.longitude_deg, b.latitude_deg, b.longitude_deg, distance);
  return distance;
}

LocalPlane::LocalPlane(GeoOrigin origin) : origin_(origin) { ISOBATH_ASSERT(valid(origin)); }

Eigen::Vector2d LocalPlane::to_plane(const GeoPoint& point) const {
  const GeographicLib::LocalCartesian plane(origin_.latitude_deg, origin_.longitude_deg);
  double east = 0, north = 0, up = 0;
  plane.Forward(point.latitude_deg, point.longitude_deg, 0, east, north, up);
  return {north, east};
}

GeoPoint LocalPlane::to_geo(const Eigen::Vector2d& north_east) const {
  ISOBATH_ASSERT(north_east.norm() < 1e6);
  const GeographicLib::LocalCartesian plane(origin_.latitude_deg, origin_.longitude_deg);
  GeoPoint point;
  double up = 0, height = 0;
  for (int i = 0; i < 20; ++i) {  // along the plane's normal down to the water; converges by 1/40 a step at 160 km
    plane.Reverse(north_east.y(), north_east.x(), up, point.latitude_deg, point.longitude_deg, height);
    if (std::abs(height) < 1e-9) break;
    up -= height;
  }
  return point;
}

GeoOrigin origin_from(const GeoPoint& point, const Eigen::Vector2d& north_east) {
  GeoOrigin origin = LocalPlane(point).to_geo(-north_east);
  for (int i = 0; i < 20; ++i) {  // meridians converge: correct the origin by the point's error in its plane
    const Eigen::Vector2d miss = LocalPlane(origin).to_plane(point) - north_east;
    if (miss.norm() < 1e-9) break;
    origin = LocalPlane(origin).to_geo(miss);
  }
  return origin;
}

std::optional<GeoPoint> from_utm(int zone, bool northern, double easting, double northing) {
  ISOBATH_ASSERT(zone >= 1 && zone <= 60);
  GeoPoint point;
  try {
    GeographicLib::UTMUPS::Reverse(zone, northern, easting, northing, point.latitude_deg, point.longitude_deg);
  } catch (const GeographicLib::GeographicErr&) {
    return std::nullopt;
  }
  return valid(point) ? std::optional(point) : std::nullopt;
}

}  // namespace isobath
