#include <algorithm>
#include <cmath>
#include <isobath/sim/hydrophones.hpp>
#include <isobath/sim/random_at.hpp>
#include <isobath/sim/world.hpp>
#include <numbers>
#include <utility>

namespace isobath {
namespace {

constexpr std::uint64_t kBiasDraw = 1, kSoundDraws = 2;

}  // namespace

Hydrophones::Hydrophones(const HydrophonesConfig& config, std::vector<SoundConfig> sounds, const World& world,
                         const Water& water, std::uint64_t seed)
    : config_(config),
      sounds_(std::move(sounds)),
      world_(world),
      water_(water),
      seed_(seed),
      bias_(config.bias_share * config.bearing_error.radians() * random_at(seed, kBiasDraw, 0).normal()) {}

Eigen::Vector3d Hydrophones::place_of(const SoundConfig& sound) const {
  if (sound.body.empty()) return sound.position;
  for (const WorldBody& body : world_.bodies()) {
    if (body.body->name == sound.body) return body.box.center() + body.moved;
  }
  return sound.position;
}

std::vector<PassiveBearing> Hydrophones::listen(Time time, const VehicleState& state, std::uint64_t number) const {
  std::vector<PassiveBearing> heard;
  const double random_part = std::sqrt(1 - config_.bias_share * config_.bias_share) * config_.bearing_error.radians();
  const Pose X_BS{Rotation(), config_.position};
  const Pose X_WS = state.X_WB * X_BS;
  for (std::size_t i = 0; i < sounds_.size(); ++i) {
    const SoundConfig& sound = sounds_[i];
    Random random = random_at(seed_, kSoundDraws + i, number);
    const double fluctuation = random.normal(), bearing = random.normal(), elevation = random.normal(),
                 cell = random.normal();
    const Eigen::Vector3d to_W = place_of(sound) - X_WS.translation;
    const double range = std::max(1.0, to_W.norm());
    const double loss = 20 * std::log10(range) + water_.absorption_db(sound.frequency_hz, X_WS.translation.z()) * range;
    const double noise = config_.noise_db + 10 * std::log10(config_.resolution_hz) - config_.gain_db;
    const double snr = sound.source_level_db - loss - noise + config_.fluctuation_db * fluctuation;
    const bool in_band = sound.frequency_hz >= config_.low_hz && sound.frequency_hz <= config_.high_hz;
    if (!in_band || snr < config_.threshold_db) continue;
    const Eigen::Vector3d to_S = X_WS.rotation.inverse() * to_W;
    const Eigen::Vector3d v_W = state.X_WB.rotation * state.v_B;
    const double closing = v_W.dot(to_W) / range;
    const double doppler = 1 + closing / water_.sound_speed(X_WS.translation.z());
    PassiveBearing& b = heard.emplace_back();
    b.time = time;
    b.bearing = Angle::radians(std::atan2(to_S.y(), to_S.x()) + bias_ + random_part * bearing).wrapped();
    b.sigma = config_.bearing_error;
    if (config_.elevation_error > Angle{}) {
      const double true_elevation = std::atan2(-to_S.z(), to_S.head<2>().norm());
      const double measured = true_elevation + config_.elevation_error.radians() * elevation;
      b.elevation = Angle::radians(std::clamp(measured, -std::numbers::pi / 2, std::numbers::pi / 2));
    }
    b.frequency_hz = std::max(1e-3, sound.frequency_hz * doppler + config_.resolution_hz / std::sqrt(12.0) * cell);
    b.resolution_hz = config_.resolution_hz;
    b.snr_db = snr;
    b.X_BS = X_BS;
  }
  return heard;
}

}  // namespace isobath
