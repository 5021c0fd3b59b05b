// FanCells: the samples of a fan, pooled to the resolution of its aperture and of the map. One cell is one look at the
// water.
//
// Beams of a fan overlap: neighbours closer than the width of a beam receive the same water and the same noise, and are
// not independent looks. So beams are pooled over the width of one beam. Range bins are pooled until a window has
// `range_cells` of them; a map does not use finer ones. The value of a cell is the mean of the squared samples (power),
// the statistic that detects a fluctuating echo in speckle (Swerling 1960, non-coherent integration).
//
// Cells are numbered beam by beam, near to far. Samples that a beam lacks (Ping::sampled) do not count; a cell without
// samples has power -1. The last cell of a beam, and the last beam, may hold fewer samples than the others.
//
// After the first ping of a geometry nothing allocates. 512 x 500 samples of 8 bits: 0.3 ms on one core.
#pragma once

#include <isobath/sonar/ping.hpp>
#include <memory>
#include <vector>

namespace isobath {

class FanCells {
 public:
  explicit FanCells(int range_cells = 200) : range_cells_(range_cells) {}

  /// Sets the geometry to that of the ping. Returns whether it differs from the previous one.
  bool prepare(const Ping& ping);
  /// Pools a ping of the prepared geometry.
  void pool(const Ping& ping);

  [[nodiscard]] int beams() const { return fan_ ? fan_->beams() : 0; }
  [[nodiscard]] int bins() const { return window_.bins; }
  [[nodiscard]] int beams_per_cell() const { return beams_per_cell_; }
  [[nodiscard]] int bins_per_cell() const { return bins_per_cell_; }
  [[nodiscard]] const std::shared_ptr<const BeamFan>& fan() const { return fan_; }  ///< fan of the cells
  [[nodiscard]] const RangeWindow& window() const { return window_; }               ///< window of the cells
  [[nodiscard]] const std::vector<float>& power() const { return power_; }          ///< mean of the squared samples
  /// The beams, or bins, of the samples in a row or column of cells.
  [[nodiscard]] BinSpan beams_of(int beam) const;
  [[nodiscard]] BinSpan bins_of(int bin) const;

 private:
  void pool_bytes(const Ping& ping);
  void pool_any(const Ping& ping);

  int range_cells_;
  std::shared_ptr<const BeamFan> sample_fan_, fan_;
  RangeWindow sample_window_, window_;
  int beams_per_cell_ = 1, bins_per_cell_ = 1;
  std::vector<float> power_;
  std::vector<float> row_;           ///< one beam of samples
  std::vector<std::uint32_t> sums_;  ///< of one row of cells
  std::vector<float> totals_, counts_;
};

}  // namespace isobath
