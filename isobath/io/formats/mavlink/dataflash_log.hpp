// ArduPilot DataFlash logs (.BIN): records A3 95, a type of one byte, fields. Records of type 128 (FMT) state length,
// name, format and labels of each type, so that the log describes itself. Fields are found by their labels.
//
// Read are
//   ATT          attitude, from which each Navigation comes (navigation_parts.hpp)
//   XKF1, NKF1   position, velocity and depth of the first core of the filter; ORGN ties them to the globe
//   POS          position and depth, in a log without these
//   RFND         a RangeReading along its orientation, 25 degrees wide unless InputConfig::beam_width sets it, at the
//                origin of the body moved by InputConfig::mount_m; only those whose status is good
// Times are seconds since the autopilot started: a log has no date.
//
// The report counts the records by name. Bytes that are no record are damage; a record cut off by the end is, too.
// Throws nothing.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>

namespace isobath {

bool looks_like_dataflash_log(Bytes head);
std::unique_ptr<Source> open_dataflash_log(ByteWindow input, const InputConfig& config);

}  // namespace isobath
