#include <cmath>
#include <isobath/vehicle/plant_difference.hpp>

namespace isobath {

std::vector<Field> fields(PlantDifference& d) {
  return {Field::real("mass", &d.mass, {0.1, 10}, "1",
                      "Factor on mass, inertia and added mass; the volume follows, so that the trim stays."),
          Field::real("drag", &d.drag, {0, 10}, "1", "Factor on all damping."),
          Field::real("buoyancy", &d.buoyancy, {-1e5, 1e5}, "N", "Buoyancy beyond that of the vehicle file."),
          Field::real("tether_m", &d.tether_m, {0, 1e4}, "m",
                      "Length of a tether of 7.6 mm that hangs down to the vehicle; 0: none.")};
}

std::vector<Field> control_model_fields(PlantDifference& d) {
  std::vector<Field> all = fields(d);
  all.pop_back();
  return all;
}

VehicleModel different_plant(VehicleModel m, const PlantDifference& d) {
  if (d.mass != 1) {
    m.volume += (d.mass - 1) * m.mass / m.reference_density;
    m.mass *= d.mass;
    m.inertia_B *= d.mass;
    m.added_mass *= d.mass;
  }
  if (d.buoyancy != 0) m.volume += d.buoyancy / (kGravity * m.reference_density);
  if (d.drag != 1) {
    m.linear_damping *= d.drag;
    m.lift_damping *= d.drag;
    m.quadratic_damping *= d.drag;
  }
  if (!(m.volume > 0)) {
    throw Error("the plant would displace no water", {.key = "plant.buoyancy"}, "less than the buoyancy of the file");
  }
  return m;
}

Vector6 tether_wrench(double length_m, const VehicleState& state, const WaterConditions& water) {
  constexpr double kDiameter = 0.0076, kDragCoefficient = 1.2;
  Eigen::Vector3d through_W = state.X_WB.rotation * state.v_B - water.current_W;
  through_W.z() = 0;
  const Eigen::Vector3d force_W =
      -0.25 * water.density * kDragCoefficient * kDiameter * length_m * through_W.norm() * through_W;
  Vector6 wrench = Vector6::Zero();
  wrench.head<3>() = state.X_WB.rotation.inverse() * force_W;
  return wrench;
}

}  // namespace isobath
