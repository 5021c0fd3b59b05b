// DepthCsv: tables of comma-separated text with a position and a depth in each row, whose columns the user declares.
//
// Nothing is guessed: InputConfig::survey says what the columns are (csv_columns, "time=Date,latitude=Lat,
// longitude=Lon,depth=Depth"), the unit of depths and their sense, the kind of positions and of times. Depths are below
// the water. What a column can be:
//   latitude and longitude   degrees on WGS 84 (csv_position "degrees")
//   northing and easting     metres in a zone of the UTM grid (csv_position "utm 33N")
//   depth                    needed
//   time                     ISO 8601 in UTC or, less utc_offset_h, local; or seconds. Absent: one second from row to
//   row heading                  degrees from true north. Absent: the course from the last position 1 m away or more
// A row gives a Navigation (B on the water, roll and pitch 0) and a RangeReading that looks down from
// transducer_depth_m. The beam is not known: 7 degrees, as in nmea.hpp, unless InputConfig::beam_width says otherwise.
//
// Rows with a missing or impossible time or position are refused and counted; a depth of 0 or above the water is "no
// bottom": counted, and no reading, its position stays. Throws Error: no declaration (naming the columns that there
// are), one that names a column that is not there or no depth or position, an unknown kind of position.
#pragma once

#include <filesystem>
#include <isobath/io/bytes.hpp>
#include <isobath/io/event.hpp>
#include <isobath/io/input_config.hpp>
#include <istream>
#include <memory>
#include <string>

namespace isobath {

/// Whether columns are declared and the first line of the text holds one of them.
bool looks_like_depth_csv(Bytes head, const SurveyInput& config);
std::unique_ptr<Source> open_depth_csv(const std::filesystem::path& file, const InputConfig& config);
std::unique_ptr<Source> open_depth_csv(std::unique_ptr<std::istream> input, const std::string& name,
                                       const InputConfig& config);

/// The names in the first line of a text that looks like a table with names, joined by ", "; empty: it does not.
std::string table_names(Bytes head);
inline constexpr const char* kDeclareColumns =
    "say what they are, as in --set input.csv_columns=\"latitude=NAME,longitude=NAME,depth=NAME\", with "
    "input.csv_depth_unit and input.csv_depth_sign";

}  // namespace isobath
