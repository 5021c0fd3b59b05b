// GrownObstacles: convex parts of obstacles grown by the vehicle's radius, so that the vehicle is a point (Rodin, Amin
// c. 1988, 2.1; ledger S3-10), with an index by place for checks of legs.
//
// The inside of a grown part is closed to the vehicle, its border is open: a leg that goes in by less than 1e-9 m is
// free. Units: m. Immutable once built. Cost with 50 parts of 18 corners: 30 us to build, 0.1 us a leg of 10 m.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <isobath/geometry/polygon.hpp>
#include <span>
#include <vector>

namespace isobath {

/// A convex part of an obstacle.
struct GrownPart {
  int obstacle = 0;
  int label = 0;    ///< of its points in a triangulation, 0 or more
  Polygon outline;  ///< as it is, at least one corner
  Polygon grown;    ///< by the vehicle's radius, at least three corners, in the positive sense
};

class GrownObstacles {
 public:
  static constexpr int kNone = -1;

  explicit GrownObstacles(std::vector<GrownPart> parts);

  [[nodiscard]] std::span<const GrownPart> parts() const { return parts_; }
  /// The number of a part whose inside the leg from a to b meets; kNone for a free leg. Both ends must be finite.
  [[nodiscard]] int blocker(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const;
  [[nodiscard]] bool is_free(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
    return blocker(a, b) == kNone;
  }
  /// The numbers of all parts whose inside holds p.
  [[nodiscard]] std::vector<int> covering(const Eigen::Vector2d& p) const;
  /// Distance from the leg to the nearest outline as it is, not grown; `most` if none is nearer. O(parts).
  [[nodiscard]] double distance(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double most) const;

 private:
  struct Side {  ///< inside: normal . p > offset
    Eigen::Vector2d normal;
    double offset;
  };
  [[nodiscard]] bool meets(std::size_t part, const Eigen::Vector2d& a, const Eigen::Vector2d& b) const;
  [[nodiscard]] int column(double x) const;
  [[nodiscard]] int row(double y) const;

  std::vector<GrownPart> parts_;
  std::vector<Eigen::AlignedBox2d> boxes_;  ///< of the grown polygons
  std::vector<Side> sides_;
  std::vector<std::size_t> first_side_;
  Eigen::AlignedBox2d all_;
  double cell_ = 1;
  int columns_ = 1, rows_ = 1;
  std::vector<std::size_t> first_in_cell_;
  std::vector<int> in_cell_;
};

}  // namespace isobath
