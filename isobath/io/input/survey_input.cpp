#include <isobath/io/input/survey_input.hpp>

namespace isobath {
namespace {

constexpr double kFarthest = 1e6;  // m from the origin: limit of the local plane

}  // namespace

Pose looking_down(double depth) {
  return {Rotation::from_heading_pitch_roll({}, Angle::degrees(-90), {}), {0, 0, depth}};
}

std::optional<Navigation> BoatFixes::fix(Time time, const GeoPoint& point, const Rotation& R_WB) {
  if (!valid(point) || point == GeoPoint{}) return std::nullopt;
  const GeoOrigin origin = report_.origin.value_or(point);
  const Eigen::Vector2d p = LocalPlane(origin).to_plane(point);
  if (!(p.norm() < kFarthest)) return std::nullopt;
  report_.origin = origin;
  Navigation fix;
  fix.time = time;
  fix.X_WB = {R_WB, {p.x(), p.y(), 0}};
  const double position = config_.position_sigma_m * config_.position_sigma_m;
  const double tilt = kTiltSigma.radians() * kTiltSigma.radians();
  const double heading = config_.heading_sigma.radians() * config_.heading_sigma.radians();
  Eigen::Matrix<double, 6, 1> variances;
  variances << position, position, 0, tilt, tilt, heading;  // B is on the water by definition
  fix.covariance = variances.asDiagonal().toDenseMatrix();
  return fix;
}

std::vector<Field> fields(SurveyInput& c) {
  return {
      Field::text("only", &c.only,
                  "Files of a survey folder to read, such as 20250117*; * matches any text, ? one character, commas "
                  "separate patterns; empty: all."),
      Field::text("without", &c.without, "Files of a survey folder to leave out, in the same syntax; empty: none."),
      Field::real("utc_offset_h", &c.utc_offset_h, {-14, 14}, "h",
                  "Local time less UTC, for logs with local times without a zone."),
      Field::real("position_sigma_m", &c.position_sigma_m, {0, 1000}, "m",
                  "Standard deviation of a survey boat's north and east, for logs that do not state it."),
      Field::degrees("heading_sigma_deg", &c.heading_sigma, {0, 180},
                     "Standard deviation of a survey boat's heading, for logs that do not state it."),
      Field::degrees("declination_deg", &c.declination, {-180, 180},
                     "Declination added to magnetic headings of a survey log, east positive; if not 0, it replaces the "
                     "one that the log states."),
      Field::real("transducer_depth_m", &c.transducer_depth_m, {0, 100}, "m",
                  "Depth of an echo sounder's transducer below the water; NMEA, 0: as the log states."),
      Field::text("csv_columns", &c.csv_columns,
                  "Columns of a table of depths: time=T,latitude=Lat,longitude=Lon,depth=D,heading=H, or easting and "
                  "northing; time and heading may be absent."),
      Field::choice("csv_depth_unit", &c.csv_depth_unit,
                    {{"m", DepthUnit::kMetre}, {"ft", DepthUnit::kFoot}, {"fathom", DepthUnit::kFathom}},
                    "Unit of the depths in a table."),
      Field::choice("csv_depth_sign", &c.csv_depth_sign, {{"down", DepthSign::kDown}, {"up", DepthSign::kUp}},
                    "Sign of the depths in a table: down if larger numbers are deeper, up if they are shallower."),
      Field::text("csv_position", &c.csv_position,
                  "Positions in a table: degrees (WGS 84), or a zone of the Universal Transverse Mercator grid such as "
                  "utm 33N."),
      Field::choice("csv_time", &c.csv_time, {{"iso", CsvTime::kIso}, {"seconds", CsvTime::kSeconds}},
                    "Times in a table: ISO 8601 (2025-01-17T16:03:47Z), or seconds since 1970 or any start."),
  };
}

}  // namespace isobath
