// Hydrophones: a simulated passive array, and the sounds of a scene that it may hear (ledger S4-54).
//
// At each interval the array gives one bearing for each sound whose line stands out of the noise. Passive sonar
// equation (Urick 1983, 2.4), in dB:
//
//   SNR = source level - (20 log10 r + absorption r) - (noise level + 10 log10 resolution) + array gain
//
// with spherical spreading over the slant range r, at least 1 m. A normal fluctuation is added to SNR; the sound is
// heard if the sum reaches the threshold. The frequency is shifted by the vehicle's motion (Doppler) and measured to a
// cell of the array. Bearings have a normal error: a part that stays the same for the whole run (the bias of the array)
// and a part that is drawn anew for each. Not modelled: shadow behind bodies, bounces, more than one sound in a cell.
//
// Random numbers follow from seed, interval and sound alone. One thread.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/sim/sound_config.hpp>
#include <isobath/sim/water.hpp>
#include <isobath/sonar/passive_bearing.hpp>
#include <isobath/vehicle/vehicle_state.hpp>
#include <vector>

namespace isobath {

class World;

class Hydrophones {
 public:
  /// `world` and `water` must outlive it.
  Hydrophones(const HydrophonesConfig& config, std::vector<SoundConfig> sounds, const World& world, const Water& water,
              std::uint64_t seed);

  [[nodiscard]] Duration interval() const { return seconds(config_.interval_s); }
  /// The sounds heard at a time, in the order of the scene; the world must have been moved to that time.
  [[nodiscard]] std::vector<PassiveBearing> listen(Time time, const VehicleState& state, std::uint64_t number) const;

 private:
  [[nodiscard]] Eigen::Vector3d place_of(const SoundConfig& sound) const;

  HydrophonesConfig config_;
  std::vector<SoundConfig> sounds_;
  const World& world_;
  const Water& water_;
  std::uint64_t seed_;
  double bias_;  ///< rad
};

}  // namespace isobath
