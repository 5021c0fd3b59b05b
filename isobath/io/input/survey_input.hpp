// SurveyInput: settings for what the logs of survey boats do not state, and helpers that their readers share: SonTek
// .sum, NMEA 0183 and tables of depths.
//
// The reference point B of a boat is on the water surface: depth 0 of W. North and east are on the local plane
// (LocalPlane) of the first valid position. A transducer is transducer_depth_m below B and looks down: the x axis of a
// RangeReading's X_BS, which is the axis of the cone, points along z of B.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/event/event.hpp>
#include <string>
#include <vector>

namespace isobath {

enum class DepthUnit : std::uint8_t { kMetre, kFoot, kFathom };
enum class DepthSign : std::uint8_t { kDown, kUp };
enum class CsvTime : std::uint8_t { kIso, kSeconds };

struct SurveyInput {
  double utc_offset_h = 0;                       ///< offset of local times in the log, east positive
  double position_sigma_m = 1;                   ///< standard deviation of north and of east each
  Angle heading_sigma = Angle::degrees(3);       ///< standard deviation of the heading
  Angle declination;                             ///< added to recorded magnetic headings
  double transducer_depth_m = 0;                 ///< below the water; NMEA: 0 means as the log states
  std::string only, without;                     ///< file names of a folder: patterns with * and ?, separated by commas
  std::string csv_columns;                       ///< "latitude=Lat,longitude=Lon,depth=Depth": depth_csv.hpp
  DepthUnit csv_depth_unit = DepthUnit::kMetre;  ///< unit of the depth column
  DepthSign csv_depth_sign = DepthSign::kDown;   ///< direction in which depths grow
  std::string csv_position = "degrees";          ///< "degrees", or "utm 33N"
  CsvTime csv_time = CsvTime::kIso;              ///< ISO 8601, or seconds
};
std::vector<Field> fields(SurveyInput& config);

/// Maximum range where none is stated: deeper than any water, so that no measured depth counts as a missing echo.
inline constexpr double kAnyDepth = 12000;
/// Standard deviation of roll and pitch, whether the log states them or not.
inline constexpr Angle kTiltSigma = Angle::degrees(1);

/// X_BS of a downward-looking transducer `depth` below B.
Pose looking_down(double depth);

/// Makes fixes of a boat on the local plane of the first fix. Holds references to its constructor arguments.
class BoatFixes {
 public:
  BoatFixes(const SurveyInput& config, SourceReport& report) : config_(config), report_(report) {}

  /// Also sets the origin of the report if there is none. Empty if the position is invalid, is 0 N 0 E (which receivers
  /// without a fix write), or is over 1000 km from the origin.
  std::optional<Navigation> fix(Time time, const GeoPoint& point, const Rotation& R_WB);

 private:
  const SurveyInput& config_;
  SourceReport& report_;
};

}  // namespace isobath
