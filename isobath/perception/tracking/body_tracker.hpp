// BodyTracker: tracks of moving and of still bodies from readings of their positions, in clutter (Rodin, Amin c. 1988,
// 2.1, 2.2; ledger S3-04, S3-15, S3-21).
//
// A Poisson multi-Bernoulli filter (Williams 2015, TOMB/P): each track has a probability of existence, a motion filter
// (motion_filter.hpp) and an extent; bodies that were never read are a Poisson field of constant density. Readings go
// to tracks with their marginal probabilities (association.hpp), not to the nearest, so that tracks which cross do not
// take each other's readings for their own. It needs no history of hypotheses: a look costs what its pairs within gates
// cost.
//
// A look is what one ping, one sector of a scan or one message showed: readings of different bodies at one time, and
// for each place the probability that a body there gives a reading. Where nothing was looked at, a track is not missed.
// A track is confirmed from `confirm` on, and stays so until its existence falls below `drop`; then it is forgotten. Of
// two tracks that agree in position and velocity the older stays: two bodies that cannot be told apart are one.
//
// Frames and units: W (N, E), m, s. The own position's error moves all readings alike. When a fix corrects it, `shift`
// moves the tracks as it moves the vehicle, so that the correction is not taken for a velocity.
//
// Untrusted input: a reading that is not finite, or whose covariance is not positive definite, is refused and counted;
// a look from before the last one is refused whole (`out_of_order`). Of readings above `max_readings`, and of tracks
// above `max_tracks`, those of least worth are dropped and counted, so that the time of a look is bounded.
#pragma once

#include <cstdint>
#include <isobath/base/time.hpp>
#include <isobath/perception/tracking/association.hpp>
#include <isobath/perception/tracking/motion_filter.hpp>
#include <optional>

namespace isobath {

struct BodyTrackerConfig {
  double clutter = 1e-4;    ///< false readings a look and m2
  double unseen = 1e-5;     ///< bodies that no track knows yet, a m2
  double survival_s = 600;  ///< mean time until a body leaves
  double gate = 16;         ///< squared distance in deviations
  double confirm = 0.9;
  double drop = 0.02;
  int max_readings = 1000;
  int max_tracks = 400;
};

std::vector<Field> fields(BodyTrackerConfig& config);

/// The position of a body, and how its echoes scatter about it.
struct BodyReading : MotionFilter::Reading {
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();  ///< of the echoes about it, m2
  double echoes = 1;                                  ///< that it was made of
};

struct BodyTrack {
  std::uint32_t number = 0;  ///< never used again
  double existence = 0;
  bool confirmed = false;
  Time first, last;  ///< readings
  std::uint32_t readings = 0;
  std::uint32_t merged = 0;  ///< number of the younger track that was found to be of the same body last; 0: none
  MotionFilter filter;
  Eigen::Matrix2d extent = Eigen::Matrix2d::Zero();  ///< scatter of the echoes about the centre, m2
  double extent_weight = 0;                          ///< echoes that it rests on
};

class BodyTracker {
 public:
  BodyTracker(const BodyTrackerConfig& config, const MotionFilterConfig& motion);

  /// Probability that a body at `p_W` gives a reading in a look.
  struct Coverage {
    virtual ~Coverage() = default;
    [[nodiscard]] virtual double detection(const Eigen::Vector2d& p_W) const = 0;
  };
  /// Takes in a look. Returns whether it was taken: not if it is older than the last one.
  bool update(Time time, std::span<const BodyReading> readings, const Coverage& coverage);
  /// A correction of the own position by `by_W`, m.
  void shift(const Eigen::Vector2d& by_W);

  [[nodiscard]] std::span<const BodyTrack> tracks() const { return tracks_; }
  struct Counts {
    std::uint64_t looks = 0, readings = 0, out_of_order = 0, unusable = 0, above_max_readings = 0, above_max_tracks = 0;
  };
  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  void take(std::span<const BodyReading> readings);
  void weigh(const Coverage& coverage);
  void begin(Time time, const Coverage& coverage);
  void correct_track(std::size_t i, Time time);
  [[nodiscard]] double least_existence() const;  ///< of a track that is not confirmed
  void merge();
  void tidy();

  BodyTrackerConfig config_;
  MotionFilterConfig motion_;
  std::vector<BodyTrack> tracks_;
  std::vector<BodyReading> readings_;
  std::vector<double> detection_;        ///< by track
  std::vector<std::size_t> first_pair_;  ///< by track
  AssociationTask task_;
  Association association_;
  std::vector<MotionFilter> mixed_;
  std::vector<MotionFilter::Estimate> estimates_;
  std::vector<double> shares_;
  std::optional<Time> time_;
  std::uint32_t next_number_ = 1;
  Counts counts_;
};

}  // namespace isobath
