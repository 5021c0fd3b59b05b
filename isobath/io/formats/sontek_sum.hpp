// SonTek RiverSurveyor summary export (.sum): one sample per second of an M9 or S5 current profiler with its GPS.
//
// A heading line of names ("Sample #,Date/Time,Frequency (MHz),...") precedes samples of 22 comma-separated fields.
// Lines end in CR, LF or CR LF. Times are local times in US format on a 12-hour clock, without a zone: they are taken
// as UTC, less InputConfig::survey.utc_offset_h. Positions are degrees, minutes and seconds with a Latin-1 degree sign
// and no hemisphere (north and east; a minus or a trailing S or W negates them). Columns are found by name.
//
// A sample gives a Navigation and up to five RangeReadings: the vertical echo sounder (0.5 MHz) and four beams that
// lean 25 degrees (3 MHz shallow, 1 MHz deep, switched by the device; Sanders, Orlinsky, CHC 2016). Depth fields are
// vertical depths below the water, so that range = (depth - z of p_WS) / (z of the beam's axis in W): the end of the
// range is exactly at the recorded depth, on the axis of the tilted beam.
//
// Meaning of the fields. SonTek's manual (RiverSurveyor S5/M9, February 2013, p. 95) says that VB_Depth and
// BT_Beam_Depth include the transducer depth and compensation for tilt. Measured on 30983 samples of Lake Caputh (16
// runs, 4 days):
// - Draught (0.07 m there): the mean of the four slant depths less the vertical one approaches +0.007 m at depth 0
//   (slope -0.3 %), so either all five include it or none does. The reader follows the manual. No sounding there is at
//   a known depth.
// - Beams 1, 2, 3, 4 point to 315, 225, 135, 45 degrees, counter-clockwise from port bow, whatever the Frequency field
//   says. Bow and stern: the footprints fit the vertical beam's own track best +0.58 +0.74 of the lean ahead for beam
//   1, -0.69 -0.47 for 2, -0.50 -0.59 for 3, +0.81 +0.67 for 4 (1 and 3 MHz; cos 45 is 0.71, none is at 0 or 1), and
//   slopes by bow less stern beams correlate with those along the track by +0.73. Port and starboard: where tracks
//   cross at right angles, slopes by beams 4 less 1 and 3 less 2 correlate with the vertical beam's slope along the
//   other track by +0.52 and +0.70 (7353 pairs within 3 m), and have its sign in 64 of 75 crossings. Of the 24 mappings
//   this one also has the smallest spread of footprints about the vertical beam's soundings within 1.0, 1.5 and 2.0 m,
//   but only by 2 % (0.0644 m rms; its mirror image 0.0658), since positions are known only to a metre.
// - Tilt is corrected: (port - starboard) / depth changes with roll by -0.0013 +-0.0003 a degree and (bow - stern) /
//   depth with pitch by +0.0003 +-0.0002, where uncorrected depths would change by 0.0058. Which side is down at
//   positive roll is not known; starboard is assumed (at the 2 degrees of that boat this moves footprints by 4 % of
//   depth to one side).
// - Slant depths less the vertical beam's at their footprints: +0.017, +0.009, -0.025, -0.021 m (beams 1 to 4), as if
//   roll were measured 0.5 degrees wrong. They are not corrected here.
// - Heading already includes the declination entered in the set-up (4.5 degrees there): the boat's direction by bottom
//   track, turned by that heading, lies 1.0 to 1.6 degrees clockwise of the GPS course on each day, not 4.5 short.
//   InputConfig::survey.declination is added nevertheless, for set-ups that left it out.
// - Time: track by bottom track fits the track by GPS best at a lag of +0.06 s (0.157 m rms; 0.18 m at +-1 s): position
//   and depth of a sample belong together.
// No published beam widths were found; 3 degrees are assumed unless InputConfig::beam_width sets the width.
//
// A depth of 0 means "no lock": it is counted by beam and gives no reading (a failed reading is not evidence: ledger
// S1-64). Samples without a readable time or position are refused and counted; lines that are not samples are damage.
// Errors: throws Error if the heading lacks a required column, or if depths are in feet.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>

namespace isobath {

bool looks_like_sontek_sum(Bytes head);
std::unique_ptr<Source> open_sontek_sum(ByteWindow input, const InputConfig& config);

}  // namespace isobath
