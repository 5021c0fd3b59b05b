#include <isobath/sim/echo_paths.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;

constexpr double kSurfaceLoss = 0.7;  ///< intensity kept in a bounce off a rough surface (APL-UW TR 9407, about 1.5 dB)
constexpr double kMinChange = 0.07;   ///< relative change of range within a cell above which the cell is divided
constexpr int kMaxPieces = 64;
constexpr double kTilt = 0.6;  ///< largest depth of a cell along the ray, as a share of the range

double power_of_db(double db) { return std::pow(10, db / 10); }

Vector3d any_tangent(const Vector3d& n) {
  return std::abs(n.z()) < 0.7 ? Vector3d(-n.y(), n.x(), 0).normalized() : Vector3d(0, -n.z(), n.y()).normalized();
}

}  // namespace

EchoPaths::EchoPaths(const SonarConfig& sonar, const World& scene_world, const Water& scene_water)
    : config(sonar),
      world(scene_world),
      water(scene_water),
      view(sonar),
      head_reflection(power_of_db(sonar.head_reflection_db)),
      volume_strength(power_of_db(scene_water.config().volume_scattering_db)),
      sea(scene_water.config().wind, sonar.frequency) {
  scatterers.emplace_back(world.material(kBottom));
  for (const WorldBody& body : world.bodies()) scatterers.emplace_back(*body.material);
}

void EchoPaths::begin_ping(const Pose& sonar_in_world) {
  X_WS = sonar_in_world;
  R_WS = X_WS.rotation.matrix();
  absorb = water.absorption_db(config.frequency, std::max(0.0, X_WS.translation.z())) * std::log(10.0) / 10;
}

EchoSpan EchoPaths::span_of(const ViewCell& cell, double range, const Vector3d& u, const Vector3d& across,
                            const Vector3d& up, const Vector3d& normal) {
  const double straight = normal.dot(u);
  const double slant_across = cell.half_across * normal.dot(across), slant_up = cell.half_up * normal.dot(up);
  const double tilt = std::min(std::abs(slant_across) + std::abs(slant_up), kTilt * std::abs(straight));
  return {range * straight / (straight - tilt), range * straight / (straight + tilt)};
}

double EchoPaths::sigma_of(const ViewCell& cell, double range, const RayHit& hit, const Vector3d& v) const {
  const double size = std::max(2 * cell.half_across, 2 * cell.half_up);  // change of the ray within the cell, rad
  if (hit.curvature == 0) return scatterer(hit.target)(v, hit.normal, any_tangent(hit.normal), size, size);
  const double cosine = std::max(-hit.normal.dot(v), 0.2);
  const double bent = size * (1 + range * hit.curvature / cosine);
  if (hit.straight.isZero()) return scatterer(hit.target)(v, hit.normal, any_tangent(hit.normal), bent, bent);
  return scatterer(hit.target)(v, hit.normal, hit.straight, size, bent);
}

double EchoPaths::echo(const ViewCell& cell, double range, const RayHit& hit, const Vector3d& u) const {
  const double cosine = std::max(-hit.normal.dot(u), kMinCosine);
  return cell.gain * attenuation(2 * range) * sigma_of(cell, range, hit, u) * cell.solid_angle /
         (cosine * range * range);
}

EchoPath EchoPaths::bounce(int mirror_target) {
  return mirror_target == kSurface  ? EchoPath::kSurfaceBounce
         : mirror_target == kBottom ? EchoPath::kBottomBounce
                                    : EchoPath::kBodyBounce;
}

double EchoPaths::reflection(int target) const { return target == kSurface ? kSurfaceLoss : scatterer(target).mirror; }

