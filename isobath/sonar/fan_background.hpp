// FanBackground: the background level of each cell of a fan, without targets.
//
// Noise, and the echoes of bottom, surface and volume, fill the fan: at one range most directions receive them. A
// target fills few directions. So the level at a range is a low quantile (kQuantile) over the neighbouring directions
// (`window_deg` to each side) of the locally averaged power: the *ring*. A wall at normal incidence is at one range
// over some 15 degrees to each side, and does not affect that quantile. Rings are averaged over kRingMemory seconds.
//
// A ring that is narrow in range, less than kNarrow cells, is a wall that fills the fan, not bottom or surface: it is
// not background (grey-scale opening along the range). Two kinds of narrow ring are background: the side-lobe echo of
// the bottom straight below or the surface straight above, at the range of altitude or depth if these are known, up to
// four times its median over the fan; and a ring that fills a fan of at least 80 degrees at the same range for kSteady
// seconds, which no flat wall can.
//
// Reverberation in a part of the fan, due to roll or a slope, and clouds of clutter fill a patch that is wide in
// direction and in range. The low quantile of a window of 3 m by 3 m, anywhere around the cell (a grey-scale opening),
// is background too: no wall is so thick, and no pole so wide.
//
// A beam that is loud over 64 cells of its range receives a wall over bottom and surface, or interference. A low
// quantile along the beam is background too. The near end of a wall that lies along a beam stays.
//
// Within ring and patch the level differs by direction: gains of beams, relief. So each cell has a level of its own,
// which follows its power slowly (`memory_s`) and stays within a factor `max_ratio` of ring and patch. A target in
// front of a hovering vehicle raises it by at most this factor.
//
// The gain of a receiver may step: if most of the fan becomes louder or fainter by kStep, all levels follow at once.
// Units: power of the samples. After the first ping of a geometry nothing allocates. One core, 256 x 250 cells: 1.3 ms.
#pragma once

#include <isobath/base/time.hpp>
#include <isobath/sonar/boundary_echoes.hpp>
#include <isobath/sonar/fan_cells.hpp>
#include <isobath/sonar/fan_config.hpp>
#include <vector>

namespace isobath {

class FanBackground {
 public:
  explicit FanBackground(const FanBackgroundConfig& config = {}) : config_(config) {}

  /// Resets all levels. `first_bin`: nearer cells are in the ringing and are not decided.
  void begin(const FanCells& cells, int first_bin, float faintest);
  /// After `begin`: sets the level of each row of cells relative to its ring, in power, from earlier learning.
  void start_from(std::vector<float> relief) { known_relief_ = std::move(relief); }
  /// Computes the levels for this ping, before its decisions. Cells with power below 0 do not count.
  void update(Time time, const std::vector<float>& power, const WaterColumn& water);
  /// After the decisions: the cells learn from this ping, slowly if their `target` is 1.
  void learn(const std::vector<std::uint8_t>& target);

  /// Level of each cell, above 0.
  [[nodiscard]] const std::vector<float>& level() const { return level_; }
  /// Level of water with noise alone: median over all ranges of the ring.
  [[nodiscard]] float quiet() const { return quiet_; }
  /// For each row of cells: median over the ranges of its level relative to the ring.
  [[nodiscard]] std::vector<double> relief() const;

 private:
  void average(const std::vector<float>& power);
  void find_rings(const WaterColumn& water);
  void follow_gain();
  void settle_rings(double dt_s, const WaterColumn& water);
  void open_row(const float* in, float* out);
  [[nodiscard]] float lower_median_of_rings(int bin);
  [[nodiscard]] std::size_t block_at(int across, int along) const {
    return static_cast<std::size_t>(across) * static_cast<std::size_t>(blocks_along_) + static_cast<std::size_t>(along);
  }
  void find_patches();
  void set_levels();
  void raise_columns(const std::vector<float>& power);

  FanBackgroundConfig config_;
  int beams_ = 0, bins_ = 0, first_bin_ = 0;
  double bin_m_ = 1, start_m_ = 0, span_ = 0;
  float faintest_ = 1;
  std::vector<int> sectors_;  ///< middle beam of each
  int half_ = 1;              ///< beams to each side of a sector's middle
  bool begun_ = false;
  int pings_ = 0;
  Time time_;
  double dt_s_ = 0;

  std::vector<float> around_;        ///< power averaged across beams
  std::vector<float> ring_, rings_;  ///< sectors x bins: of this ping, and averaged
  std::vector<float> wide_;          ///< rings without what is narrow
  std::vector<float> steady_s_;      ///< bins: since when a narrow ring has filled the fan
  int blocks_across_ = 0, blocks_along_ = 0;
  std::vector<float> block_, eroded_, patch_;  ///< blocks of cells: mean power; of their neighbourhoods
  int half_along_ = 1;                         ///< blocks to each side that a neighbourhood reaches
  std::vector<int> half_across_;               ///< the same across, by range
  std::vector<float> local_, level_;           ///< beams x bins
  std::vector<float> base_;                    ///< beams x bins: ring or patch
  std::vector<float> known_relief_;            ///< of each row, before the first ping; empty: not known
  std::vector<float> scratch_, scratch2_;
  float quiet_ = 1;
};

}  // namespace isobath
