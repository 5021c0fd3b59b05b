// Scattering: backscatter of surfaces by angle. Linear, re 1 m2 per m2.
#pragma once

#include <Eigen/Core>
#include <isobath/sim/scene.hpp>
#include <vector>

namespace isobath {

inline constexpr double kMinCosine = 0.02;  ///< minimum cosine of incidence: keeps the area of a grazing ray finite

/// Backscatter strength of a wind-roughened surface, linear, by grazing angle (Chapman and Harris 1962, with
/// frequencies above 6.4 kHz taken at its upper validity by the sqrt law of the wind; wind in m/s, frequency in Hz).
/// Clamped to -60 .. 0 dB.
double surface_scattering(double grazing_rad, double wind, double frequency);
/// Lambert part and glint of a material, precomputed.
struct Scatterer {
  double mu, mirror, slope2;
  explicit Scatterer(const Material& material);
  /// sigma, linear, for a ray u on a surface whose normal n faces it. The glint is spread over the change of the normal
  /// within a cell, (spread_1, spread_2) along (e, n x e), so that a few rays carry its whole energy.
  [[nodiscard]] double operator()(const Eigen::Vector3d& u, const Eigen::Vector3d& n, const Eigen::Vector3d& e,
                                  double spread_1, double spread_2) const;
};

/// Backscatter of the wind-roughened surface, tabulated by the sine of the grazing angle: Chapman and Harris, plus the
/// glint of facets whose slopes follow Cox and Munk 1954.
class SeaSurface {
 public:
  SeaSurface(double wind, double frequency);
  [[nodiscard]] double operator()(double sine) const {
    return table_[static_cast<std::size_t>((sine < 1 ? sine : 1) * kSteps)];
  }

 private:
  static constexpr int kSteps = 4096;
  std::vector<double> table_;
};

}  // namespace isobath
