// SweepSegmenter: finds the end of each scan of the surroundings and the start of the next (ledger S6-01).
//
// A fan of beams covers its sector with each ping. Its scans end with the first ping that comes `fan_scan_s` or more
// after the end of the previous scan, so that rules about several scans depend on time, not on the ping rate. A
// scanning head (fans of one beam) ends a scan when it has turned through 360 degrees, when it reverses (sector
// sweeps), or when it flies back. A bearing that repeats at the end of a sweep starts the next one: 31 pings from -45
// to +45 degrees at 3 degrees, both ends included, in both directions. If the log marks its sweeps (Ping::sweep), the
// marks are used.
//
// The end of a full turn, a multibeam scan or a marked sweep is known with its last ping. A reversal is known when the
// head has gone back by 1.5 steps, so up to two pings late. Skipped bearings and smaller jitter do not disturb; steps
// of 180 degrees and more cannot be distinguished from steps in the other direction.
#pragma once

#include <array>
#include <isobath/sonar/ping.hpp>
#include <optional>

namespace isobath {

struct Scan {
  int pings = 0;
  Time begin;  ///< time of the first ping
  Time end;    ///< time of the last ping
  bool full_turn = false;
  bool clockwise = true;
};

class SweepSegmenter {
 public:
  explicit SweepSegmenter(double fan_scan_s = 0) : fan_scan_(seconds(fan_scan_s)) {}

  /// The scan that ends with this ping, or whose end this ping shows; empty: none.
  std::optional<Scan> add(const Ping& ping);
  /// Pings since the end of the last scan.
  [[nodiscard]] int pings() const { return pings_; }

 private:
  std::optional<Scan> add_fan(const Ping& ping);
  void begin_at(const Ping& ping);
  void advance(const Ping& ping);
  void follow_extreme(const Ping& ping);
  [[nodiscard]] double typical_step() const;
  Scan end_marked(const Ping& ping);
  Scan end_turn(const Ping& ping);
  Scan end_reversed(const Ping& ping);

  Duration fan_scan_;
  std::optional<Time> fan_ended_;  ///< end of the last scan of a fan
  bool begun_ = false;
  int pings_ = 0;
  Time begin_;
  Angle last_azimuth_;
  double position_ = 0;  ///< unwrapped bearing, rad
  double start_ = 0;     ///< position at which the scan began
  int direction_ = 0;    ///< +1 clockwise, -1, 0 unknown
  double extreme_ = 0;   ///< farthest position in the direction
  Time extreme_time_;
  Time after_extreme_;     ///< time of the first ping after the farthest
  int since_extreme_ = 0;  ///< pings after the farthest
  std::array<double, 15> steps_{};
  int step_count_ = 0;
};

}  // namespace isobath
