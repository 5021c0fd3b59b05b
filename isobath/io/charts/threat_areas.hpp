// ThreatAreas: areas in which the vehicle may be detected or destroyed, known before the mission (Oskard 1990, III-D;
// ledger S1-37).
//
// read_threat_areas reads the polygons of a GeoJSON, shapefile or GeoPackage. Their attributes, all optional but one of
// the first two:
//   detection    probability that a vehicle is detected on `over_m` metres of path inside the area, 0 to less than 1
//   destruction  the same of being destroyed
//   over_m       that length; 1000 m if it is not given
//   name         for messages
// Points are (north, east) of W, m. A file that is damaged, has no such polygon, or a value outside these ranges, is
// refused with one line (Error). Shapes without such attributes, and what is no polygon, are refused too: a threat that
// is left out would make a path look safe.
#pragma once

#include <filesystem>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/geometry/polygon.hpp>
#include <string>
#include <vector>

namespace isobath {

struct ThreatArea {
  std::vector<Polygon> rings;  ///< the outlines and their holes, in either direction
  std::string name;
  double detection = 0;
  double destruction = 0;
  double over_m = 1000;
};

/// Throws Error.
std::vector<ThreatArea> read_threat_areas(const std::filesystem::path& file, const LocalPlane& plane);

}  // namespace isobath
