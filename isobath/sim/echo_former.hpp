// EchoFormer: the mean power that comes back in each (beam, bin) of a sonar, and by which path. No chance in here:
// speckle and noise come later (simulated_sonar.hpp).
//
// Method. The field of view is cut into cells (azimuth x elevation); one ray stands for a cell of solid angle W. Where
// it meets a surface at range r under incidence q, the cell's echo is, in units of the source level,
//     I = B(azimuth, elevation) 10^(-2 a r / 10) r^-2 sigma(q) W / cos q,      W r^2 / cos q: the area in the cell,
// sigma the backscatter of the material (scene.hpp), B the two-way pattern, a the absorption: the active sonar equation
// (Urick 1983, ch. 2). It is spread over the ranges that the surface has within the cell (by its tangent plane), so
// that a bottom at grazing incidence has no gaps. Bodies too small for the cells get cells of their own around them.
// The surface scatters after Chapman and Harris 1962 by wind and frequency, the water by its scattering strength.
// Bounces: a ray goes on from the surface, the bottom or a body as from a mirror; what it then meets comes back the
// same way, and straight. A wall met square on is seen again at twice its range by way of the sonar's housing (image
// law). Receive patterns across a fan, side lobes too, are applied beam by beam at the end.
//
// Units: power relative to 10^(source level / 10), before the receiver. Ranges as the device reads them: travel time
// times its assumed sound speed. One object a sonar; form() from one thread, itself on `threads`, with the same result
// on any number of them. Cost: see bench/sim_bench.cpp.
#pragma once

#include <isobath/base/angle.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/sim/sonar_config.hpp>
#include <isobath/sim/water.hpp>
#include <isobath/sim/world.hpp>
#include <isobath/sonar/echo_truth.hpp>
#include <memory>
#include <vector>

namespace isobath {

/// Beams x bins.
struct EchoImage {
  int beams = 0, bins = 0;
  std::vector<float> rough;       ///< mean power of many scatterers, which fluctuates
  std::vector<float> steady;      ///< power of single, small bodies, which does not
  std::vector<float> strongest;   ///< power of the strongest contribution alone
  std::vector<EchoLabel> labels;  ///< of the strongest contribution
  void resize(int beam_count, int bin_count);
};

class EchoFormer {
 public:
  /// `world` and `water` outlive it.
  EchoFormer(const SonarConfig& config, const World& world, const Water& water, int threads = 1);
  ~EchoFormer();
  EchoFormer(EchoFormer&&) noexcept;
  EchoFormer& operator=(EchoFormer&&) noexcept;

  /// Azimuth of each beam in S; one beam, 0, for a scanning head.
  [[nodiscard]] const std::vector<double>& beam_azimuths() const;
  /// What the sonar at X_WS hears. For a scanning head X_WS includes the head's own turn.
  void form(const Pose& X_WS, EchoImage& image);
  /// Contributions below this power are not worth their path: their bounces are not followed.
  /// `by_bin`: receiver gain (power) of each bin, 1 where it is largest; a power counts with it.
  void set_floor(double power, std::vector<float> by_bin = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isobath
