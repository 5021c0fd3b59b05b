// NearEchoes: the raw echoes around the vehicle on which two pings agree, for a collision check that needs no map
// (Oskard 1990, III-D; ledger S1-44, S1-F10).
//
// One echo may be noise. It is confirmed when another ping has put one within `confirm_m` of it (to a third of that,
// north and east) in the last `confirm_s`; with a head that steps, this is a neighbouring beam or the next sweep.
// Confirmed echoes count for `memory_s` after they were last received. Echoes nearer than the blanking distance do not
// age: an obstacle does not vanish because the sonar is blind to it. Callers add only echoes that stand out: the rate
// of false confirmed echoes grows with the square of the false-alarm rate.
//
// An echo is forgotten sooner where the sonar looks and hears nothing: after kSilentLooks pings and kSilent_s in which
// the beams that look there, and all beams within `confirm_m` of it, were silent up to `confirm_m` beyond it. So what
// has moved on, or was noise, does not close the water that it has left. What lies behind another echo, nearer than the
// blanking distance, or so near that it may be above or below the beams, is not looked at.
//
// World-fixed; `shift` moves the echoes when navigation corrects itself. One thread; at most kMax cells, the oldest
// are removed first.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/geometry/pose.hpp>
#include <isobath/mission/messages/messages.hpp>
#include <isobath/mission/safety/safety_config.hpp>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace isobath {

/// A confirmed echo in the vehicle's frame.
struct NearEcho {
  Eigen::Vector2d place;
  double age_s = 0;  ///< since it was last received
  std::pair<std::int64_t, std::int64_t> cell;
};

class NearEchoes {
 public:
  static constexpr std::size_t kMax = 8192;
  static constexpr int kSilentLooks = 10;
  static constexpr double kSilent_s = 3;

  /// Echoes of one ping, in L of its instant. Those that are not finite or beyond `reach_m` are left out.
  void add(std::span<const Eigen::Vector2d> echoes_L, const Pose& X_WL, double reach_m, const SafetyConfig& config,
           double now_s);
  /// Forgets what is gone by the silence of a ping.
  void hear_silence(const SonarEchoes& look, const SafetyConfig& config, double now_s);
  /// Moves all echoes, after navigation has corrected itself.
  void shift(const Eigen::Vector2d& by_W);
  void clear() { cells_.clear(); }
  /// Removes an echo that no longer says where an obstacle is.
  void remove(const NearEcho& echo) { cells_.erase(echo.cell); }
  /// The confirmed echoes in the vehicle's frame; valid until the next call. `blanking_m`: blanking distance of the
  /// sonar.
  std::span<const NearEcho> confirmed(const Pose& X_WL, double blanking_m, const SafetyConfig& config, double now_s);

 private:
  using Key = std::pair<std::int64_t, std::int64_t>;
  struct Echo {
    Eigen::Vector2d place_W;
    double heard_s = 0;
    double counts_s = 0;  ///< when last received, or nearer than the blanking distance
    bool confirmed = false;
    int silent_looks = 0;  ///< since last received
  };
  void put(const Eigen::Vector2d& place_W, const SafetyConfig& config, double now_s);
  void forget(double before_s);

  std::map<Key, Echo> cells_;
  double cell_m_ = 1;
  std::vector<NearEcho> found_;
};

/// Distance that the hull travels before it meets one of the points, on a path of constant curvature (1/m, positive to
/// starboard), up to `reach_m` or half a turn. The points are in L, turned so that x is the direction of travel. The
/// hull is a disc of `half_width_m` with its bow `bow_m` ahead of the middle. Infinite where it meets none.
double free_way(std::span<const Eigen::Vector2d> points, double curvature, double half_width_m, double bow_m,
                double reach_m);

}  // namespace isobath
