#include <algorithm>
#include <cmath>
#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <functional>
#include <isobath/sim/world.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::AlignedBox2d;
using Eigen::AlignedBox3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr float kStart = 1e-4f;  // m: a ray that leaves a surface does not meet it again

/// A shape with an intersection of its own.
struct Exact {
  enum class Kind { kSphere, kCylinder, kPlane } kind;
  Vector3d centre, axis = Vector3d::UnitZ();
  double radius = 0, half = 0;  ///< of a plane: half is half its side

  [[nodiscard]] AlignedBox3d box() const {
    Vector3d reach = Vector3d::Constant(radius);
    if (kind == Kind::kCylinder) {
      for (int i = 0; i < 3; ++i)
        reach[i] = half * std::abs(axis[i]) + radius * std::sqrt(std::max(0.0, 1 - axis[i] * axis[i]));
    }
    if (kind == Kind::kPlane) reach = {half, half, 0.01};
    return {centre - reach, centre + reach};
  }
};

struct Meeting {
  double range;
  Vector3d normal;
};

std::optional<Meeting> meet_sphere(const Exact& s, const Vector3d& p, const Vector3d& u, double near, double far) {
  const Vector3d m = p - s.centre;
  const double b = m.dot(u), c = m.squaredNorm() - s.radius * s.radius, d = b * b - c;
  if (d < 0) return std::nullopt;
  for (const double t : {-b - std::sqrt(d), -b + std::sqrt(d)}) {
    if (t > near && t < far) return Meeting{t, (m + t * u) / s.radius};
  }
  return std::nullopt;
}

std::optional<Meeting> meet_cylinder(const Exact& s, const Vector3d& p, const Vector3d& u, double near, double far) {
  const Vector3d m = p - s.centre;
  const double along_m = m.dot(s.axis), along_u = u.dot(s.axis);
  const Vector3d across_m = m - along_m * s.axis, across_u = u - along_u * s.axis;
  std::optional<Meeting> best;
  const auto take = [&](double t, const Vector3d& normal) {
    if (t > near && t < far && (!best || t < best->range)) best = Meeting{t, normal};
  };
  const double a = across_u.squaredNorm();
  if (a > 1e-14) {
    const double b = across_m.dot(across_u), c = across_m.squaredNorm() - s.radius * s.radius, d = b * b - a * c;
    if (d >= 0) {
      for (const double t : {(-b - std::sqrt(d)) / a, (-b + std::sqrt(d)) / a}) {
        if (std::abs(along_m + t * along_u) <= s.half) take(t, (across_m + t * across_u) / s.radius);
      }
    }
  }
  if (std::abs(along_u) > 1e-12) {
    for (const double end : {-s.half, s.half}) {
      const double t = (end - along_m) / along_u;
      if ((across_m + t * across_u).squaredNorm() <= s.radius * s.radius) take(t, end > 0 ? s.axis : -s.axis);
    }
  }
  return best;
}

std::optional<Meeting> meet_plane(const Exact& s, const Vector3d& p, const Vector3d& u, double near, double far) {
  if (std::abs(u.z()) < 1e-12) return std::nullopt;
  const double t = (s.centre.z() - p.z()) / u.z();
  if (!(t > near && t < far)) return std::nullopt;
  if (std::abs(p.x() + t * u.x() - s.centre.x()) > s.half || std::abs(p.y() + t * u.y() - s.centre.y()) > s.half) {
    return std::nullopt;
  }
  return Meeting{t, Vector3d::UnitZ()};
}

std::optional<Meeting> meet(const Exact& s, const Vector3d& p, const Vector3d& u, double near, double far) {
  switch (s.kind) {
    case Exact::Kind::kSphere: return meet_sphere(s, p, u, near, far);
    case Exact::Kind::kCylinder: return meet_cylinder(s, p, u, near, far);
    case Exact::Kind::kPlane: return meet_plane(s, p, u, near, far);
  }
  return std::nullopt;
}

