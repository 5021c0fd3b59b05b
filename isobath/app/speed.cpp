#include <exception>
#include <isobath/app/speed.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/error.hpp>
#include <isobath/base/nearest_name.hpp>

namespace isobath::app {

CLI::Validator speed() {
  return such_as([] { return std::vector<std::string>{"max"}; });
}

double speed_of(const std::string& speed) {
  if (speed == "max") return 0;
  try {
    std::size_t used = 0;
    const double value = std::stod(speed, &used);
    if (used == speed.size() && value > 0 && value < 1e6) return value;
  } catch (const std::exception&) {  // not a number: reported below
  }
  throw Error("not a speed: " + speed, {"--speed"}, "max, or a multiple of real time, above 0",
              did_you_mean(speed, {"max"}));
}

}  // namespace isobath::app
