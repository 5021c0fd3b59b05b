// World: the geometry of a scene for ray casting, and the material of each surface.
//
// Rays intersect spheres, cylinders and the flat bottom exactly (closed form, double precision). Walls, boxes, terrain,
// rasters and meshes are triangles, traced by Embree. The water surface is the plane z = 0. Rays are straight and start
// in the water. Many threads may call cast at once, but not beside move_to.
// Cost: 0.1 us per ray in a scene of 500,000 triangles on one core of a 2-core Xeon.
#pragma once

#include <Eigen/Core>
#include <isobath/geometry/polygon.hpp>
#include <isobath/sim/scene.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <span>

namespace isobath {

/// Targets of a ray: the water surface, the bottom, or body kFirstBody + its index in the world.
enum : int { kNothing = 0, kSurface = 1, kBottom = 2, kFirstBody = 3 };

struct RayHit {
  double range = 0;        ///< m
  Eigen::Vector3d normal;  ///< unit vector, towards the origin of the ray
  int target = kNothing;
  double curvature = 0;                                ///< 1/m, spheres and cylinders only
  Eigen::Vector3d straight = Eigen::Vector3d::Zero();  ///< unit direction of zero curvature: a cylinder's axis
};

/// A body of the scene, or one pylon of a row.
struct WorldBody {
  const Body* body = nullptr;
  std::string name;
  const Material* material = nullptr;
  Eigen::AlignedBox3d box;            ///< at the first position
  Eigen::Vector3d moved = {0, 0, 0};  ///< displacement since then
  std::vector<Polygon> plan;          ///< outline in plan at the first position: north, east; convex parts
  bool moves = false;
};

class World {
 public:
  /// Throws Error, with the place in the scene's file, for an unreadable mesh or raster or a bottom with holes.
  explicit World(const Scene& scene);
  ~World();

  /// Moves the bodies with a path to their positions at t seconds of the run.
  void move_to(double t_s);

  /// The nearest hit of a body or the bottom within max_range; the water surface is ignored. u is a unit vector.
  [[nodiscard]] std::optional<RayHit> cast(const Eigen::Vector3d& p_W, const Eigen::Vector3d& u_W,
                                           double max_range) const;
  /// Whether a body or the bottom lies within `range` along u.
  [[nodiscard]] bool blocked(const Eigen::Vector3d& p_W, const Eigen::Vector3d& u_W, double range) const;

  [[nodiscard]] std::span<const WorldBody> bodies() const;
  [[nodiscard]] const Material& material(int target) const;  ///< for the bottom or a body
  [[nodiscard]] const std::string& name(int target) const;
  /// Depth of the bottom at a position; empty if there is none.
  [[nodiscard]] std::optional<double> bottom_depth(double north, double east) const;
  /// Distance from a point to the surface of body i, m; negative inside spheres, cylinders and boxes.
  [[nodiscard]] double distance(int body, const Eigen::Vector3d& p_W) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isobath
