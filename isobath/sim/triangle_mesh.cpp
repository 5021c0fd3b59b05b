#include <algorithm>
#include <cmath>
#include <isobath/sim/triangle_mesh.hpp>
#include <limits>
#include <numbers>

namespace isobath {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector3i;

int add(TriangleMesh& mesh, const Vector3d& v) {
  mesh.vertices.push_back(v.cast<float>());
  return static_cast<int>(mesh.vertices.size()) - 1;
}
void quad(TriangleMesh& mesh, const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  const int i = add(mesh, a), j = add(mesh, b), k = add(mesh, c), l = add(mesh, d);
  mesh.triangles.push_back({i, j, k});
  mesh.triangles.push_back({i, k, l});
}

/// The polyline offset to the right by `aside`, with mitred corners.
std::vector<Vector2d> moved_aside(const std::vector<Vector2d>& line, double aside) {
  std::vector<Vector2d> out;
  const auto right = [&](std::size_t i) -> Vector2d {
    const Vector2d along = (line[i + 1] - line[i]).normalized();
    return {-along.y(), along.x()};  // north, east: right of the line
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Vector2d before = right(i == 0 ? 0 : i - 1), after = right(std::min(i, line.size() - 2));
    const Vector2d mean = before + after;
    out.push_back(line[i] + mean * (2 * aside / std::max(mean.squaredNorm(), 0.5)));
  }
  return out;
}

std::vector<Vector2d> corners(const std::vector<double>& flat) {
  std::vector<Vector2d> points;
  for (std::size_t i = 0; i + 1 < flat.size(); i += 2) points.emplace_back(flat[i], flat[i + 1]);
  return points;
}

/// Segments and arcs as chords; an arc's chords stay within 2 mm of it.
std::vector<std::pair<Vector2d, Vector2d>> chords(const Prism& p) {
  std::vector<std::pair<Vector2d, Vector2d>> all;
  for (std::size_t i = 0; i + 3 < p.lines.size(); i += 4) {
    all.emplace_back(Vector2d(p.lines[i], p.lines[i + 1]), Vector2d(p.lines[i + 2], p.lines[i + 3]));
  }
  for (std::size_t i = 0; i + 4 < p.arcs.size(); i += 5) {
    const Vector2d centre(p.arcs[i], p.arcs[i + 1]);
    const double radius = p.arcs[i + 2], from = p.arcs[i + 3] * std::numbers::pi / 180;
    double sweep = p.arcs[i + 4] * std::numbers::pi / 180 - from;
    if (sweep <= 0) sweep += 2 * std::numbers::pi;
    const double chord = 2 * std::acos(std::max(0.5, 1 - 0.002 / radius));
    const int count = std::max(4, static_cast<int>(std::ceil(sweep / chord)));
    for (int k = 0; k < count; ++k) {
      const double a = from + sweep * k / count, b = from + sweep * (k + 1) / count;
      all.emplace_back(centre + radius * Vector2d(std::cos(a), std::sin(a)),
                       centre + radius * Vector2d(std::cos(b), std::sin(b)));
    }
  }
  return all;
}

double distance_to_triangle(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a, n = ab.cross(ac);
  if (n.squaredNorm() > 1e-18) {
    const Vector3d q = p - n * (n.dot(p - a) / n.squaredNorm());
    const bool inside =
        n.dot(ab.cross(q - a)) >= 0 && n.dot((c - b).cross(q - b)) >= 0 && n.dot((a - c).cross(q - c)) >= 0;
    if (inside) return (p - q).norm();
  }
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [s, e] : {std::pair(a, b), {b, c}, {c, a}}) {
    const Vector3d along = e - s;
    const double share = along.squaredNorm() > 0 ? std::clamp((p - s).dot(along) / along.squaredNorm(), 0.0, 1.0) : 0;
    least = std::min(least, (s + share * along - p).norm());
  }
  return least;
}

}  // namespace

TriangleMesh mesh_of(const Box& b) {
  TriangleMesh mesh;
  const Rotation R = Rotation::from_heading_pitch_roll(b.heading, b.pitch, b.roll);
  const auto corner = [&](int x, int y, int z) -> Vector3d {
    return b.centre + R * Vector3d(b.size.cwiseProduct(Vector3d(x - 0.5, y - 0.5, z - 0.5)));
  };
  quad(mesh, corner(0, 0, 0), corner(1, 0, 0), corner(1, 1, 0), corner(0, 1, 0));
  quad(mesh, corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1));
  quad(mesh, corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1));
  quad(mesh, corner(0, 1, 0), corner(1, 1, 0), corner(1, 1, 1), corner(0, 1, 1));
  quad(mesh, corner(0, 0, 0), corner(0, 1, 0), corner(0, 1, 1), corner(0, 0, 1));
  quad(mesh, corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1), corner(1, 0, 1));
  return mesh;
}

TriangleMesh mesh_of(const Wall& w) {
  TriangleMesh mesh;
  const std::vector<Vector2d> top = corners(w.line);
  const std::vector<Vector2d> foot = moved_aside(top, (w.bottom - w.top) * std::tan(w.batter.radians()));
  const auto at = [](const Vector2d& p, double z) { return Vector3d(p.x(), p.y(), z); };
  for (std::size_t i = 0; i + 1 < top.size(); ++i) {
    quad(mesh, at(top[i], w.top), at(top[i + 1], w.top), at(foot[i + 1], w.bottom), at(foot[i], w.bottom));
  }
  return mesh;
}

TriangleMesh mesh_of(const Prism& p) {
  TriangleMesh mesh;
  const auto all = chords(p);
  AlignedBox2d box;
  for (const auto& [a, b] : all) box.extend(a).extend(b);
  const auto foot = [&](const Vector2d& q) -> Vector2d { return box.center() + p.bottom_scale * (q - box.center()); };
  const auto at = [](const Vector2d& q, double z) { return Vector3d(q.x(), q.y(), z); };
  for (const auto& [a, b] : all) quad(mesh, at(a, p.top), at(b, p.top), at(foot(b), p.bottom), at(foot(a), p.bottom));
  return mesh;
}

TriangleMesh mesh_of(const Mesh& m, const Place& place) {
  TriangleMesh mesh = load_mesh(m.file, m.scale, place);
  const Rotation R = Rotation::from_heading_pitch_roll(m.heading, m.pitch, m.roll);
  for (Vector3f& v : mesh.vertices) {
    const Vector3d p = m.z_up ? Vector3d(v.y(), v.x(), -v.z()) : v.cast<double>();
    v = (m.position + R * p).cast<float>();
  }
  return mesh;
}

std::vector<Polygon> plan_of(const TriangleMesh& mesh) {
  std::vector<Polygon> parts;
  if (mesh.triangles.size() > 2000) return parts;                   // too fine to draw
  for (std::size_t i = 0; i + 1 < mesh.triangles.size(); i += 2) {  // quads
    std::vector<Vector2d> points;
    for (const std::size_t t : {i, i + 1}) {
      for (int k = 0; k < 3; ++k) points.push_back(mesh.vertices[mesh.triangles[t][k]].head<2>().cast<double>());
    }
    parts.push_back(convex_hull(std::move(points)));
  }
  return parts;
}

double distance(const TriangleMesh& mesh, const Vector3d& p) {
  double least = std::numeric_limits<double>::infinity();
  const auto vertex = [&mesh](int v) -> Vector3d { return mesh.vertices[v].cast<double>(); };
  for (const Vector3i& t : mesh.triangles) {
    least = std::min(least, distance_to_triangle(p, vertex(t[0]), vertex(t[1]), vertex(t[2])));
  }
  return least;
}

}  // namespace isobath
