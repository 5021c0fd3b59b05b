#include <algorithm>
#include <isobath/scenario/ground_truth_trajectory.hpp>
#include <utility>

namespace isobath {

std::optional<Pose> true_pose_at(std::span<const TrueMotion> motion, Time time) {
  const auto after =
      std::lower_bound(motion.begin(), motion.end(), time, [](const TrueMotion& m, Time t) { return m.time < t; });
  if (after == motion.end()) return std::nullopt;
  if (after->time == time) return after->state.X_WB;
  if (after == motion.begin()) return std::nullopt;
  const TrueMotion& before = *std::prev(after);
  const double share = to_seconds(time - before.time) / to_seconds(after->time - before.time);
  return interpolate(before.state.X_WB, after->state.X_WB, share);
}

std::vector<TrueBody> outlines_of(const World& world) {
  std::vector<TrueBody> outlines;
  for (const WorldBody& body : world.bodies()) {
    for (Polygon part : body.plan) {
      for (Eigen::Vector2d& p : part) p += body.moved.head<2>();
      outlines.push_back({body.name, std::move(part), body.moved.head<2>()});
    }
  }
  return outlines;
}

void GroundTruthTrajectory::on_truth(const TrueMotion& motion) {
  const Eigen::Vector3d p_WB = motion.state.X_WB.translation;
  const double t_s = to_seconds(motion.time), hull = simulator_.hull_radius();
  const auto bodies = simulator_.world().bodies();
  double nearest = std::numeric_limits<double>::infinity();  // from the vehicle reference point
  std::size_t which = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    // The world holds the bodies as of the last ping, so the query point is moved to allow for their motion since then.
    const Eigen::Vector3d p = p_WB - displacement(*bodies[i].body, t_s);
    if (bodies[i].box.exteriorDistance(p) >= nearest) continue;
    const double away = simulator_.world().distance(static_cast<int>(i), p + bodies[i].moved);
    if (away >= nearest) continue;
    nearest = away;
    which = i;
  }
  const double clear = nearest - hull;
  if (clear < truth_.min_clearance_m) {
    truth_.min_clearance_m = clear;
    truth_.nearest_body = bodies[which].name;
    truth_.nearest_moved = displacement(*bodies[which].body, t_s).head<2>();
  }
  if (clear <= 0) touch(t_s, bodies[which].name);
  if (motion.altitude_m) {
    const double keel = *motion.altitude_m - 0.5 * simulator_.vehicle().height;
    truth_.min_altitude_m = std::min(truth_.min_altitude_m, keel);
    if (keel <= 0) touch(t_s, "the bottom");
  }
  if (!truth_.track.empty()) {
    truth_.length_m += (p_WB - truth_.track.back().state.X_WB.translation).head<2>().norm();
  }
  truth_.track.push_back(motion);
  truth_.clearance_m.push_back(clear);
}

void GroundTruthTrajectory::touch(double t_s, const std::string& what) {
  if (truth_.contact_s >= 0) return;
  truth_.contact_s = t_s;
  truth_.contact_with = what;
}

}  // namespace isobath
