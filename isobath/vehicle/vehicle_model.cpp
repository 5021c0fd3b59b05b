#include <algorithm>
#include <cmath>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <isobath/vehicle/vehicle_model.hpp>

namespace isobath {

namespace {

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d s;
  s << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return s;
}

bool positive_definite(const Matrix6& m) { return m.allFinite() && Eigen::LLT<Matrix6>(m).info() == Eigen::Success; }

bool positive_semidefinite(const Matrix6& m) {
  if (!m.allFinite()) return false;
  const Matrix6 symmetric = 0.5 * (m + m.transpose());
  const Vector6 values = Eigen::SelfAdjointEigenSolver<Matrix6>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
  return values.minCoeff() >= -1e-9 * std::max(1.0, values.cwiseAbs().maxCoeff());
}

// sum_ij D_ij |n_j| n_j n_i >= 0 for all n: by Young's inequality |n_j|^2 |n_i| <= (2 |n_j|^3 + |n_i|^3) / 3 it is
// enough that each diagonal element outweighs its row and column. Rates are first scaled to speeds by the half length.
bool quadratic_dissipative(const Matrix6& damping, double length) {
  Vector6 unit;
  unit << 1, 1, 1, 2 / length, 2 / length, 2 / length;
  for (int i = 0; i < 6; ++i) {
    double needed = 0;
    for (int j = 0; j < 6; ++j) {
      if (j == i) continue;
      needed += std::abs(damping(i, j)) * unit(i) * unit(j) * unit(j) / 3;
      needed += std::abs(damping(j, i)) * unit(j) * unit(i) * unit(i) * 2 / 3;
    }
    if (!(damping(i, i) * std::pow(unit(i), 3) >= needed)) return false;
  }
  return true;
}

// The places of the sections, so that an error about a whole matrix also has a line.
struct Places {
  Place vehicle, body, water, limits;
  std::vector<Place> thrusters, fins;
};

[[noreturn]] void refuse(const std::string& problem, Place where, const std::string& key, const std::string& allowed,
                         const std::string& advice) {
  where.key = key;
  throw Error(problem, where, allowed, advice);
}

void check(const VehicleModel& m, const Places& at) {
  if (!(m.length > 0 && m.width > 0 && m.height > 0)) {
    refuse("the hull has no size", at.vehicle, "vehicle", "length, width and height above 0 m", "");
  }
  if (!(m.mass > 0 && m.volume > 0)) {
    refuse("no mass or no volume", at.body, "body", "above 0", "give mass in kg and volume in m3");
  }
  if (!positive_definite(rigid_body_mass(m))) {
    refuse("the rigid-body mass matrix is not positive definite", at.body, "body.inertia",
           "moments about the origin of B, at least those of the mass at the centre of gravity",
           "check inertia, products and gravity_centre");
  }
  if (!m.added_mass.isApprox(m.added_mass.transpose(), 1e-9) && !m.added_mass.isZero(0)) {
    refuse("added_mass is not symmetric", at.water, "water.added_mass", "", "give Y_dr and N_dv the same value");
  }
  if (!positive_semidefinite(m.added_mass) || !positive_definite(mass_matrix(m, m.reference_density))) {
    refuse("the mass matrix with added mass is not positive definite", at.water, "water.added_mass",
           "positive where it opposes acceleration (-X_du)", "check signs: published derivatives are mostly negative");
  }
  const std::string sign = "positive where it opposes the motion (-X_u)";
  if (!positive_semidefinite(m.linear_damping)) {
    refuse("linear damping is not dissipative", at.water, "water.linear_damping", sign, "check signs and couplings");
  }
  if (!positive_semidefinite(m.lift_damping)) {
    refuse("lift damping is not dissipative", at.water, "water.lift_damping", sign,
           "leave out the Munk moments: they follow from added_mass");
  }
  if (!quadratic_dissipative(m.quadratic_damping, m.length)) {
    refuse("quadratic damping is not dissipative", at.water, "water.quadratic_damping",
           sign + ", each diagonal element above its couplings", "check signs and couplings");
  }
  if (m.actuators() > kMaxActuators) {
    refuse("too many thrusters and fins", at.vehicle, "vehicle", "at most " + std::to_string(kMaxActuators), "");
  }
  for (std::size_t i = 0; i < m.thrusters.size(); ++i) {
    const Thruster& t = m.thrusters[i];
    if (!(t.max_forward + t.max_reverse > 0) || !(std::abs(t.direction_B.norm() - 1) < 1e-6)) {
      refuse("the thruster has no thrust or no direction", i < at.thrusters.size() ? at.thrusters[i] : at.vehicle,
             "thruster", "max_forward or max_reverse above 0 N, direction not (0, 0, 0)", "");
    }
  }
  for (std::size_t i = 0; i < m.fins.size(); ++i) {
    const Fin& f = m.fins[i];
    if (!(f.lift > 0 && f.max_deflection.radians() > 0) || !(std::abs(f.direction_B.norm() - 1) < 1e-6)) {
      refuse("the fin has no lift, no deflection or no direction", i < at.fins.size() ? at.fins[i] : at.vehicle, "fin",
             "lift and max_deflection_deg above 0, direction not (0, 0, 0)", "");
    }
  }
}

// One row is the diagonal, six rows are the whole matrix.
Matrix6 matrix_of(const std::vector<double>& flat, const Place& where, const std::string& key) {
  if (flat.empty()) return Matrix6::Zero();
  if (flat.size() == 6) return Eigen::Map<const Vector6>(flat.data()).asDiagonal();
  if (flat.size() == 36) return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(flat.data());
  refuse(std::to_string(flat.size() / 6) + " rows", where, key, "1 row (the diagonal) or 6 rows", "");
}

// What a vehicle file states in another form than the model holds it.
struct StatedValues {
  Eigen::Vector3d moments = Eigen::Vector3d::Zero(), products = Eigen::Vector3d::Zero();  // of inertia
  std::vector<double> added_mass, linear_damping, lift_damping, quadratic_damping;        // matrices by rows
};

constexpr double kBig = 1e7;  // limit of masses, forces and coefficients

Section general_section(VehicleModel& m) {
  return {"vehicle",
          "General properties.",
          {Field::text("name", &m.name, "Name of the vehicle."),
           Field::real("length", &m.length, {0.01, 1000}, "m", "Length of the box around the hull, centred in B."),
           Field::real("width", &m.width, {0.01, 1000}, "m", "Width of this box."),
           Field::real("height", &m.height, {0.01, 1000}, "m", "Height of this box.")}};
}

Section body_section(VehicleModel& m, StatedValues& stated) {
  return {"body",
          "The rigid body; positions and moments about the origin of B (x forward, y starboard, z down).",
          {Field::real("mass", &m.mass, {1e-3, kBig}, "kg", "Mass, flooded water included."),
           Field::numbers("inertia", stated.moments.data(), 3, {0, kBig}, "kg m2", "Moments of inertia Ixx, Iyy, Izz."),
           Field::numbers("products", stated.products.data(), 3, {-kBig, kBig}, "kg m2",
                          "Integrals of xy, xz, yz over the mass."),
           Field::numbers("gravity_centre", m.p_BG.data(), 3, {-100, 100}, "m", "Centre of gravity."),
           Field::numbers("buoyancy_centre", m.p_BC.data(), 3, {-100, 100}, "m", "Centre of buoyancy."),
           Field::real("volume", &m.volume, {1e-6, kBig}, "m3", "Displaced volume.")}};
}

Section water_section(VehicleModel& m, StatedValues& stated) {
  return {
      "water",
      "Hydrodynamics; matrices are one row (the diagonal) or six rows, positive where they oppose the motion.",
      {Field::real("density", &m.reference_density, {900, 1100}, "kg/m3", "Density for which the values below hold."),
       Field::rows("added_mass", &stated.added_mass, 6, {-kBig, kBig}, "kg, kg m, kg m2", "Added mass; symmetric."),
       Field::rows("linear_damping", &stated.linear_damping, 6, {-kBig, kBig}, "N s/m, ...", "Times the velocity."),
       Field::rows("lift_damping", &stated.lift_damping, 6, {-kBig, kBig}, "N s2/m2, ...",
                   "Times the velocity and forward speed."),
       Field::rows("quadratic_damping", &stated.quadratic_damping, 6, {-kBig, kBig}, "N s2/m2, ...",
                   "Times the square of each velocity, with its sign.")}};
}

Section limits_section(VehicleModel& m) {
  return {"limits",
          "Limits of the vehicle.",
          {Field::real("max_speed", &m.limits.max_speed, {0.01, 30}, "m/s", "Maximum speed."),
           Field::real("max_acceleration", &m.limits.max_acceleration, {1e-3, 100}, "m/s2", "Maximum change of speed."),
           Field::real("turning_radius", &m.limits.turning_radius, {0, 10000}, "m", "Tightest turn; 0: on the spot."),
           Field::degrees("max_yaw_rate_deg", &m.limits.max_yaw_rate, {0.1, 360}, "Maximum turn per second."),
           Field::real("max_climb_rate", &m.limits.max_climb_rate, {1e-3, 30}, "m/s", "Maximum change of depth."),
           Field::real("max_depth", &m.limits.max_depth, {0.1, 12000}, "m", "Maximum depth.")}};
}

Section allocation_section(VehicleModel& m) {
  return {"allocation",
          "Which actuators make which force: 1 or 0 for surge, sway, heave, roll, pitch, yaw.",
          {Field::numbers("thruster_axes", m.thruster_axes.data(), 6, {0, 1}, "1", "Axes of the thrusters."),
           Field::numbers("fin_axes", m.fin_axes.data(), 6, {0, 1}, "1", "Axes of the fins.")}};
}

SectionList thruster_sections(VehicleModel& m, Places& at) {
  return {
      "thruster", "A propeller.", [&m, &at](const Place& place) {
        at.thrusters.push_back(place);
        Thruster& t = m.thrusters.emplace_back();
        return std::vector{
            Field::text("name", &t.name, "Name of the thruster."),
            Field::numbers("position", t.p_BT.data(), 3, {-100, 100}, "m", "Position in B."),
            Field::numbers("direction", t.direction_B.data(), 3, {-1e3, 1e3}, "1", "Of positive thrust; any length."),
            Field::real("max_forward", &t.max_forward, {0, kBig}, "N", "Maximum thrust forward."),
            Field::real("max_reverse", &t.max_reverse, {0, kBig}, "N", "Maximum thrust in reverse."),
            Field::real("dead_zone", &t.dead_zone, {0, kBig}, "N", "Smaller commands give nothing."),
            Field::real("time_constant", &t.time_constant, {0, 100}, "s", "First-order lag."),
            Field::real("torque_per_thrust", &t.torque_per_thrust, {-10, 10}, "m", "Reaction torque about direction.")};
      }};
}

SectionList fin_sections(VehicleModel& m, Places& at) {
  return {"fin", "A moving fin.", [&m, &at](const Place& place) {
            at.fins.push_back(place);
            Fin& f = m.fins.emplace_back();
            return std::vector{
                Field::text("name", &f.name, "Name of the fin."),
                Field::numbers("position", f.p_BF.data(), 3, {-100, 100}, "m", "Centre of pressure in B."),
                Field::numbers("direction", f.direction_B.data(), 3, {-1e3, 1e3}, "1",
                               "Direction of the force at positive deflection going ahead."),
                Field::real("lift", &f.lift, {0, kBig}, "N s2/(m2 rad)", "Force per squared speed and deflection."),
                Field::degrees("max_deflection_deg", &f.max_deflection, {0.1, 60}, "Maximum deflection."),
                Field::degrees("dead_zone_deg", &f.dead_zone, {0, 10}, "Smaller commands give nothing."),
                Field::real("time_constant", &f.time_constant, {0, 100}, "s", "First-order lag.")};
          }};
}

Schema vehicle_schema(VehicleModel& m, StatedValues& stated, Places& at) {
  Schema schema;
  schema.sections = {
      general_section(m),       body_section(m, stated),
      water_section(m, stated), limits_section(m),
      allocation_section(m),    {"autopilot", "Control of heading, depth and speed.", fields(m.autopilot)}};
  schema.lists = {thruster_sections(m, at), fin_sections(m, at)};
  return schema;
}

void set_section_places(const Schema& schema, const std::string& file, Places& at) {
  const auto place_of = [&](std::size_t i) {
    Place place = schema.sections[i].place;
    if (place.file.empty()) place.file = file;  // the file does not have this section
    return place;
  };
  at.vehicle = place_of(0);
  at.body = place_of(1);
  at.water = place_of(2);
}

void set_matrices(const StatedValues& stated, const Places& at, VehicleModel& m) {
  m.inertia_B = stated.moments.asDiagonal();
  m.inertia_B(0, 1) = m.inertia_B(1, 0) = -stated.products(0);
  m.inertia_B(0, 2) = m.inertia_B(2, 0) = -stated.products(1);
  m.inertia_B(1, 2) = m.inertia_B(2, 1) = -stated.products(2);
  m.added_mass = matrix_of(stated.added_mass, at.water, "water.added_mass");
  m.linear_damping = matrix_of(stated.linear_damping, at.water, "water.linear_damping");
  m.lift_damping = matrix_of(stated.lift_damping, at.water, "water.lift_damping");
  m.quadratic_damping = matrix_of(stated.quadratic_damping, at.water, "water.quadratic_damping");
}

using Reader = void (*)(std::string_view, const std::string&, Schema&);

VehicleModel read_vehicle(std::string_view text, const std::string& file, Reader reader) {
  VehicleModel m;
  StatedValues stated;
  Places at;
  Schema schema = vehicle_schema(m, stated, at);
  reader(text, file, schema);
  set_section_places(schema, file, at);
  set_matrices(stated, at, m);
  for (Thruster& t : m.thrusters) t.direction_B.normalize();
  for (Fin& f : m.fins) f.direction_B.normalize();
  check(m, at);
  return m;
}

}  // namespace

