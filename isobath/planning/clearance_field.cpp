#include <algorithm>
#include <cmath>
#include <isobath/planning/clearance_field.hpp>
#include <limits>
#include <type_traits>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

enum Column : std::uint8_t { kNoHazard, kFarHazard, kHazard, kShut };

bool is_for_good(HazardKind kind) {
  return kind != HazardKind::kSeen && kind != HazardKind::kRemembered && kind != HazardKind::kMoving;
}

/// Lowers a line of squared distances, in half voxels, to those of two lines that are `squared` away.
template <class Square>
void widen(Square* line, const Square* before, const Square* after, std::size_t count, Square squared) {
  for (std::size_t z = 0; z < count; ++z) {
    const Square nearer = static_cast<Square>(std::min(before[z], after[z]) + squared);
    line[z] = std::min(line[z], nearer);
  }
}

/// A voxel's cube reaches half a voxel from its centre.
template <class Square>
Square squared_half_voxels(int voxels) {
  const int halves = voxels == 0 ? 0 : 2 * voxels - 1;
  return static_cast<Square>(halves * halves);
}

}  // namespace

ClearanceField::ClearanceField(const OccupancySnapshot& grid, const ClearanceTask& task)
    : grid_(grid),
      least_(floor_of(task.least / grid.voxel_m())),
      size_(floor_of(task.most / grid.voxel_m()) - least_ + VoxelIndex::Ones()),
      max_m_(task.max_m),
      reach_(static_cast<int>(std::ceil(task.max_m / grid.voxel_m() + 0.5))) {
  const double voxels = size_.cast<double>().prod();
  if (!((size_.array() > 0).all() && voxels <= kMaxVoxels)) {
    throw Error("the box of water is empty or too large to plan in", {}, "1 to 30 million voxels");
  }
  trim(task);
  columns_ = columns_of(task);
  clear();
}

ClearanceField ClearanceField::of_what_is_known() const {
  ClearanceField known(*this);
  known.hoped_ = this;
  std::replace(known.columns_.begin(), known.columns_.end(), std::uint8_t{kFarHazard}, std::uint8_t{kHazard});
  return known;
}

ClearanceField::ClearanceField(const ClearanceField& other)
    : grid_(other.grid_),
      least_(other.least_),
      size_(other.size_),
      shallowest_(other.shallowest_),
      deepest_(other.deepest_),
      max_m_(other.max_m_),
      reach_(other.reach_),
      off_band_(other.off_band_),
      columns_(other.columns_) {
  clear();
}

bool ClearanceField::has_unsure() const {
  return std::find(columns_.begin(), columns_.end(), std::uint8_t{kFarHazard}) != columns_.end();
}

void ClearanceField::clear() {
  tiles_x_ = (size_.x() + kTile - 1) / kTile;
  tiles_y_ = (size_.y() + kTile - 1) / kTile;
  looked_.assign(tile_of(tiles_x_, 0), 0);
  measured_ = looked_;
  const std::size_t voxels = index_of(size_.x(), 0);
  along_.reset(new std::uint16_t[voxels]);  // not initialised: most of it is never used
  distance_.reset(new float[voxels]);
}

/// Nothing is open above or below the mission's depths and the measured water: one closed layer on each side stands for
/// all.
void ClearanceField::trim(const ClearanceTask& task) {
  shallowest_ = least_.z();
  deepest_ = least_.z() + size_.z() - 1;
  const auto in_band = [&](int layer) {
    const double depth = (layer + 0.5) * voxel_m();
    return depth >= task.shallow_m && depth <= task.deep_m;
  };
  int first = deepest_, last = shallowest_;
  for (int layer = shallowest_; layer <= deepest_; ++layer) {
    if (!in_band(layer) && (layer < grid_.first_measured() || layer > grid_.last_measured())) continue;
    first = std::min(first, layer);
    last = std::max(last, layer);
  }
  least_.z() = std::max(shallowest_, std::min(first, last) - 1);
  size_.z() = std::min(deepest_, std::max(first, last) + 1) - least_.z() + 1;
  for (int z = 0; z < size_.z(); ++z) off_band_.push_back(in_band(least_.z() + z) ? 0 : 1);
}

