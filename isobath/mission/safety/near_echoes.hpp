// NearEchoes: the raw echoes around the vehicle on which two pings agree, for a collision check that needs no map
// (Oskard 1990, III-D; ledger S1-44, S1-F10).
//
// One echo may be noise. Echoes of different pings within `confirm_m` of each other and within `confirm_s` confirm each
// other where noise hardly explains them, by a sequential likelihood-ratio test that counts looks: one rule for a sonar
// that looks at a place now and then and for one that does so thirty times a second. A look is a ping with a beam
// within `confirm_m` of the place that nothing nearer blocks. Noise gives m echoes or more there with the chance l(m):
// that of a Poisson variable with the mean n w d, where n such beams look, w is the mean width of the disc (pi / 2
// confirm_m) and d is the density of false echoes, one per metre of beam. A body gives them with the chance b, which is
// that of a buoy, of a post or of a wall (kBodies), and at least 4 l(1). For each b, m echoes of a look add ln(b /
// l(m)), at most kMostEvidence, to what the strongest echo near them has, and a look without one adds ln((1 - b) / (1 -
// l(1))), down to 0; the evidence is that of the mean of the three likelihood ratios. kEnough confirms them, and one
// look alone never gives it. Noise reaches it in one of some 250 tries, and each look is a try: where n looks fell into
// the last `confirm_s`, with an echo or without, the evidence must be greater by ln(n / kFewLooks), so that noise is
// confirmed no more often where a sonar looks more often. Two looks in a row are enough; so is one in each of two
// sweeps where false echoes are rare; clutter takes more. An echo of which no look is known (a range sonar) counts
// kMostEvidence.
//
// The density of false echoes is measured: those that are not confirmed, or were and fell silent, over the metres of
// beam within reach, of some two minutes. It starts high, as if kFirst_m had held kFirst: what is confirmed wrongly is
// not counted, so a low start would stay low.
//
// Confirmed echoes count for `memory_s` after they were last received. Echoes nearer than the blanking distance do not
// age: an obstacle does not vanish because the sonar is blind to it.
//
// An echo is forgotten sooner where the sonar looks and hears nothing: after kSilentLooks pings and kSilent_s in which
// the beams that look there, and all beams within `confirm_m` of it, were silent up to `confirm_m` beyond it. So what
// has moved on, or was noise, does not close the water that it has left. What lies behind another echo, nearer than the
// blanking distance, or so near that it may be above or below the beams, is not looked at.
//
// World-fixed; `shift` moves the echoes when navigation corrects itself. One thread; at most kMax cells, the oldest
// are removed first.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
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
  using Evidence = std::array<double, 3>;             ///< of each kind of body
  static constexpr Evidence kBodies{0.05, 0.3, 0.9};  ///< shares of the looks in which they give an echo
  static constexpr double kMostEvidence = 4.5;        ///< of one look
  static constexpr double kEnough = 5.5;              ///< to confirm, after kFewLooks or fewer within confirm_s
  static constexpr double kFewLooks = 8;
  static constexpr double kFirst = 2.5, kFirst_m = 500;

  /// One ping: takes its echoes, and forgets what is gone by its silence. Echoes that are not finite or beyond
  /// `reach_m` are left out.
  void add(const SonarEchoes& ping, double reach_m, const SafetyConfig& config, double now_s);
  /// An echo of which no look is known, in L.
  void add(const Eigen::Vector2d& echo_L, const Pose& X_WL, double reach_m, const SafetyConfig& config, double now_s);
  /// Moves all echoes, after navigation has corrected itself.
  void shift(const Eigen::Vector2d& by_W);
  void clear() { cells_.clear(); }
  /// Removes an echo that no longer says where an obstacle is.
  void remove(const NearEcho& echo) { cells_.erase(echo.cell); }
  /// The confirmed echoes in the vehicle's frame; valid until the next call. `blanking_m`: blanking distance of the
  /// sonar.
  std::span<const NearEcho> confirmed(const Pose& X_WL, double blanking_m, const SafetyConfig& config, double now_s);
  /// False echoes per metre of beam, as measured.
  [[nodiscard]] double false_echoes_per_m() const { return (kFirst + false_echoes_) / (kFirst_m + looked_m_); }

 private:
  using Key = std::pair<std::int64_t, std::int64_t>;
  struct Echo {
    Eigen::Vector2d place_W;
    double heard_s = 0;
    double counts_s = 0;  ///< when last received, or nearer than the blanking distance
    Evidence evidence{};  ///< log-likelihood ratios of each kind of body to noise
    bool confirmed = false;
    int silent_looks = 0;  ///< since last received
  };
  /// Where a ping looked: the middle of its beams in W, and half of the sector, rad.
  struct Sector {
    double time_s, middle, half;
  };
  void take(const Eigen::Vector2d& echo_L, const Pose& X_WL, double reach_m, const Evidence& gain, int looks,
            const SafetyConfig& config, double now_s);
  void put(const Eigen::Vector2d& place_W, const Evidence& gain, int looks, const SafetyConfig& config, double now_s);
  void note_sector(const SonarEchoes& ping, double within_s, double now_s);
  [[nodiscard]] int looks_at(const SonarEchoes& ping, const Eigen::Vector2d& echo_L, double apart_m) const;
  void look(const SonarEchoes& ping, double reach_m, const SafetyConfig& config, double now_s);
  void count_metres(const SonarEchoes& ping, double reach_m, double now_s);
  void bound(const SafetyConfig& config, double now_s);
  void forget(double before_s);

  std::map<Key, Echo> cells_;
  std::deque<Sector> sectors_;  ///< of the pings of the last `confirm_s`, the newest last
  double cell_m_ = 1;
  double false_echoes_ = 0, looked_m_ = 0;  ///< of the last minutes
  double counted_s_ = 0;
  std::vector<NearEcho> found_;
};

/// Distance that the hull travels before it meets one of the points, on a path of constant curvature (1/m, positive to
/// starboard), up to `reach_m` or half a turn. The points are in L, turned so that x is the direction of travel. The
/// hull is a disc of `half_width_m` with its bow `bow_m` ahead of the middle. Infinite where it meets none.
double free_way(std::span<const Eigen::Vector2d> points, double curvature, double half_width_m, double bow_m,
                double reach_m);

}  // namespace isobath
