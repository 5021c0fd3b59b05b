// World: a scene as geometry that rays can meet, with what each surface is.
//
// Spheres, cylinders and the flat bottom are met exactly (their own intersection, in double precision); walls, boxes,
// terrain, rasters and meshes as triangles, through Embree. The water surface is the plane z = 0. Rays are straight and
// start in the water. Casting is safe from many threads; move_to is not, and must not run beside it.
// Cost: 0.1 us a ray in a scene of 500,000 triangles on one core of a 2-core Xeon.
#pragma once

#include <Eigen/Core>
#include <isobath/geometry/polygon.hpp>
#include <isobath/sim/scene.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <span>

namespace isobath {

/// What a ray can meet: the surface of the water, the bottom, or body kFirstBody + its index in the world.
enum : int { kNothing = 0, kSurface = 1, kBottom = 2, kFirstBody = 3 };

struct RayHit {
  double range = 0;        ///< m
  Eigen::Vector3d normal;  ///< unit, towards where the ray came from
  int target = kNothing;
  double curvature = 0;                                ///< 1/m, of spheres and cylinders
  Eigen::Vector3d straight = Eigen::Vector3d::Zero();  ///< unit direction without curvature: the axis of a cylinder
};

/// A body of the scene, or one pylon of a row.
struct WorldBody {
  const Body* body = nullptr;
  std::string name;
  const Material* material = nullptr;
  Eigen::AlignedBox3d box;            ///< at its first place
  Eigen::Vector3d moved = {0, 0, 0};  ///< since then
  std::vector<Polygon> plan;          ///< its outline from above at its first place: north, east; convex parts
  bool moves = false;
};

class World {
 public:
  /// Throws Error, with the place in the scene's file, for a mesh or raster that cannot be read, a bottom with holes.
  explicit World(const Scene& scene);
  ~World();

  /// Bodies with a path go where they are t seconds into the run.
  void move_to(double t_s);

  /// The nearest body or bottom within max_range; the surface is not looked at. u is a unit vector.
  [[nodiscard]] std::optional<RayHit> cast(const Eigen::Vector3d& p_W, const Eigen::Vector3d& u_W,
                                           double max_range) const;
  /// Whether anything stands within `range` along u.
  [[nodiscard]] bool blocked(const Eigen::Vector3d& p_W, const Eigen::Vector3d& u_W, double range) const;

  [[nodiscard]] std::span<const WorldBody> bodies() const;
  [[nodiscard]] const Material& material(int target) const;  ///< of the bottom or a body
  [[nodiscard]] const std::string& name(int target) const;
  /// Depth of the bottom below (or above) a place; empty where there is none.
  [[nodiscard]] std::optional<double> bottom_depth(double north, double east) const;
  /// From a point to the nearest surface of body i, m; negative inside spheres, cylinders and boxes.
  [[nodiscard]] double distance(int body, const Eigen::Vector3d& p_W) const;
  /// North and east of the smallest and the largest corner of everything, without the flat bottom.
  [[nodiscard]] Eigen::AlignedBox2d extent() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isobath
