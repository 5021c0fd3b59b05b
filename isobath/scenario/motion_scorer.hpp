// MotionScorer: how well a simulated run tracked the bodies that move (ledger S3-15). DetectionScorer feeds it.
//
// Each scan compares the tracks that are known to move with the bodies that truly move (at kLeastSpeed at least) and
// whose echoes were heard since the scan before. Both are points in plan, placed from the vehicle: the error of its
// own position does not count. The distance of the two sets is OSPA with the cut-off kCutOff_m (set_distance.hpp). A
// track within kCutOff_m of a moving body that was not heard, because something hides it, counts neither way.
//
// A body is known from the first scan on in which a track is assigned to it, nearer than kCutOff_m. Where another track
// is assigned to it later, that is a switch.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

struct MotionScore {
  int scans = 0;      ///< in which a moving body was heard, or a track was false
  double ospa_m = 0;  ///< mean of these scans
  int bodies = 0;     ///< that moved and were heard
  int known = 0;      ///< of these, known to move at some time
  int switches = 0;
  double held_share = 0;                           ///< of moving bodies heard, those with a track; mean of these scans
  double false_tracks = 0;                         ///< mean of these scans
  double velocity_rms = 0;                         ///< m/s, of all pairs
  double position_rms_m = 0;                       ///< of all pairs
  double known_after_s = 0, known_after_95_s = 0;  ///< from the first echo: median and 95 % quantile
};

class MotionScorer {
 public:
  static constexpr double kCutOff_m = 5, kLeastSpeed = 0.15;

  struct TrueBody {
    std::size_t number = 0;
    Eigen::Vector2d p, velocity;
    bool heard = false;  ///< since the last scan
  };
  struct Track {
    std::uint32_t number = 0;
    Eigen::Vector2d p, velocity;
  };
  /// Bodies and tracks of one scan, in one frame.
  void add(double time_s, std::span<const TrueBody> bodies, std::span<const Track> tracks);
  [[nodiscard]] MotionScore score() const;

 private:
  struct Watch {
    double first_heard_s = 0;
    std::optional<double> known_s;
    std::uint32_t track = 0;
  };
  std::map<std::size_t, Watch> watched_;
  int scans_ = 0, switches_ = 0;
  std::int64_t pairs_ = 0, false_ = 0;
  double ospa_ = 0, held_ = 0, velocity_squares_ = 0, position_squares_ = 0;
};

}  // namespace isobath
