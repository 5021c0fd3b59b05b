// SmoothSurface: a bottom with continuous slope through scattered soundings.
//
// Source: Renka and Cline 1984, cited by Oskard 1990, III-A; ledger S1-14, S1-D07. The soundings are triangulated
// (Delaunay); the slope at each is that of a quadratic fitted to its neighbours by weighted least squares; each
// triangle carries a Clough-Tocher cubic, split at the centroid, whose slope across a side runs linearly from end to
// end. Planes are reproduced to rounding, quadratics with exact slopes too; the error falls with the third power of the
// spacing away from the hull. Nothing is said outside the convex hull.
//
// How far it may be wrong: surface_error.hpp.
// Units: metres; depth down; points are (north, east). Cost on one core: 1e5 soundings in 0.26 s, 0.4 us a sample.
// Errors: throws Error when the soundings span no area. Threads: reading from any number.
#pragma once

#include <cstdint>
#include <isobath/geometry/triangulation.hpp>

namespace isobath {

struct SurveyPoint {
  Eigen::Vector2d north_east{0, 0};
  double depth_m = 0;
  int run = 0;  ///< of the survey: soundings of one run share its errors of position, draught and water level
};

enum class Merge : std::uint8_t {
  kMean,      ///< place and depth of the mean
  kShoalest,  ///< the shoalest as it stands: for charts and keels
};
/// Soundings in the same square of edge `cell_m` become one; with 0 only those at exactly the same place. In the order
/// of their first.
std::vector<SurveyPoint> merged(std::span<const SurveyPoint> soundings, double cell_m, Merge how);

class SmoothSurface {
 public:
  struct Sample {
    double depth_m = 0;
    double flat_m = 0;               ///< depth of the flat triangle there
    Eigen::Vector2d gradient{0, 0};  ///< of the depth, along north and east
    double distance_m = 0;           ///< to the nearest sounding
    int nearest = 0;                 ///< its index
  };

  /// Of soundings at the same place only the first counts: see `merged`.
  explicit SmoothSurface(std::vector<SurveyPoint> soundings);
  /// With known slopes.
  SmoothSurface(std::vector<SurveyPoint> soundings, std::vector<Eigen::Vector2d> gradients);

  /// Empty outside the hull.
  [[nodiscard]] std::optional<Sample> at(const Eigen::Vector2d& p) const;
  [[nodiscard]] const std::vector<SurveyPoint>& soundings() const { return soundings_; }
  [[nodiscard]] const std::vector<Eigen::Vector2d>& gradients() const { return gradients_; }
  [[nodiscard]] const Triangulation& triangulation() const { return triangulation_; }

 private:
  void estimate_gradients();

  std::vector<SurveyPoint> soundings_;
  Triangulation triangulation_;
  std::vector<Eigen::Vector2d> gradients_;
};

}  // namespace isobath
