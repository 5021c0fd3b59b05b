// Outlines that a person drew on pictures with LabelMe: the JSON of the program (Wada) and the XML of the web tool of
// 2008 (Russell et al.), which Horner et al. c. 2009, 4.1.2, used (ledger S5-24).
//
// A pixel is marked if its centre lies inside a polygon (even-odd rule; the left and upper edges belong to the
// polygon). Pixels of several polygons count once. Coordinates are pixels of the picture; (0, 0) is its upper left
// corner. JSON: "shapes" with "shape_type" polygon or rectangle, whatever their label; "imageWidth" and "imageHeight",
// if stated, must equal the picture's. XML: <object> with <polygon> of <pt>; objects with <deleted>1</deleted> are left
// out.
//
// Input is untrusted. Errors: throws Error if the text has neither format, another shape, a coordinate that is not a
// number or far outside, over 10000 shapes or over a million points.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

/// Whether the text may be annotations: JSON with "shapes" or XML with <annotation>.
bool looks_like_polygon_marks(std::string_view text);

/// width x height values, row after row from the top; 1 where marked.
std::vector<std::uint8_t> parse_polygon_marks(std::string_view text, int width, int height, const std::string& file);

}  // namespace isobath
