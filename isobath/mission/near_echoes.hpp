// NearEchoes: the raw echoes around the vehicle that two pings agree on, for a look ahead that needs no map (Oskard
// 1990, III-D; ledger S1-44, S1-F10).
//
// One echo may be noise. It is confirmed when another ping has put one not farther than `confirm_m` away (to a third of
// it, north and east) within the last `confirm_s`: of a head that steps, a neighbouring beam or the next sweep.
// Confirmed ones count for `memory_s` after they were last heard, and what is nearer than the sonar hears does not age:
// an obstacle does not vanish because the sonar is blind to it. Callers hand in only echoes that stand out: the rate of
// false ones grows with the square of that of false alarms.
//
// World fixed, moved by `shift` when navigation corrects itself. One thread; at most kMost cells, the oldest go first.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/geometry/pose.hpp>
#include <isobath/mission/safety_config.hpp>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace isobath {

class NearEchoes {
 public:
  static constexpr std::size_t kMost = 8192;

  /// Echoes of one ping, in L of its instant. Those that are not finite or beyond `reach_m` are left out.
  void add(std::span<const Eigen::Vector2d> echoes_L, const Pose& X_WL, double reach_m, const SafetyConfig& config,
           double now_s);
  /// The world has moved under what is remembered.
  void shift(const Eigen::Vector2d& by_W);
  void clear() { cells_.clear(); }
  /// The confirmed ones in the vehicle's frame; valid until the next call. `blind_m`: nearer than this nothing is
  /// heard.
  std::span<const Eigen::Vector2d> confirmed(const Pose& X_WL, double blind_m, const SafetyConfig& config,
                                             double now_s);

 private:
  using Key = std::pair<std::int64_t, std::int64_t>;
  struct Echo {
    Eigen::Vector2d place_W;
    double heard_s = 0;
    double counts_s = 0;  ///< last heard, or too near to be heard
    bool confirmed = false;
  };
  void put(const Eigen::Vector2d& place_W, const SafetyConfig& config, double now_s);
  void forget(double before_s);

  std::map<Key, Echo> cells_;
  double cell_m_ = 1;
  std::vector<Eigen::Vector2d> found_;
};

/// How far the hull gets before it meets one of the points, along a way of constant curvature (1/m, positive to
/// starboard), up to `reach_m` or half a turn; the points in L turned so that x is where it travels. The hull is a disc
/// of `half_width_m`, its bow `bow_m` ahead of the middle. Infinite: it meets none.
double free_way(std::span<const Eigen::Vector2d> points, double curvature, double half_width_m, double bow_m,
                double reach_m);

}  // namespace isobath
