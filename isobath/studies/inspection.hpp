// inspect: lists what an input holds: streams, rates, gaps, geometry, damage. Reads the input once, to its end.
#pragma once

#include <functional>
#include <isobath/event/event.hpp>
#include <string>
#include <vector>

namespace isobath {

struct StreamFacts {
  std::string name;  ///< "pings", "ranges", "navigation", "health", "swaths", "operator"
  std::uint64_t events = 0;
  Time first, last;
  double median_interval_s = 0;
  double longest_gap_s = 0;
  Time longest_gap_at;
  std::uint64_t gaps = 0;       ///< longer than five median intervals
  std::uint64_t backwards = 0;  ///< steps back in time

  /// 1/s; 0 for fewer than two events.
  [[nodiscard]] double rate() const;
};

/// One kind of ping: range and number of beams may change within a log.
struct PingGeometry {
  int beams = 0, bins = 0;
  double start_m = 0, end_m = 0;
  std::uint64_t pings = 0;
};

/// All swaths of a log together. Minima and maxima are taken over the valid swaths.
struct SwathFacts {
  std::uint64_t swaths = 0, soundings = 0, in_water = 0;  ///< in_water: soundings of something above the bottom
  std::size_t beams_min = 0, beams_max = 0;               ///< soundings per swath
  bool level = false;                                     ///< depths are below the water surface; else below the body
  float depth_min_m = 0, depth_max_m = 0;
  double sound_speed_min = 0, sound_speed_max = 0;  ///< 0: not stated
};

struct Inspection {
  std::vector<StreamFacts> streams;      ///< those with at least one event
  std::vector<PingGeometry> geometries;  ///< in the order of first appearance, at most kMaxGeometries
  double azimuth_min_deg = 0, azimuth_max_deg = 0;
  double beam_width_deg = 0, beam_height_deg = 0;
  float intensity_min = 0, intensity_max = 0, full_scale = 0;
  std::uint64_t bad_pings = 0;
  SwathFacts swaths;
  std::uint64_t bad_swaths = 0;

  static constexpr std::size_t kMaxGeometries = 16;
};

/// Calls `progress(events)` every 64 events.
Inspection inspect(Source& source, const std::function<void(std::uint64_t)>& progress = {});

}  // namespace isobath
