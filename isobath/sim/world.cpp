#include <algorithm>
#include <cmath>
#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <isobath/sim/exact_shape.hpp>
#include <isobath/sim/triangle_mesh.hpp>
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

constexpr float kStart = 1e-4f;  // m: offset by which a ray leaves a surface without a second hit

void bounds_of(const RTCBoundsFunctionArguments* args) {
  const AlignedBox3d box = static_cast<const ExactShape*>(args->geometryUserPtr)->box();
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

/// Normalises the direction: in single precision its length is not quite 1, which matters for small, distant spheres.
std::optional<Meeting> meet_along(const ExactShape& shape, const RTCRay& ray) {
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
  const ExactShape& shape = *static_cast<const ExactShape*>(args->geometryUserPtr);
  const auto found = meet_along(shape, both->ray);
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
  const ExactShape& shape = *static_cast<const ExactShape*>(args->geometryUserPtr);
  if (meet_along(shape, *ray)) ray->tfar = -std::numeric_limits<float>::infinity();
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
                "repair the mesh, or set allow_holes = true");
  }
  return mesh;
}

Polygon circle(const Vector2d& centre, double radius) {
  Polygon points;
  for (int i = 0; i < 24; ++i) {
    const double a = 2 * std::numbers::pi * i / 24;
    points.push_back(centre + radius * Vector2d(std::cos(a), std::sin(a)));
  }
  return points;
}

}  // namespace

struct World::State {
  RTCDevice device = nullptr;
  RTCScene top = nullptr;
  const Scene* scene = nullptr;
  const Material* bottom_material = nullptr;
  std::vector<WorldBody> bodies;
  std::vector<std::unique_ptr<ExactShape>> exact;           ///< by target; null: triangles
  std::vector<TriangleMesh> meshes;                         ///< by target; empty if exact
  std::vector<RTCScene> inner;                              ///< scenes of moving bodies
  std::vector<int> target;                                  ///< by geometry of the top scene
  std::vector<std::pair<std::size_t, RTCGeometry>> moving;  ///< body, instance
  std::string nothing = "nothing", surface = "surface", bottom = "bottom";

  ~State() {
    for (RTCScene s : inner) rtcReleaseScene(s);
    if (top) rtcReleaseScene(top);
    if (device) rtcReleaseDevice(device);
  }

  RTCGeometry geometry(const ExactShape& shape) const {
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(g, 1);
    rtcSetGeometryUserData(g, const_cast<ExactShape*>(&shape));
    rtcSetGeometryBoundsFunction(g, bounds_of, nullptr);
    rtcSetGeometryIntersectFunction(g, intersect_exact);
    rtcSetGeometryOccludedFunction(g, occluded_exact);
    return g;
  }

  RTCGeometry geometry(const TriangleMesh& mesh) const {
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
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

  /// Adds the geometry of a target to the world; a moving body gets a scene of its own.
  void place(RTCGeometry g, int of, bool moves) {
    rtcCommitGeometry(g);
    if (moves) {
      RTCScene own = rtcNewScene(device);
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

  void add_body(const Body& body, std::string name, std::optional<ExactShape> shape, TriangleMesh mesh) {
    WorldBody made;
    made.body = &body;
    made.name = std::move(name);
    made.material = scene->material(body.material);
    made.moves = body.path.size() >= 8;
    if (shape) {
      made.box = shape->box();
      made.plan = {circle(shape->centre.head<2>(), shape->radius)};
      if (shape->kind == ExactShape::Kind::kCylinder && std::abs(shape->axis.z()) < 0.999) {
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
    exact.push_back(shape ? std::make_unique<ExactShape>(*shape) : nullptr);
    meshes.push_back(std::move(mesh));
    const int of = kFirstBody + static_cast<int>(bodies.size()) - 1;
    place(exact.back() ? geometry(*exact.back()) : geometry(meshes.back()), of, bodies.back().moves);
  }

  void add_body(const Body& body) {
    using K = ExactShape::Kind;
    if (const auto* c = std::get_if<Cylinder>(&body.shape)) {
      return add_body(body, body.name,
                      ExactShape{K::kCylinder, c->centre, c->axis.normalized(), c->radius, c->length / 2}, {});
    }
    if (const auto* s = std::get_if<Sphere>(&body.shape)) {
      return add_body(body, body.name, ExactShape{K::kSphere, s->centre, Vector3d::UnitZ(), s->radius, 0}, {});
    }
    if (const auto* p = std::get_if<Pylons>(&body.shape)) {
      for (int i = 0; i < p->count; ++i) {
        const Vector2d at = p->first + i * p->step;
        const Vector3d centre(at.x(), at.y(), 0.5 * (p->top + p->bottom));
        add_body(body, fmt::format("{}.{}", body.name, i + 1),
                 ExactShape{K::kCylinder, centre, Vector3d::UnitZ(), p->radius, 0.5 * (p->bottom - p->top)}, {});
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
      exact[0] = std::make_unique<ExactShape>(
          ExactShape{ExactShape::Kind::kPlane, {0, 0, c.depth}, Vector3d::UnitZ(), 0, c.extent_m});
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
  rtcSetSceneFlags(s.top, RTC_SCENE_FLAG_ROBUST);  // no ray passes between two adjacent triangles
  s.add_bottom();
  for (const Body& body : scene.bodies) s.add_body(body);
  rtcCommitScene(s.top);
}

World::~World() = default;

void World::move_to(double t_s) {
  bool moved = false;
  for (const auto& [body, instance] : state_->moving) {
    WorldBody& b = state_->bodies[body];
    const Vector3d to = displacement(*b.body, t_s);
    if (to == b.moved) continue;
    b.moved = to;
    State::set_place(instance, to);
    moved = true;
  }
  if (moved) rtcCommitScene(state_->top);  // rebuilds the top-level tree
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
  if (const ExactShape* shape = state_->exact[static_cast<std::size_t>(hit.target - kBottom)].get();
      shape && shape->radius > 0) {
    const bool cylinder = shape->kind == ExactShape::Kind::kCylinder;
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
    p.z() += 1e-3;  // continue below a body above the bottom
    left -= hit->range;
  }
  return std::nullopt;
}

double World::distance(int index, const Vector3d& p_W) const {
  const auto i = static_cast<std::size_t>(index);
  const Vector3d p = p_W - state_->bodies[i].moved;
  if (const ExactShape* e = state_->exact[i + 1].get()) {
    const Vector3d m = p - e->centre;
    if (e->kind == ExactShape::Kind::kSphere) return m.norm() - e->radius;
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
  return isobath::distance(state_->meshes[i + 1], p);
}

}  // namespace isobath