void bounds_of(const RTCBoundsFunctionArguments* args) {
  const AlignedBox3d box = static_cast<const Exact*>(args->geometryUserPtr)->box();
  RTCBounds& b = *args->bounds_o;
  const auto down = [](double v) { return static_cast<float>(v - 1e-3 - 1e-6 * std::abs(v)); };
  const auto up = [](double v) { return static_cast<float>(v + 1e-3 + 1e-6 * std::abs(v)); };
  b.lower_x = down(box.min().x());
  b.lower_y = down(box.min().y());
  b.lower_z = down(box.min().z());
  b.upper_x = up(box.max().x());
  b.upper_y = up(box.max().y());
  b.upper_z = up(box.max().z());
}

/// Directions in single precision are not quite of length one, which a small sphere far away would feel.
std::optional<Meeting> meet(const Exact& shape, const RTCRay& ray) {
  const Vector3d p(ray.org_x, ray.org_y, ray.org_z), v(ray.dir_x, ray.dir_y, ray.dir_z);
  const double length = v.norm();
  auto found =
      meet(shape, p, v / length, static_cast<double>(ray.tnear) * length, static_cast<double>(ray.tfar) * length);
  if (found) found->range /= length;
  return found;
}

void intersect_exact(const RTCIntersectFunctionNArguments* args) {
  if (!args->valid[0]) return;
  auto* both = reinterpret_cast<RTCRayHit*>(args->rayhit);
  const Exact& shape = *static_cast<const Exact*>(args->geometryUserPtr);
  const auto found = meet(shape, both->ray);
  if (!found) return;
  both->ray.tfar = static_cast<float>(found->range);
  both->hit.Ng_x = static_cast<float>(found->normal.x());
  both->hit.Ng_y = static_cast<float>(found->normal.y());
  both->hit.Ng_z = static_cast<float>(found->normal.z());
  both->hit.geomID = args->geomID;
  both->hit.primID = args->primID;
  both->hit.instID[0] = args->context->instID[0];
}

void occluded_exact(const RTCOccludedFunctionNArguments* args) {
  if (!args->valid[0]) return;
  auto* ray = reinterpret_cast<RTCRay*>(args->ray);
  const Exact& shape = *static_cast<const Exact*>(args->geometryUserPtr);
  if (meet(shape, *ray)) ray->tfar = -std::numeric_limits<float>::infinity();
}

// Shapes as triangles ------------------------------------------------------------------------------------------------

int add(TriangleMesh& mesh, const Vector3d& v) {
  mesh.vertices.push_back(v.cast<float>());
  return static_cast<int>(mesh.vertices.size()) - 1;
}
void quad(TriangleMesh& mesh, const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  const int i = add(mesh, a), j = add(mesh, b), k = add(mesh, c), l = add(mesh, d);
  mesh.triangles.push_back({i, j, k});
  mesh.triangles.push_back({i, k, l});
}

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

