// Scans of a mechanically scanned sonar as CSV, one ping per line: `# t_s,head_deg,bin_m,nbins,i0,i1,...`
//
// t_s: seconds since any start. head_deg: bearing of the head; InputConfig states its direction of growth and its zero.
// bin_m: length of a range bin; bin k covers [k, k + 1) bin_m. i: intensity 0..255. The beam is that of a Tritech
// Micron: 3 x 35 degrees. Throws Error if no line follows the heading, or if the first line states more bins than any
// sonar has.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>

namespace isobath {

bool looks_like_scan_csv(Bytes head);
std::unique_ptr<Source> open_scan_csv(ByteWindow input, const InputConfig& config);

}  // namespace isobath
