// OverlapTable: which cells each range bin of a beam overlaps, and by what share of the cell (ledger S6-11, S6-12).
//
// A row holds one beam, all bins: its cells, as offsets from the cell of the sensor, with the pooled effect of an
// all-clear beam on each; and for every bin its entries {cell of the row, share}. Shares are exact areas
// (geometry/sector_overlap) for a direction and a sub-cell place of the sensor that are rounded: the direction to at
// most a quarter of the beam's width and to an eighth of a cell at full range, the place to 1/offset_steps of a cell.
// The rounding never adds up: poses stay exact.
//
// Rows are made when they are first needed and kept in a fixed arena; the oldest make room. Rows of the eight symmetric
// directions of the square are one row, read with other strides. What a row holds never depends on what is kept.
//
// Frames: the grid's G. Units: cells, except where a name says metres. After `prepare` has seen a sensor set-up nothing
// allocates, once the scratch space has met its largest row. Not for use by two threads at once.
#pragma once

#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <isobath/geometry/cartesian_grid.hpp>
#include <isobath/geometry/sector_overlap.hpp>
#include <isobath/sonar/ping.hpp>
#include <span>
#include <vector>

namespace isobath {

struct OverlapTableConfig {
  int table_mb = 64;
  int offset_steps = 4;                       ///< places of the sensor within a cell, along each axis
  Angle bearing_step = Angle::degrees(0.25);  ///< rounding of directions, at most
};

std::vector<Field> fields(OverlapTableConfig& config);

class OverlapTable {
 public:
  /// Cells farther than `reach_cells` from the sensor are left out: they lie in no grid. Throws Error.
  OverlapTable(const OverlapTableConfig& config, double cell_m, int reach_cells);

  /// The sensor set-up of the next rows. `gain` is d of each bin (S6-15), 0 where a bin is not usable.
  void prepare(const BeamFan& fan, const RangeWindow& window, std::span<const double> gain);

  struct CellOffset {
    std::int16_t u;
    std::int16_t v;
  };
  struct Entry {
    std::uint32_t cell;  ///< of the row
    float share;
  };

  /// A row as it lies in the grid: offset (u, v) is cell (x + x_u u + x_v v, y + y_u u + y_v v). Valid until the next
  /// call.
  struct Row {
    int x, y;
    int x_u, x_v, y_u, y_v;
    std::span<const CellOffset> cells;
    std::span<const double> clear;               ///< log-odds increment of each cell where all bins are clear
    std::span<const std::uint32_t> first_entry;  ///< of each bin, and one more
    std::span<const Entry> entries;
    CellOffset low, high;       ///< bounds of the cells
    Eigen::Vector2d direction;  ///< as rounded, in G
    Eigen::Vector2d sensor;     ///< as rounded, in G, cells

    [[nodiscard]] std::span<const Entry> bin(int k) const {
      return entries.subspan(first_entry[k], first_entry[k + 1] - first_entry[k]);
    }
    [[nodiscard]] Cell cell(CellOffset o) const { return {x + x_u * o.u + x_v * o.v, y + y_u * o.u + y_v * o.v}; }
  };
  /// `sensor` is its place in G, in metres; `beam` chooses the width, `azimuth` is its direction in G.
  [[nodiscard]] Row row(int beam, Angle azimuth, const Eigen::Vector2d& sensor);

  [[nodiscard]] std::uint64_t rows_built() const { return rows_built_; }
  /// Full width that stands for that of a beam: widths within 2 % of one another share rows.
  [[nodiscard]] Angle width(int beam) const { return widths_[width_of_beam_[beam]]; }

 private:
  struct Header;
  void adopt(const BeamFan& fan, const RangeWindow& window);
  void group_widths(const BeamFan& fan);
  void forget();
  Header* find_or_build(std::uint32_t key, Angle width, int bearing, int qx, int qy);
  void build(Angle width, int bearing, int qx, int qy);
  void build_cell(const Wedge& wedge, int u, int v, const Eigen::Vector2d& sensor);
  Header* store(std::uint32_t key);
  std::byte* allocate(std::size_t bytes);
  void evict_oldest();
  void pool(Header& row) const;

  OverlapTableConfig config_;
  double cell_m_;
  int reach_;
  RangeWindow window_;
  double start_ = 0;  ///< of the window, and its bin, in cells
  double bin_ = 1;
  int octant_ = 1;  ///< directions in 45 degrees
  std::vector<Angle> fan_widths_;
  std::vector<Angle> widths_;
  std::vector<int> width_of_beam_;
  std::vector<double> gain_;
  std::uint32_t gain_version_ = 0;

  std::vector<std::uint32_t> slot_;  ///< of each key: 0, or place in the arena / 16 + 1
  std::vector<std::byte> arena_;
  std::size_t head_ = 0;
  std::size_t tail_ = 0;
  std::size_t wrap_ = 0;
  bool wrapped_ = false;
  std::uint64_t rows_built_ = 0;

  struct Found {
    std::uint32_t bin;
    Entry entry;
  };
  std::vector<CellOffset> cells_;  ///< scratch: the row in work
  std::vector<Found> found_;
  std::vector<std::byte> single_;  ///< a row too large for the arena
};

}  // namespace isobath
