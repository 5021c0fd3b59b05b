#include <cmath>
#include <isobath/vehicle/vehicle_parameters.hpp>

namespace isobath {

VehicleParameters parameters_of(const VehicleModel& model) {
  VehicleParameters parameters;
  parameters.half_width_m = model.width / 2;
  parameters.hull_radius_m = std::hypot(model.length, model.width) / 2;
  parameters.braking = model.limits.max_acceleration;
  parameters.min_speed = model.autopilot.depth_by == DepthBy::kPitch ? model.autopilot.min_flow : 0;
  parameters.depth_lag_s = 2 / model.autopilot.depth_bandwidth;      // the gain of its outer loop is half the bandwidth
  parameters.heading_lag_s = 2 / model.autopilot.heading_bandwidth;  // likewise
  parameters.can_sway = model.thruster_axes(1) > 0 && !model.thrusters.empty();
  parameters.limits = model.limits;
  return parameters;
}

std::vector<Field> fields(VehicleParameters& s) {
  return {Field::real("half_width", &s.half_width_m, {0, 100}, "m", "Half the width of the hull."),
          Field::real("hull_radius", &s.hull_radius_m, {0, 500}, "m", "Radius of a circle in plan around the hull."),
          Field::real("braking", &s.braking, {1e-3, 100}, "m/s2", "Deceleration with thrust removed or reversed."),
          Field::real("min_speed", &s.min_speed, {0, 20}, "m/s", "Minimum speed that holds depth and heading."),
          Field::flag("can_sway", &s.can_sway, "Thrusters move the vehicle sideways."),
          Field::real("max_speed", &s.limits.max_speed, {1e-3, 50}, "m/s", "Maximum speed."),
          Field::real("max_acceleration", &s.limits.max_acceleration, {1e-3, 100}, "m/s2", "Along the path."),
          Field::real("turning_radius", &s.limits.turning_radius, {0, 1000}, "m", "Tightest turn; 0: on the spot."),
          Field::degrees("max_yaw_rate_deg", &s.limits.max_yaw_rate, {0.1, 720}, "Maximum turn per second."),
          Field::real("max_climb_rate", &s.limits.max_climb_rate, {1e-3, 20}, "m/s", "Maximum change of depth."),
          Field::real("max_depth", &s.limits.max_depth, {0, 12000}, "m", "Maximum depth.")};
}

}  // namespace isobath
