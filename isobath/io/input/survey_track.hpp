// SurveyTrack: merges the records of multibeam survey logs. Positions, attitudes and swaths enter as the recorder wrote
// them, seconds out of order; Navigation, swaths and pings leave in order of time.
//
// A Navigation has the time of each position, swath and ping and precedes it. Its position is the one that the record
// states, else it is interpolated on the local plane between the positions around it (no further apart than kReach),
// else extrapolated from the nearest position with its speed and course (at most kReach; kHold if they are not known).
// Roll, pitch and heave are interpolated between attitude samples; beyond the samples, the nearest one is used for at
// most kHold, and after that the body is taken to be level. Heading: of the swath, else of the attitude, else of the
// position record. Velocity: horizontal, of the position record.
// Depth of B: as stated by the record, else heave (positive down) less the height of B's origin above the water line at
// rest; 0 if a log states neither. Frame::kLevel soundings state depths below the water themselves: none of this is
// added to them.
// Pings have fans from whose beams the recorder has removed the roll (Kongsberg water columns). SurveyTrack turns X_BS
// back by the roll of the Navigation at the time of the ping, so that the fan is vertical in the world; there is no
// turn where the body is taken to be level.
// A Navigation has a covariance if the log states a quality of the position. Unstated parts are taken from the
// resolution of the records (0.01 degrees, 1 cm), which is a lower bound. If position records only repeat what the
// swaths state more precisely (.kmall), they give a Navigation of their own only after kHold without a swath. The
// origin on the globe is the first valid position.
// Nothing is released before the log is kWait further on (recorders write attitude once per second), or kReach while no
// position is known. A swath that never finds a position is released without a Navigation. A kBody swath that finds no
// attitude within kTilt is refused, since it would be wrong. If the time goes back by more than kSetBack, the clock was
// set back: all waiting events are released and the history is cleared. Memory is bounded: kMaxHistory samples,
// kMaxPending events, kMaxWaiting soundings.
#pragma once

#include <deque>
#include <isobath/event/event.hpp>
#include <memory>
#include <optional>

namespace isobath {

struct MotionSample {
  Time time;
  Angle roll, pitch;
  double heave_m = 0;  ///< positive down
  std::optional<Angle> heading;
  double sigma_tilt = 0, sigma_heading = 0, sigma_heave_m = 0;  ///< rad, rad, m; 0: not stated
};

struct PositionFix {
  Time time;
  GeoPoint point;
  std::optional<Eigen::Vector2d> velocity;  ///< north, east, m/s
  std::optional<Angle> heading;
  double sigma_m = 0;  ///< north and east, each; 0: not stated
};

struct SwathRecord {
  Swath swath;
  std::optional<GeoPoint> position;  ///< stated by the record itself
  std::optional<double> depth_m;     ///< depth of B below the water, likewise
};

/// Velocity (north, east) from a course and a speed over ground.
Eigen::Vector2d along(Angle course, double speed);

class SurveyTrack {
 public:
  static constexpr Duration kWait = std::chrono::seconds(2);
  static constexpr Duration kReach = std::chrono::seconds(5);
  static constexpr Duration kHold = std::chrono::seconds(1);
  static constexpr Duration kTilt = std::chrono::milliseconds(200);
  static constexpr Duration kSetBack = std::chrono::seconds(60);
  static constexpr std::size_t kMaxHistory = 4096;
  static constexpr std::size_t kMaxPending = 8192;
  static constexpr std::size_t kMaxWaiting = std::size_t{1} << 20;

  /// `report` must outlive this object.
  explicit SurveyTrack(SourceReport& report);
  ~SurveyTrack();

  /// Sets the water line below B's origin at rest, m (negative: above it).
  void set_water_line(double z_m) { water_line_m_ = z_m; }
  void add(const MotionSample& sample);
  void add(const PositionFix& fix);
  void add(SwathRecord record);
  /// A swath of the same time goes first, since its record states more about the pose. `ping.X_BS`: without roll.
  void add_ping(Ping ping);
  /// Ends the input: all waiting events are released.
  void finish();
  /// The next event; empty: needs more input.
  std::optional<Event> next();

 private:
  struct Placed {
    PositionFix fix;
    Eigen::Vector2d north_east;
  };
  struct Pending {
    Time time;
    std::optional<SwathRecord> swath;  ///< either this or `ping`; neither: a position
    std::optional<Ping> ping = {};
  };
  void see(Time time);
  void wait_for(Pending pending);
  [[nodiscard]] bool due() const;
  void release_front();
  void release(Pending pending);
  void release(Ping ping);
  void forget_before(Time time);
  void tell_coverage();
  [[nodiscard]] std::optional<Eigen::Vector2d> on_plane(const GeoPoint& point);
  [[nodiscard]] std::optional<Placed> position_at(Time time) const;
  /// The sample at a time, or the nearest one; `away`: its distance in time.
  [[nodiscard]] std::optional<MotionSample> motion_at(Time time, Duration& away) const;
  [[nodiscard]] Navigation navigation(Time time, const Placed& place, const std::optional<MotionSample>& motion,
                                      Angle heading) const;

  SourceReport& report_;
  std::unique_ptr<LocalPlane> plane_;
  double water_line_m_ = 0;
  std::deque<MotionSample> motion_;  ///< by time
  std::deque<Placed> positions_;     ///< by time
  std::deque<Pending> pending_;      ///< by time
  std::size_t waiting_soundings_ = 0;
  std::deque<Event> ready_;
  std::optional<Time> newest_;
  std::optional<Time> last_navigation_;
  Angle last_roll_;                  ///< roll of the last Navigation
  std::optional<Time> last_stated_;  ///< time of the last swath with its own position
  bool finished_ = false;
  std::uint64_t fixes_ = 0, beyond_samples_ = 0, without_motion_ = 0, without_position_ = 0;
  std::uint64_t pings_without_position_ = 0;
};

}  // namespace isobath
