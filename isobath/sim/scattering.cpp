#include <algorithm>
#include <cmath>
#include <isobath/sim/scattering.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

double from_db(double db) { return std::pow(10, db / 10); }

}  // namespace

double surface_scattering(double grazing_rad, double wind, double frequency) {
  const double knots = std::max(wind, 0.5) * 1.9438;
  const double beta = 158 * std::pow(knots * std::cbrt(frequency), -0.58);
  const double degrees = std::max(grazing_rad * 180 / kPi, 0.1);
  const double db = 3.3 * beta * std::log10(degrees / 30) - 42.4 * std::log10(beta) + 2.6;
  return from_db(std::clamp(db, -60.0, 0.0));
}

Scatterer::Scatterer(const Material& m)
    : mu(from_db(m.lambert_db)), mirror(from_db(m.reflection_db)), slope2(m.roughness * m.roughness) {}

double Scatterer::operator()(const Vector3d& u, const Vector3d& n, const Vector3d& e, double spread_1,
                             double spread_2) const {
  const double c = std::max(-n.dot(u), kMinCosine), cc = c * c;
  const double s1 = slope2 + 0.25 * spread_1 * spread_1, s2 = slope2 + 0.25 * spread_2 * spread_2;
  const double along = u.dot(e), across2 = std::max(0.0, 1 - cc - along * along);
  const double exponent = 0.5 * (along * along / s1 + across2 / s2) / cc;
  const double glint = exponent > 30 ? 0 : mirror / (8 * kPi * std::sqrt(s1 * s2) * cc * cc) * std::exp(-exponent);
  return mu * cc + glint;
}

SeaSurface::SeaSurface(double wind, double frequency) {
  const double s2 = 0.003 + 0.00512 * wind;
  for (int i = 0; i <= kSteps; ++i) {
    const double sine = std::max((i + 0.5) / kSteps, kMinCosine), square = std::min(1.0, sine * sine);
    const double tan2 = 1 / square - 1;
    const double glint = tan2 > 60 * s2 ? 0 : std::exp(-tan2 / (2 * s2)) / (8 * kPi * s2 * square * square);
    table_.push_back(surface_scattering(std::asin(std::min(sine, 1.0)), wind, frequency) + glint);
  }
}

}  // namespace isobath
