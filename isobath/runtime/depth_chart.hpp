// The charts that people print: depth, and confidence, of a window of a depth map, as PNG (ledger S1-17, S1-18, S1-27,
// S1-77).
//
// Soundings lie along lines, half a metre wide, with unsurveyed water between them. A depth chart therefore tells three
// waters apart, and claims nothing further:
//   measured      a sensor's depth, or a charted one that a depth sonar has confirmed: full colour, drawn at least
//                 three picture pixels wide
//   charted       a depth of the map that no sensor has confirmed: paler, hatched
//   interpolated  what `surface` says between soundings: paler, fading with the distance to the nearest measured pixel,
//                 and nothing beyond `reach_m`
// Contours are solid, and dashed ("approximate") where the nearest sounding is farther than half the reach. They are
// traced through depths averaged over about three of their cells: for reading, not for clearances. The figures are
// soundings: the shoalest measured pixel of its surroundings, rounded to the shoaler decimetre (metre from 31 m on).
// A picture pixel shows the mean depth of the measured map pixels that it overlaps, else of the charted ones; in the
// confidence chart their mean confidence, rounded down.
// Soundings outside of the window are not known to a chart: ask for the window with a margin of the reach if they
// count. Shore: closed rings; on land only soundings are drawn; water is the side, inside or outside of an odd number
// of rings, that holds most known pixels. Depths m, positive down; positions (north, east) of W, m. Colours are even in
// lightness (Oklab) and told apart by people who are colour-blind. The same input gives the same bytes. Errors: none
// but those of drawing. Cost: 1 s for a sheet of 1400 x 1000, plus one call of `surface` for every 9 picture pixels
// within reach.
#pragma once

#include <isobath/geometry/contours.hpp>
#include <isobath/runtime/chart_field.hpp>
#include <isobath/runtime/picture.hpp>
#include <string>
#include <vector>

namespace isobath {

struct ChartLook {
  int plot_px = 1400;  ///< longer side of the plot
  bool soundings = true;
};

std::string depth_chart_png(const DepthChart& chart, const ChartLook& look = {});
/// Classes 0-4, 5-9, 10-14, 15-19 and 20; grey where nothing is known. `confidence` must not be empty.
std::string confidence_chart_png(const DepthChart& chart, const ChartLook& look = {});

/// The contours of such a chart in (north, east), traced on a grid of `node_m`; at nice levels.
std::vector<ContourLine> depth_contours(const DepthChart& chart, double node_m);

/// Share 0 (shoal, light) to 1 (deep, dark).
Colour depth_colour(double share);

}  // namespace isobath
