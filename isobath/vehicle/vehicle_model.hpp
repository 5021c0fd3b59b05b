// VehicleModel: the contents of a vehicle file: body, hydrodynamics, actuators, limits and autopilot of one vehicle
// (ledger S7-13; notation after Fossen 2011).
//
// Six-vectors have the order surge, sway, heave, roll, pitch, yaw: velocities (u, v, w, p, q, r) and wrenches
// (X, Y, Z, K, M, N), all about the origin of B with components in B. Matrices are positive where they oppose the
// motion: added_mass is -X_du and so on, damping is -X_u, -X_uu.
//
//   M = M_RB + (density / reference) added_mass
//   damping wrench = -(density / reference) (linear nu + |u| lift nu + quadratic (|nu| nu)), nu relative to the water
//
// `lift` contains damping that grows with forward speed: body lift, and the lift of fins that do not move. Its
// published form is Y_uv u v; |u| instead of u keeps it dissipative astern. It does not include the Munk moments, which
// follow from added_mass through C(nu).
//
// Errors: load_vehicle and parse_vehicle throw Error with line and column on everything that read_toml refuses, and
// with the line of the section where M is not positive definite, damping is not dissipative, or an actuator is not
// valid. Immutable after loading; may be shared by threads.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/angle.hpp>
#include <isobath/base/config.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

inline constexpr double kGravity = 9.81;   ///< m/s2, the value that the published weights use
inline constexpr int kMaxActuators = 16;   ///< thrusters and fins of one vehicle
inline constexpr double kSeaWater = 1025;  ///< kg/m3

/// One number an actuator: thrusters first (N), then fins (rad), in the order of the file. Never allocates.
using ActuatorVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxActuators, 1>;
using ActuatorMatrix = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaxActuators>;

/// A propeller; its command is a thrust in N.
struct Thruster {
  std::string name;
  Eigen::Vector3d p_BT = Eigen::Vector3d::Zero();          ///< m
  Eigen::Vector3d direction_B = Eigen::Vector3d::UnitX();  ///< of positive thrust; normalised
  double max_forward = 0;                                  ///< N
  double max_reverse = 0;                                  ///< N, positive
  double dead_zone = 0;                                    ///< N: smaller commands give nothing
  double time_constant = 0;                                ///< s
  double torque_per_thrust = 0;                            ///< reaction torque about direction_B, N m / N
};

/// A moving fin; its command is a deflection. Force: lift u |u| deflection along direction_B, at p_BF.
struct Fin {
  std::string name;
  Eigen::Vector3d p_BF = Eigen::Vector3d::Zero();          ///< centre of pressure, m
  Eigen::Vector3d direction_B = Eigen::Vector3d::UnitY();  ///< of the force at positive deflection going ahead
  double lift = 0;                                         ///< N s2 / (m2 rad), at the reference density
  Angle max_deflection;
  Angle dead_zone;
  double time_constant = 0;  ///< s
};

struct VehicleLimits {
  double max_speed = 2;                     ///< m/s
  double max_acceleration = 1;              ///< m/s2
  double turning_radius = 0;                ///< m; 0: turns on the spot
  Angle max_yaw_rate = Angle::degrees(30);  ///< a second
  double max_climb_rate = 0.5;              ///< m/s
  double max_depth = 100;                   ///< m
};

enum class DepthBy { kHeave, kPitch };

/// The kinds of control (autopilot.hpp).
enum class ControlKind : std::uint8_t { kPid, kModel, kAdaptive };
inline constexpr ControlKind kControlKinds[] = {ControlKind::kPid, ControlKind::kModel, ControlKind::kAdaptive};

/// The bandwidth of each loop: gains follow from the vehicle's own inertia.
struct AutopilotConfig {
  ControlKind control = ControlKind::kPid;
  DepthBy depth_by = DepthBy::kHeave;
  double speed_bandwidth = 1;  ///< rad/s, of each loop
  double heading_bandwidth = 1;
  double depth_bandwidth = 0.5;
  double attitude_bandwidth = 2;  ///< roll and pitch
  double force_bandwidth = 1;     ///< rad/s, of the feedback on speeds of control by model and adaptive control
  double integral_rate = 0.1;     ///< rad/s, of the integral action of all loops
  Angle max_pitch = Angle::degrees(20);
  double min_flow = 0.5;  ///< m/s through the water: minimum flow that fins are computed for, and kept under way
};

const char* to_text(ControlKind control);
/// A setting that takes the place of the vehicle file's control; its value "file", empty: the file's stays.
Field control_field(std::optional<ControlKind>& control, std::string sentence);
std::vector<Field> fields(AutopilotConfig& config);

struct VehicleModel {
  std::string name;
  double length = 1;  ///< of the box around the hull, centred in B, m
  double width = 0.5;
  double height = 0.5;

  double mass = 0;                                      ///< kg
  Eigen::Matrix3d inertia_B = Eigen::Matrix3d::Zero();  ///< about the origin of B, kg m2
  Eigen::Vector3d p_BG = Eigen::Vector3d::Zero();       ///< centre of gravity, m
  Eigen::Vector3d p_BC = Eigen::Vector3d::Zero();       ///< centre of buoyancy, m
  double volume = 0;                                    ///< displaced, m3

  double reference_density = kSeaWater;  ///< the density for which the coefficients hold, kg/m3
  Matrix6 added_mass = Matrix6::Zero();
  Matrix6 linear_damping = Matrix6::Zero();
  Matrix6 lift_damping = Matrix6::Zero();
  Matrix6 quadratic_damping = Matrix6::Zero();

  std::vector<Thruster> thrusters;
  std::vector<Fin> fins;
  Vector6 thruster_axes = Vector6::Ones();  ///< 1 where thrusters, fins make the wrench; 0 elsewhere
  Vector6 fin_axes = Vector6::Zero();

  VehicleLimits limits;
  AutopilotConfig autopilot;

  [[nodiscard]] int actuators() const { return static_cast<int>(thrusters.size() + fins.size()); }
};

/// Rigid-body part of M.
Matrix6 rigid_body_mass(const VehicleModel& model);
/// M at this density.
Matrix6 mass_matrix(const VehicleModel& model, double density);

VehicleModel load_vehicle(const std::string& path);
VehicleModel parse_vehicle(std::string_view text, const std::string& name);

/// Throws Error if the model is not physical; for models built in code. `where` names its source.
void check_vehicle(const VehicleModel& model, const Place& where = {});

}  // namespace isobath
