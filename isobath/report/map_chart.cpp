#include <algorithm>
#include <cstdint>
#include <isobath/report/map_chart.hpp>
#include <limits>
#include <utility>
#include <vector>

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

namespace {

/// The rows of a window within a larger one; `unknown` elsewhere.
template <class Value>
void widen(std::vector<Value>& values, const PixelWindow& window, int by, Value unknown) {
  if (values.empty()) return;
  const int width = window.width + 2 * by;
  std::vector<Value> wide(static_cast<std::size_t>(width) * static_cast<std::size_t>(window.height + 2 * by), unknown);
  for (int row = 0; row < window.height; ++row) {
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(row) * window.width, window.width,
                wide.begin() + static_cast<std::ptrdiff_t>(row + by) * width + by);
  }
  values = std::move(wide);
}

}  // namespace

void add_margin(DepthChart& chart, int pixels) {
  widen(chart.depth_m, chart.window, pixels, std::numeric_limits<float>::quiet_NaN());
  widen(chart.confidence, chart.window, pixels, std::uint8_t{255});
  widen(chart.flags, chart.window, pixels, std::uint8_t{0});
  chart.window = {chart.window.column - pixels, chart.window.row - pixels, chart.window.width + 2 * pixels,
                  chart.window.height + 2 * pixels};
}

}  // namespace isobath
