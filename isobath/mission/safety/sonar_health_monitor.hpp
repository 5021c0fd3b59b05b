// SonarHealthMonitor: whether one sonar can still be trusted, judged by the quality of its pings (SonarHealthSample).
// Faults have hysteresis by counts of pings in a row. A blind side is judged by the pings of that side alone, so that a
// head that steps from side to side is judged like a fan.
//
// Time is a clock of the caller's, s. One thread; allocates nothing.
#pragma once

#include <cstdint>
#include <isobath/mission/messages/messages.hpp>
#include <isobath/mission/safety/safety_config.hpp>
#include <optional>

namespace isobath {

/// Up after `enter` bad pings in a row, down after `leave` good ones.
class Streak {
 public:
  void add(bool bad, int enter, int leave);
  [[nodiscard]] bool up() const { return up_; }

 private:
  int bad_ = 0, good_ = 0;
  bool up_ = false;
};

class SonarHealthMonitor {
 public:
  /// Ignores data with the time of the last one: it is the same ping again.
  void update(const SonarHealthSample& look, const SafetyConfig& config, double now_s);

  [[nodiscard]] double last_s() const { return last_s_; }
  [[nodiscard]] bool frozen() const { return frozen_; }
  [[nodiscard]] bool saturated() const { return saturated_.up(); }
  [[nodiscard]] bool garbled() const { return garbled_.up(); }
  [[nodiscard]] bool deaf(const SafetyConfig& config, double now_s) const;
  [[nodiscard]] bool port_blind() const { return port_.blind.up(); }
  [[nodiscard]] bool starboard_blind() const { return starboard_.blind.up(); }
  [[nodiscard]] const SonarHealthSample& last() const { return look_; }

 private:
  struct Side {
    Streak blind;
    std::optional<double> level;  ///< slow mean
  };
  static void look_to(Side& side, const std::optional<double>& level, const Side& other, const SafetyConfig& config);

  SonarHealthSample look_;  ///< the last one
  bool spoken_ = false;
  double last_s_ = 0;
  int same_ = 0, fresh_ = 0;
  bool frozen_ = false;
  Streak saturated_, garbled_;
  Side port_, starboard_;
  std::optional<double> deaf_since_s_;
};

}  // namespace isobath
