#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/io/exports/geojson.hpp>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using Json = nlohmann::ordered_json;
using Eigen::Vector2d;

/// Twice the area, positive if the corners turn from east to north.
double turning(const std::vector<Vector2d>& north_east) {
  double sum = 0;
  for (std::size_t i = 0; i < north_east.size(); ++i) {
    const Vector2d& a = north_east[i];
    const Vector2d& b = north_east[(i + 1) % north_east.size()];
    sum += a.y() * b.x() - b.y() * a.x();
  }
  return sum;
}

double rounded(double degrees) { return std::round(degrees * 1e9) / 1e9; }

Json positions_of(const std::vector<Vector2d>& points, const LocalPlane& plane) {
  Json list = Json::array();
  for (const Vector2d& point : points) {
    const GeoPoint p = plane.to_geo(point);
    list.push_back({rounded(p.longitude_deg), rounded(p.latitude_deg)});
  }
  return list;
}

Json ring_of(std::vector<Vector2d> outline, const LocalPlane& plane) {
  ISOBATH_ASSERT(outline.size() >= 3);
  if (turning(outline) < 0) std::reverse(outline.begin(), outline.end());
  outline.push_back(outline.front());
  return positions_of(outline, plane);
}

Json geometry_of(const GeoFeature& feature, const LocalPlane& plane) {
  switch (feature.shape) {
    case GeoShape::kPolygon:
      return {{"type", "Polygon"}, {"coordinates", Json::array({ring_of(feature.outline, plane)})}};
    case GeoShape::kLine:
      ISOBATH_ASSERT(feature.outline.size() >= 2);
      return {{"type", "LineString"}, {"coordinates", positions_of(feature.outline, plane)}};
    case GeoShape::kPoint: break;
  }
  ISOBATH_ASSERT(!feature.outline.empty());
  Json positions = positions_of(feature.outline, plane);
  if (positions.size() == 1) return {{"type", "Point"}, {"coordinates", std::move(positions[0])}};
  return {{"type", "MultiPoint"}, {"coordinates", std::move(positions)}};
}

Json feature_of(const GeoFeature& feature, const LocalPlane& plane) {
  Json properties = Json::object();
  for (const auto& [name, value] : feature.properties) {
    std::visit([&, &key = name](const auto& v) { properties[key] = v; }, value);
  }
  return {{"type", "Feature"}, {"geometry", geometry_of(feature, plane)}, {"properties", std::move(properties)}};
}

}  // namespace

std::string geojson_text(std::span<const GeoFeature> features, const GeoOrigin& origin) {
  const LocalPlane plane(origin);
  Json list = Json::array();
  for (const GeoFeature& feature : features) list.push_back(feature_of(feature, plane));
  const Json collection = {{"type", "FeatureCollection"}, {"features", std::move(list)}};
  return collection.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace isobath
