#include <cmath>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <isobath/io/charts/chart_objects.hpp>
#include <isobath/io/charts/threat_areas.hpp>
#include <ogrsf_frmts.h>

namespace isobath {
namespace {

constexpr std::size_t kMaxCorners = 100'000;  // each row of the mission map looks at all of them

/// An attribute within [low, high); empty if there is none.
std::optional<double> value_of(const PriorJob& job, const OGRFeature& feature, const char* name, double low,
                               double high) {
  const int i = feature.GetFieldIndex(name);
  if (i < 0 || !feature.IsFieldSetAndNotNull(i)) return {};
  const OGRFieldType type = feature.GetFieldDefnRef(i)->GetType();
  const bool is_number = type == OFTReal || type == OFTInteger || type == OFTInteger64;
  const auto value = is_number ? number_attribute(feature, name) : std::nullopt;
  if (!value || *value < low || *value >= high) {
    job.refuse(fmt::format("area {}: {} is {}", feature.GetFID(), name, feature.GetFieldAsString(i)),
               fmt::format("at least {}, less than {}", low, high));
  }
  return value;
}

ThreatArea threat_of(const PriorJob& job, const OGRFeature& feature) {
  constexpr double kLongest = 1e6;
  ThreatArea threat;
  threat.name = text_attribute(feature, "name");
  const auto detection = value_of(job, feature, "detection", 0, 1);
  const auto destruction = value_of(job, feature, "destruction", 0, 1);
  if (!detection && !destruction) {
    job.refuse(fmt::format("area {} has neither \"detection\" nor \"destruction\"", feature.GetFID()),
               "each is a probability over \"over_m\" metres of path");
  }
  threat.detection = detection.value_or(0);
  threat.destruction = destruction.value_or(0);
  threat.over_m = value_of(job, feature, "over_m", 0.1, kLongest).value_or(threat.over_m);
  return threat;
}

}  // namespace

std::vector<ThreatArea> read_threat_areas(const std::filesystem::path& file, const LocalPlane& plane) {
  GdalSession gdal;
  const PriorConfig config;
  const PriorJob job{file.string(), config, plane, {}, gdal};
  const Dataset data = open_drawing(job, "areas");
  std::vector<ThreatArea> threats;
  std::size_t corners = 0;
  for (OGRLayer* layer : data->GetLayers()) {
    Prior counts;
    ChartShapes shapes(PlaneMapping(job, layer->GetSpatialRef()), counts);
    for (const OGRFeatureUniquePtr& feature : *layer) {
      ThreatArea threat = threat_of(job, *feature);
      for (std::vector<Polygon>& rings : shapes.of(feature->GetGeometryRef(), "areas").areas) {
        for (Polygon& ring : rings) threat.rings.push_back(std::move(ring));
      }
      if (threat.rings.empty()) {
        job.refuse(fmt::format("area {} is no polygon within reach of the map", feature->GetFID()));
      }
      for (const Polygon& ring : threat.rings) corners += ring.size();
      if (corners > kMaxCorners) job.refuse(fmt::format("its areas have more than {} corners", kMaxCorners));
      threats.push_back(std::move(threat));
    }
  }
  if (gdal.failures() > 0) job.refuse("the file is damaged or cut off: " + gdal.complaint());
  if (threats.empty()) job.refuse("it contains no area");
  return threats;
}

}  // namespace isobath
