// TrackStudy: tracks of bodies from a table of positions, without their names; and where the table has names, how well
// they were held (Rodin, Amin c. 1988, 2.1; ledger S3-15). `isobath track` prints it.
//
// The rows of one time are a look: positions of different bodies. A body gives a reading after `interval_s` on average,
// so a look at `t` seconds after the last one shows a given body with probability 1 - exp(-t / interval_s).
//
// Score. Before a reading is taken in, the confirmed track that is predicted nearest to it is looked up: within
// `within_m` the body was held. Its number must be the one that held the body the last time, else the body's track was
// switched. The velocity of the track, after the reading, is compared with course and speed of the row. Once an
// interval the confirmed tracks are compared with the bodies heard in the last `kStale` intervals, which keep the
// velocity of their row: a track farther than `within_m` from all of them is false, and the distance of the two sets is
// OSPA with `within_m` as its cut-off (set_distance.hpp).
//
// Beside it a nearest-neighbour tracker takes the same readings: a Kalman filter of constant velocity for each body, a
// reading goes to the nearest track within the gate or begins a new one, three readings confirm, and a track without a
// reading for `kStale` intervals is dropped.
#pragma once

#include <isobath/io/input/position_table.hpp>
#include <isobath/perception/tracking/body_tracker.hpp>

namespace isobath {

struct TrackRequest {
  static constexpr double kStale = 5;

  std::filesystem::path file;
  double sigma_m = 0.3;
  double interval_s = 1;
  double within_m = 2;
  BodyTrackerConfig tracker = {.clutter = 1e-6};  ///< a table has few false positions
  MotionFilterConfig motion = {};
};

std::vector<Section> sections(TrackRequest& request);

struct TrackScore {
  std::uint64_t asked = 0, held = 0, switches = 0;  ///< rows of bodies that were read `kKnown` times before
  std::uint64_t velocities = 0;
  double velocity_rms = 0, velocity_median = 0;  ///< m/s
  std::uint64_t still = 0, still_moving = 0;     ///< velocities of bodies below 0.05 m/s, and those above 0.1 m/s
  double false_tracks = 0;                       ///< mean, of confirmed tracks
  double ospa_m = 0;                             ///< mean

  static constexpr int kKnown = 5;
};

/// One confirmed track: where it was at its readings.
struct TrackCourse {
  std::uint32_t number = 0;
  std::vector<Time> times;
  std::vector<Eigen::Vector2d> p_W;
  Eigen::Vector2d velocity_W = Eigen::Vector2d::Zero();  ///< last
  double share_still = 0;                                ///< last

  [[nodiscard]] bool lies_still() const { return share_still > 0.5; }
};

struct TrackStudy {
  PositionTable table;
  std::vector<TrackCourse> courses;
  TrackScore score, nearest;  ///< without names: zero
  BodyTracker::Counts counts;
};

/// Throws Error.
TrackStudy study_tracks(const TrackRequest& request);

/// track.geojson (where the table has latitude and longitude), tracks.csv and tracks.png; returns their names.
std::vector<std::filesystem::path> write_tracks(const TrackStudy& study, const std::filesystem::path& folder);

}  // namespace isobath
