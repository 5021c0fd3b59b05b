// Pictures of textured planes and spheres, ray by ray, in closed form: what the tests of stereo compare with.
#pragma once

#include <algorithm>
#include <cmath>
#include <Eigen/Core>
#include <functional>
#include <isobath/base/random.hpp>
#include <isobath/stereo/optics/camera_image.hpp>
#include <limits>
#include <optional>
#include <vector>

namespace isobath::test {

/// n.p = distance, or a sphere about `centre`, or a card: the part of a plane within `half_side` of `centre` in x and
/// y. In the frame of the left camera.
struct Surface {
  Eigen::Vector3d normal = {0, 0, 0};
  double distance = 0;
  Eigen::Vector3d centre = {0, 0, 0};
  double radius = 0;
  double half_side = 0;
};
inline Surface plane(const Eigen::Vector3d& normal, double distance) { return {normal, distance, {0, 0, 0}, 0, 0}; }
inline Surface sphere(const Eigen::Vector3d& centre, double radius) { return {{0, 0, 0}, 0, centre, radius, 0}; }
inline Surface card(const Eigen::Vector3d& centre, double half_side) {
  return {{0, 0, 1}, centre.z(), centre, 0, half_side};
}

struct RayEnd {
  Eigen::Vector3d p;
  double along;
};

inline std::optional<double> meets(const Surface& s, const Eigen::Vector3d& from, const Eigen::Vector3d& along) {
  if (s.radius > 0) {
    const Eigen::Vector3d to = s.centre - from;
    const double middle = to.dot(along), off2 = to.squaredNorm() - middle * middle;
    if (off2 > s.radius * s.radius) return {};
    const double at = middle - std::sqrt(s.radius * s.radius - off2);
    return at > 0 ? std::optional(at) : std::nullopt;
  }
  const double slope = s.normal.dot(along);
  if (std::abs(slope) < 1e-12) return {};
  const double at = (s.distance - s.normal.dot(from)) / slope;
  const Eigen::Vector3d off = from + at * along - s.centre;
  const bool beside = s.half_side > 0 && std::max(std::abs(off.x()), std::abs(off.y())) > s.half_side;
  return at > 0 && !beside ? std::optional(at) : std::nullopt;
}

inline std::optional<RayEnd> nearest(const std::vector<Surface>& scene, const Eigen::Vector3d& from,
                                     const Eigen::Vector3d& along) {
  std::optional<RayEnd> best;
  for (const Surface& s : scene) {
    const auto at = meets(s, from, along);
    if (at && (!best || *at < best->along)) best = RayEnd{from + *at * along, *at};
  }
  return best;
}

/// A texture without repetition, 0..1: waves of many directions and lengths between 1.5 and 12 cm.
inline double waves(const Eigen::Vector3d& p) {
  constexpr int kWaves = 14;
  struct Wave {
    Eigen::Vector3d per_m;
    double phase;
  };
  static const std::vector<Wave> all = [] {
    std::vector<Wave> made;
    Random random(5);
    for (int k = 0; k < kWaves; ++k) {
      const Eigen::Vector3d direction(random.normal(), random.normal(), random.normal());
      made.push_back(
          {direction.normalized() * (6.283185307179586 / random.uniform(0.015, 0.12)), 6.3 * random.uniform()});
    }
    return made;
  }();
  double sum = 0;
  for (const Wave& wave : all) sum += std::sin(wave.per_m.dot(p) + wave.phase);
  return std::clamp(0.5 + sum / std::sqrt(8.0 * kWaves), 0.0, 1.0);
}

using LineOfSight = std::function<std::pair<Eigen::Vector3d, Eigen::Vector3d>(double column, double row)>;
using Shade = std::function<double(const RayEnd& end)>;  ///< 0..255

/// The mean of 2 x 2 rays a pixel.
inline CameraImage take_picture(const std::vector<Surface>& scene, int width, int height, const LineOfSight& sight,
                                const std::vector<Shade>& channels, double noise = 0.5, std::uint64_t seed = 1) {
  CameraImage image(width, height, static_cast<int>(channels.size()));
  Random random(seed);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      std::vector<double> sums(channels.size(), 0);
      for (int k = 0; k < 4; ++k) {
        const auto [from, along] = sight(column - 0.25 + 0.5 * (k & 1), row - 0.25 + 0.5 * (k >> 1));
        const auto end = nearest(scene, from, along);
        for (std::size_t c = 0; end && c < channels.size(); ++c) sums[c] += 0.25 * channels[c](*end);
      }
      for (std::size_t c = 0; c < channels.size(); ++c) {
        image(column, row, static_cast<int>(c)) =
            static_cast<std::uint8_t>(std::clamp(std::lround(sums[c] + noise * random.normal()), 0L, 255L));
      }
    }
  }
  return image;
}

/// A rectified pair of pinhole cameras side by side.
struct RayPair {
  int width = 320, height = 240;
  double focal = 300, baseline = 0.15;
  std::vector<Surface> scene;

  [[nodiscard]] LineOfSight sight(double right_of_left) const {
    return [this, right_of_left](double column, double row) {
      const Eigen::Vector3d along((column - 0.5 * (width - 1)) / focal, (row - 0.5 * (height - 1)) / focal, 1);
      return std::pair(Eigen::Vector3d(right_of_left, 0, 0), Eigen::Vector3d(along.normalized()));
    };
  }
  [[nodiscard]] CameraImage left(const std::vector<Shade>& channels, double noise = 0.5) const {
    return take_picture(scene, width, height, sight(0), channels, noise, 1);
  }
  [[nodiscard]] CameraImage right(const std::vector<Shade>& channels, double noise = 0.5) const {
    return take_picture(scene, width, height, sight(baseline), channels, noise, 2);
  }
  [[nodiscard]] std::vector<float> truth() const {
    std::vector<float> all;
    for (int row = 0; row < height; ++row) {
      for (int column = 0; column < width; ++column) {
        const auto [from, along] = sight(0)(column, row);
        const auto end = nearest(scene, from, along);
        all.push_back(end ? static_cast<float>(focal * baseline / end->p.z())
                          : std::numeric_limits<float>::quiet_NaN());
      }
    }
    return all;
  }
};

inline std::vector<Shade> textured() {
  return {[](const RayEnd& end) { return 20 + 210 * waves(end.p); }};
}

/// A slanted wall, a floor, and two spheres before them.
inline RayPair room() {
  RayPair pair;
  pair.scene = {plane(Eigen::Vector3d(0.25, 0, 1).normalized(), 2.4), plane({0, 1, 0}, 0.8),
                sphere({-0.35, 0.05, 1.5}, 0.28), sphere({0.4, -0.2, 1.9}, 0.25)};
  return pair;
}

}  // namespace isobath::test
