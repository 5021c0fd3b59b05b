// FanWatch: what FanDetector hears of one sonar at one setting, kept for a model of it, and to tell how far it departs
// from the model that the detector began with.
//
// Kept: the ratios u of the cells without a target, stratum by stratum, from the ping on from which backgrounds are
// settled; the mean power of each cell, targets left out; of every eighth beam of a ping the samples at full scale, at
// zero, and their power. After `begin` nothing allocates. 512 x 500 samples: 0.2 ms a ping on one core.
#pragma once

#include <isobath/sonar/fan_cells.hpp>
#include <isobath/sonar/fan_model.hpp>

namespace isobath {

/// Reorders the values; 0 of none.
double median_of(std::vector<double>& values);

class FanWatch {
 public:
  void begin(const Ping& ping, const FanCells& cells, int first_bin);
  /// The ratio of a cell without a target.
  void add(std::size_t stratum, float u) {
    if (pings_ >= kRough) tally_[stratum].add(u);
  }
  /// After a ping's cells: the next one begins. Cells with power below 0 or `target` 1 do not count.
  void hear(const Ping& ping, const std::vector<float>& power, const std::vector<std::uint8_t>& target);
  /// Whether the middle of the ratios of all cells so far, with their targets, contradicts a law. Judged at the first
  /// ping and up to the 40th.
  bool contradicts(const TailLaw& law, const std::vector<float>& ratios);

  [[nodiscard]] int pings() const { return pings_; }
  /// All of a model but correlation, quality and the blind zone.
  void describe(FanModel& model) const;
  /// `thresholds`: of the model, a stratum each, for the rate `asked`. Levels and gains: where `same` setting.
  [[nodiscard]] FanDeparture departure(const FanModel& model, const std::array<float, FanModel::kStrata>& thresholds,
                                       double asked, bool same) const;

 private:
  static constexpr int kRough = 8;  ///< pings, until the backgrounds are settled
  static constexpr int kEvery = 8;  ///< beams
  [[nodiscard]] std::vector<double> levels() const;
  [[nodiscard]] std::vector<double> gains_db(const std::vector<double>& levels) const;
  [[nodiscard]] double mean(std::size_t cell) const { return count_[cell] > 0 ? sum_[cell] / count_[cell] : 0; }

  int pings_ = 0, rows_ = 0, bins_ = 0, first_bin_ = 0;
  double cell_m_ = 0;
  RangeWindow window_;
  SampleType type_ = SampleType::kU8;
  float full_scale_ = 255;
  Time first_, last_;
  std::array<TailLaw, FanModel::kStrata> tally_;
  TailLaw heard_;
  std::vector<double> sum_;  ///< of each cell: power
  std::vector<float> count_;
  std::vector<float> row_;
  std::vector<double> beam_sum_, beam_count_;  ///< of the sonar's beams: power of samples behind the blind zone
  double samples_ = 0, clipped_ = 0, silent_ = 0;
  int first_sample_ = 0;
};

}  // namespace isobath
