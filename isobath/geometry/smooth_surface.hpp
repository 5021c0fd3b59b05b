// SmoothSurface: a bottom with continuous slope through scattered soundings.
//
// Source: Renka and Cline 1984, cited by Oskard 1990, III-A; ledger S1-14, S1-D07. The soundings are triangulated
// (Delaunay). The slope at each sounding is that of a quadratic fitted to its neighbours by weighted least squares.
// Each triangle carries a Clough-Tocher cubic, split at the centroid, whose slope across a side varies linearly from
// end to end. Planes are reproduced to rounding, quadratics too where the slopes are exact; away from the hull the
// error falls with the third power of the spacing. There is no surface outside the convex hull.
//
// surface_error.hpp estimates its error.
// Units: metres; depth down; points are (north, east). Cost on one core: 1e5 soundings in 0.26 s, 0.4 us a sample.
// Errors: throws Error when the soundings span no area. Threads: any number may read.
#pragma once

#include <cstdint>
#include <isobath/geometry/triangulation.hpp>

namespace isobath {

struct SurveyPoint {
  Eigen::Vector2d north_east{0, 0};
  double depth_m = 0;
  int run = 0;  ///< survey run: soundings of one run share its errors of position, draught and water level
};

enum class Merge : std::uint8_t {
  kMean,      ///< mean position and depth
  kShoalest,  ///< the shoalest sounding unchanged: for charts and keels
};
/// Merges soundings in the same square of edge `cell_m`; with 0 only those at exactly the same place. The result is in
/// the order of the first sounding of each square.
std::vector<SurveyPoint> merged(std::span<const SurveyPoint> soundings, double cell_m, Merge how);

class SmoothSurface {
 public:
  struct Sample {
    double depth_m = 0;
    double flat_m = 0;               ///< depth of the flat triangle at this point
    Eigen::Vector2d gradient{0, 0};  ///< of the depth, along north and east
    double distance_m = 0;           ///< to the nearest sounding
    int nearest = 0;                 ///< index of that sounding
  };

  /// Only the first of soundings at the same place counts: see `merged`.
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
