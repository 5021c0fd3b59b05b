#include <isobath/run/run.hpp>
#include <isobath/run/vehicle_run.hpp>
#include <limits>

namespace isobath {

RunOutcome run(const RunRequest& request) {
  VehicleRun vehicle(request);
  while (vehicle.advance(std::numeric_limits<double>::infinity())) {
  }
  return vehicle.outcome();
}

}  // namespace isobath
