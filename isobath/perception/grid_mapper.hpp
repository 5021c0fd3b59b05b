// GridMapper: pings into the body-fixed grid (Ganesan 2015, 3.3 and 3.4; ledger S6-09, S6-12 to S6-27).
//
// Each ping first moves the grid by the vehicle's displacement since the last one, then updates it beam by beam, in the
// order of the fan: a fan of beams counts exactly as its beams one after another. Within a beam all clear bins come
// first, pooled into one addition a cell, then the echoes in the order of range. Bins are independent looks, so that
// any order is valid sequential Bayes up to the independence of the cells (S6-72); this one is fixed, so the result is
// deterministic. Bins that are not usable, or whose p_D is not above f, leave the grid as it is, whatever they hold.
//
// Beams are projected to the level plane: azimuth from the whole attitude, roll and pitch removed; slant ranges are
// taken as horizontal. Cells beyond the border count with their prior.
//
// After warm-up (a few pings of each sensor set-up) nothing allocates in the grid's default modes. One thread.
#pragma once

#include <cstdint>
#include <isobath/base/config.hpp>
#include <isobath/map/body_grid.hpp>
#include <isobath/map/motion.hpp>
#include <isobath/perception/bin_update.hpp>
#include <isobath/perception/overlap_table.hpp>
#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/ping.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct GridMapperConfig {
  enum class Update : std::uint8_t { kBin, kPrinted, kAnyTarget } update = Update::kBin;
  int block = 3;  ///< r of the printed form, cells
  MotionConfig motion;
  OverlapTableConfig table;
};

std::vector<Field> fields(GridMapperConfig& config);

class GridMapper {
 public:
  /// Throws Error.
  GridMapper(const BodyGridConfig& grid, const GridMapperConfig& config);

  /// The ping is valid (check() finds no fault), decisions have its size, the pose is finite.
  void update(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB,
              const DisplacementSource& source = {});

  /// The motion alone: brings the grid to a pose without an echo (S6-27).
  void advance(Time time, const Pose& X_WB, const DisplacementSource& source = {});

  [[nodiscard]] const BodyGrid& grid() const { return grid_; }
  [[nodiscard]] BodyGrid& grid() { return grid_; }
  [[nodiscard]] const OverlapTable& table() const { return table_; }

 private:
  void take_sensor(const Ping& ping, const EchoDecisions& decisions);
  void update_beam(const OverlapTable::Row& row, const std::uint64_t* hits);
  void lift_hits(const OverlapTable::Row& row, const std::uint64_t* hits);
  void apply_clears(const OverlapTable::Row& row);
  void apply_bin(const OverlapTable::Row& row, int bin, bool hit);
  template <class Visit>
  void for_each_hit(const std::uint64_t* hits, Visit visit) const;

  GridMapperConfig config_;
  BodyGrid grid_;
  OverlapTable table_;
  Time time_;
  std::optional<Pose> last_X_WB_;

  int bins_ = 0;
  double start_m_ = 0;
  double bin_m_ = 0;
  double false_alarm_ = 0;
  std::vector<float> p_detect_;
  std::vector<double> gain_;           ///< d of each bin, 0 where not usable
  std::vector<std::uint64_t> usable_;  ///< bins that may touch the grid
  std::vector<std::ptrdiff_t> index_;  ///< scratch of one bin: grid index or -1
  std::vector<double> log_odds_;
  std::vector<double> share_;
  std::vector<double> scratch_;
};

}  // namespace isobath
