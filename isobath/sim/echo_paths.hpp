// EchoPaths: from one cell of the field of view to the echoes that it receives, over all paths (echo_synthesizer.hpp):
// direct, over the surface, the bottom or a body, and the multiples between a wall and the sonar's housing. It holds
// the state of one ping. Internal to the sources of the simulated echoes.
#pragma once

#include <algorithm>
#include <cmath>
#include <isobath/geometry/pose.hpp>
#include <isobath/sim/field_of_view.hpp>
#include <isobath/sim/scattering.hpp>
#include <isobath/sim/sonar_config.hpp>
#include <isobath/sim/water.hpp>
#include <isobath/sim/world.hpp>
#include <isobath/sonar/echo_truth.hpp>
#include <vector>

namespace isobath {

/// The ranges between which an echo lies, m.
struct EchoSpan {
  double near, far;
};

/// An echo by one path, at the ranges that the device reads, before the receive patterns.
struct PathEcho {
  EchoSpan span;
  double power;  ///< relative to the source level
  EchoLabel label;
};

/// All vectors are in W unless said otherwise.
class EchoPaths {
 public:
  EchoPaths(const SonarConfig& sonar, const World& scene_world, const Water& scene_water);
  /// Starts a ping from X_WS; `small` remains.
  void begin_ping(const Pose& sonar_in_world);

  SonarConfig config;
  const World& world;
  const Water& water;
  FieldOfView view;
  double floor = 0;        ///< echoes whose contribution is below this power are not traced
  double head_reflection;  ///< of the sonar's housing
  double volume_strength;  ///< backscatter of a cubic metre of water
  SeaSurface sea;
  std::vector<Scatterer> scatterers;  ///< by target, from the bottom on

  Pose X_WS;
  Eigen::Matrix3d R_WS = Eigen::Matrix3d::Identity();
  double absorb = 0;        ///< per metre, one way, natural
  std::vector<bool> small;  ///< by body: whether it has cells of its own

  [[nodiscard]] double bin_m() const { return config.range_m / config.bins; }
  [[nodiscard]] double attenuation(double path) const { return std::exp(-absorb * path); }

  /// Appends every echo of a cell, and states how far open water reaches in it. `only`: the body that the cell was made
  /// for, or kNothing.
  void trace(const ViewCell& cell, int only, double& open_range, std::vector<PathEcho>& echoes) const;

  /// Appends the echoes of body `target` over the horizontal mirror at depth `mirror_z`, as seen in
  /// one cell.
  void over_mirror(const ViewCell& cell, int target, double mirror_z, int mirror_target,
                   std::vector<PathEcho>& echoes) const;

 private:
  /// Whether all echoes at these ranges, and their multiples, lie beyond the window.
  [[nodiscard]] bool too_far(const EchoSpan& read) const { return read.near - config.resolution_m >= config.range_m; }
  /// Factor from true range to the range that the device reads.
  [[nodiscard]] double stretch(double depth) const {
    return config.sound_speed / water.mean_sound_speed(X_WS.translation.z(), depth);
  }
  [[nodiscard]] bool has_own_cells(int target) const {
    return target >= kFirstBody && small[static_cast<std::size_t>(target - kFirstBody)];
  }
  [[nodiscard]] double reflection(int target) const;
  [[nodiscard]] const Scatterer& scatterer(int target) const {
    return scatterers[static_cast<std::size_t>(target - kBottom)];
  }

  /// sigma for this cell where a ray along v meets a surface after `range` of path.
  [[nodiscard]] double sigma_of(const ViewCell& cell, double range, const RayHit& hit, const Eigen::Vector3d& v) const;
  /// Power of the echo that a cell meets after `range` of path and that returns by the same path. `cell.gain` is
  /// two-way, so the pattern is applied once.
  [[nodiscard]] double echo(const ViewCell& cell, double range, const RayHit& hit, const Eigen::Vector3d& u) const;
  static EchoPath bounce(int mirror_target);
  /// The ranges between which a cell meets the tangent plane of the surface at `range`. All vectors in one frame.
  static EchoSpan span_of(const ViewCell& cell, double range, const Eigen::Vector3d& u, const Eigen::Vector3d& across,
                          const Eigen::Vector3d& up, const Eigen::Vector3d& normal);
  /// Within one cell a surface at grazing incidence spans many ranges. Its tangent plane is divided along the
  /// elevation, and each piece has its own range and power. Calls visit(piece, range, direction, up).
  template <class Visit>
  void pieces(const ViewCell& cell, double range, const Eigen::Vector3d& u, const Eigen::Vector3d& up,
              const Eigen::Vector3d& normal, const Visit& visit) const;
  void meet_surface(const ViewCell& cell, const Eigen::Vector3d& p, const Eigen::Vector3d& u, double range,
                    std::vector<PathEcho>& echoes) const;
  /// A multiple: wall, housing, wall. By the image law its amplitude is that of the first echo times R H / 2.
  void repeat(const ViewCell& cell, double range, const RayHit& hit, const Eigen::Vector3d& u, const EchoSpan& read,
              std::vector<PathEcho>& echoes) const;
  /// Traces the ray that a mirror reflects after `first` metres, and the echo that it meets.
  void go_on(const ViewCell& cell, const Eigen::Vector3d& p, const Eigen::Vector3d& u, double first,
             const Eigen::Vector3d& mirror, int mirror_target, std::vector<PathEcho>& echoes) const;
  /// The two return paths of an echo whose outward path was over a mirror: over the mirror again, or direct. The direct
  /// path counts twice, since sound also takes it in the opposite sense.
  void follow(const ViewCell& cell, const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector3d& v,
              double first, const RayHit& hit, const Eigen::Vector3d& across_v, const Eigen::Vector3d& up_v,
              double kept, EchoPath path, std::vector<PathEcho>& echoes) const;
};

}  // namespace isobath
