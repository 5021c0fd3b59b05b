#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <isobath/io/charts/chart_objects.hpp>
#include <iterator>
#include <ogrsf_frmts.h>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kMaxPoints = 20'000'000;

}  // namespace

ChartShapes::ChartShapes(PlaneMapping mapping, Prior& prior) : mapping_(std::move(mapping)), prior_(prior) {}

ChartShapes::Found ChartShapes::of(OGRGeometry* geometry, const std::string& name) {
  Found found;
  if (!geometry || geometry->IsEmpty()) {
    ++prior_.left_out[name + " without shape"];
    return {};
  }
  if (!collect(*geometry, found, 0)) {
    ++prior_.left_out[name + " too far from the map"];
    return {};
  }
  return found;
}

bool ChartShapes::place(double x, double y, Vector2d& p) {
  const auto at = mapping_.to_plane(x, y);
  if (!at || at->norm() > 5e5 || ++points_ > kMaxPoints) return false;
  p = *at;
  return true;
}

bool ChartShapes::line(const OGRSimpleCurve& curve, std::vector<Vector2d>& out) {
  out.resize(static_cast<std::size_t>(curve.getNumPoints()));
  for (int i = 0; i < curve.getNumPoints(); ++i) {
    if (!place(curve.getX(i), curve.getY(i), out[static_cast<std::size_t>(i)])) return false;
  }
  note(out);
  return true;
}

void ChartShapes::note(const std::vector<Vector2d>& points) {
  for (const Vector2d& p : points) {
    low_ = low_.cwiseMin(p);
    high_ = high_.cwiseMax(p);
  }
}

bool ChartShapes::polygon(const OGRPolygon& from, Found& found) {
  std::vector<Polygon> rings;
  for (int i = -1; i < from.getNumInteriorRings(); ++i) {
    const OGRLinearRing* ring = i < 0 ? from.getExteriorRing() : from.getInteriorRing(i);
    Polygon outline;
    if (!ring || !line(*ring, outline)) return false;
    while (outline.size() > 1 && outline.back() == outline.front()) outline.pop_back();
    if (outline.size() >= 3) rings.push_back(std::move(outline));
  }
  if (!rings.empty()) found.areas.push_back(std::move(rings));
  return true;
}

bool ChartShapes::collect(const OGRGeometry& geometry, Found& found, int depth) {
  switch (wkbFlatten(geometry.getGeometryType())) {
    case wkbPoint: {
      const OGRPoint& point = *geometry.toPoint();
      found.points.emplace_back();
      found.heights.push_back(point.getZ());
      if (!place(point.getX(), point.getY(), found.points.back())) return false;
      note({found.points.back()});
      return true;
    }
    case wkbLineString: found.lines.emplace_back(); return line(*geometry.toLineString(), found.lines.back());
    case wkbPolygon: return polygon(*geometry.toPolygon(), found);
    case wkbMultiPoint:
    case wkbMultiLineString:
    case wkbMultiPolygon:
    case wkbGeometryCollection: {
      if (depth > 8) return false;
      for (const OGRGeometry* part : *geometry.toGeometryCollection()) {
        if (!collect(*part, found, depth + 1)) return false;
      }
      return true;
    }
    default: return false;
  }
}

std::optional<double> number_attribute(const OGRFeature& feature, const char* name) {
  const int i = feature.GetFieldIndex(name);
  if (i < 0 || !feature.IsFieldSetAndNotNull(i)) return {};
  const double value = feature.GetFieldAsDouble(i);
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::string text_attribute(const OGRFeature& feature, const char* name) {
  const int i = feature.GetFieldIndex(name);
  return i >= 0 && feature.IsFieldSetAndNotNull(i) ? feature.GetFieldAsString(i) : "";
}

bool attribute_lists(const OGRFeature& feature, const char* name, int value) {
  const int i = feature.GetFieldIndex(name);
  if (i < 0 || !feature.IsFieldSetAndNotNull(i)) return false;
  char** items = feature.GetFieldAsStringList(i);
  for (char** item = items; item && *item; ++item) {
    if (std::strtol(*item, nullptr, 10) == value) return true;
  }
  return false;
}

std::map<std::string, std::string> chart_attributes(const OGRFeature& feature) {
  static const char* const kRecord[] = {"RCID", "PRIM", "GRUP", "OBJL", "RVER", "AGEN", "FIDN", "FIDS", "LNAM"};
  std::map<std::string, std::string> all;
  for (int i = 0; i < feature.GetFieldCount(); ++i) {
    const char* name = feature.GetFieldDefnRef(i)->GetNameRef();
    const bool record =
        std::any_of(std::begin(kRecord), std::end(kRecord), [&](const char* r) { return EQUAL(r, name); });
    if (!record && feature.IsFieldSetAndNotNull(i)) all[name] = feature.GetFieldAsString(i);
  }
  return all;
}

}  // namespace isobath
