// Pings with finer range bins than a map can use, as pings with fewer bins: each new bin is the mean of adjacent bins.
//
// Why: single samples of an echo are speckle. The standard deviation of the mean of n independent samples is smaller by
// sqrt(n), so that the same echo stands out more; only range resolution below a map's cell is lost. The cell of a map
// grows with the range of the sonar (a voxel is 1/200 of it), and so does the limit here: a bin must be no shorter than
// 1/max_bins of the distance from the sonar to the end of its window. For an ARIS with samples of 1 cm up to 23 m and
// 1500 bins, two samples form a bin.
//
// Means are of the recorded counts (decibels stay decibels) and are rounded if samples are integers. Bins at the far
// end that do not fill a new bin are dropped. A new bin counts as sampled if all its parts were. Pings with few enough
// bins and all other events pass unchanged.
#pragma once

#include <isobath/event/event.hpp>
#include <memory>

namespace isobath {

/// Returns the source unchanged if `max_bins` is 0.
std::unique_ptr<Source> with_pooled_bins(std::unique_ptr<Source> source, int max_bins);

}  // namespace isobath
