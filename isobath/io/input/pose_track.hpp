// PoseTrack: fixes of the vehicle from a table of comma-separated text, for use with any log.
//
// The line of names states the columns, in any order; other columns are ignored:
//   time       t_s (seconds), time_us (microseconds since 1970), or time (ISO 8601, UTC: 2024-03-13T15:50:16.25Z)
//   position   north_m, east_m, depth_m; or x, y, z (the same in W: north, east, down); or lat_deg, lon_deg (WGS 84)
//              with depth_m if present (else 0): then local metres start at the first row, and the report holds that
//              origin
//   attitude   heading_deg, with pitch_deg and roll_deg if present (else 0); or qw, qx, qy, qz (body to world)
//   velocity   vn, ve, vd in m/s: optional
// If a table has both metres and lat_deg, lon_deg, the first row ties the metres to the globe.
// Rows that lack a value, hold one that is not finite or impossible, or go back in time are rejected and counted.
// Errors: throws Error with file and line if the line of names lacks time, position or attitude, or has two of a kind.
#pragma once

#include <filesystem>
#include <isobath/event/event.hpp>
#include <istream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace isobath {

/// Reasons in SourceReport::rejected for refused rows of poses, here and in folders of frames.
inline constexpr const char* kBadPose = "pose row with a missing or impossible value";
inline constexpr const char* kPoseBackwards = "pose row that goes back in time";

std::unique_ptr<Source> open_pose_track(const std::filesystem::path& file);
std::unique_ptr<Source> open_pose_track(std::unique_ptr<std::istream> input, const std::string& name);

/// The time in a text such as "2024-03-13T15:50:16.25Z": years 1970 to 2200, "T" or a blank, up to nine decimals, Z
/// optional.
std::optional<Time> time_from_iso(std::string_view text);

/// Merges the events of a log and the fixes of a track by time; at equal times, fixes come first. A log that is out of
/// order stays so. Fixes of the log itself are dropped and counted: the track replaces them. Bytes and damages are
/// those of the log, rejections those of both.
std::unique_ptr<Source> merge_by_time(std::unique_ptr<Source> log, std::unique_ptr<Source> track);

}  // namespace isobath
