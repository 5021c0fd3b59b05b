// Equations of motion that are written a second time, apart from dynamics.cpp, for tests.
#pragma once

#include <array>
#include <cmath>
#include <Eigen/LU>
#include <tests/vehicle/models.hpp>

namespace isobath::test {

/// M nu' in the matrix form of Fossen 2011, 8.1, for any vehicle in still water at its reference density: C from M, the
/// damping of the file, restoring forces by components.
inline Vector6 fossen_force(const VehicleModel& m, const Eigen::Matrix3d& R_WB, const Vector6& nu, const Vector6& tau) {
  const Matrix6 M = rigid_body_mass(m) + m.added_mass;
  const double W = m.mass * kGravity, B = m.reference_density * m.volume * kGravity;
  const double down[3] = {R_WB(2, 0), R_WB(2, 1), R_WB(2, 2)};
  const Eigen::Vector3d g = W * m.p_BG - B * m.p_BC;
  Vector6 restoring;
  restoring << (W - B) * down[0], (W - B) * down[1], (W - B) * down[2], g(1) * down[2] - g(2) * down[1],
      g(2) * down[0] - g(0) * down[2], g(0) * down[1] - g(1) * down[0];
  return tau + restoring + damping_wrench(m, nu) - coriolis(M, nu) * nu;
}

/// The REMUS 100 by the scalar equations of Prestero 2001 (chapter 4; SNAME notation), with attitude in Euler angles:
/// north, east, depth, roll, pitch, yaw, u, v, w, p, q, r. Derivatives carry the sign of the force, as printed; two of
/// them as vehicles/remus100.toml explains (Y_vv, and M_rp, N_pq from K_dp and N_dr: 4.81 where 4.86 is printed).
struct PublishedRemus {
  using State = std::array<double, 12>;
  double thrust = 3.86, propeller_torque = -0.543, rudder = 0, stern = 0;

  [[nodiscard]] State rate(const State& x) const {
    constexpr double W = 299, B = 306, m = W / 9.81, zG = 0.0196, Ixx = 0.177, Iyy = 3.45, Izz = 3.45;
    const double phi = x[3], theta = x[4], psi = x[5];
    const double u = x[6], v = x[7], w = x[8], p = x[9], q = x[10], r = x[11];
    const double sphi = std::sin(phi), cphi = std::cos(phi), sth = std::sin(theta), cth = std::cos(theta);
    const double spsi = std::sin(psi), cpsi = std::cos(psi);
    constexpr double M_rp = 4.88 - 0.0704, N_pq = -M_rp;
    const double X =
        -(W - B) * sth - 1.62 * u * std::abs(u) - 35.5 * w * q - 1.93 * q * q + 35.5 * v * r - 1.93 * r * r + thrust;
    const double Y = (W - B) * cth * sphi - 131 * v * std::abs(v) + 0.632 * r * std::abs(r) + 5.22 * u * r +
                     35.5 * w * p + 1.93 * p * q - 28.6 * u * v + 9.64 * u * u * rudder;
    const double Z = (W - B) * cth * cphi - 131 * w * std::abs(w) - 0.632 * q * std::abs(q) - 5.22 * u * q -
                     35.5 * v * p + 1.93 * r * p - 28.6 * u * w - 9.64 * u * u * stern;
    const double K = -zG * W * cth * sphi - 0.13 * p * std::abs(p) + propeller_torque;
    const double Mq = -zG * W * sth + 3.18 * w * std::abs(w) - 188 * q * std::abs(q) - 2.0 * u * q - 1.93 * v * p +
                      M_rp * r * p + 24.0 * u * w - 6.15 * u * u * stern;
    const double N = -3.18 * v * std::abs(v) - 94 * r * std::abs(r) - 2.0 * u * r - 1.93 * w * p + N_pq * p * q -
                     24.0 * u * v - 6.15 * u * u * rudder;
    // What stands with accelerations on the left; the rest of the rigid body on the right.
    Matrix6 A;
    A << m + 0.93, 0, 0, 0, m * zG, 0,      //
        0, m + 35.5, 0, -m * zG, 0, -1.93,  //
        0, 0, m + 35.5, 0, 1.93, 0,         //
        0, -m * zG, 0, Ixx + 0.0704, 0, 0,  //
        m * zG, 0, 1.93, 0, Iyy + 4.88, 0,  //
        0, -1.93, 0, 0, 0, Izz + 4.88;
    Vector6 b;
    b << X - m * (w * q - v * r + zG * p * r), Y - m * (u * r - w * p + zG * q * r),
        Z - m * (v * p - u * q - zG * (p * p + q * q)), K - (Izz - Iyy) * q * r + m * zG * (u * r - w * p),
        Mq - (Ixx - Izz) * r * p - m * zG * (w * q - v * r), N - (Iyy - Ixx) * p * q;
    const Vector6 a = A.partialPivLu().solve(b);
    return {u * cpsi * cth + v * (cpsi * sth * sphi - spsi * cphi) + w * (cpsi * sth * cphi + spsi * sphi),
            u * spsi * cth + v * (spsi * sth * sphi + cpsi * cphi) + w * (spsi * sth * cphi - cpsi * sphi),
            -u * sth + v * cth * sphi + w * cth * cphi,
            p + sth / cth * (q * sphi + r * cphi),
            q * cphi - r * sphi,
            (q * sphi + r * cphi) / cth,
            a(0),
            a(1),
            a(2),
            a(3),
            a(4),
            a(5)};
  }
};

}  // namespace isobath::test