void EchoPaths::trace(const ViewCell& cell, int only, double& open_range, std::vector<PathEcho>& echoes) const {
  const Vector3d p = X_WS.translation, u = R_WS * cell.u;
  const double reach = 3 * config.range_m;  // part of a cell can be much nearer than its middle
  const double to_surface = u.z() < -1e-9 && p.z() > 0 ? -p.z() / u.z() : 1e30;
  const auto hit = world.cast(p, u, std::min(reach, to_surface));
  if (!hit) {
    open_range = std::min(reach, to_surface);
    if (only == kNothing && to_surface < 4 * reach) meet_surface(cell, p, u, to_surface, echoes);
    return;
  }
  open_range = hit->range;
  if (only != kNothing ? hit->target != only : has_own_cells(hit->target)) return;
  const Vector3d across_W = R_WS * cell.across, up_W = R_WS * cell.up;
  const bool silent = hit->target == kBottom && !config.bottom_reverberation;
  pieces(cell, hit->range, u, up_W, hit->normal,
         [&](const ViewCell& piece, double range, const Vector3d& v, const Vector3d& up) {
           const EchoSpan span = span_of(piece, range, v, across_W, up, hit->normal);
           const double k = stretch(p.z() + range * v.z());
           const EchoSpan read{k * span.near, k * span.far};
           if (too_far(read)) return;
           if (!silent)
             echoes.push_back({read, echo(piece, range, *hit, v), EchoLabel(hit->target, EchoPath::kDirect)});
           if (config.multiple) repeat(piece, range, *hit, v, read, echoes);
         });
  if (only == kNothing && (hit->target == kBottom ? config.bottom_bounce : config.body_bounce)) {
    go_on(cell, p, u, hit->range, hit->normal, hit->target, echoes);
  }
}

void EchoPaths::over_mirror(const ViewCell& cell, int target, double mirror_z, int mirror_target,
                            std::vector<PathEcho>& echoes) const {
  const Vector3d p = X_WS.translation, u = R_WS * cell.u;
  const double first = (mirror_z - p.z()) / u.z();
  if (!(first > 0) || first > config.range_m || world.blocked(p, u, first * (1 - 1e-4) - 1e-3)) return;
  const Vector3d q = p + first * u;
  const auto reflect = [](const Vector3d& v) { return Vector3d(v.x(), v.y(), -v.z()); };
  const Vector3d v = reflect(u), off = 1e-3 * Vector3d(0, 0, mirror_target == kSurface ? 1 : -1);
  const auto hit = world.cast(q + off, v, 2 * config.range_m - first);
  if (!hit || hit->target != target) return;
  follow(cell, p, q, v, first, *hit, reflect(R_WS * cell.across), reflect(R_WS * cell.up), reflection(mirror_target),
         bounce(mirror_target), echoes);
}

template <class Visit>
void EchoPaths::pieces(const ViewCell& cell, double range, const Vector3d& u, const Vector3d& up,
                       const Vector3d& normal, const Visit& visit) const {
  const double straight = -normal.dot(u), across_up = std::abs(2 * cell.half_up * normal.dot(up));
  // All of it is beyond the window: kTilt and the speed of sound bring an echo nearer by less than one half.
  if (straight * range > 2 * (config.range_m + config.resolution_m) * (straight + across_up)) return;
  const double change = across_up / std::max(straight, 1e-6);
  const double loudest = 0.003 * cell.gain * attenuation(2 * range) * cell.solid_angle / (range * range);
  if (change < kMinChange || loudest < floor) return visit(cell, range, u, up);
  const double bins = change * range / bin_m();
  if (bins < 1) return visit(cell, range, u, up);
  const int count = std::min(kMaxPieces, 1 + static_cast<int>(std::min(change / kMinChange, bins)));
  ViewCell piece = cell;
  piece.half_up /= count;
  piece.solid_angle /= count;
  for (int i = 0; i < count; ++i) {
    const double offset = cell.half_up * ((2.0 * i + 1) / count - 1);
    const double square = offset * offset;  // cells are small: the series are exact to 1e-6
    const double cosine = 1 - square * (0.5 - square / 24), sine = offset * (1 - square * (1.0 / 6 - square / 120));
    const Vector3d v = cosine * u + sine * up;
    const double towards = -normal.dot(v), r = straight * range / std::max(towards, 1e-9);
    if (towards < 1e-4 || r > 2 * config.range_m) continue;  // over the horizon
    piece.elevation = cell.elevation + offset;
    piece.gain = view.height.gain(piece.elevation);
    visit(piece, r, v, Vector3d(cosine * up - sine * u));
  }
}