/// The corners of a polyline moved to the right by `aside`, mitred.
std::vector<Vector2d> moved_aside(const std::vector<Vector2d>& line, double aside) {
  std::vector<Vector2d> out;
  const auto right = [&](std::size_t i) -> Vector2d {
    const Vector2d along = (line[i + 1] - line[i]).normalized();
    return {-along.y(), along.x()};  // north, east: right of the way
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

TriangleMesh bottom_mesh(const BottomConfig& c) {
  if (c.kind == BottomKind::kTerrain) return terrain_mesh(c);
  if (c.kind == BottomKind::kRaster) return raster_mesh(c);
  TriangleMesh mesh = load_mesh(c.file, c.scale, c.place);
  AlignedBox3d box;
  for (Vector3f& v : mesh.vertices) {
    v = Vector3f(v.y(), v.x(), -v.z() + static_cast<float>(c.depth));  // east-north-up to north-east-down
    box.extend(v.cast<double>());
  }
  const Vector3d to(c.centred ? box.center().x() : c.origin.y(), c.centred ? box.center().y() : c.origin.x(), 0);
  for (Vector3f& v : mesh.vertices) v -= to.cast<float>();
  const int count = c.allow_holes ? 0 : holes(mesh);
  if (count > 0) {
    Place place = c.place;
    place.key += ".file";
    throw Error(fmt::format("the bottom has holes: {} border lines within its outline", count), place, "",
                "mend the mesh, or set allow_holes = true");
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

Polygon circle(const Vector2d& centre, double radius) {
  Polygon points;
  for (int i = 0; i < 24; ++i) {
    const double a = 2 * std::numbers::pi * i / 24;
    points.push_back(centre + radius * Vector2d(std::cos(a), std::sin(a)));
  }
  return points;
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

struct World::State {
  RTCDevice device = nullptr;
  RTCScene top = nullptr;
  const Scene* scene = nullptr;
  const Material* bottom_material = nullptr;
  std::vector<WorldBody> bodies;
  std::vector<std::unique_ptr<Exact>> exact;                ///< of every target; null: triangles
  std::vector<TriangleMesh> meshes;                         ///< of every target; empty where exact
  std::vector<RTCScene> inner;                              ///< of bodies that move
  std::vector<int> target;                                  ///< by geometry of the top scene
  std::vector<std::pair<std::size_t, RTCGeometry>> moving;  ///< body, instance
  std::string nothing = "nothing", surface = "surface", bottom = "bottom";

  ~State() {
    for (const RTCScene s : inner) rtcReleaseScene(s);
    if (top) rtcReleaseScene(top);
    if (device) rtcReleaseDevice(device);
  }

  RTCGeometry geometry(const Exact& shape) const {
    const RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(g, 1);
    rtcSetGeometryUserData(g, const_cast<Exact*>(&shape));
    rtcSetGeometryBoundsFunction(g, bounds_of, nullptr);
    rtcSetGeometryIntersectFunction(g, intersect_exact);
    rtcSetGeometryOccludedFunction(g, occluded_exact);
    return g;
  }

  RTCGeometry geometry(const TriangleMesh& mesh) const {
    const RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), mesh.vertices.size()));
    for (const Vector3f& v : mesh.vertices) vertices = std::copy_n(v.data(), 3, vertices);
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), mesh.triangles.size()));
    for (const Vector3i& t : mesh.triangles) {
      for (int k = 0; k < 3; ++k) *indices++ = static_cast<unsigned>(t[k]);
    }
    return g;
  }

  /// Puts a geometry that belongs to a target into the world; a body that moves gets a scene of its own.
  void place(RTCGeometry g, int of, bool moves) {
    rtcCommitGeometry(g);
    if (moves) {
      const RTCScene own = rtcNewScene(device);
      rtcAttachGeometry(own, g);
      rtcReleaseGeometry(g);
      rtcCommitScene(own);
      inner.push_back(own);
      g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
      rtcSetGeometryInstancedScene(g, own);
      rtcSetGeometryTimeStepCount(g, 1);
      moving.emplace_back(static_cast<std::size_t>(of - kFirstBody), g);
      set_place(g, Vector3d::Zero());
    }
    rtcAttachGeometry(top, g);
    rtcReleaseGeometry(g);
    target.push_back(of);
  }

  static void set_place(RTCGeometry instance, const Vector3d& moved) {
    const std::array<float, 12> transform{1,
                                          0,
                                          0,
                                          0,
                                          1,
                                          0,
                                          0,
                                          0,
                                          1,
                                          static_cast<float>(moved.x()),
                                          static_cast<float>(moved.y()),
                                          static_cast<float>(moved.z())};
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, transform.data());
    rtcCommitGeometry(instance);
  }

  void add_body(const Body& body, std::string name, std::optional<Exact> shape, TriangleMesh mesh) {
    WorldBody made;
    made.body = &body;
    made.name = std::move(name);
    made.material = scene->material(body.material);
    made.moves = body.path.size() >= 8;
    if (shape) {
      made.box = shape->box();
      made.plan = {circle(shape->centre.head<2>(), shape->radius)};
      if (shape->kind == Exact::Kind::kCylinder && std::abs(shape->axis.z()) < 0.999) {
        const Vector3d half = shape->half * shape->axis;
        auto ends = circle((shape->centre - half).head<2>(), shape->radius);
        const auto other = circle((shape->centre + half).head<2>(), shape->radius);
        ends.insert(ends.end(), other.begin(), other.end());
        made.plan = {convex_hull(std::move(ends))};
      }
    } else {
      for (const Vector3f& v : mesh.vertices) made.box.extend(v.cast<double>());
      made.plan = plan_of(mesh);
    }
    bodies.push_back(std::move(made));
    exact.push_back(shape ? std::make_unique<Exact>(*shape) : nullptr);
    meshes.push_back(std::move(mesh));
    const int of = kFirstBody + static_cast<int>(bodies.size()) - 1;
    place(exact.back() ? geometry(*exact.back()) : geometry(meshes.back()), of, bodies.back().moves);
  }

  void add_body(const Body& body) {
    using K = Exact::Kind;
    if (const auto* c = std::get_if<Cylinder>(&body.shape)) {
      return add_body(body, body.name, Exact{K::kCylinder, c->centre, c->axis.normalized(), c->radius, c->length / 2},
                      {});
    }
    if (const auto* s = std::get_if<Sphere>(&body.shape)) {
      return add_body(body, body.name, Exact{K::kSphere, s->centre, Vector3d::UnitZ(), s->radius, 0}, {});
    }
    if (const auto* p = std::get_if<Pylons>(&body.shape)) {
      for (int i = 0; i < p->count; ++i) {
        const Vector2d at = p->first + i * p->step;
        const Vector3d centre(at.x(), at.y(), 0.5 * (p->top + p->bottom));
        add_body(body, fmt::format("{}.{}", body.name, i + 1),
                 Exact{K::kCylinder, centre, Vector3d::UnitZ(), p->radius, 0.5 * (p->bottom - p->top)}, {});
      }
      return;
    }
    if (const auto* b = std::get_if<Box>(&body.shape)) return add_body(body, body.name, {}, mesh_of(*b));
    if (const auto* w = std::get_if<Wall>(&body.shape)) return add_body(body, body.name, {}, mesh_of(*w));
    if (const auto* p = std::get_if<Prism>(&body.shape)) return add_body(body, body.name, {}, mesh_of(*p));
    add_body(body, body.name, {}, mesh_of(std::get<Mesh>(body.shape), body.place));
  }

  void add_bottom() {
    const BottomConfig& c = scene->bottom;
    bottom_material = scene->material(c.material);
    exact.push_back(nullptr);
    meshes.emplace_back();
    if (c.kind == BottomKind::kNone) return;
    if (c.kind == BottomKind::kFlat) {
      exact[0] = std::make_unique<Exact>(Exact{Exact::Kind::kPlane, {0, 0, c.depth}, Vector3d::UnitZ(), 0, c.extent_m});
      return place(geometry(*exact[0]), kBottom, false);
    }
    meshes[0] = bottom_mesh(c);
    place(geometry(meshes[0]), kBottom, false);
  }
};

