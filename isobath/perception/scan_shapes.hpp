// ScanShapes: a level scan described by lines and arcs, each with the echoes that it explains (Auran, Silven 1995, 3.1,
// after Mathisen 1993; ledger S4-45, S4-47).
//
// Each shape explains neighbouring echoes. Of all partitions of the scan into shapes and echoes without a shape, the
// one that minimises
//   sum of min(deviation^2, miss)  +  miss for each echo without a shape  +  price of each shape
// is found by dynamic programming over the bearings (Bellman 1961), starting at the widest gap. A run is not extended
// once a quarter of its echoes does not fit. An echo beyond sqrt(miss) deviations has no shape either. So each echo
// belongs to one shape or to none.
//
// Two consecutive lines that meet near their ends form a corner. Both are fitted again with reduced weights of the
// echoes near it, and the corner is their intersection.
//
// Plan coordinates (north, east) of W, m. Pure. Cost: about n x (longest shape) fits; 6 ms for 140 echoes in a room
// (bench/README.md), 80 ms inside a round tank, where each part of it is an arc.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/perception/plane_shapes.hpp>
#include <variant>
#include <vector>

namespace isobath {

struct ScanShapesConfig {
  double miss = 9;         ///< maximum squared deviation of an echo: 3 standard deviations
  double line_price = 14;  ///< in squared deviations
  double arc_price = 24;
  int min_line = 4;  ///< minimum number of echoes
  int min_arc = 5;
  Angle min_sweep = Angle::degrees(40);  ///< minimum sweep of an arc; a shape that turns less is a line
  Angle gap = Angle::degrees(10);        ///< maximum angle between neighbouring echoes of one shape
  double gap_m = 4;                      ///< maximum distance between them
  double corner_m = 2;                   ///< maximum distance from a corner to the ends of its lines
};

struct ScanShape {
  std::variant<PlaneLine, PlaneArc> shape;
  std::vector<std::size_t> echoes;  ///< indices of the echoes in the scan that it explains
  [[nodiscard]] const PlaneLine* line() const { return std::get_if<PlaneLine>(&shape); }
  [[nodiscard]] const PlaneArc* arc() const { return std::get_if<PlaneArc>(&shape); }
};
struct ScanCorner : PlaneCorner {
  std::size_t first = 0, second = 0;  ///< indices of its lines in `shapes`
};
struct ScanShapes {
  std::vector<ScanShape> shapes;  ///< in order of bearing, starting at the widest gap
  std::vector<ScanCorner> corners;
  std::vector<std::size_t> unassigned;
};

/// `scan` must be sorted.
ScanShapes shapes_of(const PlaneScan& scan, const ScanShapesConfig& config = {});

}  // namespace isobath