/// For each hazard, whether it and all hazards connected with it are far.
std::vector<bool> ClearanceField::may_open(const ClearanceTask& task) {
  const std::size_t count = task.hazards.size();
  std::vector<bool> far(count, false);
  if (task.look_on_m <= 0) return far;
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < count; ++i) {
    far[i] = signed_distance(task.hazards[i].outline, task.vehicle_W.head<2>()) > task.look_on_m;
    if (!far[i] && !is_for_good(task.hazards[i].kind)) near.push_back(i);
  }
  while (!near.empty()) {
    const Polygon& from = task.hazards[near.back()].outline;
    near.pop_back();
    for (std::size_t i = 0; i < count; ++i) {
      if (!far[i] || is_for_good(task.hazards[i].kind)) continue;
      double apart = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < from.size(); ++k) {
        const Vector2d& next = from[(k + 1) % from.size()];
        apart = std::min(apart, isobath::leg_distance(task.hazards[i].outline, from[k], next).distance_m);
      }
      if (apart > task.apart_m) continue;
      far[i] = false;
      near.push_back(i);
    }
  }
  return far;
}

/// The kind of each column of the box, north then east.
std::vector<std::uint8_t> ClearanceField::columns_of(const ClearanceTask& task) const {
  std::vector<std::uint8_t> columns(column_of(size_.x(), 0), kNoHazard);
  const std::vector<bool> far = may_open(task);
  for (const Hazard& hazard : task.hazards) {
    const double reach = std::max(hazard.margin_m, std::sqrt(0.5) * voxel_m());  // a line closes the columns it meets
    Vector2d low = hazard.outline.front(), high = low;
    for (const Vector2d& corner : hazard.outline) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
    const auto cells = [&](double from, double to, int axis) {
      const int first = static_cast<int>(std::floor((from - reach) / voxel_m())) - least_[axis],
                last = static_cast<int>(std::floor((to + reach) / voxel_m())) - least_[axis];
      return std::pair{std::max(first, 0), std::min(last, size_[axis] - 1)};
    };
    if (((high - low).array() > 1e6).any() || low.cwiseAbs().maxCoeff() > 1e7) continue;
    const auto north = cells(low.x(), high.x(), 0), east = cells(low.y(), high.y(), 1);
    const bool open = far[static_cast<std::size_t>(&hazard - task.hazards.data())];
    const std::uint8_t column = is_for_good(hazard.kind) ? kShut : open ? kFarHazard : kHazard;
    for (int x = north.first; x <= north.second; ++x) {
      for (int y = east.first; y <= east.second; ++y) {
        std::uint8_t& at = columns[column_of(x, y)];
        if (at >= column) continue;
        if (signed_distance(hazard.outline, centre_of({x, y, 0}).head<2>()) <= reach) at = column;
      }
    }
  }
  return columns;
}

/// For the columns of a tile: which voxels are closed, and how far along depth the nearest closed one is from each
/// voxel.
void ClearanceField::look(int tile_x, int tile_y) const {
  const auto nz = static_cast<std::size_t>(size_.z());
  const int above = grid_.least().z() - least_.z();  // layers of this field before the grid's first
  std::vector<SpaceCell> water(nz, SpaceCell::kUnknown);
  for (int x = kTile * tile_x; x < std::min(kTile * (tile_x + 1), size_.x()); ++x) {
    for (int y = kTile * tile_y; y < std::min(kTile * (tile_y + 1), size_.y()); ++y) {
      const std::uint8_t column = columns_[column_of(x, y)];
      std::uint16_t* along = &along_[index_of(x, y)];
      if (column == kShut) {
        std::fill_n(along, nz, std::uint16_t{0});
        continue;
      }
      const std::span<const SpaceCell> known = grid_.column(least_.x() + x, least_.y() + y);
      std::fill(water.begin(), water.end(), SpaceCell::kUnknown);
      const int first = std::max(0, above), last = std::min(size_.z(), above + static_cast<int>(known.size()));
      if (first < last) std::copy_n(known.begin() + (first - above), last - first, water.begin() + first);
      const std::uint8_t measured_alone = column == kHazard ? 1 : 0;
      for (std::size_t z = 0; z < nz; ++z) {  // without branches, so that it vectorises
        const auto unmeasured = static_cast<std::uint16_t>(water[z] != SpaceCell::kMeasured),
                   occupied = static_cast<std::uint16_t>(water[z] == SpaceCell::kOccupied);
        const int closed = occupied | (unmeasured & (measured_alone | off_band_[z]));
        along[z] = static_cast<std::uint16_t>(closed - 1);  // all bits set where open
      }
      std::uint16_t off = kFar;  // voxels from the last closed one
      for (std::size_t z = 0; z < nz; ++z) {
        off = static_cast<std::uint16_t>((off + 1) & along[z]);
        along[z] = off;
      }
      off = kFar;
      for (std::size_t z = nz; z-- > 0;) {
        off = std::min(along[z], static_cast<std::uint16_t>(off + 1));
        along[z] = off;
      }
    }
  }
}

