// GroundTruthTrajectory: the true track of a simulated vehicle, and the clearance of its hull from the bodies of the
// scene. Scores of a closed loop use it; nothing on board can see it.
//
// It is evaluated ten times a second, with every body at its position of that instant. For bodies, the hull is a level
// disc with half the diagonal of its plan as radius (Simulator::hull_radius); for the bottom, it is half the height.
// Both enclose the hull, so the clearance is never overstated. The exact distance of a body, which for a mesh tests
// every triangle, is computed only if its bounding box is near enough to matter.
#pragma once

#include <isobath/geometry/polygon.hpp>
#include <isobath/scenario/scenario.hpp>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace isobath {

struct TrackTruth {
  std::vector<TrueMotion> track;    ///< ten per second
  std::vector<double> clearance_m;  ///< from the hull to the nearest body, for each of them; infinite without bodies
  double contact_s = -1;            ///< when the hull first touched a body or the bottom; -1: never
  std::string contact_with;
  double min_clearance_m = std::numeric_limits<double>::infinity();  ///< minimum of clearance_m
  std::string nearest_body;
  Eigen::Vector2d nearest_moved = Eigen::Vector2d::Zero();          ///< how far that body had then moved along its path
  double min_altitude_m = std::numeric_limits<double>::infinity();  ///< minimum of the keel above the bottom
  double length_m = 0;                                              ///< length of the track in plan
};

/// The true pose of the vehicle at a time, interpolated between two instants of its motion; empty outside it.
std::optional<Pose> true_pose_at(std::span<const TrueMotion> motion, Time time);

/// The outline in W of a true body, or of one pylon of a row.
struct TrueBody {
  std::string name;
  Polygon outline;
  Eigen::Vector2d moved = Eigen::Vector2d::Zero();  ///< along its path, from the scene's start
};

/// The outlines of all bodies of a scene, at their current positions.
std::vector<TrueBody> outlines_of(const World& world);

class GroundTruthTrajectory : public SimulatedSource::TruthSink {
 public:
  explicit GroundTruthTrajectory(const Simulator& simulator) : simulator_(simulator) {}

  void on_truth(const EchoTruth&) override {}
  void on_truth(const TrueMotion& motion) override;
  [[nodiscard]] const TrackTruth& truth() const { return truth_; }

 private:
  void touch(double t_s, const std::string& what);

  const Simulator& simulator_;
  TrackTruth truth_;
};

}  // namespace isobath
