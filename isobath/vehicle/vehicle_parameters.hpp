// VehicleParameters: the size and the limits of a vehicle, for planning and command.
#pragma once

#include <isobath/vehicle/vehicle_model.hpp>

namespace isobath {

struct VehicleParameters {
  double half_width_m = 0.25;   ///< of the hull, across
  double hull_radius_m = 0.36;  ///< of the circle in plan around the hull, centred in B
  double braking = 0.25;        ///< m/s2, with thrust removed or reversed
  double min_speed = 0;         ///< below it the vehicle does not hold depth or heading, m/s; 0: it can hover
  double depth_lag_s = 4;       ///< by which it follows a depth set-point that moves steadily
  double heading_lag_s = 2;     ///< by which it follows a heading set-point that turns steadily
  bool can_sway = false;        ///< thrusters move it sideways
  VehicleLimits limits;
};

/// Braking is the maximum acceleration of the file; a vehicle that dives by pitch needs its minimum flow.
VehicleParameters parameters_of(const VehicleModel& model);

/// All of them, for logs and configurations of runs without a vehicle file.
std::vector<Field> fields(VehicleParameters& parameters);

}  // namespace isobath
