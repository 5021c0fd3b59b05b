// TrafficReplay: ships of a recording of AIS reports as bodies that meet an underwater vehicle.
//
// Recording: a table of positions with time and name (io/input/position_table.hpp; AIS: MMSI). The reports of one ship
// are joined by straight lines. Untrusted: reports without a name, of the same time as the one before, and wild ones
// (an implied speed above 50 m/s) are left out and counted. Where a ship sends no usable report for more than 180 s,
// its track ends, and a later report begins a new one. Reported courses and speeds are not used. At most `kMaxTracks`
// tracks are kept; a recording with more is an Error.
//
// Scale: lengths are divided by `length_scale`, times by `time_scale`, so that speeds are divided by length_scale /
// time_scale: by 10 with the defaults.
//
// A run draws, by its seed, one report of a ship that then moves at `min_speed` or more, a time in `meeting_s`, and an
// angle. The traffic is turned by the angle about the reported position and laid so that the ship is there when a
// vehicle that goes straight is there, too, after the drawn time. All other ships that come within `within_m` of the
// vehicle's start come along, as long as they have a track at time 0. A ship whose track ends before the run goes
// straight on. The draw is repeated until no ship is within `free_m` of the start at time 0. Ships do not react.
//
// Bodies are upright cylinders with a path, "ship 12" by the order in which ships first appear in the recording.
// Frames: recordings in the plane of the first position, m and s as recorded; bodies in W, m, and s of the run.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <filesystem>
#include <isobath/base/config.hpp>
#include <isobath/sim/encounters.hpp>
#include <isobath/sim/scene.hpp>
#include <map>
#include <string>
#include <vector>

namespace isobath {

struct ReplayConfig {
  bool on = false;
  std::string file;  ///< empty: given on the command line
  double length_scale = 30;
  double time_scale = 3;
  Eigen::Vector2d meeting_s = {20, 50};
  double min_speed = 0.3;  ///< m/s, scaled
  double radius_m = 0.5;
  double within_m = 300;
  double free_m = 10;
  double top_m = 0, bottom_m = 30;
};
std::vector<Field> fields(ReplayConfig& config);

/// One ship without a gap: at least two reports, in the order of their times.
struct RecordedTrack {
  std::size_t ship = 0;  ///< by first appearance, from 1
  std::vector<double> t_s;
  std::vector<Eigen::Vector2d> p;

  [[nodiscard]] bool covers(double time_s) const { return time_s >= t_s.front() && time_s <= t_s.back(); }
  /// After its end straight on, before its start at its first position.
  [[nodiscard]] Eigen::Vector2d at(double time_s) const;
};

struct TrafficRecording {
  static constexpr double kMaxSpeed = 50;  ///< m/s, as recorded
  static constexpr double kMaxGap_s = 180;
  static constexpr std::size_t kMaxTracks = 100'000;

  std::vector<RecordedTrack> tracks;
  std::map<std::string, std::uint64_t> left_out;  ///< reason: reports

  /// A number that changes with any time or place of the recording.
  [[nodiscard]] std::uint64_t digest() const;
};

/// Throws Error if the file cannot be read, or has no ship with two usable reports.
TrafficRecording read_recording(const std::filesystem::path& file);

struct ReplayedTraffic {
  std::vector<Body> bodies;  ///< the one that the vehicle meets first
  double meeting_s = 0;
};
/// Throws Error if no report fits: none of a ship that moves, or always one too near to the start.
ReplayedTraffic replayed_traffic(const ReplayConfig& config, const TrafficRecording& recording,
                                 const EncounteredVehicle& vehicle, std::uint64_t seed, double duration_s);

}  // namespace isobath