/// Whether any voxel within reach of a tile is unsure in the field from which this one takes its values.
bool ClearanceField::differs_about(int tile_x, int tile_y) const {
  const int end_x = std::min(kTile * (tile_x + 1) + reach_, size_.x()),
            end_y = std::min(kTile * (tile_y + 1) + reach_, size_.y());
  for (int x = std::max(0, kTile * tile_x - reach_); x < end_x; ++x) {
    const auto from = hoped_->columns_.begin() + static_cast<std::ptrdiff_t>(column_of(x, 0));
    const auto first = from + std::max(0, kTile * tile_y - reach_), last = from + end_y;
    if (std::find(first, last, std::uint8_t{kFarHazard}) != last) return true;
  }
  return false;
}

void ClearanceField::measure(int tile_x, int tile_y) const {
  const std::size_t tile = tile_of(tile_x, tile_y);
  if (hoped_ && !differs_about(tile_x, tile_y)) {
    if (hoped_->measured_[tile] == 0) hoped_->measure(tile_x, tile_y);
    const std::size_t columns = static_cast<std::size_t>(std::min(kTile, size_.y() - kTile * tile_y));
    for (int x = kTile * tile_x; x < std::min(kTile * (tile_x + 1), size_.x()); ++x) {
      const std::size_t first = index_of(x, kTile * tile_y);
      std::copy_n(&hoped_->distance_[first], columns * static_cast<std::size_t>(size_.z()), &distance_[first]);
    }
    measured_[tile] = 1;
    return;
  }
  const int margin = (reach_ + kTile - 1) / kTile;
  for (int x = std::max(0, tile_x - margin); x <= std::min(tiles_x_ - 1, tile_x + margin); ++x) {
    for (int y = std::max(0, tile_y - margin); y <= std::min(tiles_y_ - 1, tile_y + margin); ++y) {
      std::uint8_t& looked = looked_[tile_of(x, y)];
      if (looked == 0) look(x, y);
      looked = 1;
    }
  }
  // 16-bit integers where they suffice: their largest distance, 64 voxels, is then beyond `max_m`.
  if (reach_ < 64) {
    measure_by<std::int16_t>(tile_x, tile_y);
  } else {
    measure_by<float>(tile_x, tile_y);
  }
  measured_[tile] = 1;
}

/// Squared distances, with one more axis each time: depth (look), then east, then north.
template <class Square>
void ClearanceField::measure_by(int tile_x, int tile_y) const {
  const Square far = std::is_integral_v<Square> ? Square{0x4000} : std::numeric_limits<Square>::max();
  const int x0 = kTile * tile_x, x1 = std::min(x0 + kTile, size_.x()), y0 = kTile * tile_y,
            y1 = std::min(y0 + kTile, size_.y());
  const int low_x = std::max(0, x0 - reach_), high_x = std::min(size_.x(), x1 + reach_),
            low_y = std::max(0, y0 - reach_), high_y = std::min(size_.y(), y1 + reach_);
  const auto nz = static_cast<std::size_t>(size_.z()), line = (nz + 15) / 16 * 16,
             wide = static_cast<std::size_t>(high_y - low_y), tile_y_lines = static_cast<std::size_t>(y1 - y0);
  std::vector<Square> squares(static_cast<std::size_t>(reach_) + 1);
  for (int k = 0; k <= reach_; ++k) squares[static_cast<std::size_t>(k)] = squared_half_voxels<Square>(k);

  std::vector<Square> along(wide * line, far), east(static_cast<std::size_t>(high_x - low_x) * tile_y_lines * line);
  for (int x = low_x; x < high_x; ++x) {
    for (int y = low_y; y < high_y; ++y) {
      const std::uint16_t* from = &along_[index_of(x, y)];
      Square* to = &along[static_cast<std::size_t>(y - low_y) * line];
      for (std::size_t z = 0; z < nz; ++z) to[z] = from[z] <= reach_ ? squares[from[z]] : far;
    }
    for (int y = y0; y < y1; ++y) {
      Square* to =
          &east[(static_cast<std::size_t>(x - low_x) * tile_y_lines + static_cast<std::size_t>(y - y0)) * line];
      const auto at = [&](int other) { return &along[static_cast<std::size_t>(other - low_y) * line]; };
      std::copy_n(at(y), line, to);
      for (int k = 1; k <= reach_; ++k) {
        const int before = y - k, after = y + k;
        if (before < low_y && after >= high_y) break;
        widen(to, at(before < low_y ? after : before), at(after >= high_y ? before : after), line,
              squares[static_cast<std::size_t>(k)]);
      }
    }
  }
  const auto most = static_cast<float>(max_m_), voxel = static_cast<float>(voxel_m());
  std::vector<Square> all(line);
  for (int x = x0; x < x1; ++x) {
    for (int y = y0; y < y1; ++y) {
      const auto at = [&](int other) {
        return &east[(static_cast<std::size_t>(other - low_x) * tile_y_lines + static_cast<std::size_t>(y - y0)) *
                     line];
      };
      std::copy_n(at(x), line, all.begin());
      for (int k = 1; k <= reach_; ++k) {
        const int before = x - k, after = x + k;
        if (before < low_x && after >= high_x) break;
        widen(all.data(), at(before < low_x ? after : before), at(after >= high_x ? before : after), line,
              squares[static_cast<std::size_t>(k)]);
      }
      float* to = &distance_[index_of(x, y)];
      for (std::size_t z = 0; z < nz; ++z) {
        to[z] = std::min(most, voxel * std::sqrt(0.25F * static_cast<float>(all[z])));
      }
    }
  }
}

