// overlap_area: the exact area of overlap of a range bin, which is an annular sector, with a square cell (Ganesan 2015,
// 3.3, equations 3.7-3.10; ledger S6-11).
//
// The square is clipped by the two radial half-planes of the beam, which leaves a convex polygon. The polygon's overlap
// with the bin is its overlap with the outer disc minus its overlap with the inner disc. Both have a closed form
// (triangles and circular sectors). The apex of the sector is the origin; angles run from x to y. Sectors wider than
// 180 degrees are cut in two. Error: about 1e-15 r^2, where r is the outer radius of the bin.
#pragma once

#include <array>
#include <Eigen/Core>
#include <isobath/base/angle.hpp>
#include <span>

namespace isobath {

struct AnnularSector {
  double inner = 0;  ///< radius, m
  double outer = 0;
  Angle centre;
  Angle width;  ///< full, at most 360 degrees
};

struct Square {
  Eigen::Vector2d low;  ///< corner with the least x and y
  double side = 1;
};

double overlap_area(const AnnularSector& sector, const Square& square);

/// A wedge with its apex at the origin, at most 180 degrees wide: the sector of one beam.
class Wedge {
 public:
  Wedge(Angle centre, Angle width);

  /// Convex, at most 6 corners: a rectangle cut by two lines.
  struct Piece {
    std::array<Eigen::Vector2d, 8> corners;
    int count = 0;
    [[nodiscard]] std::span<const Eigen::Vector2d> polygon() const {
      return {corners.data(), static_cast<std::size_t>(count)};
    }
  };
  [[nodiscard]] Piece clip(const Eigen::Vector2d& low, const Eigen::Vector2d& high) const;

 private:
  Eigen::Vector2d right_;  ///< inward normals of the two sides
  Eigen::Vector2d left_;
};

/// Area of a convex polygon within a disc about the origin.
double disc_overlap(std::span<const Eigen::Vector2d> polygon, double radius);

}  // namespace isobath
