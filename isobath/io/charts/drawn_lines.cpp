#include <gdal_priv.h>
#include <isobath/io/charts/chart_objects.hpp>
#include <isobath/io/charts/drawn_lines.hpp>
#include <ogrsf_frmts.h>

namespace isobath {

std::vector<std::vector<Eigen::Vector2d>> read_drawn_lines(const std::filesystem::path& file, const LocalPlane& plane) {
  GdalSession gdal;
  const PriorConfig config;
  const PriorJob job{file.string(), config, plane, {}, gdal};
  const Dataset data = open_drawing(job, "lines");
  std::vector<std::vector<Eigen::Vector2d>> lines;
  for (OGRLayer* layer : data->GetLayers()) {
    Prior counts;
    ChartShapes shapes(PlaneMapping(job, layer->GetSpatialRef()), counts);
    for (const OGRFeatureUniquePtr& feature : *layer) {
      for (std::vector<Eigen::Vector2d>& line : shapes.of(feature->GetGeometryRef(), "lines").lines) {
        if (line.size() >= 2) lines.push_back(std::move(line));
      }
    }
  }
  if (gdal.failures() > 0) job.refuse("the file is damaged or cut off: " + gdal.complaint());
  if (lines.empty()) job.refuse("it contains no line within reach of the map");
  return lines;
}

}  // namespace isobath
