// GeoJSON (RFC 7946): polygons, lines and points on the globe with properties, for charts.
//
// Positions are longitude, latitude in degrees (WGS 84), rounded to 1e-9 degrees. Rings are closed and
// counter-clockwise. The same features give the same text. A property that is not finite becomes null, since JSON has
// no non-finite numbers.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/geometry/geodesy.hpp>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace isobath {

enum class GeoShape : std::uint8_t {
  kPolygon,  ///< three corners or more, in either direction, not closed
  kLine,     ///< two or more
  kPoint,    ///< one point, or several points of one feature
};

struct GeoFeature {
  using Value = std::variant<bool, std::int64_t, double, std::string>;

  std::vector<Eigen::Vector2d> outline;                   ///< north, east in W, m
  std::vector<std::pair<std::string, Value>> properties;  ///< in this order
  GeoShape shape = GeoShape::kPolygon;
};

std::string geojson_text(std::span<const GeoFeature> features, const GeoOrigin& origin);

}  // namespace isobath
