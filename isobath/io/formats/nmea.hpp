// NMEA 0183 depth tracks: the sentences of a GPS, a compass and an echo sounder on one wire, recorded as text.
// NmeaDecoder describes what the sentences give.
//
// Lines end in CR, LF or CR LF. Text that is no sentence is damage. If the first 64 KiB of a log have no date, days are
// counted from its start.
//
// Throws nothing. Checked on 22 minutes of a sailing boat (OpenCPN, Hakefjord.log): 7528 DPT give 7528 readings. That
// file holds the same recording four times over, so its times step back three times; after 20 positions the clock
// follows.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>

namespace isobath {

/// Whether most of the first lines are sentences with a right checksum.
bool looks_like_nmea(Bytes head);
std::unique_ptr<Source> open_nmea(ByteWindow input, const InputConfig& config);

}  // namespace isobath
