// Fans that a test makes by hand, and what a voxel map holds after them.
#pragma once

#include <array>
#include <cmath>
#include <isobath/base/random.hpp>
#include <isobath/perception/fan_mapper.hpp>
#include <map>
#include <memory>

namespace isobath::test {

inline double odds(double p) { return std::log(p / (1 - p)); }

struct Look {
  Ping ping;
  EchoDecisions decisions;
};

/// A fan that hears nothing, of beams as wide as they stand apart unless a width is given.
inline Look fan(int beams, int bins, double bin_m, double half_deg, double height_deg = 15, double width_deg = 0) {
  Look look;
  auto f = std::make_shared<BeamFan>();
  const double spacing = beams > 1 ? 2 * half_deg / (beams - 1) : 2 * half_deg;
  for (int b = 0; b < beams; ++b) {
    f->azimuth.push_back(Angle::degrees(beams > 1 ? -half_deg + spacing * b : 0));
    f->width.push_back(Angle::degrees(width_deg > 0 ? width_deg : spacing));
  }
  f->height = Angle::degrees(height_deg);
  look.ping.fan = f;
  look.ping.window = {0, bin_m, bins};
  look.decisions.reset(beams, bins);
  look.decisions.p_detect.assign(static_cast<std::size_t>(bins), 0.8f);
  return look;
}

inline Pose pose(double heading, double pitch, double roll, const Eigen::Vector3d& at = Eigen::Vector3d::Zero()) {
  return {Rotation::from_heading_pitch_roll(Angle::degrees(heading), Angle::degrees(pitch), Angle::degrees(roll)), at};
}

using Key = std::array<int, 3>;
inline std::map<Key, int> contents(const VoxelBlocks& blocks) {
  std::map<Key, int> all;
  blocks.for_each(0, [&](const VoxelBlocks::Block& b) {
    for (int i = 0; i < 16; ++i) {
      for (int j = 0; j < 16; ++j) {
        for (int k = 0; k < 16; ++k) {
          const VoxelIndex v = b.corner + VoxelIndex(i, j, k);
          if (const LogOdds16 e = b.evidence[VoxelBlocks::offset(v)]; e != kUnseen) all[{v.x(), v.y(), v.z()}] = e;
        }
      }
    }
  });
  return all;
}

inline FanMapperConfig by(FanMapperConfig::Rule rule, int shadow_bins = 0) {
  FanMapperConfig config;
  config.rule = rule;
  config.shadow_bins = shadow_bins;
  config.visibility = 1;
  config.max_looks = 4;
  return config;
}

/// A tenth of the cells are hits, the first six bins of no use.
inline Look noisy_fan(Random& random) {
  Look look = fan(64, 100, 0.1, 60);
  for (int b = 0; b < 64; ++b) {
    for (int k = 0; k < 100; ++k) {
      if (random.uniform() < 0.1) look.decisions.set_hit(b, k);
    }
  }
  for (int k = 0; k < 6; ++k) look.decisions.set_unusable(k);
  return look;
}

}  // namespace isobath::test
