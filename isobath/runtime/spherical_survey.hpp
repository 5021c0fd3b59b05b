// SphericalSurvey: a room of lines and arcs scanned from numbered places along a path, in the spherical grid of the
// vehicle at the last of them; and what stands there: edges, arcs, and corners that are confirmed on the way (Auran,
// Silven 1995, 3.1, 3.2 and 4.3; ledger S4-D01, S4-D02, S4-31 to S4-35, S4-42 to S4-47, S4-52). `isobath sphere` runs
// one.
#pragma once

#include <array>
#include <isobath/perception/corner_evidence.hpp>
#include <isobath/perception/false_echoes.hpp>
#include <isobath/perception/spherical_mapper.hpp>
#include <isobath/perception/tangential_clusters.hpp>
#include <isobath/perception/target_score.hpp>
#include <isobath/sim/plane_section.hpp>
#include <memory>

namespace isobath {

struct SphericalSurveyConfig {
  int scans = 10;
  int seed = -1;  ///< -1: the scene's
  SectionSonarConfig sonar;
  SphericalGridConfig grid;
  SphericalMapperConfig mapper;
  bool leave_out_false = false;  ///< multiples, and clusters that do not stand
  FalseEchoConfig false_echoes;
};

/// A round thing, from all scans that told an arc of it.
struct SurveyArc {
  PlaneArc arc;
  int scans = 0;
};
/// What the scans were told as.
struct SurveyFeatures {
  CornerEvidence evidence;  ///< edges and corners, W
  std::vector<SurveyArc> arcs;
  std::vector<Eigen::Vector2d> accounted, unaccounted;  ///< echoes, W
  std::size_t runs = 0;                                 ///< of constant range
  TangentialClusters planes;                            ///< of the grid at the last place, G
  struct Target {
    SphericalCluster cluster;
    TargetScore score;
  };
  std::vector<Target> targets;  ///< clusters of the same grid, the largest first
};

struct SphericalSurvey {
  ScanPath path;
  SurveyFeatures features;
  std::unique_ptr<SphericalGrid> grid;  ///< at the last place
  std::uint64_t beams = 0, echoes = 0;
  std::uint64_t dropped_echoes = 0;  ///< that left the grid's range
  std::uint64_t occupied = 0;
  std::array<std::array<std::uint64_t, 3>, 3> causes{};  ///< echoes by SectionEcho, and by what they were told as
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
