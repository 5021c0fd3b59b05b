#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/sonar/cfar.hpp>

namespace isobath {
namespace {

/// False-alarm rate of the ordered statistic for a factor.
double os_rate(int n, int rank, double factor) {
  double rate = 1;
  for (int i = 0; i < rank; ++i) rate *= (n - i) / (n - i + factor);
  return rate;
}

int rank_of(double share, int n) { return std::max(1, static_cast<int>(std::ceil(share * n))); }

}  // namespace

std::vector<Field> fields(CfarConfig& c) {
  return {Field::integer("cfar_guard", &c.guard, {0, 1000}, "bins",
                         "Number of bins on each side that are left out of the level."),
          Field::integer("cfar_reference", &c.reference, {1, 1000}, "bins",
                         "Number of bins on each side from which the level is estimated."),
          Field::real("cfar_rank", &c.rank, {0.01, 1}, "1", "Rank of the ordered statistic, as a share of the bins."),
          Field::choice<CfarLaw>("cfar_law", &c.law,
                                 {{"exponential", CfarLaw::kExponential}, {"rayleigh", CfarLaw::kRayleigh}},
                                 "Law of the noise: samples are powers (exponential) or amplitudes (rayleigh).")};
}

double ca_cfar_factor(int reference_bins, double false_alarm) {
  ISOBATH_ASSERT(reference_bins > 0 && false_alarm > 0 && false_alarm < 1);
  return reference_bins * (std::pow(false_alarm, -1.0 / reference_bins) - 1);
}

double os_cfar_factor(int reference_bins, int rank, double false_alarm) {
  ISOBATH_ASSERT(rank > 0 && rank <= reference_bins && false_alarm > 0 && false_alarm < 1);
  double low = 0;
  double high = 1;
  while (os_rate(reference_bins, rank, high) > false_alarm) high *= 2;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (os_rate(reference_bins, rank, middle) > false_alarm ? low : high) = middle;
  }
  return high;
}

Cfar::Cfar(const CfarConfig& config, bool ordered, double false_alarm) : config_(config), ordered_(ordered) {
  factors_.assign(2 * config.reference + 1, 0);
  for (int n = 1; n <= 2 * config.reference; ++n) {
    factors_[n] = ordered ? os_cfar_factor(n, rank_of(config.rank, n), false_alarm) : ca_cfar_factor(n, false_alarm);
  }
}

void Cfar::detect(const float* beam, int first, int bins, std::uint64_t* hits) {
  power_.resize(bins);
  sums_.resize(bins + 1);
  sums_[0] = 0;
  for (int k = 0; k < bins; ++k) {
    power_[k] = config_.law == CfarLaw::kRayleigh ? static_cast<double>(beam[k]) * beam[k] : beam[k];
    sums_[k + 1] = sums_[k] + power_[k];
  }
  for (int k = first; k < bins; ++k) {
    if (ordered_ ? exceeds_rank(k, first, bins) : exceeds_mean(k, first, bins))
      hits[k / 64] |= std::uint64_t{1} << (k % 64);
  }
}

namespace {

/// Reference bins of a bin: [a, b) before and [c, d) behind it.
struct Neighbours {
  int a, b, c, d;
  [[nodiscard]] int count() const { return b - a + d - c; }
};

Neighbours neighbours(const CfarConfig& config, int bin, int first, int bins) {
  const int b = std::max(first, bin - config.guard);
  const int c = std::min(bins, bin + config.guard + 1);
  return {std::max(first, b - config.reference), b, c, std::min(bins, c + config.reference)};
}

}  // namespace

bool Cfar::exceeds_mean(int bin, int first, int bins) const {
  const Neighbours n = neighbours(config_, bin, first, bins);
  if (n.count() == 0) return false;
  const double level = (sums_[n.b] - sums_[n.a] + sums_[n.d] - sums_[n.c]) / n.count();
  return power_[bin] > 0 && power_[bin] >= factors_[n.count()] * level;
}

// cut >= alpha x_(k) is equivalent to: at least k reference bins are at or below cut / alpha. Counting needs no
// sorting.
bool Cfar::exceeds_rank(int bin, int first, int bins) const {
  const Neighbours n = neighbours(config_, bin, first, bins);
  if (n.count() == 0 || !(power_[bin] > 0)) return false;
  const double limit = power_[bin] / factors_[n.count()];
  int below = 0;
  for (int k = n.a; k < n.b; ++k) below += power_[k] <= limit;
  for (int k = n.c; k < n.d; ++k) below += power_[k] <= limit;
  return below >= rank_of(config_.rank, n.count());
}

}  // namespace isobath
