#include <cmath>
#include <isobath/stereo/optics/water_light.hpp>

namespace isobath {

double WaterLight::seen(double without_water, double distance_m, int channel) const {
  return without_water * std::exp(-attenuation_per_m[channel] * distance_m) +
         veil[channel] * (1 - std::exp(-backscatter_per_m[channel] * distance_m));
}

std::vector<Field> fields(WaterLight& l) {
  return {Field::numbers("attenuation_per_m", l.attenuation_per_m.data(), 3, {0, 20}, "1/m",
                         "Attenuation of light, red, green, blue."),
          Field::numbers("backscatter_per_m", l.backscatter_per_m.data(), 3, {0, 20}, "1/m",
                         "How fast the veil of scattered light grows with distance, red, green, blue."),
          Field::numbers("veil", l.veil.data(), 3, {0, 255}, "grey levels",
                         "Brightness of the veil far away, red, green, blue.")};
}

}  // namespace isobath
