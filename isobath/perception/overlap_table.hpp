// OverlapTable: the cells that each range bin of a beam overlaps, and the overlapped share of each cell (ledger S6-11,
// S6-12).
//
// A row holds one beam with all its bins: its cells, as offsets from the cell of the sensor, with the pooled effect of
// an all-clear beam on each; and for each bin its entries {cell of the row, share}. Shares are exact areas
// (geometry/sector_overlap) for a rounded direction and a rounded sub-cell position of the sensor. The direction is
// rounded to at most a quarter of the beam's width and to an eighth of a cell at full range, the position to
// 1/offset_steps of a cell. Rounding errors do not accumulate, since poses stay exact.
//
// Rows are built on first use and kept in a fixed arena; new rows replace the oldest. The eight symmetric directions of
// the square share one row, read with different strides. The content of a row does not depend on the other rows kept.
//
// Frames: the grid's G. Units: cells, unless a name says metres. After `prepare` for a sensor set-up nothing allocates
// once the scratch space has reached its largest row. Not thread-safe.
#pragma once

#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <isobath/geometry/cartesian_grid.hpp>
#include <isobath/geometry/sector_overlap.hpp>
#include <isobath/sonar/ping.hpp>
#include <memory>
#include <span>
#include <vector>

namespace isobath {

struct OverlapTableConfig {
  int table_mb = 64;
  int offset_steps = 2;                       ///< positions of the sensor within a cell, along each axis
  Angle bearing_step = Angle::degrees(0.25);  ///< maximum rounding of directions
};

std::vector<Field> fields(OverlapTableConfig& config);

class OverlapTable {
 public:
  /// Cells farther than `reach_cells` from the sensor are left out: they are in no grid. Throws Error.
  OverlapTable(const OverlapTableConfig& config, double cell_m, int reach_cells);

  /// Sets the sensor set-up of the next rows. `gain`: d of each bin (S6-15), 0 for a bin that is not usable.
  void prepare(const BeamFan& fan, const RangeWindow& window, std::span<const double> gain);

  struct CellOffset {
    std::int16_t u;
    std::int16_t v;
  };
  struct Entry {
    std::uint32_t cell;  ///< index in the row
    float share;
  };

  /// A row placed in the grid: offset (u, v) is cell (x + x_u u + x_v v, y + y_u u + y_v v). Valid until the next call.
  struct Row {
    int x, y;
    int x_u, x_v, y_u, y_v;
    std::span<const CellOffset> cells;
    std::span<const double> clear;               ///< log-odds increment of each cell if all bins are clear
    std::span<const std::uint32_t> first_entry;  ///< by bin, and one more
    std::span<const Entry> entries;
    CellOffset low, high;       ///< bounds of the cells
    Eigen::Vector2d direction;  ///< rounded, in G
    Eigen::Vector2d sensor;     ///< rounded, in G, cells

    [[nodiscard]] std::span<const Entry> bin(int k) const {
      return entries.subspan(first_entry[k], first_entry[k + 1] - first_entry[k]);
    }
    [[nodiscard]] Cell cell(CellOffset o) const { return {x + x_u * o.u + x_v * o.v, y + y_u * o.u + y_v * o.v}; }
  };
  /// `sensor`: its position in G, metres; `beam` selects the width; `azimuth`: direction of the beam in G.
  [[nodiscard]] Row row(int beam, Angle azimuth, const Eigen::Vector2d& sensor);

  [[nodiscard]] std::uint64_t rows_built() const { return rows_built_; }
  /// Full width used for a beam: widths within 2 % of one another share rows.
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
  double start_ = 0;  ///< start of the window and size of a bin, in cells
  double bin_ = 1;
  int octant_ = 1;  ///< directions in 45 degrees
  std::vector<Angle> fan_widths_;
  std::vector<Angle> widths_;
  std::vector<int> width_of_beam_;
  std::vector<double> gain_;
  std::uint32_t gain_version_ = 0;

  std::vector<std::uint32_t> slot_;  ///< by key: 0, or offset in the arena / 16 + 1
  std::size_t arena_size_ = 0;
  std::unique_ptr<std::byte[]> arena_;  ///< memory pages stay untouched until used
  std::size_t head_ = 0;
  std::size_t tail_ = 0;
  std::size_t wrap_ = 0;
  bool wrapped_ = false;
  std::uint64_t rows_built_ = 0;

  struct Found {
    std::uint32_t bin;
    Entry entry;
  };
  std::vector<CellOffset> cells_;  ///< scratch: the row being built
  std::vector<Found> found_;
  std::vector<std::byte> single_;  ///< a row too large for the arena
};

}  // namespace isobath
