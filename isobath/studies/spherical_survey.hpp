// SphericalSurvey: scans a room of lines and arcs from numbered positions along a path into a spherical grid, which is
// centred on the vehicle at the last position. It also finds the features of the room: edges, arcs, and corners that
// later scans confirm (Auran, Silven 1995, 3.1, 3.2 and 4.3; ledger S4-D01, S4-D02, S4-31 to S4-35, S4-42 to S4-47,
// S4-52). The vehicle's navigation may drift; then the corners of the room, which its chart shows, fix its position
// (S4-49). `isobath sphere` runs a survey.
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
  int seed = -1;           ///< -1: the seed of the scene
  int passes = 1;          ///< along the path, to and fro; `scans` in each
  double drift_share = 0;  ///< of the way: how fast the error of dead reckoning grows, in one direction
  SectionSonarConfig sonar;
  SphericalGridConfig grid;
  SphericalMapperConfig mapper;
  bool leave_out_false = false;  ///< leaves out multiple echoes, and clusters with too low a score
  bool known_walls = false;      ///< the walls of the first scan's section are in the grid from the start (S4-15)
  int coarser = 1;               ///< above 1: a second grid, with directions and layers this many times as wide (S4-17)
  FalseEchoConfig false_echoes;
};

/// A round body, merged from the arcs of all scans that show it.
struct SurveyArc {
  PlaneArc arc;
  int scans = 0;
};
/// The features found in the scans.
struct SurveyFeatures {
  CornerEvidence evidence;  ///< edges and corners, W
  std::vector<SurveyArc> arcs;
  std::vector<Eigen::Vector2d> accounted, unaccounted;  ///< echoes, W
  std::size_t runs = 0;                                 ///< runs of constant range
  TangentialClusters planes;                            ///< planes in the grid at the last position, G
  struct Target {
    SphericalCluster cluster;
    TargetScore score;
  };
  std::vector<Target> targets;  ///< clusters of the same grid, the largest first
};

/// An echo as the survey keeps it, to feed other grids (S4-17).
struct SurveyEcho {
  Eigen::Vector3d at_W;  ///< by the position that the vehicle believed in
  double range_m = 0;    ///< from where it was heard
  int scan = 1;
};

/// What the vehicle takes for its position at each scan.
struct SurveyNavigation {
  std::vector<Eigen::Vector2d> dead_reckoning;
  std::vector<Eigen::Vector2d> believed;  ///< corrected by the corners of the chart
  int fixes = 0;                          ///< scans that corrected it
  int corners = 0;                        ///< of all fixes
  double way_m = 0;
};
/// Distance of the positions from those of the scans, m.
struct PositionErrors {
  double last_m = 0, worst_m = 0;
};
PositionErrors errors_of(const std::vector<Eigen::Vector2d>& positions, const ScanPath& path);

struct SphericalSurvey {
  ScanPath path;
  SurveyNavigation navigation;
  SurveyFeatures features;
  std::unique_ptr<SphericalGrid> grid;    ///< at the last position
  std::unique_ptr<SphericalGrid> coarse;  ///< the same contents in wider cells; null: not wanted
  std::vector<SurveyEcho> stored;         ///< the echoes that are in the grid, in the order of time
  std::uint64_t beams = 0, echoes = 0;
  std::uint64_t dropped_echoes = 0;  ///< echoes that left the range of the grid
  std::uint64_t occupied = 0;
  std::array<std::array<std::uint64_t, 3>, 3> causes{};  ///< echoes by true cause (SectionEcho) and found EchoCause
  /// Distance from the centres of occupied cells with echoes to the true walls at their depth, m.
  double median_error_m = 0, worst_error_m = 0;
  std::uint64_t known = 0;   ///< cells that hold walls known from the start
  double known_error_m = 0;  ///< largest distance of their contents from the true walls
};

/// The configuration for the first sonar of the scene: its range, its beam width, and buckets as wide.
SphericalSurveyConfig survey_config(const Scene& scene);
/// The configuration for a sonar of a data sheet (listed_resolution): its range, errors, beams and the sector that they
/// cover about the vehicle's course, and a grid as fine (S4-36).
SphericalSurveyConfig survey_config(const SonarResolution& sonar);
/// Throws Error if the scene has neither lines nor arcs, or if its vehicle does not move.
SphericalSurvey run_spherical_survey(const Scene& scene, const SphericalSurveyConfig& config);

/// Distance from a plan point to the nearest line or arc, m.
double distance_to(const PlaneSection& section, const Eigen::Vector2d& p);

}  // namespace isobath
