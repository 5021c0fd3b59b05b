// Pictures of two recordings side by side (comparison.hpp), as PNG: charts of their statistics and images of their
// scans. The legends call the recordings `a` and `b`.
#pragma once

#include <isobath/report/plot/picture.hpp>
#include <isobath/studies/compare_outcome.hpp>
#include <string>

namespace isobath {

/// By range: median, 16 to 84 %, 99 %.
std::string level_chart(const CompareOutcome& c, const std::string& a, const std::string& b);
/// Share of the background samples by value, with the law that fits best.
std::string background_chart(const CompareOutcome& c, const std::string& a, const std::string& b);
/// Share of all samples beyond the blind zone that reach a level.
std::string exceedance_chart(const CompareOutcome& c, const std::string& a, const std::string& b);

PlanExtent extent_of(const PolarImage& image);
/// Plan view; the brightness is the square root of the level. `top`: the level of the brightest shade, counts.
std::string image_picture(const PolarImage& image, const PlanExtent& extent, double top, const std::string& title);
/// The level that 99.9 % of either recording's samples stay below, counts.
double top_of(const CompareOutcome& c);

}  // namespace isobath
