#include <algorithm>
#include <cmath>
#include <isobath/base/split_work.hpp>
#include <isobath/sim/camera_simulator.hpp>
#include <isobath/sim/random_at.hpp>

namespace isobath {

using Eigen::Vector2d, Eigen::Vector3d;

Pose looking_ahead(const Pose& X_WB) {
  Eigen::Matrix3d R_BC;
  R_BC << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  return {X_WB.rotation * Rotation::from_matrix(R_BC), X_WB.translation};
}

namespace {

/// In 0..1, for a point of a lattice.
double lattice_value(std::uint64_t seed, std::int64_t x, std::int64_t y, std::int64_t z) {
  std::uint64_t key = seed;
  for (const std::int64_t k : {x, y, z}) key = Random(key ^ static_cast<std::uint64_t>(k)).bits();
  return static_cast<double>(key >> 11) * 0x1.0p-53;
}

/// Value noise: the values of a lattice, interpolated smoothly.
double value_noise(std::uint64_t seed, const Vector3d& p) {
  std::int64_t cell[3];
  double part[3];
  for (int k = 0; k < 3; ++k) {
    const double low = std::floor(p[k]), u = p[k] - low;
    cell[k] = static_cast<std::int64_t>(low);
    part[k] = u * u * (3 - 2 * u);
  }
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::int64_t at[3];
    for (int k = 0; k < 3; ++k) {
      const int up = corner >> k & 1;
      at[k] = cell[k] + up;
      weight *= up ? part[k] : 1 - part[k];
    }
    sum += weight * lattice_value(seed, at[0], at[1], at[2]);
  }
  return sum;
}

}  // namespace

Vector3d CameraSimulator::texture(const Vector3d& p_W) const {
  static constexpr double kWavelengths_m[5] = {0.01, 0.02, 0.04, 0.09, 0.2};
  Vector3d sum(0, 0, 0);
  for (std::uint64_t k = 0; k < 5; ++k) {
    const Vector3d scaled = p_W / kWavelengths_m[k];
    sum += Vector3d::Constant(0.75 * value_noise(seed_at(seed_, k, 9), scaled));
    if (k % 2 == 1) continue;  // two of five wavelengths have one hue
    for (int c = 0; c < 3; ++c) sum[c] += 0.4 * value_noise(seed_at(seed_, k, static_cast<std::uint64_t>(c)), scaled);
  }
  constexpr double kMean = 0.5 * (5 * 0.75 + 3 * 0.4);
  return ((sum.array() - kMean) * 0.32 + 0.5).cwiseMax(0.0).cwiseMin(1.0);
}

std::optional<Vector3d> CameraSimulator::first_hit(const Vector3d& p_W, const Vector3d& u_W) const {
  const auto hit = world_.cast(p_W, u_W, kFar);
  if (!hit) return {};
  return Vector3d(p_W + hit->range * u_W);
}

Vector3d CameraSimulator::colour(const CameraOptics& optics, const Pose& X_WC, const Vector2d& pixel) const {
  const Vector2d n = optics.model.normalised(pixel);
  FlatPort::Ray ray{{0, 0, 0}, Vector3d(n.x(), n.y(), 1).normalized()};
  if (optics.through_port) ray = optics.port.ray(n);
  const Vector3d from = X_WC * ray.origin, along = X_WC.rotation * ray.direction;
  const auto hit = world_.cast(from, along, kFar);
  const double range = hit ? hit->range : kFar;
  const double lit = hit ? 0.35 + 0.65 * std::abs(hit->normal.dot(along)) : 0;
  Vector3d out(0, 0, 0);
  if (hit) out = texture(from + range * along);
  if (hit && optics.isoluminant) {
    const double swing = 200 * (out[0] - 0.5);
    out = {120 + swing, 120 - swing * 77 / 150, 120};
  } else {
    out *= 230 * lit;
  }
  for (int c = 0; c < 3; ++c) out[c] = optics.light.seen(out[c], range, c);
  return out;
}

CameraImage CameraSimulator::take(const CameraOptics& optics, const Pose& X_WC, std::uint64_t exposure) const {
  CameraImage image(optics.model.width, optics.model.height, 3);
  split_work(image.height, threads_, [&](int first, int last) {
    for (int row = first; row < last; ++row) {
      Random random = random_at(seed_, exposure + 100, static_cast<std::uint64_t>(row));
      for (int column = 0; column < image.width; ++column) {
        Vector3d sum(0, 0, 0);
        for (int k = 0; k < 4; ++k) {
          sum += colour(optics, X_WC, {column - 0.25 + 0.5 * (k & 1), row - 0.25 + 0.5 * (k >> 1)});
        }
        for (int c = 0; c < 3; ++c) {
          const double level = 0.25 * sum[c] + optics.noise * random.normal();
          image(column, row, c) = static_cast<std::uint8_t>(std::clamp(std::lround(level), 0L, 255L));
        }
      }
    }
  });
  return image;
}

}  // namespace isobath
