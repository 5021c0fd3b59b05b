// VehicleSheet: what planning and command must know of a vehicle: how much room it takes, and what it cannot do.
#pragma once

#include <isobath/vehicle/vehicle_model.hpp>

namespace isobath {

struct VehicleSheet {
  double half_width_m = 0.25;   ///< of the hull, across
  double hull_radius_m = 0.36;  ///< of the circle in plan that holds the hull, about B
  double braking = 0.25;        ///< m/s2, when thrust is taken away or reversed
  double min_speed = 0;         ///< below it the vehicle does not hold depth or heading, m/s; 0: it can hover
  double depth_lag_s = 4;       ///< by which it comes after a depth set-point that moves steadily
  bool can_sway = false;        ///< thrusters move it sideways
  VehicleLimits limits;
};

/// Braking is the greatest acceleration that the file allows; a vehicle that dives by pitch needs its least flow.
VehicleSheet sheet_of(const VehicleModel& model);

/// All of it, for logs and configurations of runs without a vehicle file.
std::vector<Field> fields(VehicleSheet& sheet);

}  // namespace isobath
