// Pings with more range bins than a map can use, as pings with fewer: each new bin is the mean of so many neighbours.
//
// Why: single samples of an echo are speckle. The mean of n independent ones varies by 1 / sqrt(n) as much, so that the
// same echo stands out further; what is lost is range resolution below a map's cell. A map's cell goes with the range
// of the sonar (a voxel is 1/200 of it), and so does the measure here: a bin is to be no shorter than 1/most_bins of
// the way from the sonar to the end of its window. Of an ARIS's samples of 1 cm up to 23 m, four go together.
//
// Means are of the counts as they are (decibels stay decibels) and rounded to whole ones where samples are whole. Bins
// at the far end that fill no new one are dropped, and a new bin counts as sampled where all of it was. Pings with few
// enough bins pass untouched, as do all other events.
#pragma once

#include <isobath/io/event.hpp>
#include <memory>

namespace isobath {

/// `most_bins` of 0: the source as it is.
std::unique_ptr<Source> with_pooled_bins(std::unique_ptr<Source> source, int most_bins);

}  // namespace isobath
