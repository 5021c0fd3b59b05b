#include <algorithm>
#include <cmath>
#include <isobath/planning/space_room.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

enum Column : std::uint8_t { kNoHazard, kFarHazard, kHazard, kShut };

bool is_for_good(HazardKind kind) { return kind != HazardKind::kSeen && kind != HazardKind::kRemembered; }

/// Squares of distances in voxels, from centres to the nearest face of a closed voxel, along one axis more: of a line
/// of `count` values, `stride` apart. A voxel's cube reaches half a voxel from its centre.
void widen(float* line, std::size_t count, std::size_t stride, int reach, std::vector<float>& padded) {
  const std::size_t margin = static_cast<std::size_t>(reach);
  const float far = std::numeric_limits<float>::max();
  padded.assign(count + 2 * margin, far);
  bool any = false;
  for (std::size_t i = 0; i < count; ++i) {
    padded[margin + i] = line[i * stride];
    any = any || line[i * stride] < far;
  }
  if (!any) return;
  for (std::size_t i = 0; i < count; ++i) {
    float least = padded[margin + i];
    for (int k = 1; k <= reach; ++k) {
      const float off = static_cast<float>(k) - 0.5F;
      const float nearer =
          std::min(padded[margin + i - static_cast<std::size_t>(k)], padded[margin + i + static_cast<std::size_t>(k)]);
      if (nearer < far) least = std::min(least, nearer + off * off);
    }
    line[i * stride] = least;
  }
}

}  // namespace

SpaceRoom::SpaceRoom(const SpaceGrid& grid, const SpaceRoomTask& task)
    : voxel_m_(grid.voxel_m()),
      least_(floor_of(task.least / voxel_m_)),
      size_(floor_of(task.most / voxel_m_) - least_ + VoxelIndex::Ones()) {
  const double voxels = size_.cast<double>().prod();
  if (!((size_.array() > 0).all() && voxels <= kMostVoxels)) {
    throw Error("a box of water cannot be planned through", {}, "1 to 30 million voxels");
  }
  close(grid, task);
  measure(task.most_m);
}

/// Of each hazard, whether it and all that it hangs together with are far.
std::vector<bool> SpaceRoom::may_open(const SpaceRoomTask& task) {
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

/// For each column of the box, north then east.
std::vector<std::uint8_t> SpaceRoom::columns_of(const SpaceRoomTask& task) const {
  std::vector<std::uint8_t> columns(static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()),
                                    kNoHazard);
  const std::vector<bool> far = may_open(task);
  for (const Hazard& hazard : task.hazards) {
    const double reach = std::max(hazard.margin_m, std::sqrt(0.5) * voxel_m_);  // a line closes the columns it meets
    Vector2d low = hazard.outline.front(), high = low;
    for (const Vector2d& corner : hazard.outline) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
    const auto cells = [&](double from, double to, int axis) {
      const int first = static_cast<int>(std::floor((from - reach) / voxel_m_)) - least_[axis],
                last = static_cast<int>(std::floor((to + reach) / voxel_m_)) - least_[axis];
      return std::pair{std::max(first, 0), std::min(last, size_[axis] - 1)};
    };
    if (((high - low).array() > 1e6).any() || low.cwiseAbs().maxCoeff() > 1e7) continue;
    const auto north = cells(low.x(), high.x(), 0), east = cells(low.y(), high.y(), 1);
    const bool open = far[static_cast<std::size_t>(&hazard - task.hazards.data())];
    const std::uint8_t column = is_for_good(hazard.kind) ? kShut : open ? kFarHazard : kHazard;
    for (int x = north.first; x <= north.second; ++x) {
      for (int y = east.first; y <= east.second; ++y) {
        std::uint8_t& at =
            columns[static_cast<std::size_t>(x) * static_cast<std::size_t>(size_.y()) + static_cast<std::size_t>(y)];
        if (at >= column) continue;
        if (signed_distance(hazard.outline, centre_of({x, y, 0}).head<2>()) <= reach) at = column;
      }
    }
  }
  return columns;
}

