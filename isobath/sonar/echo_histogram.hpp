// EchoHistogram: the distribution of intensities in each range bin, as counts per level. All statistics of echoes are
// made from it (noise fits, thresholds, ROC curves): its size does not grow with the recording.
//
// Levels: 8-bit samples keep their 256 values; level v stands for intensities v - 1/2 .. v + 1/2, so that "at or above
// v" (ledger S6-03) is "above the edge v - 1/2". Samples of 16 bits and floats have one level for all up to full scale
// / 2^16 and 64 logarithmic levels an octave above it (1.1 to 1.6 % apart), up to twice full scale; within a level
// samples count as evenly spread. Larger ones fall into the last level.
#pragma once

#include <cstdint>
#include <isobath/sonar/ping.hpp>
#include <vector>

namespace isobath {

class EchoLevels {
 public:
  EchoLevels() = default;  ///< of 8-bit samples
  EchoLevels(SampleType type, float full_scale);

  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] int level(float value) const;
  /// Lower edge of a level, in intensity; edge(count()) is the end of the last one.
  [[nodiscard]] double edge(int level) const;
  [[nodiscard]] std::vector<double> edges() const;
  /// Whether the samples are whole numbers of their own levels (8 bits).
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
  /// Forgets half of what was seen.
  void halve();

  [[nodiscard]] const EchoLevels& levels() const { return levels_; }
  [[nodiscard]] int bins() const { return bins_; }
  [[nodiscard]] const std::uint32_t* row(int bin) const { return counts_.data() + offset(bin); }

  /// The levels of bins first .. last - 1 together.
  [[nodiscard]] std::vector<std::uint64_t> pooled(int first, int last) const;

 private:
  [[nodiscard]] std::size_t offset(int bin) const { return std::size_t(bin) * std::size_t(levels_.count()); }
  EchoLevels levels_;
  int bins_ = 0;
  std::vector<std::uint32_t> counts_;
};

/// One distribution over levels, summed up for questions.
class EchoDistribution {
 public:
  EchoDistribution(const EchoLevels& levels, const std::vector<std::uint64_t>& counts);
  EchoDistribution(const EchoHistogram& histogram, int first, int last);

  [[nodiscard]] double samples() const { return cumulative_.back(); }
  [[nodiscard]] double mean() const;
  [[nodiscard]] double deviation() const;
  /// Share of samples at or above an intensity, linear within a level.
  [[nodiscard]] double rate_at_or_above(double threshold) const;
  /// The intensity that a share p of the samples stays below, linear within a level.
  [[nodiscard]] double quantile(double p) const;
  /// The threshold that noise reaches at the rate f: exactly for continuous samples; at most f for whole numbers, which
  /// are compared with whole numbers.
  [[nodiscard]] double threshold(double false_alarm) const;

 private:
  [[nodiscard]] double moment(double about, int power) const;
  EchoLevels levels_;
  std::vector<double> cumulative_;  ///< of the levels below each edge; count() + 1 entries
};

}  // namespace isobath
