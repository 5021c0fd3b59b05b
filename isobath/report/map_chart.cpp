#include <isobath/report/map_chart.hpp>
#include <limits>

namespace isobath {

DepthChart chart_of(const MapRaster& raster, const MapFacts& facts) {
  DepthChart chart;
  chart.grid = raster.grid;
  chart.window = raster.window;
  chart.depth_m = raster.depth_m;
  chart.confidence = raster.confidence;
  chart.flags = raster.flags;
  for (std::size_t i = 0; i < chart.flags.size(); ++i) {  // a bound set by forward sonar is not a depth to print
    const bool bound = (raster.flags[i] & kSensed) != 0 && (raster.flags[i] & kSeenByDepth) == 0;
    if (!bound) continue;
    chart.depth_m[i] = std::numeric_limits<float>::quiet_NaN();
    chart.confidence[i] = 255;
  }
  chart.origin = facts.origin;
  chart.datum = "Depths in metres below " + facts.datum;
  return chart;
}

}  // namespace isobath
