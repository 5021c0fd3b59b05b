// ScanShapes: a level scan told as lines and arcs, each with the echoes that it accounts for (Auran, Silven 1995, 3.1,
// after Mathisen 1993; ledger S4-45, S4-47).
//
// Each shape takes neighbouring echoes. Of all ways to part the scan into shapes and echoes that nothing accounts for,
// the one of the least
//   sum of min(deviation^2, miss)  +  miss for each echo without a shape  +  price of each shape
// is found by dynamic programming over the bearings (Bellman 1961), from the widest gap on round the turn; runs of
// which a quarter fits nothing are not drawn on. An echo beyond sqrt(miss) deviations stays without a shape, too. So
// the counts add up: every echo is of one shape, or of none.
//
// Where two lines that follow one another meet near their ends there is a corner; both are fitted again, with the
// echoes near it counting less, and meet in the place that is told.
//
// Plan coordinates (north, east) of W, m. Pure. Cost: about n x (longest shape) fits; 6 ms for 140 echoes in a room
// (bench/README.md), 80 ms inside a round tank, where every part of it is an arc.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/perception/plane_shapes.hpp>
#include <variant>
#include <vector>

namespace isobath {

struct ScanShapesConfig {
  double miss = 9;         ///< squared deviations that an echo may have: 3 standard deviations
  double line_price = 14;  ///< in squared deviations
  double arc_price = 24;
  int least_line = 4;  ///< echoes
  int least_arc = 5;
  Angle least_sweep = Angle::degrees(40);  ///< of an arc; what turns less is a line
  Angle gap = Angle::degrees(10);          ///< between neighbouring echoes of one shape
  double gap_m = 4;                        ///< between them, too
  double corner_m = 2;                     ///< from a corner to the ends of its lines, at most
};

struct ScanShape {
  std::variant<PlaneLine, PlaneArc> shape;
  std::vector<std::size_t> echoes;  ///< of the scan, accounted for
  [[nodiscard]] const PlaneLine* line() const { return std::get_if<PlaneLine>(&shape); }
  [[nodiscard]] const PlaneArc* arc() const { return std::get_if<PlaneArc>(&shape); }
};
struct ScanCorner : PlaneCorner {
  std::size_t first = 0, second = 0;  ///< shapes
};
struct ScanShapes {
  std::vector<ScanShape> shapes;  ///< in order of bearing, from the widest gap on
  std::vector<ScanCorner> corners;
  std::vector<std::size_t> unassigned;
};

/// `scan` is sorted.
ScanShapes shapes_of(const PlaneScan& scan, const ScanShapesConfig& config = {});

}  // namespace isobath
