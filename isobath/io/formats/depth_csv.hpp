// DepthCsv: tables of comma-separated text with a position and a depth in each row. The user declares the columns.
//
// Nothing is guessed. InputConfig::survey states the columns (csv_columns, for example
// "time=Date,latitude=Lat,longitude=Lon,depth=Depth"), the unit and sign of depths, the kind of positions and the kind
// of times. Depths are below the water surface. The columns are
//   latitude and longitude   degrees on WGS 84 (csv_position "degrees")
//   northing and easting     metres in a zone of the UTM grid (csv_position "utm 33N")
//   depth                    required
//   time                     ISO 8601, in UTC or in local time (less utc_offset_h); or seconds. Absent: one second from
//                            row to row
//   heading                  degrees from true north. Absent: the course over the last 1 m or more of track
// A row gives a Navigation (B on the water, roll and pitch 0) and a RangeReading that looks down from
// transducer_depth_m. The beam is not known: its width is 7 degrees, as in nmea.hpp, unless InputConfig::beam_width
// sets it.
//
// Rows with a missing or impossible time or position are refused and counted. A depth of 0 or above the water means "no
// bottom": it is counted and gives no reading, but the row still gives its position. Errors: throws Error if no columns
// are declared (the message lists the columns of the file), if a declared column is missing, if no depth or position is
// declared, or if the kind of position is unknown.
#pragma once

#include <filesystem>
#include <isobath/event/event.hpp>
#include <isobath/io/bytes/bytes.hpp>
#include <isobath/io/input/input_config.hpp>
#include <istream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

/// Whether columns are declared and the line of names holds one of them.
bool looks_like_depth_csv(Bytes head, const SurveyInput& config);
std::unique_ptr<Source> open_depth_csv(const std::filesystem::path& file, const InputConfig& config);
std::unique_ptr<Source> open_depth_csv(std::unique_ptr<std::istream> input, const std::string& name,
                                       const InputConfig& config);

/// InputConfig::survey.csv_position: a zone of the UTM grid such as "utm 33N", or "degrees": empty. Throws Error.
struct UtmZone {
  int zone = 0;
  bool northern = true;
};
std::optional<UtmZone> utm_zone_of(std::string_view position);
double metres_of(DepthUnit unit);

/// The column names of a text that looks like a table; empty: it does not look like one.
std::vector<std::string> table_columns(Bytes head);
inline constexpr const char* kDeclareColumns =
    "declare them, as in --set input.csv_columns=\"latitude=NAME,longitude=NAME,depth=NAME\", with "
    "input.csv_depth_unit and input.csv_depth_sign";

}  // namespace isobath
