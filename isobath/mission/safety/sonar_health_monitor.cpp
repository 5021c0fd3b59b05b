#include <algorithm>
#include <isobath/mission/safety/sonar_health_monitor.hpp>

namespace isobath {
namespace {

constexpr double kSlowMean = 0.1;    // share of the newest ping
constexpr double kHeard = 0.002;     // level of a side, of full scale, below which it says nothing about the other
constexpr double kNearlyAll = 0.98;  // share of samples at an end of the scale, where pings may well be equal

}  // namespace

void Streak::add(bool bad, int enter, int leave) {
  bad_ = bad ? std::min(bad_ + 1, enter) : 0;
  good_ = bad ? 0 : std::min(good_ + 1, leave);
  if (bad_ >= enter) up_ = true;
  if (good_ >= leave) up_ = false;
}

void SonarHealthMonitor::look_to(Side& side, const std::optional<double>& level, const Side& other,
                                 const SafetyConfig& config) {
  if (!level) return;
  const bool comparable = other.level && *other.level > kHeard;
  side.blind.add(comparable && *level < config.blind_share * *other.level, config.blind_looks, config.good_looks);
  side.level = side.level ? *side.level + kSlowMean * (*level - *side.level) : *level;
}

void SonarHealthMonitor::update(const SonarHealthSample& look, const SafetyConfig& config, double now_s) {
  if (spoken_ && look.time == look_.time) return;
  const bool plain = look.full_scale < kNearlyAll && look.silent < kNearlyAll;
  const bool same = spoken_ && plain && look.digest == look_.digest;
  same_ = same ? std::min(same_ + 1, config.frozen_looks) : 0;
  fresh_ = same ? 0 : std::min(fresh_ + 1, config.good_looks);
  if (same_ + 1 >= config.frozen_looks) frozen_ = true;
  if (fresh_ >= config.good_looks) frozen_ = false;
  saturated_.add(!(look.full_scale < config.saturated_share), config.bad_looks, config.good_looks);
  garbled_.add(!(look.roughness < config.garbled_roughness), config.bad_looks, config.good_looks);
  look_to(port_, look.port, starboard_, config);
  look_to(starboard_, look.starboard, port_, config);
  if (!(look.silent < 1)) {
    if (!deaf_since_s_) deaf_since_s_ = now_s;
  } else {
    deaf_since_s_.reset();
  }
  look_ = look;
  last_s_ = now_s;
  spoken_ = true;
}

bool SonarHealthMonitor::deaf(const SafetyConfig& config, double now_s) const {
  return deaf_since_s_ && now_s - *deaf_since_s_ >= config.deaf_s;
}

}  // namespace isobath
