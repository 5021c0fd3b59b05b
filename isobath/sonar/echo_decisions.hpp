// EchoDecisions: the decision of an echo detector for each bin of one ping, with its likelihoods.
//
// S = 1 if the intensity is at or above the threshold of its bin, else 0 (ledger S6-03). Each decision comes with the
// probabilities that a mapper needs: P(S = 1 | target) = p_D(k) and P(S = 1 | no target) = f (S6-14). Bins without
// information (blind zone, S6-09; p_D <= f) are not usable: neither their 1 nor their 0 may change a map. A bin of one
// beam may be dim: bottom or surface are loud there, and it has a p_D of its own (S6-69). A detector that knows the
// likelihoods of an echo's intensity with and without a target gives their ratio (S5-25).
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

namespace isobath {

class EchoDecisions {
 public:
  /// Makes all bins clear and usable. Allocates only if the size exceeds all earlier ones.
  void reset(int beams, int bins) {
    beams_ = beams;
    bins_ = bins;
    words_ = (bins + 63) / 64;
    hits_.assign(static_cast<std::size_t>(beams) * words_, 0);
    usable_.assign(words_, ~std::uint64_t{0});
    if (bins % 64 != 0) usable_.back() = (std::uint64_t{1} << (bins % 64)) - 1;
    p_detect.assign(bins, 0);
    dim_.clear();
    has_ratios_ = false;
    weight = max_echo_weight = 1;
  }

  [[nodiscard]] int beams() const { return beams_; }
  [[nodiscard]] int bins() const { return bins_; }
  [[nodiscard]] int words() const { return words_; }

  [[nodiscard]] bool hit(int beam, int bin) const { return hits(beam)[bin / 64] >> (bin % 64) & 1; }
  void set_hit(int beam, int bin) { hits(beam)[bin / 64] |= std::uint64_t{1} << (bin % 64); }
  /// words() words; bit k % 64 of word k / 64 is the decision of bin k. Ignore hits in bins that are not usable.
  [[nodiscard]] const std::uint64_t* hits(int beam) const { return hits_.data() + std::size_t(beam) * words_; }
  [[nodiscard]] std::uint64_t* hits(int beam) { return hits_.data() + std::size_t(beam) * words_; }

  /// Usable bins are the same for all beams of a ping.
  [[nodiscard]] bool usable(int bin) const { return usable_[bin / 64] >> (bin % 64) & 1; }
  [[nodiscard]] const std::uint64_t* usable() const { return usable_.data(); }
  void set_unusable(int bin) { usable_[bin / 64] &= ~(std::uint64_t{1} << (bin % 64)); }

  /// words() words; null if no bin of the ping is dim.
  [[nodiscard]] const std::uint64_t* dim(int beam) const {
    return dim_.empty() ? nullptr : dim_.data() + std::size_t(beam) * words_;
  }
  /// p_D of a dim bin; 0: its decision has no information.
  [[nodiscard]] float p_dim(int beam, int bin) const { return p_dim_[std::size_t(beam) * bins_ + bin]; }
  [[nodiscard]] bool is_dim(int beam, int bin) const {
    return !dim_.empty() && (dim(beam)[bin / 64] >> (bin % 64) & 1) != 0;
  }
  /// p_D of this bin of this beam, dim or not.
  [[nodiscard]] float p_of(int beam, int bin) const { return is_dim(beam, bin) ? p_dim(beam, bin) : p_detect[bin]; }
  /// Whether this bin of this beam may change a map.
  [[nodiscard]] bool tells(int beam, int bin) const {
    return usable(bin) && !(is_dim(beam, bin) && !(p_dim(beam, bin) > 0));
  }
  /// Sets the dim bins of one beam: words() words, and bins() values of p_D; only those of dim bins are used.
  void set_dim(int beam, const std::uint64_t* bits, const float* p) {
    if (dim_.empty()) {
      dim_.assign(hits_.size(), 0);
      p_dim_.resize(std::size_t(beams_) * bins_);
    }
    std::copy_n(bits, words_, dim_.begin() + std::ptrdiff_t(beam) * words_);
    std::copy_n(p, bins_, p_dim_.begin() + std::ptrdiff_t(beam) * bins_);
  }

  /// Marks this bin of this beam as without information.
  void set_blind(int beam, int bin) {
    if (dim_.empty()) {
      dim_.assign(hits_.size(), 0);
      p_dim_.resize(std::size_t(beams_) * bins_);
    }
    const std::uint64_t bit = std::uint64_t{1} << (bin % 64);
    hits(beam)[bin / 64] &= ~bit;
    dim_[std::size_t(beam) * words_ + bin / 64] |= bit;
    p_dim_[std::size_t(beam) * bins_ + bin] = 0;
  }

  /// P(intensity | target) / P(intensity | no target) of the bins of a beam that hold an echo; 1 in all others. Null:
  /// the detector does not know the likelihoods.
  [[nodiscard]] const float* ratios(int beam) const {
    return has_ratios_ ? ratios_.data() + std::size_t(beam) * bins_ : nullptr;
  }
  void set_ratio(int beam, int bin, float ratio) {
    if (!has_ratios_) ratios_.assign(std::size_t(beams_) * bins_, 1);
    has_ratios_ = true;
    ratios_[std::size_t(beam) * bins_ + bin] = ratio;
  }

  std::vector<float> p_detect;  ///< p_D(k) of each bin; above false_alarm if the bin is usable
  double false_alarm = 0.02;    ///< f, the same for all bins
  float weight = 1;             ///< share of an independent look; maps multiply the ping's evidence by it
  float max_echo_weight = 1;    ///< maximum weight of the ping's echoes

 private:
  int beams_ = 0;
  int bins_ = 0;
  int words_ = 0;
  std::vector<std::uint64_t> hits_;
  std::vector<std::uint64_t> usable_;
  std::vector<std::uint64_t> dim_;
  std::vector<float> p_dim_;
  bool has_ratios_ = false;
  std::vector<float> ratios_;
};

}  // namespace isobath
