// Baselines for suites in which bodies move. Both steer by line of sight to the mission point (LineOfSightHelm) and
// differ in what they do about bodies.
//
// VelocityObstacleHelm  Optimal reciprocal collision avoidance (van den Berg et al. 2009; reciprocal_avoidance.hpp).
//                       The helm takes the whole responsibility, because the others do not react. It is told the true
//                       place, velocity and radius of each body; no sonar measures these without error. Its own
//                       position is that of the navigation. A body counts as the disc around each convex part of its
//                       outline in plan. Heading and speed of the chosen velocity are the set-point. The method takes
//                       the vehicle for a disc that changes its velocity at once; the vehicle has a turning radius and
//                       a minimum speed. Without a body in the way the set-point is that of line of sight.
// StopAndWaitHelm       Goes straight. Where an obstacle of the last scan lies in the way ahead, it commands speed 0
//                       until the way is clear, and gives up after `patience_s`. The way ahead is a strip of the hull's
//                       width and a clearance on each side, max(look_m, look_s of way) long. A vehicle that cannot stop
//                       drifts on.
//
// Frame W, m, s. Each is a function of its inputs.
#pragma once

#include <isobath/evaluation/baseline_helms.hpp>
#include <isobath/planning/traffic/reciprocal_avoidance.hpp>
#include <isobath/sim/scene.hpp>

namespace isobath {

/// A body of a scene as a disc in plan; a body of several convex parts gives several discs.
struct SceneDisc {
  Body body;                                      ///< its path
  Eigen::Vector2d p_W = Eigen::Vector2d::Zero();  ///< at the first position of the body
  double radius_m = 0;
  double top_m = 0, bottom_m = 0;  ///< depths, at the first position

  /// Place and velocity at t seconds of the run.
  [[nodiscard]] AvoidedDisc at(double t_s) const;
};
/// All bodies of the scene. Throws Error as World does.
std::vector<SceneDisc> discs_of(const Scene& scene);

struct VelocityObstacleConfig {
  double margin_m = 0.5;     ///< beyond the distance at which a run counts as a collision
  double horizon_s = 10;     ///< contacts later than this are not avoided
  std::size_t nearest = 20;  ///< number of discs that are considered
};

class VelocityObstacleHelm : public LineOfSightHelm {
 public:
  VelocityObstacleHelm(const MissionPlan& mission, const VehicleParameters& vehicle, std::vector<SceneDisc> discs,
                       const VelocityObstacleConfig& config);
  /// The radius of the own disc: the hull's, the distance that counts as a collision (run_score.hpp: half the length of
  /// the hull), and the margin.
  [[nodiscard]] double own_radius_m() const { return 2 * vehicle().hull_radius_m + config_.margin_m; }

 protected:
  Setpoint decide(const Setpoint& wanted) override;

 private:
  void find_nearest();

  VelocityObstacleConfig config_;
  std::vector<SceneDisc> discs_;
  Drift drift_;
  std::optional<Time> before_;     ///< the last fix
  std::vector<AvoidedDisc> near_;  ///< the nearest discs at the present time, by their distance
};

struct StopAndWaitConfig {
  double clearance_m = 3;
  double look_m = 15, look_s = 10;  ///< length of the way ahead that must be clear: the larger of the two
  double patience_s = 60;
};

class StopAndWaitHelm : public LineOfSightHelm {
 public:
  StopAndWaitHelm(const MissionPlan& mission, const VehicleParameters& vehicle, const StopAndWaitConfig& config);
  void on_scan(const ScanResult& scan) override;

 protected:
  Setpoint decide(const Setpoint& wanted) override;

 private:
  /// The nearest point of an obstacle in the way ahead.
  [[nodiscard]] std::optional<Eigen::Vector2d> obstruction(double look_m) const;

  StopAndWaitConfig config_;
  std::vector<Polygon> outlines_;  ///< in W
  std::optional<Time> stopped_;    ///< since when
};

}  // namespace isobath
