// PositionTable: positions of bodies over time, from a table with a line of column names, such as AIS reports, the
// contacts of a radar or of a diver's sonar, or detections made elsewhere.
//
// Columns, by name in any case: time (ISO 8601 in UTC, or seconds) or time_s; latitude and longitude in degrees
// (latitude, latitude_degrees, latitude_deg, lat; longitude likewise), or north and east in metres (north, north_m;
// east, east_m); and where they are there a name of the body (mmsi, id, body), its course (cog_degrees, course_deg) and
// its speed (sog_knots, speed_knots, speed_mps). The name, course and speed are for scores only: no tracker sees them.
//
// The origin of W is the first position. Untrusted: a row without a time or a possible position is left out and
// counted, as is one farther than `kFarthest` from the first. More than `kMostRows` rows are an Error. Rows are sorted
// by time.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <filesystem>
#include <isobath/base/time.hpp>
#include <isobath/geometry/geodesy.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

struct PositionTable {
  static constexpr double kFarthest = 1e5;  ///< m
  static constexpr std::size_t kMostRows = 5'000'000;

  struct Row {
    Time time;
    Eigen::Vector2d p_W = Eigen::Vector2d::Zero();
    std::optional<std::size_t> body;            ///< index of `names`
    std::optional<Eigen::Vector2d> velocity_W;  ///< from course and speed, m/s
  };
  std::vector<Row> rows;
  std::vector<std::string> names;  ///< of the bodies
  std::optional<GeoOrigin> origin;
  std::map<std::string, std::uint64_t> left_out;  ///< reason: rows
  std::uint64_t out_of_order = 0;                 ///< rows that are earlier than a row above them
};

/// Throws Error if the file cannot be read, or lacks the columns of time and position, or has no usable row.
PositionTable read_positions(const std::filesystem::path& file);

}  // namespace isobath
