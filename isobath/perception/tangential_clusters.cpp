#include <algorithm>
#include <cmath>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <isobath/perception/tangential_clusters.hpp>
#include <limits>
#include <numeric>
#include <optional>

namespace isobath {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Neighbours of all echoes, in consecutive lists.
struct EchoNeighbours {
  std::vector<std::size_t> begin;
  std::vector<std::uint32_t> of;
  [[nodiscard]] std::span<const std::uint32_t> at(std::size_t i) const {
    return {of.data() + begin[i], begin[i + 1] - begin[i]};
  }
};
EchoNeighbours neighbours_of(std::span<const Vector3d> echoes, const TangentialConfig& config) {
  const double cosine = cos(config.window), wide = 2 * sin(config.window / 2) * config.apart;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  std::vector<double> range;
  for (const Vector3d& p : echoes) range.push_back(p.norm());
  for (std::uint32_t i = 0; i < echoes.size(); ++i) {
    for (std::uint32_t k = i + 1; k < echoes.size(); ++k) {
      const double product = echoes[i].dot(echoes[k]);
      if (product < cosine * range[i] * range[k]) continue;
      const double apart2 = range[i] * range[i] + range[k] * range[k] - 2 * product;
      if (apart2 > std::pow(wide * std::min(range[i], range[k]), 2)) continue;
      pairs.emplace_back(i, k);
      pairs.emplace_back(k, i);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  EchoNeighbours neighbours;
  neighbours.begin.assign(echoes.size() + 1, 0);
  for (const auto& pair : pairs) {
    ++neighbours.begin[pair.first + 1];
    neighbours.of.push_back(pair.second);
  }
  std::partial_sum(neighbours.begin.begin(), neighbours.begin.end(), neighbours.begin.begin());
  return neighbours;
}

/// Running sums of points, and the least-squares plane through them.
class PlaneSums {
 public:
  void add(const Vector3d& p) {
    ++n_;
    sum_ += p;
    squares_ += p * p.transpose();
  }
  [[nodiscard]] int size() const { return n_; }
  [[nodiscard]] TangentPlane plane(bool vertical) const {
    TangentPlane plane;
    plane.support = n_;
    plane.centre = sum_ / n_;
    Matrix3d spread = squares_ / n_ - plane.centre * plane.centre.transpose();
    if (vertical) {
      spread.row(2).setZero();
      spread.col(2).setZero();
      spread(2, 2) = spread.trace() + 1;
    }
    const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(spread);
    plane.normal = axes.eigenvectors().col(0);
    plane.rms_m = std::sqrt(std::max(0.0, axes.eigenvalues()[0]));
    if (plane.normal.dot(plane.centre) > 0) plane.normal = -plane.normal;
    plane.distance_m = -plane.normal.dot(plane.centre);
    return plane;
  }

 private:
  int n_ = 0;
  Vector3d sum_ = Vector3d::Zero();
  Matrix3d squares_ = Matrix3d::Zero();
};

class PlaneGrower {
 public:
  PlaneGrower(std::span<const Vector3d> echoes, const TangentialConfig& config)
      : echoes_(echoes), config_(config), neighbours_(neighbours_of(echoes, config)), plane_of_(echoes.size(), -1) {
    for (std::size_t i = 0; i < echoes.size(); ++i) {
      PlaneSums sums;
      sums.add(echoes[i]);
      for (const std::uint32_t k : neighbours_.at(i)) sums.add(echoes[k]);
      local_.push_back(sums.size() > 3 ? std::optional(sums.plane(config.vertical)) : std::nullopt);
    }
  }

  TangentialClusters grow() {
    std::vector<std::uint32_t> seeds(echoes_.size());
    std::iota(seeds.begin(), seeds.end(), 0u);
    // by the residual of their neighbourhood in standard deviations, so that near echoes have no advantage
    const auto roughness = [&](std::uint32_t i) {
      return local_[i] ? local_[i]->rms_m / sigma(echoes_[i]) : std::numeric_limits<double>::infinity();
    };
    std::stable_sort(seeds.begin(), seeds.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return roughness(a) < roughness(b); });
    for (const std::uint32_t seed : seeds) {
      if (plane_of_[seed] < 0 && local_[seed]) grow_from(seed);
    }
    settle();
    return told();
  }

 private:
  [[nodiscard]] double sigma(const Vector3d& p) const {
    return std::max(config_.sigma_m, config_.sigma_share * p.norm());
  }
  /// Distance in standard deviations of the range, the dominant error along the normal.
  [[nodiscard]] double deviation(const TangentPlane& plane, const Vector3d& p) const {
    return std::abs(plane.normal.dot(p) + plane.distance_m) / sigma(p);
  }
  [[nodiscard]] bool joins(const TangentPlane& plane, std::uint32_t i) const {
    return deviation(plane, echoes_[i]) <= config_.gate && local_[i] &&
           plane.normal.dot(local_[i]->normal) >= cos(config_.turned);
  }
  void grow_from(std::uint32_t seed) {
    PlaneSums sums;
    std::vector<std::uint32_t> members;
    const int number = static_cast<int>(planes_.size());
    TangentPlane plane = *local_[seed];
    const auto take = [&](std::uint32_t i) {
      plane_of_[i] = number;
      members.push_back(i);
      sums.add(echoes_[i]);
    };
    take(seed);
    int fitted = config_.least;
    for (std::size_t next = 0; next < members.size(); ++next) {
      for (const std::uint32_t k : neighbours_.at(members[next])) {
        if (plane_of_[k] < 0 && joins(plane, k)) take(k);
      }
      if (sums.size() < fitted) continue;
      plane = sums.plane(config_.vertical);
      fitted = sums.size() + sums.size() / 4;
    }
    if (sums.size() >= config_.least) {
      planes_.push_back(sums.plane(config_.vertical));
      return;
    }
    for (const std::uint32_t i : members) plane_of_[i] = -1;
  }
  /// Assigns each echo to the nearest of its neighbours' planes, and refits the planes.
  void settle() {
    std::vector<int> nearest = plane_of_;
    for (std::uint32_t i = 0; i < echoes_.size(); ++i) {
      double least = config_.gate;
      if (plane_of_[i] >= 0) least = deviation(planes_[static_cast<std::size_t>(plane_of_[i])], echoes_[i]);
      for (const std::uint32_t k : neighbours_.at(i)) {
        if (plane_of_[k] < 0) continue;
        const double d = deviation(planes_[static_cast<std::size_t>(plane_of_[k])], echoes_[i]);
        if (d >= least) continue;
        least = d;
        nearest[i] = plane_of_[k];
      }
    }
    plane_of_ = nearest;
    std::vector<PlaneSums> sums(planes_.size());
    for (std::uint32_t i = 0; i < echoes_.size(); ++i) {
      if (plane_of_[i] >= 0) sums[static_cast<std::size_t>(plane_of_[i])].add(echoes_[i]);
    }
    for (std::size_t p = 0; p < planes_.size(); ++p) {
      if (sums[p].size() > 3) planes_[p] = sums[p].plane(config_.vertical);
    }
  }
  [[nodiscard]] TangentialClusters told() const {
    TangentialClusters told;
    std::vector<std::size_t> order(planes_.size()), number(planes_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return planes_[a].support > planes_[b].support; });
    for (std::size_t k = 0; k < order.size(); ++k) {
      number[order[k]] = k;
      told.planes.push_back(planes_[order[k]]);
    }
    for (const int p : plane_of_) {
      told.plane_of.push_back(p < 0 ? -1 : static_cast<int>(number[static_cast<std::size_t>(p)]));
    }
    find_edges(told);
    return told;
  }
  void find_edges(TangentialClusters& told) const {
    const std::size_t n = told.planes.size();
    std::vector<int> pairs(n * n, 0);
    std::vector<Vector3d> middle(n * n, Vector3d::Zero());
    for (std::uint32_t i = 0; i < echoes_.size(); ++i) {
      for (const std::uint32_t k : neighbours_.at(i)) {
        const int a = told.plane_of[i], b = told.plane_of[k];
        if (k < i || a < 0 || b < 0 || a == b) continue;
        const std::size_t at = static_cast<std::size_t>(std::min(a, b)) * n + static_cast<std::size_t>(std::max(a, b));
        ++pairs[at];
        middle[at] += 0.5 * (echoes_[i] + echoes_[k]);
      }
    }
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = a + 1; b < n; ++b) {
        const TangentPlane &p = told.planes[a], &q = told.planes[b];
        const Vector3d along = p.normal.cross(q.normal);
        if (pairs[a * n + b] == 0 || along.norm() < sin(config_.turned / 2)) continue;
        const Vector3d between = middle[a * n + b] / pairs[a * n + b];
        Matrix3d rows;
        rows << p.normal.transpose(), q.normal.transpose(), along.transpose();
        const Vector3d at = rows.inverse() * Vector3d(-p.distance_m, -q.distance_m, along.dot(between));
        told.edges.push_back({a, b, at, along.normalized(), pairs[a * n + b]});
      }
    }
  }

  std::span<const Vector3d> echoes_;
  const TangentialConfig& config_;
  EchoNeighbours neighbours_;
  std::vector<std::optional<TangentPlane>> local_;
  std::vector<int> plane_of_;
  std::vector<TangentPlane> planes_;
};

}  // namespace

TangentialClusters tangential_clusters(std::span<const Vector3d> echoes, const TangentialConfig& config) {
  return PlaneGrower(echoes, config).grow();
}

std::vector<Vector3d> echoes_of(const SphericalGrid& grid, double probability) {
  std::vector<Vector3d> points;
  grid.cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
    for (const SphericalCell& cell : beam) {
      if (cell.echoes > 0 && SphericalGrid::probability(cell) >= probability) points.push_back(grid.point_of(cell));
    }
  });
  return points;
}

}  // namespace isobath
