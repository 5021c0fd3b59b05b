#include <exception>
#include <isobath/app/speed.hpp>
#include <isobath/base/error.hpp>

namespace isobath::app {

double speed_of(const std::string& speed) {
  if (speed == "max") return 0;
  try {
    std::size_t used = 0;
    const double value = std::stod(speed, &used);
    if (used == speed.size() && value > 0 && value < 1e6) return value;
  } catch (const std::exception&) {  // not a number: reported below
  }
  throw Error("not a speed: " + speed, {"--speed"}, "max, or a multiple of real time, above 0");
}

}  // namespace isobath::app