void SpaceRoom::close(const SpaceGrid& grid, const SpaceRoomTask& task) {
  const std::vector<std::uint8_t> columns = columns_of(task);
  state_.assign(
      static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()) * static_cast<std::size_t>(size_.z()),
      State::kOpen);
  std::size_t at = 0;
  for (int x = 0; x < size_.x(); ++x) {
    for (int y = 0; y < size_.y(); ++y) {
      const std::uint8_t column =
          columns[static_cast<std::size_t>(x) * static_cast<std::size_t>(size_.y()) + static_cast<std::size_t>(y)];
      for (int z = 0; z < size_.z(); ++z, ++at) {
        const SpaceCell water = grid.at(least_ + VoxelIndex(x, y, z));
        const double depth = (least_.z() + z + 0.5) * voxel_m_;
        const bool in_band = depth >= task.shallow_m && depth <= task.deep_m;
        const bool measured = water == SpaceCell::kMeasured;
        if (column == kShut || water == SpaceCell::kOccupied || (!measured && (column == kHazard || !in_band))) {
          state_[at] = State::kClosed;
        } else if (!measured && column == kFarHazard) {
          state_[at] = State::kUnsure;
        }
      }
    }
  }
}

void SpaceRoom::measure(double most_m) {
  const auto nx = static_cast<std::size_t>(size_.x()), ny = static_cast<std::size_t>(size_.y()),
             nz = static_cast<std::size_t>(size_.z());
  distance_.resize(state_.size());
  std::transform(state_.begin(), state_.end(), distance_.begin(),
                 [](State s) { return s == State::kClosed ? 0.0F : std::numeric_limits<float>::max(); });
  const int reach = static_cast<int>(std::ceil(most_m / voxel_m_ + 0.5));
  std::vector<float> padded;
  for (std::size_t x = 0; x < nx; ++x) {
    for (std::size_t y = 0; y < ny; ++y) widen(&distance_[(x * ny + y) * nz], nz, 1, reach, padded);
  }
  for (std::size_t x = 0; x < nx; ++x) {
    for (std::size_t z = 0; z < nz; ++z) widen(&distance_[x * ny * nz + z], ny, nz, reach, padded);
  }
  for (std::size_t y = 0; y < ny; ++y) {
    for (std::size_t z = 0; z < nz; ++z) widen(&distance_[y * nz + z], nx, ny * nz, reach, padded);
  }
  const auto most = static_cast<float>(most_m), voxel = static_cast<float>(voxel_m_);
  for (float& d : distance_) d = std::min(most, voxel * std::sqrt(d));
}

bool SpaceRoom::holds(const Vector3d& p_W) const { return inside(voxel_at(p_W)); }

double SpaceRoom::distance(const Vector3d& p_W) const {
  const Vector3d at = p_W / voxel_m_ - Vector3d::Constant(0.5);
  const VoxelIndex low = floor_of(at);
  const Vector3d share = at - low.cast<double>();
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const VoxelIndex step(corner & 1, corner >> 1 & 1, corner >> 2);
    const Vector3d weight = step.cast<double>().cwiseProduct(share) +
                            (VoxelIndex::Ones() - step).cast<double>().cwiseProduct(Vector3d::Ones() - share);
    sum += weight.prod() * distance(VoxelIndex(low + step - least_));
  }
  return sum;
}

bool SpaceRoom::is_unsure(const Vector3d& p_W) const {
  const VoxelIndex i = voxel_at(p_W);
  return inside(i) && state_[index_of(i)] == State::kUnsure;
}

double SpaceRoom::leg_distance(const Vector3d& a_W, const Vector3d& b_W) const {
  const int pieces = std::max(1, static_cast<int>(std::ceil((b_W - a_W).norm() / (0.5 * voxel_m_))));
  double least = distance(a_W);
  for (int i = 1; i <= pieces && least > 0; ++i) {
    least = std::min(least, distance(Vector3d(a_W + (b_W - a_W) * i / pieces)));
  }
  return least;
}

}  // namespace isobath
