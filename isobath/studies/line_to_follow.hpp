// line_to_follow: the line of a map that a path is to follow: a pipeline, the coast or another line feature of the map,
// or the contour line of a depth (ledger S1-24, S1-78).
#pragma once

#include <filesystem>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/map/depth/depth_map.hpp>
#include <isobath/world/map_features.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

struct LineWanted {
  /// Name or kind of a line feature ("pipeline", "coast", "contour"), in any case; "nearest": whichever is nearest.
  std::string feature;
  std::filesystem::path file;       ///< instead: lines that a person drew (drawn_lines.hpp)
  std::optional<double> contour_m;  ///< instead: where the map has this depth
  double cell_m = 2;                ///< contours are drawn through the shoalest depths of cells of this size

  [[nodiscard]] bool any() const { return !feature.empty() || !file.empty() || contour_m.has_value(); }
};

/// From the point of the line nearest to `start` to the one nearest to `end`, or to the farther end of the line;
/// (north, east) of W. All lines of the same kind, name and charted depth count as one where their ends meet. A contour
/// is simplified to half a cell, and rings below ten cells in length are left out. Throws Error if the map has no such
/// line. `origin` of W, which a file needs.
std::vector<Eigen::Vector2d> line_to_follow(const DepthSnapshot& depths, const MapFeatures& features,
                                            const LineWanted& wanted, const std::optional<GeoOrigin>& origin,
                                            const Eigen::Vector2d& start, const std::optional<Eigen::Vector2d>& end);

}  // namespace isobath
