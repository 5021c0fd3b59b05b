// TriangleMesh: bodies and bottoms without closed-form ray intersection. triangle_mesh.cpp makes the meshes of a
// scene's shapes, mesh_files.cpp those of terrain and rasters (GDAL); mesh_import.cpp reads mesh files (Assimp).
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
/// Number of closed border lines besides the outermost one; separate parts count too. Vertices at the same position
/// count as one.
int holes(const TriangleMesh& mesh);
TriangleMesh terrain_mesh(const BottomConfig& config);
/// Reads a raster with GDAL. Throws Error if it cannot be read or has cells without data.
TriangleMesh raster_mesh(const BottomConfig& config);
/// Reads a mesh with Assimp, in the axes of the file, scaled. Throws Error if it cannot be read. The file is untrusted:
/// a process of its own reads it, with limits on memory and time that grow with the size of the file.
TriangleMesh load_mesh(const std::string& file, double scale, const Place& place);

TriangleMesh mesh_of(const Box& box);
TriangleMesh mesh_of(const Wall& wall);
TriangleMesh mesh_of(const Prism& prism);
/// Throws Error if the file cannot be read.
TriangleMesh mesh_of(const Mesh& mesh, const Place& place);

/// The outline in plan as convex parts: north, east; empty for a mesh that is too fine to draw.
std::vector<Polygon> plan_of(const TriangleMesh& mesh);
/// Distance from a point to the nearest triangle, m.
double distance(const TriangleMesh& mesh, const Eigen::Vector3d& p);

}  // namespace isobath
