// What a run writes of its depth map: charts, contours, a raster, and the part of the report that shows them.
#pragma once

#include <filesystem>
#include <isobath/runtime/depth_outcome.hpp>
#include <isobath/runtime/depth_model.hpp>
#include <isobath/runtime/html_report.hpp>
#include <string>
#include <vector>

namespace isobath {

/// PNG; empty where nothing is known.
struct DepthPictures {
  std::string depth, confidence;
};

/// Writes depth.tif, chart.png, confidence.png, and contours.geojson where the place is known, into `folder`; their
/// names are appended to `files`. Throws Error where they cannot be written.
DepthPictures write_depth_files(const DepthModel& model, const std::filesystem::path& folder,
                                std::vector<std::filesystem::path>& files);

/// What sonar changed against the charts: the first `most` regions.
void add_changes(HtmlReport& page, const MapChanges& changes, const std::optional<GeoOrigin>& origin,
                 std::size_t most = 50);
void add_depth(HtmlReport& page, const DepthOutcome& depth, const DepthPictures& pictures);

}  // namespace isobath
