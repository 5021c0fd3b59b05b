#include <isobath/onboard/onboard_configuration.hpp>

namespace isobath {

std::vector<Field> fields(SensorConfig& c) {
  return {Field::text("model", &c.model, "Sensor model or fan model made by isobath calibrate; empty: none."),
          Field::text("histogram", &c.histogram, "Histogram model made by isobath calibrate; empty: none."),
          Field::text("histogram_vertical", &c.histogram_vertical,
                      "Histogram model of the vertical fans; empty: that of sensor.histogram.")};
}

std::vector<Field> fields(MapConfig& c) {
  return {Field::flag("fit", &c.fit, "Set cell and size of the grid by the sonar's range; false: use [grid]."),
          Field::real("fan_scan_s", &c.fan_scan_s, {0, 60}, "s",
                      "Interval at which obstacles of a fan are extracted from the grid; 0: after each ping."),
          Field::real("sounding_band_m", &c.sounding_band_m, {0, 100}, "m",
                      "Soundings of a 3-D sonar within this distance above or below the vehicle are obstacles of the "
                      "plan view.")};
}

}  // namespace isobath
