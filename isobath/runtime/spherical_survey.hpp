// SphericalSurvey: a room of lines and arcs scanned from numbered places along a path, in the spherical grid of the
// vehicle at the last of them (Auran, Silven 1995, 3.2 and 4.3; ledger S4-D01, S4-31 to S4-35). `isobath sphere` runs
// one.
#pragma once

#include <isobath/map/spherical_grid.hpp>
#include <isobath/perception/spherical_mapper.hpp>
#include <isobath/sim/plane_section.hpp>
#include <memory>

namespace isobath {

struct SphericalSurveyConfig {
  int scans = 10;
  int seed = -1;  ///< -1: the scene's
  SectionSonarConfig sonar;
  SphericalGridConfig grid;
  SphericalMapperConfig mapper;
};

struct SphericalSurvey {
  ScanPath path;
  std::unique_ptr<SphericalGrid> grid;  ///< at the last place
  std::uint64_t beams = 0, echoes = 0;
  std::uint64_t dropped_echoes = 0;  ///< that left the grid's range
  std::uint64_t occupied = 0;
  /// Of the echoes' cells that are occupied, from their middles to the true walls at their depth, m.
  double median_error_m = 0, worst_error_m = 0;
};

/// Of the sonar in the scene: its range and the width of its beams, buckets as wide.
SphericalSurveyConfig survey_config(const Scene& scene);
/// Throws Error where the scene has neither lines nor arcs, or its vehicle goes nowhere.
SphericalSurvey run_spherical_survey(const Scene& scene, const SphericalSurveyConfig& config);

/// From a plan point to the nearest line or arc, m.
double distance_to(const PlaneSection& section, const Eigen::Vector2d& p);

}  // namespace isobath
