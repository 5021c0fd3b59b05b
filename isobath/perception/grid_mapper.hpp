// GridMapper: inserts pings into the body-fixed grid (Ganesan 2015, 3.3 and 3.4; ledger S6-09, S6-12 to S6-27).
//
// Each ping first moves the grid by the vehicle's displacement since the previous ping, and then updates it beam by
// beam in the order of the fan. A fan of beams therefore gives the same result as its beams one after another. Within a
// beam all clear bins come first, pooled into one addition per cell, then the echoes in order of range. Bins are
// independent looks, so any order is valid sequential Bayes up to the independence of the cells (S6-72); a fixed order
// makes the result deterministic. Bins that are not usable, or whose p_D is not above f, do not change the grid,
// whether they hold an echo or not. Dim bins have their own p_D. All evidence of a ping is weighted by
// EchoDecisions::weight, that of echoes by at most `max_echo_weight`. Where that is below 1, the beams that one map
// cell spans are one look at it together: near the sonar an echo of one of many beams says little.
//
// Beams are projected to the level plane. The azimuth is that of the full attitude, with roll and pitch removed. Slant
// ranges are multiplied by the cosine of the tilt of the sonar's axis, accurate to 1.5 % of the range, so a tilt of up
// to 10 degrees has no effect. Cells beyond the border count with their prior.
//
// After warm-up (a few pings of each sensor set-up) nothing allocates in the grid's default modes. One thread.
#pragma once

#include <cstdint>
#include <isobath/base/config.hpp>
#include <isobath/map/occupancy/body_grid.hpp>
#include <isobath/map/occupancy/motion_uncertainty.hpp>
#include <isobath/perception/bin_update.hpp>
#include <isobath/perception/overlap_table.hpp>
#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/ping.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct GridMapperConfig {
  enum class Update : std::uint8_t { kBin, kPrinted, kAnyTarget } update = Update::kBin;
  int block = 3;  ///< r of the printed form, in cells
  MotionConfig motion;
  OverlapTableConfig table;
};

std::vector<Field> fields(GridMapperConfig& config);

class GridMapper {
 public:
  /// Throws Error.
  GridMapper(const BodyGridConfig& grid, const GridMapperConfig& config);

  /// Inserts a ping. The ping must be valid (check() finds no fault), the decisions have its size, and the pose be
  /// finite.
  void update(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB,
              const DisplacementSource& source = {});

  /// Moves the grid to a pose without a ping (S6-27).
  void advance(Time time, const Pose& X_WB, const DisplacementSource& source = {});

  [[nodiscard]] const BodyGrid& grid() const { return grid_; }
  [[nodiscard]] BodyGrid& grid() { return grid_; }
  [[nodiscard]] const OverlapTable& table() const { return table_; }

 private:
  struct Placed;
  /// A bin and its cells: touches_[first], up to the first of the next look.
  struct Look {
    int bin;
    bool hit;
    double gain;
    std::size_t first;
  };
  struct Touch {
    std::ptrdiff_t index;  ///< in the grid, or -1
    float share;
    OverlapTable::CellOffset cell;
  };
  [[nodiscard]] double gain_of(float p_detect) const;  ///< d (S6-15); 0 where p_D is not above f
  void take_tilt(const Eigen::Vector3d& ahead_L);
  void take_sensor(const Ping& ping, const EchoDecisions& decisions);
  void update_beam(const OverlapTable::Row& row, const EchoDecisions& decisions, int beam);
  void gather(const OverlapTable::Row& row, const Placed& placed, const EchoDecisions& decisions, int beam,
              bool clears);
  void lift_looks();
  void apply_clears(const OverlapTable::Row& row, const Placed& placed);
  void apply_dim_clears();
  void apply_looks(const OverlapTable::Row& row, bool hit);
  [[nodiscard]] double share_of_look(int bin) const;
  void apply_look(const OverlapTable::Row& row, const Look& look, std::size_t end, bool hit);

  GridMapperConfig config_;
  BodyGrid grid_;
  OverlapTable table_;
  Time time_;
  std::optional<Pose> last_X_WB_;
  TurnVariance turn_variance_;

  double level_share_ = 1;  ///< of a slant range, horizontally
  int bins_ = 0;
  double start_m_ = 0;
  double bin_m_ = 0;
  double false_alarm_ = 0;
  double beam_step_ = 0;                 ///< between beams, rad; 0: each beam is a look of its own
  double weight_ = 1, echo_weight_ = 1;  ///< of the ping, and of its echoes
  std::vector<float> p_detect_;
  std::vector<double> gain_;           ///< d of each bin, 0 where not usable
  std::vector<std::uint64_t> usable_;  ///< bins that may touch the grid
  std::vector<Look> looks_;            ///< scratch of one beam: the bins that are looked at one by one
  std::vector<Touch> touches_;
  std::vector<std::ptrdiff_t> index_;  ///< scratch of one bin
  std::vector<double> log_odds_;
  std::vector<double> share_;
  std::vector<double> scratch_;
};

}  // namespace isobath
