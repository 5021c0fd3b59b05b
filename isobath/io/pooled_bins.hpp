// Pings with more range bins than a map can use, as pings with fewer: each new bin is the mean of so many neighbours.
//
// Why: single samples of an echo are speckle. The mean of n independent ones varies by 1 / sqrt(n) as much, so that the
// same echo stands out further; what is lost is range resolution below a map's cell. An ARIS takes 2000 samples of 1 cm
// (input.most_bins).
//
// Means are of the counts as they are (decibels stay decibels) and rounded to whole ones where samples are whole. Bins
// at the far end that fill no new one are dropped. Pings with few enough bins pass untouched, as do all other events.
#pragma once

#include <isobath/io/event.hpp>
#include <memory>

namespace isobath {

/// The source with at most so many bins in a beam; `most_bins` of 0: as it is.
std::unique_ptr<Source> with_pooled_bins(std::unique_ptr<Source> source, int most_bins);

}  // namespace isobath