void EchoPaths::meet_surface(const ViewCell& cell, const Vector3d& p, const Vector3d& u, double range,
                             std::vector<PathEcho>& echoes) const {
  const Vector3d normal(0, 0, 1);
  if (config.surface_reverberation) {
    const double k = stretch(0);
    const Vector3d across_W = R_WS * cell.across, up_W = R_WS * cell.up;
    pieces(cell, range, u, up_W, normal, [&](const ViewCell& piece, double r, const Vector3d& v, const Vector3d& up) {
      const EchoSpan span = span_of(piece, r, v, across_W, up, normal);
      const EchoSpan read{k * span.near, k * span.far};
      if (too_far(read)) return;
      const double sine = std::max(-v.z(), kMinCosine);
      const double sigma = sea(sine);
      echoes.push_back({read, piece.gain * attenuation(2 * r) * sigma * piece.solid_angle / (sine * r * r),
                        EchoLabel(kSurface, EchoPath::kDirect)});
    });
  }
  if (config.surface_bounce) go_on(cell, p, u, range, normal, kSurface, echoes);
}

void EchoPaths::repeat(const ViewCell& cell, double range, const RayHit& hit, const Vector3d& u, const EchoSpan& read,
                       std::vector<PathEcho>& echoes) const {
  if (-hit.normal.dot(u) < 0.9) return;
  const double again = 0.25 * scatterer(hit.target).mirror * head_reflection;
  echoes.push_back({EchoSpan{2 * read.near, 2 * read.far},
                    echo(cell, range, hit, u) * cell.gain * again * attenuation(2 * range),
                    EchoLabel(hit.target, EchoPath::kMultiple)});
}

void EchoPaths::go_on(const ViewCell& cell, const Vector3d& p, const Vector3d& u, double first, const Vector3d& mirror,
                      int mirror_target, std::vector<PathEcho>& echoes) const {
  const double kept = reflection(mirror_target);
  const double best = cell.gain * kept * attenuation(2 * first) * cell.solid_angle / (first * first);  // at sigma 1
  if (best < 0.01 * floor || first > config.range_m) return;
  const auto reflect = [&mirror](const Vector3d& v) -> Vector3d { return v - 2 * v.dot(mirror) * mirror; };
  const Vector3d q = p + first * u, v = reflect(u);
  const double to_surface = v.z() < -1e-9 ? -q.z() / v.z() : 1e30;
  const auto hit = world.cast(q + 1e-3 * mirror, v, std::min(2 * config.range_m - first, to_surface));
  if (!hit || has_own_cells(hit->target)) return;
  follow(cell, p, q, v, first, *hit, reflect(R_WS * cell.across), reflect(R_WS * cell.up), kept, bounce(mirror_target),
         echoes);
}

void EchoPaths::follow(const ViewCell& cell, const Vector3d& p, const Vector3d& q, const Vector3d& v, double first,
                       const RayHit& hit, const Vector3d& across_v, const Vector3d& up_v, double kept, EchoPath path,
                       std::vector<PathEcho>& echoes) const {
  const double range = first + hit.range;
  const Vector3d at = q + hit.range * v;
  const double k = stretch(at.z());
  const EchoSpan span = span_of(cell, range, v, across_v, up_v, hit.normal);
  const EchoLabel label(hit.target, path);
  pieces(cell, range, v, up_v, hit.normal, [&](const ViewCell& piece, double r, const Vector3d& w, const Vector3d& up) {
    const EchoSpan there = span_of(piece, r, w, across_v, up, hit.normal);
    const EchoSpan read{k * there.near, k * there.far};
    if (!too_far(read)) echoes.push_back({read, kept * kept * echo(piece, r, hit, w), label});
  });
  const Vector3d back = at - p;
  const double d = back.norm();
  const double cosine = std::max(-hit.normal.dot(v), kMinCosine), cosine_back = -hit.normal.dot(back) / d;
  if (cosine_back <= 0 || path == EchoPath::kBodyBounce || 0.5 * (range + d) > config.range_m) return;
  const Vector3d w_S = R_WS.transpose() * back / d;
  const double gain = std::sqrt(cell.gain * view.height.gain(std::asin(std::clamp(-w_S.z(), -1.0, 1.0))));
  const double sigma = std::sqrt(sigma_of(cell, range, hit, v) * sigma_of(cell, range, hit, back / d));
  const double power = 2 * gain * kept * sigma * cell.solid_angle / (cosine * d * d) * attenuation(range + d);
  if (power < 0.01 * floor || world.blocked(p, back / d, d * (1 - 1e-4) - 1e-3)) return;
  const double shift = 0.5 * (range + d) - range;
  echoes.push_back({{k * (span.near + shift), k * (span.far + shift)}, power, label});
}

}  // namespace isobath
