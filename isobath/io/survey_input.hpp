// What the logs of a survey boat leave open, and the shapes of event that their readers share: SonTek .sum, NMEA 0183
// and tables of depths.
//
// A boat has its reference point B on the water: depth 0 of W. North and east are on the local plane (LocalPlane) of
// the first valid position. A transducer hangs transducer_depth_m below B and looks down: a RangeReading's X_BS has its
// x axis, the axis of the cone, along z of B.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/io/event.hpp>
#include <string>
#include <vector>

namespace isobath {

enum class DepthUnit : std::uint8_t { kMetre, kFoot, kFathom };
enum class DepthSign : std::uint8_t { kDown, kUp };
enum class CsvTime : std::uint8_t { kIso, kSeconds };

struct SurveyInput {
  double utc_offset_h = 0;                       ///< of local times in the log, east positive
  double position_sigma_m = 1;                   ///< standard deviation of north and of east each
  Angle heading_sigma = Angle::degrees(3);       ///< standard deviation of the heading
  Angle declination;                             ///< added to recorded headings that are magnetic
  double transducer_depth_m = 0;                 ///< below the water; NMEA: 0 means what the log says
  std::string only, without;                     ///< file names of a folder: patterns with * and ?, separated by commas
  std::string csv_columns;                       ///< "latitude=Lat,longitude=Lon,depth=Depth": depth_csv.hpp
  DepthUnit csv_depth_unit = DepthUnit::kMetre;  ///< of the depth column
  DepthSign csv_depth_sign = DepthSign::kDown;   ///< in which sense depths grow
  std::string csv_position = "degrees";          ///< "degrees", or "utm 33N"
  CsvTime csv_time = CsvTime::kIso;              ///< ISO 8601, or seconds
};
std::vector<Field> fields(SurveyInput& config);

/// A range with no stated limit: deeper than any water, so that no measured depth counts as a missing echo.
inline constexpr double kAnyDepth = 12000;
/// Roll and pitch of a boat whose log does not say them, or of one as its sensor says them: standard deviation.
inline constexpr Angle kTiltSigma = Angle::degrees(1);

/// X_BS of a transducer `depth` below B that looks down.
Pose looking_down(double depth);

/// Fixes of a boat on the local plane of the first of them. Holds references to what it is made from.
class BoatFixes {
 public:
  BoatFixes(const SurveyInput& config, SourceReport& report) : config_(config), report_(report) {}

  /// Sets the origin of the report where there is none. Empty: no position on Earth, 0 N 0 E (which receivers without a
  /// fix write), or farther than 1000 km from the origin.
  std::optional<Navigation> fix(Time time, const GeoPoint& point, const Rotation& R_WB);

 private:
  const SurveyInput& config_;
  SourceReport& report_;
};

}  // namespace isobath
