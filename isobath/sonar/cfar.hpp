// Cfar: constant-false-alarm-rate detectors of the literature, along the range bins of one beam.
//
// Source: cell averaging, Finn and Johnson 1968; ordered statistic, Rohling 1983. Ledger S6-62, S6-64. The bin under
// test is compared with alpha times a level that is estimated from `reference` bins on each side, beyond `guard` bins.
// The factor has a closed form for noise with exponentially distributed power:
//   CA: alpha = N (f^(-1/N) - 1), level = mean;   OS: f = prod_{i<k} (N - i) / (N - i + alpha), level = k-th smallest.
// `exponential` takes the samples as powers, `rayleigh` as amplitudes, whose squares are powers. Noise of another law
// gives another false-alarm rate; log-compressed samples fit neither. At the ends of a beam N is the number of bins
// left in the window.
#pragma once

#include <cstdint>
#include <isobath/base/config.hpp>
#include <vector>

namespace isobath {

enum class CfarLaw : std::uint8_t { kExponential, kRayleigh };

struct CfarConfig {
  int guard = 4;
  int reference = 16;
  double rank = 0.75;  ///< rank of the ordered statistic: k = ceil(rank N)
  CfarLaw law = CfarLaw::kRayleigh;
};
std::vector<Field> fields(CfarConfig& config);

/// Factor alpha on powers; N reference bins, rank k counted from 1.
double ca_cfar_factor(int reference_bins, double false_alarm);
double os_cfar_factor(int reference_bins, int rank, double false_alarm);

class Cfar {
 public:
  Cfar() = default;
  Cfar(const CfarConfig& config, bool ordered, double false_alarm);

  /// Tests the beam from bin `first` on and sets the bits of hits, bit k % 64 of word k / 64. Bins without a reference
  /// bin stay clear.
  void detect(const float* beam, int first, int bins, std::uint64_t* hits);

 private:
  [[nodiscard]] bool exceeds_mean(int bin, int first, int bins) const;
  [[nodiscard]] bool exceeds_rank(int bin, int first, int bins) const;

  CfarConfig config_;
  bool ordered_ = false;
  std::vector<double> factors_;  ///< by the number of reference bins
  std::vector<double> power_;
  std::vector<double> sums_;  ///< cumulative sums of power_ before each bin
};

}  // namespace isobath
