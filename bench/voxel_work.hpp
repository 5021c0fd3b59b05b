// The work of the voxel benchmarks, for this project and its peers alike: a scene, a path, rays and questions, wide
// fans. Stated in full, so that anybody can repeat them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <Eigen/Geometry>
#include <isobath/base/random.hpp>
#include <isobath/map/voxel/voxel_blocks.hpp>
#include <isobath/perception/fan_mapper.hpp>
#include <memory>
#include <numbers>
#include <vector>

namespace isobath::bench {

using Eigen::Vector3d;

inline constexpr double kVoxel = 0.25, kReach = 50, kHit = 0.847, kMiss = -0.405, kMin = -2, kMax = 3.48;

/// As the work is stated: of the first uniform itself, not of what is left of one (Random::normal).
inline double normal(Random& random) {
  const double a = random.uniform(), b = random.uniform();
  return std::sqrt(-2 * std::log(a)) * std::cos(2 * std::numbers::pi * b);
}

struct Pillar {
  double x, y, radius;
};

/// A flat bottom at z = -10 and twenty pillars up to z = 0; z is up here, and nothing in the work depends on it.
inline std::vector<Pillar> pillars() {
  Random random(42);
  std::vector<Pillar> all;
  while (all.size() < 20) {
    const double x = 120 * random.uniform() - 60, y = 120 * random.uniform() - 60;
    const double radius = 0.5 + 1.5 * random.uniform();
    if (std::hypot(x, y) >= 5) all.push_back({x, y, radius});
  }
  return all;
}

struct Stand {
  Vector3d at;
  double yaw, pitch, roll;
};

inline std::vector<Stand> path() {
  Random random(7);
  std::vector<Stand> stands;
  Stand s{{0, 0, -5}, 0, 0, 0};
  double dz = 0;
  for (int i = 0; i < 1000; ++i) {
    stands.push_back(s);
    s.yaw += 0.035 * normal(random);
    if (std::hypot(s.at.x(), s.at.y()) > 60) {
      s.yaw += 0.1 * std::remainder(std::atan2(-s.at.y(), -s.at.x()) - s.yaw, 2 * std::numbers::pi);
    }
    s.roll = 0.95 * s.roll + 0.0175 * normal(random);
    s.pitch = 0.95 * s.pitch + 0.0175 * normal(random);
    dz = 0.9 * dz + 0.01 * normal(random);
    s.at += Vector3d(0.15 * std::cos(s.yaw), 0.15 * std::sin(s.yaw), dz);
    s.at.z() = std::clamp(s.at.z(), -8.0, -2.0);
  }
  return stands;
}

inline double range_to(const Vector3d& from, const Vector3d& u, const std::vector<Pillar>& all) {
  double least = u.z() < 0 ? (-10 - from.z()) / u.z() : INFINITY;
  for (const Pillar& p : all) {
    const double dx = from.x() - p.x, dy = from.y() - p.y, a = u.x() * u.x() + u.y() * u.y();
    const double b = dx * u.x() + dy * u.y(), c = dx * dx + dy * dy - p.radius * p.radius, root = b * b - a * c;
    if (root < 0 || a == 0) continue;
    const double t = (-b - std::sqrt(root)) / a;
    if (t > 0 && t < least && from.z() + t * u.z() <= 0) least = t;
  }
  return least;
}

struct Ray {
  Vector3d from, to;
  bool hit;
};

/// 1000 scans of 128 x 32 rays.
inline const std::vector<Ray>& rays() {
  static const std::vector<Ray> kRays = [] {
    Random noise(99);
    const auto all = pillars();
    const auto degrees = [](double d) { return d * std::numbers::pi / 180; };
    std::vector<Ray> made;
    made.reserve(1000 * 128 * 32);
    for (const Stand& s : path()) {
      const Eigen::Matrix3d R =
          (Eigen::AngleAxisd(s.yaw, Vector3d::UnitZ()) * Eigen::AngleAxisd(s.pitch, Vector3d::UnitY()) *
           Eigen::AngleAxisd(s.roll, Vector3d::UnitX()))
              .toRotationMatrix();
      for (int i = 0; i < 128; ++i) {
        for (int j = 0; j < 32; ++j) {
          const double azimuth = degrees(-65 + 130.0 * i / 127), elevation = degrees(-30 + 40.0 * j / 31);
          const Vector3d u = R * Vector3d(std::cos(elevation) * std::cos(azimuth),
                                          std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
          const double range = range_to(s.at, u, all);
          const bool hit = range < 49.5;
          const double heard = hit ? std::max(0.3, range + 0.05 * normal(noise)) : kReach;
          made.push_back({s.at, s.at + heard * u, hit});
        }
      }
    }
    return made;
  }();
  return kRays;
}

inline std::vector<Vector3d> questions() {
  Random random(5);
  std::vector<Vector3d> all(5'000'000);
  for (Vector3d& p : all) {
    p.x() = 120 * random.uniform() - 60;
    p.y() = 120 * random.uniform() - 60;
    p.z() = 15.5 * random.uniform() - 10.5;
  }
  return all;
}

/// 200 pings of 512 beams by 500 bins, 15 degrees tall: an echo of ten bins in each beam, all else clear.
struct WideFans {
  Ping ping;
  std::vector<EchoDecisions> decisions{200};
  std::vector<Pose> poses;
};
inline const WideFans& wide_fans() {
  static const WideFans kFans = [] {
    WideFans made;
    auto fan = std::make_shared<BeamFan>();
    for (int b = 0; b < 512; ++b) {
      fan->azimuth.push_back(Angle::degrees(-65 + 130.0 * b / 511));
      fan->width.push_back(Angle::degrees(130.0 / 511));
    }
    fan->height = Angle::degrees(15);
    made.ping.fan = fan;
    made.ping.window = {0, 0.1, 500};
    const auto stands = path();
    for (int i = 0; i < 200; ++i) {
      EchoDecisions& d = made.decisions[static_cast<std::size_t>(i)];
      d.reset(512, 500);
      d.p_detect.assign(500, 0.8f);
      for (int b = 0; b < 512; ++b) {
        const int first = static_cast<int>(std::floor((20 + 15 * std::sin(0.05 * b + 0.1 * i)) / 0.1));
        for (int k = first; k < first + 10; ++k) d.set_hit(b, k);
      }
      const Stand& s = stands[static_cast<std::size_t>(5 * i)];  // z up there, down here
      made.poses.push_back(
          {Rotation::from_heading_pitch_roll(Angle::radians(-s.yaw), Angle::radians(-s.pitch), Angle::radians(s.roll)),
           {s.at.x(), -s.at.y(), -s.at.z()}});
    }
    return made;
  }();
  return kFans;
}

inline VoxelBlocks mapped() {
  VoxelBlocks blocks({to_evidence(kMin), to_evidence(kMax)});
  const LogOdds16 hit = to_evidence(kHit), miss = to_evidence(kMiss);
  for (const Ray& r : rays()) blocks.insert_ray(r.from / kVoxel, r.to / kVoxel, miss, r.hit ? hit : miss);
  return blocks;
}

}  // namespace isobath::bench
