// NearestTracker: the tracker that most programs have, for comparison (track_study.hpp). A Kalman filter of constant
// velocity for each body; a reading goes to the nearest track within the gate, in deviations, or begins a new track.
#pragma once

#include <isobath/perception/tracking/body_tracker.hpp>
#include <optional>

namespace isobath {

struct NearestTrackerConfig {
  static constexpr std::uint32_t kConfirm = 3;  ///< readings

  double acceleration = 0.05;  ///< m/s2, white, standard deviation at 1 Hz
  double max_speed = 3;        ///< m/s: twice the deviation of the velocity of a new track
  double gate = 16;            ///< squared distance in deviations
  double stale_s = 10;         ///< a track without a reading for so long is dropped
};

class NearestTracker {
 public:
  struct Track {
    std::uint32_t number = 0;
    std::uint32_t readings = 1;
    Time last;
    Eigen::Vector4d mean = Eigen::Vector4d::Zero();  ///< N, E, and their velocities
    Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();

    [[nodiscard]] bool is_confirmed() const { return readings >= NearestTrackerConfig::kConfirm; }
  };

  explicit NearestTracker(const NearestTrackerConfig& config) : config_(config) {}
  /// Moves all tracks to `time`, which must not run backwards, and drops the stale ones.
  void advance(Time time);
  /// Returns the track that took the reading.
  const Track& take(const BodyReading& reading);
  [[nodiscard]] std::span<const Track> tracks() const { return tracks_; }

 private:
  NearestTrackerConfig config_;
  std::vector<Track> tracks_;
  std::optional<Time> time_;
  std::uint32_t next_number_ = 1;
};

}  // namespace isobath
