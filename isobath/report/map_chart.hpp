// chart_of: a depth map as the data of a chart.
#pragma once

#include <isobath/map/depth/map_folder.hpp>
#include <isobath/report/plot/depth_chart.hpp>
#include <isobath/world/map_raster.hpp>

namespace isobath {

/// The data of a chart: charted depths and depths of depth sonars, without the bounds that forward sonars set. The
/// caller adds tracks, shore and obstructions.
DepthChart chart_of(const MapRaster& raster, const MapFacts& facts);

/// Widens the window of a chart by so many unknown pixels on every side.
void add_margin(DepthChart& chart, int pixels);

}  // namespace isobath
