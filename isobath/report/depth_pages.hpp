// Files and report pages of a run's depth map: charts, contours, a raster, and the section of the report that shows
// them.
#pragma once

#include <filesystem>
#include <isobath/report/depth_outcome.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/report/plot/chart_layout.hpp>
#include <isobath/world/depth_model.hpp>
#include <string>
#include <vector>

namespace isobath {

/// PNG; empty if nothing is known.
struct DepthPictures {
  std::string depth, confidence;
};

/// Writes depth.tif, chart.png, confidence.png and, if the map has an origin, contours.geojson into `folder`, and
/// appends their names to `files`. Throws Error if they cannot be written.
DepthPictures write_depth_files(const DepthModel& model, const ChartSource& source, const std::filesystem::path& folder,
                                std::vector<std::filesystem::path>& files);

/// Table of the regions that sonar changed against the charts: the first `most`.
void add_changes(HtmlReport& page, const MapChanges& changes, const std::optional<GeoOrigin>& origin,
                 std::size_t most = 50);
void add_depth(HtmlReport& page, const DepthOutcome& depth, const DepthPictures& pictures);

}  // namespace isobath
