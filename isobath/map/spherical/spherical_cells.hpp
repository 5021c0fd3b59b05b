// SphericalCells: the stored cells of a spherical grid, by direction and layer (Auran, Silven 1995, 4.2; ledger S4-06
// to S4-10, S4-13, S4-16, S4-E10).
//
// The cells of one direction are adjacent in one array, nearest first, with a bit for each layer that has a cell. The
// cell of a layer is found by counting bits, and a mask tells whether any cell is nearer than a range. There are three
// ordered walks, as the paper links them: beams by azimuth and elevation, forwards and backwards; cells of a beam by
// range; cells of one layer in the order of beams (from the bits, without any further structure). Beams own the cells;
// the walks are views.
//
// Directions are those of the turned table (S4-21): a turn changes directions and moves no cell. One thread. Adding a
// cell after the last one of a beam moves no cell, unless the beam's capacity has to double. References and spans are
// valid until the next change.
#pragma once

#include <array>
#include <bit>
#include <isobath/base/time.hpp>
#include <isobath/map/spherical/spherical_directions.hpp>
#include <span>
#include <utility>
#include <vector>

namespace isobath {

/// One cell. Its content, the echoes that fell into it, is a box in the axes T (spherical_grid.hpp): its moments move
/// with the vehicle exactly, while cells stay in place (S4-23).
struct SphericalCell {
  std::array<float, 3> mean{};    ///< of the content, m; the middle of a cell without echoes
  std::array<float, 6> spread{};  ///< covariance of the content: xx, xy, xz, yy, yz, zz, m2
  float weight = 0;               ///< of the content when contents merge: 1 an echo
  float log_odds = 0;             ///< of being occupied
  std::uint32_t echoes = 0;
  std::uint32_t scans = 0;  ///< with echoes in this cell
  std::uint32_t last_scan = 0;
  Time first_echo{}, last_echo{};
  std::uint16_t layer = 0;
  bool locked = false, prior = false;

  /// Whether it holds an echo, a part of one that was split, or a known surface; else an echo beside it has touched it.
  [[nodiscard]] bool holds_echo() const { return prior || weight >= kSmallestPart; }
  static constexpr float kSmallestPart = 1.0f / 128;

  [[nodiscard]] Eigen::Vector3d point() const {
    return {static_cast<double>(mean[0]), static_cast<double>(mean[1]), static_cast<double>(mean[2])};
  }
};

class SphericalCells {
 public:
  SphericalCells(int azimuths, int elevations, int layers);

  // Reading.
  // -----------------------------------------------------------------------------------------------------------
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] const DirectionTable& directions() const { return table_; }
  /// The cells of a direction, nearest first; empty for none.
  [[nodiscard]] std::span<const SphericalCell> beam(const SphericalDirection& d) const {
    const std::uint32_t id = table_.find(d);
    if (id == DirectionTable::kNone) return {};
    return {pool_.data() + beams_[id].begin, beams_[id].count};
  }
  [[nodiscard]] const SphericalCell* find(const SphericalDirection& d, int layer) const;
  [[nodiscard]] bool any(const SphericalDirection& d) const { return table_.find(d) != DirectionTable::kNone; }
  [[nodiscard]] int first_occupied(const SphericalDirection& d) const;  ///< layer, -1 for none
  /// Cells of a layer in the order of beams: `visit(direction, cell)`.
  template <class Visit>
  void each_of_layer(int layer, const Visit& visit) const {
    each_beam([&](const SphericalDirection& d, std::span<const SphericalCell>) {
      if (const SphericalCell* cell = find(d, layer)) visit(d, *cell);
    });
  }
  /// `visit(direction, cells)` in the order of beams.
  template <class Visit>
  void each_beam(const Visit& visit) const {
    for (auto d = table_.first(); d; d = table_.after(*d)) visit(*d, beam(*d));
  }
  /// Records moved since construction, to grow a beam or to compact the array.
  [[nodiscard]] std::uint64_t records_moved() const { return records_moved_; }

  // Writing.
  // -----------------------------------------------------------------------------------------------------------
  /// The cell of a direction and layer; makes it if there is none (all zero but its layer) and then sets `made`.
  SphericalCell& at(const SphericalDirection& d, int layer, bool& made);
  void mark_occupied(const SphericalDirection& d, int layer, bool occupied);
  /// Returns false if there is no such cell.
  bool erase(const SphericalDirection& d, int layer);
  /// Erases the cells for which `wanted(cell)` is true.
  template <class Wanted>
  void erase_all(const Wanted& wanted) {
    for (auto d = table_.first(); d;) {
      const auto next = table_.after(*d);
      for (std::size_t i = beam(*d).size(); i-- > 0;) {
        const SphericalCell& cell = beam(*d)[i];
        if (wanted(cell)) erase(*d, cell.layer);
      }
      d = next;
    }
  }
  void turn(int buckets) { table_.turn(buckets); }
  /// Changes every cell once, in any order: `change(cell)` returns whether the cell is now occupied.
  template <class Change>
  void change_all(const Change& change) {
    for (auto d = table_.first(); d; d = table_.after(*d)) {
      const std::uint32_t id = table_.find(*d);
      std::uint64_t* occupied = occupied_.data() + id * words_;
      for (std::size_t w = 0; w < words_; ++w) occupied[w] = 0;
      for (std::size_t i = 0; i < beams_[id].count; ++i) {
        SphericalCell& cell = pool_[beams_[id].begin + i];
        if (change(cell)) occupied[cell.layer / 64] |= std::uint64_t{1} << (cell.layer % 64);
      }
    }
  }

  // Rebuilds all cells in the order of beams (of the turned table): begin, then beams with their cells by layer.
  void begin_again();
  void begin_beam(const SphericalDirection& d);
  void append(const SphericalCell& cell, bool occupied);
  [[nodiscard]] SphericalCell& last() { return pool_.back(); }

 private:
  struct Beam {
    std::uint32_t begin = 0;
    std::uint16_t count = 0, room = 0;
  };
  [[nodiscard]] static std::uint64_t below(int bit) { return (std::uint64_t{1} << bit) - 1; }
  [[nodiscard]] std::size_t rank(std::uint32_t id, int layer) const {
    const std::uint64_t* stored = stored_.data() + id * words_;
    const auto word = static_cast<std::size_t>(layer) / 64;
    std::size_t n = static_cast<std::size_t>(std::popcount(stored[word] & below(layer % 64)));
    for (std::size_t w = 0; w < word; ++w) n += static_cast<std::size_t>(std::popcount(stored[w]));
    return n;
  }
  [[nodiscard]] bool holds(std::uint32_t id, int layer) const {
    return (stored_[id * words_ + static_cast<std::size_t>(layer) / 64] >> (layer % 64) & 1) != 0;
  }
  std::uint32_t make_beam(const SphericalDirection& d);
  void make_room(std::uint32_t id);
  void compact();

  std::size_t words_;
  std::size_t size_ = 0, wasted_ = 0;
  std::uint64_t records_moved_ = 0;
  DirectionTable table_;
  std::vector<Beam> beams_;
  std::vector<std::uint32_t> free_beams_;
  std::vector<std::uint64_t> stored_, occupied_;  ///< words_ of each beam
  std::vector<SphericalCell> pool_, old_pool_;
};

}  // namespace isobath
