#include <cmath>
#include <isobath/vehicle/vehicle_sheet.hpp>

namespace isobath {

VehicleSheet sheet_of(const VehicleModel& model) {
  VehicleSheet sheet;
  sheet.half_width_m = model.width / 2;
  sheet.hull_radius_m = std::hypot(model.length, model.width) / 2;
  sheet.braking = model.limits.max_acceleration;
  sheet.min_speed = model.autopilot.depth_by == DepthBy::kPitch ? model.autopilot.min_flow : 0;
  sheet.depth_lag_s = 2 / model.autopilot.depth_bandwidth;  // the gain of its outer loop is half the bandwidth
  sheet.can_sway = model.thruster_axes(1) > 0 && !model.thrusters.empty();
  sheet.limits = model.limits;
  return sheet;
}

}  // namespace isobath