bool ClearanceField::holds(const Vector3d& p_W) const {
  VoxelIndex i = voxel_at(p_W);
  const int layer = least_.z() + i.z();
  i.z() = 0;
  return inside(i) && layer >= shallowest_ && layer <= deepest_;
}

double ClearanceField::distance(const Vector3d& p_W) const {
  const Vector3d at = p_W / voxel_m() - Vector3d::Constant(0.5);
  const VoxelIndex low = floor_of(at), first = low - least_;
  const Vector3d share = at - low.cast<double>(), rest = Vector3d::Ones() - share;
  double sum = 0;
  if (is_within_a_tile(first)) {  // as below, without eight separate look-ups
    const std::size_t east = static_cast<std::size_t>(size_.z()), north = index_of(1, 0);
    const float* corner = &distance_[index_of(first.x(), first.y()) + static_cast<std::size_t>(first.z())];
    sum += rest.x() * (rest.y() * rest.z()) * corner[0];
    sum += share.x() * (rest.y() * rest.z()) * corner[north];
    sum += rest.x() * (share.y() * rest.z()) * corner[east];
    sum += share.x() * (share.y() * rest.z()) * corner[north + east];
    sum += rest.x() * (rest.y() * share.z()) * corner[1];
    sum += share.x() * (rest.y() * share.z()) * corner[north + 1];
    sum += rest.x() * (share.y() * share.z()) * corner[east + 1];
    sum += share.x() * (share.y() * share.z()) * corner[north + east + 1];
    return sum;
  }
  for (int corner = 0; corner < 8; ++corner) {
    const VoxelIndex step(corner & 1, corner >> 1 & 1, corner >> 2);
    const double x = step.x() == 1 ? share.x() : rest.x(), y = step.y() == 1 ? share.y() : rest.y(),
                 z = step.z() == 1 ? share.z() : rest.z();
    sum += x * (y * z) * distance(VoxelIndex(first + step));
  }
  return sum;
}

/// Whether a voxel and its next ones all lie in one tile, which has been measured.
bool ClearanceField::is_within_a_tile(const VoxelIndex& i) const {
  constexpr int kLast = kTile - 1;
  if (!inside(i) || !inside(i + VoxelIndex::Ones()) || (i.x() & kLast) == kLast || (i.y() & kLast) == kLast)
    return false;
  return measured_[tile_of(i.x() >> kTileLog2, i.y() >> kTileLog2)] != 0;
}

bool ClearanceField::is_unsure(const Vector3d& p_W) const {
  const VoxelIndex i = voxel_at(p_W);
  if (!inside(i) || columns_[column_of(i.x(), i.y())] != kFarHazard) return false;
  const SpaceCell cell = grid_.at(least_ + i);
  return off_band_[static_cast<std::size_t>(i.z())] == 0 && cell != SpaceCell::kMeasured &&
         cell != SpaceCell::kOccupied;
}

double ClearanceField::leg_distance(const Vector3d& a_W, const Vector3d& b_W) const {
  const int pieces = std::max(1, static_cast<int>(std::ceil((b_W - a_W).norm() / (0.5 * voxel_m()))));
  double least = distance(a_W);
  for (int i = 1; i <= pieces && least > 0; ++i) {
    least = std::min(least, distance(Vector3d(a_W + (b_W - a_W) * i / pieces)));
  }
  return least;
}

}  // namespace isobath
