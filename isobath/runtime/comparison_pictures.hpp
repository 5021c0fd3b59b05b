// What two recordings look like side by side (comparison.hpp), as PNG: charts of their statistics, images of their
// scans. `a` and `b` are what the legends call them.
#pragma once

#include <isobath/runtime/compare_outcome.hpp>
#include <isobath/runtime/picture.hpp>
#include <string>

namespace isobath {

/// By range: median, 16 to 84 %, 99 %.
std::string level_chart(const CompareOutcome& c, const std::string& a, const std::string& b);
/// Share of the samples by value, in steps of a count; the law that is nearest beside it.
std::string background_chart(const CompareOutcome& c, const std::string& a, const std::string& b);
/// How many samples reach a level: all of them, behind the blind zone.
std::string exceedance_chart(const CompareOutcome& c, const std::string& a, const std::string& b);

PlanExtent extent_of(const PolarImage& image);
/// From above, the brightness a square root of the level; `top`: the level of the brightest shade, counts.
std::string image_picture(const PolarImage& image, const PlanExtent& extent, double top, const std::string& title);
/// What 99.9 % of either recording's samples stay below, counts.
double top_of(const CompareOutcome& c);

}  // namespace isobath
