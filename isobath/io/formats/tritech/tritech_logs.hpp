// Logs of Tritech heads. tritech_device.hpp describes how lines become pings. Seanet Pro's own V4LOG has no public
// description: Seanet Pro must export it to CSV.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>

namespace isobath {

/// Raw frames of the serial line without times; times are estimated from the range setting and the serial line.
bool looks_like_tritech_stream(Bytes head);
std::unique_ptr<Source> open_tritech_stream(ByteWindow input, const InputConfig& config);

/// CSV export of Seanet Pro: a heading, then one line per ping: label, time of day, node, head status, HdCtrl, range
/// (0.1 m), gain, slope, ADLow, ADSpan, left limit, right limit, step, bearing (1/16 gradian), number of bins, bins.
/// The length of a bin is the range divided by the number of bins. Throws Error if nothing follows the heading.
bool looks_like_seanet_csv(Bytes head);
std::unique_ptr<Source> open_seanet_csv(ByteWindow input, const InputConfig& config);

}  // namespace isobath
