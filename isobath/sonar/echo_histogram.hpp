// EchoHistogram: the distribution of intensities in each range bin, as counts per level. All echo statistics are
// computed from it (noise fits, thresholds, ROC curves), so their memory does not grow with the recording.
//
// Levels: 8-bit samples keep their 256 values; level v covers intensities v - 1/2 .. v + 1/2, so that "at or above v"
// (ledger S6-03) is "above the edge v - 1/2". Samples of 16 bits and floats have one level for all values up to full
// scale / 2^16 and 64 logarithmic levels per octave above it (1.1 to 1.6 % apart), up to twice full scale. Within a
// level samples count as evenly spread. Larger samples count in the last level.
#pragma once

#include <cstdint>
#include <isobath/sonar/ping.hpp>
#include <vector>

namespace isobath {

class EchoLevels {
 public:
  EchoLevels() = default;  ///< levels of 8-bit samples
  EchoLevels(SampleType type, float full_scale);

  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] int level(float value) const;
  /// Lower edge of a level, as intensity; edge(count()) is the upper edge of the last one.
  [[nodiscard]] double edge(int level) const;
  [[nodiscard]] std::vector<double> edges() const;
  /// Whether each sample value is a level of its own (8 bits).
  [[nodiscard]] bool discrete() const { return discrete_; }
  bool operator==(const EchoLevels&) const = default;

 private:
  bool discrete_ = true;
  int count_ = 256;
  float unit_ = 1;  ///< intensity of the lower edge of level 1 (not discrete)
};

class EchoHistogram {
 public:
  EchoHistogram() = default;
  EchoHistogram(EchoLevels levels, int bins);

  void add(int bin, float value, std::uint32_t weight = 1) {
    counts_[offset(bin) + std::size_t(levels_.level(value))] += weight;
  }
  void add(const EchoHistogram& other);
  /// Halves all counts.
  void halve();

  [[nodiscard]] const EchoLevels& levels() const { return levels_; }
  [[nodiscard]] int bins() const { return bins_; }
  [[nodiscard]] const std::uint32_t* row(int bin) const { return counts_.data() + offset(bin); }

  /// Counts by level, summed over bins first .. last - 1.
  [[nodiscard]] std::vector<std::uint64_t> pooled(int first, int last) const;

 private:
  [[nodiscard]] std::size_t offset(int bin) const { return std::size_t(bin) * std::size_t(levels_.count()); }
  EchoLevels levels_;
  int bins_ = 0;
  std::vector<std::uint32_t> counts_;
};

/// One cumulative distribution over levels.
class EchoDistribution {
 public:
  EchoDistribution(const EchoLevels& levels, const std::vector<std::uint64_t>& counts);
  EchoDistribution(const EchoHistogram& histogram, int first, int last);

  [[nodiscard]] double samples() const { return cumulative_.back(); }
  [[nodiscard]] double mean() const;
  [[nodiscard]] double deviation() const;
  /// Share of samples at or above an intensity, linear within a level.
  [[nodiscard]] double rate_at_or_above(double threshold) const;
  /// The intensity below which a share p of the samples lies, linear within a level.
  [[nodiscard]] double quantile(double p) const;
  /// The threshold that noise reaches at the rate f: exact for continuous samples. For whole-number samples, which are
  /// compared with whole thresholds, the rate is at most f.
  [[nodiscard]] double threshold(double false_alarm) const;

 private:
  [[nodiscard]] double moment(double about, int power) const;
  EchoLevels levels_;
  std::vector<double> cumulative_;  ///< counts below each edge; count() + 1 entries
};

}  // namespace isobath
