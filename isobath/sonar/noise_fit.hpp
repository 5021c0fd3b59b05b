// NoiseFit: fits noise laws to the background of a range bin, with a goodness-of-fit test.
//
// Source: Ganesan 2015, 4.2; ledger S6-08, S6-D01, S6-E13 (noise at sea fits neither law: the test may reject all of
// them). Laws: Gaussian (mean, deviation), Rayleigh (scale: E[x^2] = 2 scale^2), K (shape, scale: an amplitude whose
// power is exponential with a Gamma-distributed mean, E[x^2] = 4 shape scale^2; Jakeman and Pusey 1976). Parameters:
// maximum likelihood for Gaussian and Rayleigh, second and fourth moment for K.
//
// Test: the Anderson-Darling statistic on counts per level (Lockhart, Spinelli and Stephens 2007). The law is compared
// only at the edges of the levels, so ties of 8-bit data are no deviation from the law. Its p-value comes from a
// parametric bootstrap: samples of the fitted law are put into the same levels and fitted again, and their statistics
// are ranked. So estimated parameters, rounding and clipping at 0 affect both sides alike. A law that reaches below
// level 0 puts that mass into it. Smallest p-value: 1 / (bootstraps + 1). The p-value assumes independent samples,
// which neighbouring beams and pings are not quite. For large samples of real sonars every law is rejected, and the
// statistics rank the laws.
#pragma once

#include <cstdint>
#include <isobath/sonar/echo_histogram.hpp>

namespace isobath {

enum class NoiseLaw : std::uint8_t { kGaussian, kRayleigh, kK };
const char* to_text(NoiseLaw law);

struct NoiseFit {
  NoiseLaw law = NoiseLaw::kGaussian;
  double location = 0;   ///< mean of the Gaussian; 0 for the others
  double scale = 0;      ///< counts
  double shape = 0;      ///< shape of K; large: nearly Rayleigh
  double statistic = 0;  ///< Anderson-Darling; smaller is better
  double p_value = 0;
  std::uint64_t samples = 0;
};

struct NoiseFitConfig {
  int bootstraps = 99;
  std::uint64_t seed = 1;
  double significance = 0.01;  ///< a law with a smaller p-value is rejected
};

/// `counts`: samples per level. Needs at least 8 samples in at least 3 levels; otherwise the statistic is infinite and
/// the p-value 0.
NoiseFit fit_noise(const EchoLevels& levels, const std::vector<std::uint64_t>& counts, NoiseLaw law,
                   const NoiseFitConfig& config);

/// P(noise < x) under the fit.
double cumulative(const NoiseFit& fit, double x);

}  // namespace isobath
