// FanWatch: statistics of one sonar at one setting, collected by FanDetector. They give a model of the sonar, and its
// departure from the model with which the detector started.
//
// Collected: the ratios u of cells without a target, by stratum, from the ping at which backgrounds have settled; the
// mean power of each cell, without targets; for every eighth beam of a ping the number of samples at full scale and at
// zero, and their power. After `begin` nothing allocates. 512 x 500 samples: 0.2 ms per ping on one core.
#pragma once

#include <isobath/sonar/fan_cells.hpp>
#include <isobath/sonar/fan_model.hpp>

namespace isobath {

/// Median; reorders the values. 0 if there are none.
double median_of(std::vector<double>& values);

class FanWatch {
 public:
  void begin(const Ping& ping, const FanCells& cells, int first_bin);
  /// Adds the ratio of a cell without a target.
  void add(std::size_t stratum, float u) {
    if (pings_ >= kRough) tally_[stratum].add(u);
  }
  /// Ends a ping after its cells. Cells with power below 0 or `target` 1 do not count.
  void end_ping(const Ping& ping, const std::vector<float>& power, const std::vector<std::uint8_t>& target);
  /// Whether the median ratio of all cells so far, including targets, contradicts a law. Tested at the first ping and
  /// up to the 40th.
  bool contradicts(const TailLaw& law, const std::vector<float>& ratios);

  [[nodiscard]] int pings() const { return pings_; }
  /// Fills in a model, except correlation, quality and blind zone.
  void describe(FanModel& model) const;
  /// Departure from a model. `thresholds`: those of the model by stratum, for the rate `asked`. `same`: whether the
  /// setting is the same; only then levels and gains are compared.
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
