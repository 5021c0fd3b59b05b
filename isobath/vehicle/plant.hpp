// VehiclePlant: the interface of a vehicle that follows set-points (ledger S7-14).
//
// DynamicVehicle is VehicleDynamics under an Autopilot: actuators, inertia, current and density all act. Its plant may
// differ from the vehicle file, and so may what the autopilot takes it for (PlantDifference).
// KinematicVehicle follows set-points exactly within the limits of the vehicle file: arcs and straight lines through
// the water, without actuators and inertia; it is for scenes that need a path and no dynamics. Set-points are over
// ground, as an autopilot holds them. The water moves the vehicle where the vehicle cannot compensate: a current across
// the hull carries away a vehicle without sway, and one stronger than the maximum speed carries away any vehicle. Depth
// is held against vertical currents.
//
// Depth never leaves [0, max_depth] by a set-point. Units SI. One thread at a time; nothing allocates in step.
#pragma once

#include <isobath/vehicle/autopilot.hpp>
#include <isobath/vehicle/plant_difference.hpp>
#include <memory>

namespace isobath {

class VehiclePlant {
 public:
  VehiclePlant() = default;
  VehiclePlant(const VehiclePlant&) = delete;
  VehiclePlant& operator=(const VehiclePlant&) = delete;
  virtual ~VehiclePlant() = default;

  [[nodiscard]] virtual const VehicleState& state() const = 0;
  /// Commands to the actuators in the order of the vehicle file, thrusters in N and fins in rad; empty: it has none.
  [[nodiscard]] virtual ActuatorVector commands() const { return {}; }
  /// dt in s, above 0.
  virtual void step(const Setpoint& setpoint, const WaterConditions& water, double dt) = 0;
};

class DynamicVehicle final : public VehiclePlant {
 public:
  static constexpr double kLongestStep = 0.02;  ///< s; longer steps are divided

  explicit DynamicVehicle(const VehicleModel& model, const VehicleState& initial = {},
                          const PlantDifference& difference = {}, const PlantDifference& taken_for = {})
      : dynamics_(different_plant(model, difference), initial),
        autopilot_(make_autopilot(different_plant(model, taken_for))),
        tether_m_(difference.tether_m) {}

  [[nodiscard]] const VehicleState& state() const override { return dynamics_.state(); }
  void step(const Setpoint& setpoint, const WaterConditions& water, double dt) override;
  [[nodiscard]] ActuatorVector commands() const override { return autopilot_->allocation().commands; }
  VehicleDynamics& dynamics() { return dynamics_; }
  Autopilot& autopilot() { return *autopilot_; }

 private:
  VehicleDynamics dynamics_;
  std::unique_ptr<Autopilot> autopilot_;
  double tether_m_;
};

class KinematicVehicle final : public VehiclePlant {
 public:
  explicit KinematicVehicle(const VehicleModel& model, const VehicleState& initial = {});

  [[nodiscard]] const VehicleState& state() const override { return state_; }
  void step(const Setpoint& setpoint, const WaterConditions& water, double dt) override;

 private:
  VehicleLimits limits_;
  DepthBy depth_by_;
  double max_pitch_;  ///< rad
  bool can_sway_;
  VehicleState state_;
  double speed_ = 0;  ///< along the path, over ground
  double sway_ = 0;
};

enum class PlantKind { kDynamic, kKinematic };

/// `difference`: of the plant; `taken_for`: of the autopilot's model. A kinematic vehicle has no forces; they do not
/// act on it.
std::unique_ptr<VehiclePlant> make_plant(const VehicleModel& model, PlantKind kind, const VehicleState& initial = {},
                                         const PlantDifference& difference = {}, const PlantDifference& taken_for = {});

}  // namespace isobath
