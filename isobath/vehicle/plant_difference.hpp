// PlantDifference: how a simulated vehicle differs from its vehicle file, which control keeps: a payload, growth on the
// hull, a tether; or how what control takes it for does: wrong coefficients (ledger S7-08, S7-17).
//
// A tether hangs from a point above the vehicle and drifts with neither: water that passes the vehicle at v_r in the
// plane draws on its lower half, F = -1/2 rho C_d diameter (length / 2) |v_r| v_r, at the origin of B; C_d 1.2 of a
// cable across the flow (Hoerner 1965). Diameter: 7.6 mm, that of the BlueROV2's cable (maker's data sheet). SI units.
#pragma once

#include <isobath/vehicle/dynamics.hpp>

namespace isobath {

struct PlantDifference {
  double mass = 1;      ///< factor on mass, inertia and added mass; the volume follows, so that the trim stays
  double drag = 1;      ///< factor on all damping
  double buoyancy = 0;  ///< more than the file's, N
  double tether_m = 0;  ///< length of a tether that hangs down to the vehicle; 0: none

  bool operator==(const PlantDifference&) const = default;
};

std::vector<Field> fields(PlantDifference& difference);
/// The same without the tether, which no control knows.
std::vector<Field> control_model_fields(PlantDifference& difference);

/// The vehicle of a file with a difference. Throws Error if its volume is not above 0.
VehicleModel different_plant(VehicleModel model, const PlantDifference& difference);

/// Wrench of the tether, in B.
Vector6 tether_wrench(double length_m, const VehicleState& state, const WaterConditions& water);

}  // namespace isobath
