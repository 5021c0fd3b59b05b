// DrawnLines: lines that a person drew on a chart, such as the route of a pipeline, from a GeoJSON, shapefile or
// GeoPackage (ledger S1-24). Points are (north, east) of W, m. What is no line is ignored; a file that is damaged or
// has no line is refused with one line (Error).
#pragma once

#include <filesystem>
#include <isobath/geometry/geodesy.hpp>
#include <vector>

namespace isobath {

/// Lines of two points or more; the parts of a multi-line apart. Throws Error.
std::vector<std::vector<Eigen::Vector2d>> read_drawn_lines(const std::filesystem::path& file, const LocalPlane& plane);

}  // namespace isobath