World::World(const Scene& scene) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.scene = &scene;
  s.device = rtcNewDevice("threads=1,verbose=0");
  s.top = rtcNewScene(s.device);
  rtcSetSceneFlags(s.top, RTC_SCENE_FLAG_ROBUST);  // no ray slips through between two triangles
  s.add_bottom();
  for (const Body& body : scene.bodies) s.add_body(body);
  rtcCommitScene(s.top);
}

World::~World() = default;

void World::move_to(double t_s) {
  if (state_->moving.empty()) return;
  for (const auto& [body, instance] : state_->moving) {
    WorldBody& b = state_->bodies[body];
    b.moved = displacement(*b.body, t_s);
    State::set_place(instance, b.moved);
  }
  rtcCommitScene(state_->top);
}

namespace {

void fill(RTCRay& ray, const Vector3d& p, const Vector3d& u, double range) {
  ray.org_x = static_cast<float>(p.x());
  ray.org_y = static_cast<float>(p.y());
  ray.org_z = static_cast<float>(p.z());
  ray.dir_x = static_cast<float>(u.x());
  ray.dir_y = static_cast<float>(u.y());
  ray.dir_z = static_cast<float>(u.z());
  ray.tnear = kStart;
  ray.tfar = static_cast<float>(range);
  ray.time = 0;
  ray.mask = 0xffffffffu;
  ray.flags = 0;
}

}  // namespace

