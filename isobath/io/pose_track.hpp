// PoseTrack: fixes of the vehicle in a table of comma-separated text, beside any log.
//
// The line of names says which columns there are, in any order; other columns are passed over:
//   time       t_s (seconds), time_us (microseconds since 1970), or time (ISO 8601, UTC: 2024-03-13T15:50:16.25Z)
//   position   north_m, east_m, depth_m; or x, y, z (the same in W: north, east, down); or lat_deg, lon_deg (WGS 84)
//   with depth_m if
//              there is one (0 otherwise): then local metres start at the first row, and the report holds that origin
//   attitude   heading_deg, with pitch_deg and roll_deg if there are (0 otherwise); or qw, qx, qy, qz (body to world)
//   velocity   vn, ve, vd in m/s: optional
// lat_deg and lon_deg beside metres tie these to the globe by the first row.
// Rows that lack a value, hold one that is not finite or impossible, or go back in time are rejected and counted.
// Errors: a line of names without time, position or attitude, or with two of a kind, throws Error with file and line.
#pragma once

#include <filesystem>
#include <isobath/io/event.hpp>
#include <istream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace isobath {

/// Why rows of poses are refused: the reasons in SourceReport::rejected, here and in folders of frames.
inline constexpr const char* kBadPose = "pose row with a missing or impossible value";
inline constexpr const char* kPoseBackwards = "pose row that goes back in time";

std::unique_ptr<Source> open_pose_track(const std::filesystem::path& file);
std::unique_ptr<Source> open_pose_track(std::unique_ptr<std::istream> input, const std::string& name);

/// "2024-03-13T15:50:16.25Z" (Z may be absent, up to nine decimals, "T" or a blank); years 1970 to 2200.
std::optional<Time> time_from_iso(std::string_view text);

/// The events of a log and the fixes of a track in one stream, by time; of the same time, fixes come first. Where a log
/// is out of order it stays so. Fixes of the log itself are dropped and counted: the track takes their place. Bytes and
/// damages are those of the log, rejections those of both.
std::unique_ptr<Source> merge_by_time(std::unique_ptr<Source> log, std::unique_ptr<Source> track);

}  // namespace isobath
