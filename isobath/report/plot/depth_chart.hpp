// depth_chart_png, confidence_chart_png: printable charts of depth and of confidence in a window of a depth map, as PNG
// (ledger S1-17, S1-18, S1-27, S1-77).
//
// Soundings lie along lines, half a metre wide, with unsurveyed water between them. A depth chart therefore
// distinguishes three kinds of water:
//   measured      a sensor's depth, or a charted one that a depth sonar has confirmed: full colour, drawn at least
//                 three picture pixels wide
//   charted       a depth of the map that no sensor has confirmed: paler, hatched
//   interpolated  the depth of `surface` between soundings: paler, fading with the distance to the nearest measured
//                 pixel; blank beyond `reach_m`
//
// Contours are solid, and dashed ("approximate") where the nearest sounding is farther than half the reach. They are
// traced through depths averaged over about three of their cells: for reading, not for clearances. The figures are
// soundings: the shoalest measured pixel of its surroundings, rounded to the shoaler decimetre (metre from 31 m on). A
// picture pixel shows the mean depth of the measured map pixels that it overlaps, else of the charted ones; in the
// confidence chart it shows their mean confidence, rounded down.
//
// A chart does not know the soundings outside its window: if they matter, add a margin of the reach to the window.
// Shore: closed rings. On land only soundings are drawn. Water is the side, inside or outside of an odd number of
// rings, that holds most known pixels. Depths m, positive down; positions (north, east) of W, m. Colours are even in
// lightness (Oklab) and safe for colour-blind readers. The same input gives the same bytes. Errors: only those of
// drawing. Cost: 1 s for a sheet of 1400 x 1000, plus one call of `surface` for every 9 picture pixels within reach.
#pragma once

#include <isobath/geometry/contours.hpp>
#include <isobath/report/plot/chart_field.hpp>
#include <isobath/report/plot/picture.hpp>
#include <string>
#include <vector>

namespace isobath {

struct ChartLook {
  int plot_px = 1400;  ///< longer side of the plot
  bool soundings = true;
};

std::string depth_chart_png(const DepthChart& chart, const ChartLook& look = {});
/// Classes 0-4, 5-9, 10-14, 15-19 and 20; grey where unknown. `confidence` must not be empty.
std::string confidence_chart_png(const DepthChart& chart, const ChartLook& look = {});

/// The contours of such a chart at round levels, in (north, east), traced on a grid of `node_m`.
std::vector<ContourLine> depth_contours(const DepthChart& chart, double node_m);

/// Share 0 (shoal, light) to 1 (deep, dark).
Colour depth_colour(double share);

}  // namespace isobath