std::optional<RayHit> World::cast(const Vector3d& p, const Vector3d& u, double max_range) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit both;
  fill(both.ray, p, u, max_range);
  both.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  both.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(state_->top, &context, &both);
  if (both.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const unsigned outer = both.hit.instID[0] != RTC_INVALID_GEOMETRY_ID ? both.hit.instID[0] : both.hit.geomID;
  RayHit hit;
  hit.range = static_cast<double>(both.ray.tfar);
  hit.target = state_->target[outer];
  hit.normal = Vector3d(both.hit.Ng_x, both.hit.Ng_y, both.hit.Ng_z).normalized();
  if (hit.normal.dot(u) > 0) hit.normal = -hit.normal;
  if (const Exact* shape = state_->exact[static_cast<std::size_t>(hit.target - kBottom)].get();
      shape && shape->radius > 0) {
    const bool cylinder = shape->kind == Exact::Kind::kCylinder;
    const bool end = cylinder && std::abs(hit.normal.dot(shape->axis)) > 0.999;
    hit.curvature = end ? 0 : 1 / shape->radius;
    if (cylinder) hit.straight = shape->axis;
  }
  return hit;
}

bool World::blocked(const Vector3d& p, const Vector3d& u, double range) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray;
  fill(ray, p, u, range);
  rtcOccluded1(state_->top, &context, &ray);
  return ray.tfar < 0;
}

std::span<const WorldBody> World::bodies() const { return state_->bodies; }

const Material& World::material(int target) const {
  ISOBATH_ASSERT(target >= kBottom);
  return target == kBottom ? *state_->bottom_material
                           : *state_->bodies[static_cast<std::size_t>(target - kFirstBody)].material;
}

const std::string& World::name(int target) const {
  if (target == kNothing) return state_->nothing;
  if (target == kSurface) return state_->surface;
  if (target == kBottom) return state_->bottom;
  return state_->bodies[static_cast<std::size_t>(target - kFirstBody)].name;
}

std::optional<double> World::bottom_depth(double north, double east) const {
  constexpr double kAbove = -1000;
  Vector3d p(north, east, kAbove);
  for (double left = 20000; left > 0;) {
    const auto hit = cast(p, Vector3d::UnitZ(), left);
    if (!hit) return std::nullopt;
    p.z() += hit->range;
    if (hit->target == kBottom) return p.z();
    p.z() += 1e-3;  // through a body that stands above it
    left -= hit->range;
  }
  return std::nullopt;
}

double World::distance(int index, const Vector3d& p_W) const {
  const auto i = static_cast<std::size_t>(index);
  const Vector3d p = p_W - state_->bodies[i].moved;
  if (const Exact* e = state_->exact[i + 1].get()) {
    const Vector3d m = p - e->centre;
    if (e->kind == Exact::Kind::kSphere) return m.norm() - e->radius;
    const double along = std::abs(m.dot(e->axis)) - e->half;
    const double across = (m - m.dot(e->axis) * e->axis).norm() - e->radius;
    return along > 0 && across > 0 ? std::hypot(along, across) : std::max(along, across);
  }
  if (const auto* b = std::get_if<Box>(&state_->bodies[i].body->shape)) {
    const Rotation R = Rotation::from_heading_pitch_roll(b->heading, b->pitch, b->roll);
    const Vector3d out = (R.inverse() * Vector3d(p - b->centre)).cwiseAbs() - b->size / 2;
    const double inside = out.maxCoeff();
    return inside < 0 ? inside : out.cwiseMax(0.0).norm();
  }
  double least = std::numeric_limits<double>::infinity();
  const TriangleMesh& mesh = state_->meshes[i + 1];
  const auto vertex = [&mesh](int v) -> Vector3d { return mesh.vertices[v].cast<double>(); };
  for (const Vector3i& t : mesh.triangles) {
    least = std::min(least, distance_to_triangle(p, vertex(t[0]), vertex(t[1]), vertex(t[2])));
  }
  return least;
}

AlignedBox2d World::extent() const {
  AlignedBox2d box;
  for (const WorldBody& b : state_->bodies) {
    box.extend(Vector2d(b.box.min().head<2>())).extend(Vector2d(b.box.max().head<2>()));
  }
  for (const Vector3f& v : state_->meshes[0].vertices) box.extend(Vector2d(v.head<2>().cast<double>()));
  return box;
}

}  // namespace isobath
