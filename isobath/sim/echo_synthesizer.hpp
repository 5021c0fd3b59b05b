// EchoSynthesizer: the mean echo power in each (beam, bin) of a sonar, and the path of the strongest echo. It is
// deterministic: speckle and noise are added later (simulated_sonar.hpp).
//
// Method. The field of view is divided into cells (azimuth x elevation). One ray stands for a cell of solid angle W.
// If the ray meets a surface at range r under incidence q, the cell's echo is, in units of the source level,
//     I = B(azimuth, elevation) 10^(-2 a r / 10) r^-2 sigma(q) W / cos q,      W r^2 / cos q: the area in the cell,
// with the backscatter sigma of the material (scene.hpp), the two-way pattern B and the absorption a. This is the
// active sonar equation (Urick 1983, ch. 2). The echo is spread over the ranges of the surface's tangent plane within
// the cell, so that a bottom at grazing incidence has no gaps. Bodies that are small against the cells get finer cells
// of their own. The sea surface scatters after Chapman and Harris 1962 by wind and frequency, the water by its
// scattering strength. Bounces: the surface, the bottom or a body reflects a ray like a mirror; an echo that the
// reflected ray meets returns over the mirror and directly. A wall at normal incidence appears again at twice its
// range, reflected by the sonar's housing (image law). The receive patterns of a fan, including side lobes, are applied
// per beam at the end.
//
// Units: power relative to 10^(source level / 10), before the receiver. Ranges are those of the device: travel time
// times its assumed sound speed. One object per sonar. One thread calls form(), which runs on `threads`; the result
// does not depend on their number. Cost: see bench/sim_bench.cpp.
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

/// Arrays of beams x bins.
struct EchoImage {
  int beams = 0, bins = 0;
  std::vector<float> rough;       ///< mean power of distributed scatterers, which fluctuates
  std::vector<float> steady;      ///< power of single, small bodies, which does not fluctuate
  std::vector<float> strongest;   ///< power of the strongest contribution alone
  std::vector<EchoLabel> labels;  ///< labels of the strongest contribution
  void resize(int beam_count, int bin_count);
};

class EchoSynthesizer {
 public:
  /// `world` and `water` must outlive the object.
  EchoSynthesizer(const SonarConfig& config, const World& world, const Water& water, int threads = 1);
  ~EchoSynthesizer();
  EchoSynthesizer(EchoSynthesizer&&) noexcept;
  EchoSynthesizer& operator=(EchoSynthesizer&&) noexcept;

  /// Azimuth of each beam in S; a scanning head has one beam at 0.
  [[nodiscard]] const std::vector<double>& beam_azimuths() const;
  /// Computes the echoes of a ping from X_WS. For a scanning head X_WS includes the rotation of the head.
  void form(const Pose& X_WS, EchoImage& image);
  /// Bounces whose contribution is below this power are not traced.
  /// `by_bin`: receiver gain (power) of each bin, 1 at its largest; powers are compared after this gain.
  void set_floor(double power, std::vector<float> by_bin = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isobath
