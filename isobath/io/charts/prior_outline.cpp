// Reader of outlines: polygons of a water body.
#include <cstddef>
#include <isobath/io/charts/chart_objects.hpp>
#include <isobath/io/charts/prior_reader.hpp>
#include <ogrsf_frmts.h>
#include <utility>

namespace isobath {

PriorOfFile read_outline_prior(const PriorJob& job, GDALDataset& data) {
  Prior prior;
  prior.format = std::string(data.GetDriverName()) + " outline";
  OGRLayer* layer = data.GetLayerCount() > 0 ? data.GetLayer(0) : nullptr;
  if (!layer) job.refuse("the file holds no layer");
  ChartShapes shapes(PlaneMapping(job, layer->GetSpatialRef()), prior);
  for (const OGRFeatureUniquePtr& feature : *layer) {
    ChartShapes::Found found = shapes.of(feature->GetGeometryRef(), "outlines");
    for (auto& rings : found.areas) {
      ++prior.read["outlines"];
      for (const Polygon& ring : rings) {
        prior.lines.push_back({PriorLineKind::kCoast, ring, {}, {}});
        prior.lines.back().points.push_back(ring.front());
      }
      prior.areas.push_back({PriorAreaKind::kWater, std::move(rings), {}, {}, text_attribute(*feature, "name")});
    }
  }
  if (prior.areas.empty()) job.refuse("it contains no polygon of a water body", "draw the outline as polygons");
  if (job.gdal.failures() > 0) job.refuse("the outline is damaged or cut off: " + job.gdal.complaint());
  prior.raster = empty_raster(window_over(job, shapes.low(), shapes.high()));
  std::vector<bool> water(prior.raster.depth_m.size(), false);
  for (const PriorArea& area : prior.areas) {
    fill(area.rings, prior.raster.window, [&](std::size_t i) { water[i] = true; });
  }
  for (std::size_t i = 0; i < water.size(); ++i) {
    if (water[i]) continue;
    prior.raster.depth_m[i] = 0;
    prior.raster.sigma_m[i] = static_cast<float>(job.config.sigma_m);
  }
  return {std::move(prior), false};
}

}  // namespace isobath
