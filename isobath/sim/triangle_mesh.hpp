// TriangleMesh: what is not met in closed form. Made from the shapes of a scene here, from terrain and files in
// mesh_files.cpp, the only place that knows GDAL and Assimp.
#pragma once

#include <Eigen/Core>
#include <isobath/geometry/polygon.hpp>
#include <isobath/sim/scene.hpp>
#include <string>
#include <vector>

namespace isobath {

/// Triangles, in W.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector3i> triangles;
};
/// Closed border lines beyond the outermost one; vertices at the same place count as one. Parts that lie apart count
/// too.
int holes(const TriangleMesh& mesh);
TriangleMesh terrain_mesh(const BottomConfig& config);
/// Through GDAL. Throws Error where it cannot be read, or has cells without data.
TriangleMesh raster_mesh(const BottomConfig& config);
/// Through Assimp, in the axes of the file times scale. Throws Error where it cannot be read.
TriangleMesh load_mesh(const std::string& file, double scale, const Place& place);

TriangleMesh mesh_of(const Box& box);
TriangleMesh mesh_of(const Wall& wall);
TriangleMesh mesh_of(const Prism& prism);
/// Throws Error where the file cannot be read.
TriangleMesh mesh_of(const Mesh& mesh, const Place& place);

/// Its outline from above as convex parts: north, east; none for a mesh too fine to draw.
std::vector<Polygon> plan_of(const TriangleMesh& mesh);
/// From a point to its nearest triangle, m.
double distance(const TriangleMesh& mesh, const Eigen::Vector3d& p);

}  // namespace isobath
