#include <algorithm>
#include <isobath/base/error.hpp>
#include <isobath/map/spherical/spherical_cells.hpp>

namespace isobath {

SphericalCells::SphericalCells(int azimuths, int elevations, int layers)
    : words_((static_cast<std::size_t>(layers) + 63) / 64), table_(azimuths, elevations) {
  ISOBATH_ASSERT(layers > 0 && layers < 65536);
}

std::size_t SphericalCells::bytes() const {
  return table_.bytes() + beams_.size() * sizeof(Beam) + free_beams_.size() * sizeof(free_beams_[0]) +
         (stored_.size() + occupied_.size()) * sizeof(stored_[0]) + pool_.size() * sizeof(SphericalCell);
}

const SphericalCell* SphericalCells::find(const SphericalDirection& d, int layer) const {
  const std::uint32_t id = table_.find(d);
  if (id == DirectionTable::kNone || !holds(id, layer)) return nullptr;
  return &pool_[beams_[id].begin + rank(id, layer)];
}

int SphericalCells::first_occupied(const SphericalDirection& d) const {
  const std::uint32_t id = table_.find(d);
  if (id == DirectionTable::kNone) return -1;
  for (std::size_t w = 0; w < words_; ++w) {
    const std::uint64_t bits = occupied_[id * words_ + w];
    if (bits != 0) return static_cast<int>(64 * w) + std::countr_zero(bits);
  }
  return -1;
}

std::uint32_t SphericalCells::make_beam(const SphericalDirection& d) {
  std::uint32_t id = 0;
  if (free_beams_.empty()) {
    id = static_cast<std::uint32_t>(beams_.size());
    beams_.emplace_back();
    stored_.resize(stored_.size() + words_);
    occupied_.resize(occupied_.size() + words_);
  } else {
    id = free_beams_.back();
    free_beams_.pop_back();
  }
  table_.set(d, id);
  return id;
}

// A beam at the end of the array grows in place; any other moves to the end, with twice its capacity.
void SphericalCells::make_room(std::uint32_t id) {
  Beam& beam = beams_[id];
  if (beam.count < beam.room) return;
  if (beam.room > 0 && beam.begin + beam.room == pool_.size()) {
    pool_.resize(pool_.size() + 1);
    ++beam.room;
    return;
  }
  const std::size_t room = std::max<std::size_t>(2, 2 * std::size_t{beam.room}), begin = pool_.size();
  pool_.resize(begin + room);
  std::copy_n(pool_.begin() + beam.begin, beam.count, pool_.begin() + static_cast<std::ptrdiff_t>(begin));
  records_moved_ += beam.count;
  wasted_ += beam.room;
  beam.begin = static_cast<std::uint32_t>(begin);
  beam.room = static_cast<std::uint16_t>(room);
  if (wasted_ > size_ + 4096) compact();
}

// Sorts the array by beams, so that walks read it from one end to the other.
void SphericalCells::compact() {
  old_pool_.swap(pool_);
  pool_.clear();
  for (auto d = table_.first(); d; d = table_.after(*d)) {
    Beam& beam = beams_[table_.find(*d)];
    const auto from = old_pool_.begin() + beam.begin;
    beam.begin = static_cast<std::uint32_t>(pool_.size());
    pool_.insert(pool_.end(), from, from + beam.room);
  }
  records_moved_ += pool_.size();
  wasted_ = 0;
}

SphericalCell& SphericalCells::at(const SphericalDirection& d, int layer, bool& made) {
  std::uint32_t id = table_.find(d);
  made = id == DirectionTable::kNone || !holds(id, layer);
  if (!made) return pool_[beams_[id].begin + rank(id, layer)];
  if (id == DirectionTable::kNone) id = make_beam(d);
  make_room(id);
  const std::size_t at = rank(id, layer);
  Beam& beam = beams_[id];
  const auto begin = pool_.begin() + beam.begin;
  std::move_backward(begin + static_cast<std::ptrdiff_t>(at), begin + beam.count, begin + beam.count + 1);
  records_moved_ += beam.count - at;
  ++beam.count;
  ++size_;
  stored_[id * words_ + static_cast<std::size_t>(layer) / 64] |= std::uint64_t{1} << (layer % 64);
  SphericalCell& cell = pool_[beam.begin + at];
  cell = {};
  cell.layer = static_cast<std::uint16_t>(layer);
  return cell;
}

void SphericalCells::mark_occupied(const SphericalDirection& d, int layer, bool occupied) {
  const std::uint32_t id = table_.find(d);
  if (id == DirectionTable::kNone || !holds(id, layer)) return;
  std::uint64_t& word = occupied_[id * words_ + static_cast<std::size_t>(layer) / 64];
  const std::uint64_t bit = std::uint64_t{1} << (layer % 64);
  word = occupied ? word | bit : word & ~bit;
}

bool SphericalCells::erase(const SphericalDirection& d, int layer) {
  const std::uint32_t id = table_.find(d);
  if (id == DirectionTable::kNone || !holds(id, layer)) return false;
  mark_occupied(d, layer, false);
  const std::size_t at = rank(id, layer);
  Beam& beam = beams_[id];
  const auto begin = pool_.begin() + beam.begin;
  std::move(begin + static_cast<std::ptrdiff_t>(at) + 1, begin + beam.count, begin + static_cast<std::ptrdiff_t>(at));
  records_moved_ += beam.count - at - 1u;
  stored_[id * words_ + static_cast<std::size_t>(layer) / 64] &= ~(std::uint64_t{1} << (layer % 64));
  --size_;
  if (--beam.count > 0) return true;
  wasted_ += beam.room;
  beam = {};
  table_.erase(d);
  free_beams_.push_back(id);
  return true;
}

void SphericalCells::begin_again() {
  table_.clear();
  beams_.clear();
  free_beams_.clear();
  stored_.clear();
  occupied_.clear();
  pool_.clear();
  size_ = wasted_ = 0;
}

void SphericalCells::begin_beam(const SphericalDirection& d) {
  const std::uint32_t id = make_beam(d);
  beams_[id].begin = static_cast<std::uint32_t>(pool_.size());
}

void SphericalCells::append(const SphericalCell& cell, bool occupied) {
  Beam& beam = beams_.back();
  pool_.push_back(cell);
  ++beam.count;
  ++beam.room;
  ++size_;
  const std::size_t word = stored_.size() - words_ + cell.layer / 64u;
  const std::uint64_t bit = std::uint64_t{1} << (cell.layer % 64);
  stored_[word] |= bit;
  if (occupied) occupied_[word] |= bit;
}

}  // namespace isobath
