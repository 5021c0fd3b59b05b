#include <isobath/run/run.hpp>
#include <isobath/run/vehicle_run.hpp>

namespace isobath {

RunOutcome run(const RunRequest& request) {
  VehicleRun vehicle(request);
  while (vehicle.advance()) {
  }
  return vehicle.outcome();
}

}  // namespace isobath