const char* to_text(ControlKind control) {
  switch (control) {
    case ControlKind::kPid: return "pid";
    case ControlKind::kModel: return "model";
    case ControlKind::kAdaptive: return "adaptive";
  }
  return "";
}

Field control_field(std::optional<ControlKind>& control, std::string sentence) {
  std::vector<std::pair<std::string, std::optional<ControlKind>>> names = {{"file", std::nullopt}};
  for (const ControlKind kind : kControlKinds) names.emplace_back(to_text(kind), kind);
  return Field::choice("control", &control, names, std::move(sentence));
}

std::vector<Field> fields(AutopilotConfig& c) {
  std::vector<std::pair<std::string, ControlKind>> names;
  for (const ControlKind kind : kControlKinds) names.emplace_back(to_text(kind), kind);
  return {
      Field::choice("control", &c.control, names,
                    "pid: cascaded loops. model: a law with the parameters of this file. adaptive: the same law, which "
                    "estimates the parameters under way."),
      Field::choice("depth_by", &c.depth_by, {{"heave", DepthBy::kHeave}, {"pitch", DepthBy::kPitch}},
                    "How the vehicle changes depth: by heave, or by pitch."),
      Field::real("speed_bandwidth", &c.speed_bandwidth, {0.01, 20}, "rad/s", "Bandwidth of the speed loops."),
      Field::real("heading_bandwidth", &c.heading_bandwidth, {0.01, 20}, "rad/s", "Bandwidth of the heading loop."),
      Field::real("depth_bandwidth", &c.depth_bandwidth, {0.01, 20}, "rad/s", "Bandwidth of the depth loop."),
      Field::real("attitude_bandwidth", &c.attitude_bandwidth, {0.01, 20}, "rad/s", "Bandwidth of roll and pitch."),
      Field::real("force_bandwidth", &c.force_bandwidth, {0.01, 20}, "rad/s",
                  "Bandwidth with which control by model and adaptive control act against forces along the axes; a "
                  "higher one holds the position better and passes on more noise."),
      Field::real("integral_rate", &c.integral_rate, {0, 5}, "rad/s", "Rate of the integral action."),
      Field::degrees("max_pitch_deg", &c.max_pitch, {0.1, 80}, "Maximum pitch set-point."),
      Field::real("min_flow", &c.min_flow, {0.01, 10}, "m/s", "Minimum flow over the fins; kept under way."),
  };
}

Matrix6 rigid_body_mass(const VehicleModel& model) {
  Matrix6 m;
  m << model.mass * Eigen::Matrix3d::Identity(), -model.mass * skew(model.p_BG), model.mass * skew(model.p_BG),
      model.inertia_B;
  return m;
}

Matrix6 mass_matrix(const VehicleModel& model, double density) {
  return rigid_body_mass(model) + density / model.reference_density * model.added_mass;
}

VehicleModel load_vehicle(const std::string& path) {
  return read_vehicle({}, path,
                      [](std::string_view, const std::string& file, Schema& schema) { read_toml_file(file, schema); });
}

VehicleModel parse_vehicle(std::string_view text, const std::string& name) {
  return read_vehicle(text, name, [](std::string_view toml, const std::string& file, Schema& schema) {
    read_toml(toml, file, schema);
  });
}

void check_vehicle(const VehicleModel& model, const Place& where) {
  Places at;
  at.vehicle = at.body = at.water = at.limits = where;
  check(model, at);
}

}  // namespace isobath
