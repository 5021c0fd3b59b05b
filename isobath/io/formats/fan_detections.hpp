// Fan detections: tables of what the detector of an imaging fan has kept, range and bearing, with the track of the
// vehicle in tables beside it. ARACATI 2017 (Federal University of Rio Grande) has been published in this form.
//
// Each table is comma-separated text and is recognised by its column names, in any order:
//   detections       time_s, range_m, bearing_deg (positive to starboard); other columns are ignored
//   satellite track  time, x, y, theta and no others: x east, y north in m; theta is the heading of the COMPASS in
//                    radians, clockwise from north
//   dead reckoning   time, x, y and no others: likewise, in a frame of its own
// Times are seconds since 1970 or since any start. A folder with one table of detections and one satellite track is one
// log; a table of detections alone is a log without poses (InputConfig::navigation gives it some).
//
// The detections of one time are one Swath: points in the water, in the plane of the fan at the body's origin, turned
// by mount_heading. The fan does not resolve elevation (Swath::beam_height; 20 degrees unless set), states no intensity
// and no beam without an echo. Each row of the track is a Navigation at depth 0, roll and pitch 0. Those of the
// satellite receiver have position_sigma_m and heading_sigma as standard deviations, those of dead reckoning none.
//
// InputConfig::track chooses the track. Dead reckoning states no heading: it takes that of the compass. Its frame is
// turned onto that of the compass, so that the vehicle moves ahead on average, and shifted so that its first position
// is the receiver's: a vehicle that dives after a fix. Nothing else of the receiver gets into it. On ARACATI 2017 the
// turn is 31.7 degrees.
//
// Rows that lack a value or hold an impossible one, and track rows that go back in time, are rejected and counted.
// Detections that go back in time are passed on; the gate rejects them. Errors: throws Error where a folder holds two
// tables of a kind, or not the track that is asked for.
#pragma once

#include <filesystem>
#include <isobath/event/event.hpp>
#include <isobath/io/bytes/bytes.hpp>
#include <isobath/io/input/input_config.hpp>
#include <istream>
#include <memory>
#include <string>

namespace isobath {

inline constexpr const char* kBadDetection = "detection with a missing or impossible value";
inline constexpr const char* kNoHeading = "dead reckoning at a time without a compass heading";

bool looks_like_fan_detections(Bytes head);
/// Whether a file of the folder is a table of detections.
bool looks_like_fan_folder(const std::filesystem::path& folder);

/// A table of detections alone.
std::unique_ptr<Source> open_fan_detections(const std::filesystem::path& file, const InputConfig& config);
std::unique_ptr<Source> open_fan_detections(std::unique_ptr<std::istream> input, const std::string& name,
                                            const InputConfig& config);
/// The detections of a folder, and the track that the settings choose, by time.
std::unique_ptr<Source> open_fan_folder(const std::filesystem::path& folder, const InputConfig& config);
/// The satellite track of such a folder; null: there is none.
std::unique_ptr<Source> open_reference_of_fan_folder(const std::filesystem::path& folder, const InputConfig& config);

/// The fixes of the two kinds of tracks. `compass`: a satellite track, whose headings are used.
std::unique_ptr<Source> open_satellite_track(std::unique_ptr<std::istream> input, const std::string& name,
                                             const InputConfig& config);
std::unique_ptr<Source> open_dead_reckoning(std::unique_ptr<std::istream> input, const std::string& name,
                                            std::unique_ptr<Source> compass);

}  // namespace isobath
