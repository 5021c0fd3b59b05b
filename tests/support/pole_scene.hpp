// A pole on the straight way of 45 m, in water without a bottom: seconds of simulation, hundredths of work.
#pragma once

namespace isobath::test {

inline constexpr const char* kPoleScene = R"(
[scene]
title = "a pole on the way"
duration_s = 60
seed = 3
[vehicle]
start = [0, 0, 10]
speed = 1.5
[[waypoint]]
north = 45
depth = 10
[[cylinder]]
name = "pole"
centre = [26, 0.3, 10]
radius = 0.5
length = 20
[[sonar]]
preset = "micron"
sector_deg = 120
range_m = 40
bins = 80
interval_s = 0.06
blanking_m = 1.5
spurious_share = 0
noise_level = 15
noise_sigma = 5
)";

}  // namespace isobath::test
