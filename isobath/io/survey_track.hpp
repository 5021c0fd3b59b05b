// SurveyTrack: what the logs of multibeam surveys have in common. Positions, attitudes and swaths go in as the recorder
// wrote them, seconds out of order; out come Navigation, swaths and pings in order of time.
//
// A Navigation stands at the time of each position, swath and ping, just before it. Its position is that of the
// record itself, else interpolated on the local plane between the positions around it (no further apart than kReach),
// else carried on from the nearest with its speed and course (at most kReach; kHold where they are not known). Roll,
// pitch and heave are interpolated between attitude samples; beyond the samples the nearest one stands for at most
// kHold, after that the body is taken to be level. Heading: of the swath, else of the attitude, else of the position
// record; velocity: horizontal, of the position record.
// Depth of B: stated by the record, else heave (positive down) less the height of B's origin above the water line at
// rest; 0 where a log says neither. Frame::kLevel soundings state depths below the water themselves: nothing of this is
// added to them.
// Pings are of fans whose beams have had the roll taken out (Kongsberg water columns): X_BS gets the roll of the
// Navigation at the ping's time back, so that the fan stands upright in the world; none where that is taken to be
// level. Covariance where the log states a quality of the position; what is not stated is taken from the resolution of
// the records (0.01 degrees, 1 cm), which is a lower bound. Where position records only repeat what the swaths state
// with more care (.kmall), they give a Navigation of their own only where no swath has been for kHold. Origin on the
// globe: the first valid position. Nothing is released before the log is kWait further on (recorders write attitude by
// the second), or kReach where no position is known yet. A swath that never finds a position goes out without a
// Navigation; one in kBody that finds no attitude within kTilt is refused, since it would be wrong. A time that goes
// back by more than kSetBack is a clock set back: all that waits is released and memory begins anew. Memory is bounded:
// kMaxHistory samples, kMaxPending events, kMaxWaiting soundings.
#pragma once

#include <deque>
#include <isobath/io/event.hpp>
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
  double sigma_m = 0;  ///< of north and of east; 0: not stated
};

struct SwathRecord {
  Swath swath;
  std::optional<GeoPoint> position;  ///< stated by the record itself
  std::optional<double> depth_m;     ///< of B below the water, likewise
};

/// Velocity of a speed over ground along a course.
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

  /// `report` must live as long as this.
  explicit SurveyTrack(SourceReport& report);
  ~SurveyTrack();

  /// The water line below B's origin at rest, m (negative: above it).
  void set_water_line(double z_m) { water_line_m_ = z_m; }
  void add(const MotionSample& sample);
  void add(const PositionFix& fix);
  void add(SwathRecord record);
  /// Behind a swath of the same time, whose record says more of where the vehicle is. `ping.X_BS`: without roll.
  void add_ping(Ping ping);
  /// Nothing follows: what waits is released.
  void finish();
  /// Empty: more input is wanted.
  std::optional<Event> next();

 private:
  struct Placed {
    PositionFix fix;
    Eigen::Vector2d north_east;
  };
  struct Pending {
    Time time;
    std::optional<SwathRecord> swath;  ///< this, or `ping`; neither: a position
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
  /// The sample at a time, or the nearest; `away`: how far that is.
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
  Angle last_roll_;                  ///< of that fix
  std::optional<Time> last_stated_;  ///< swath with a position of its own
  bool finished_ = false;
  std::uint64_t fixes_ = 0, beyond_samples_ = 0, without_motion_ = 0, without_position_ = 0;
  std::uint64_t pings_without_position_ = 0;
};

}  // namespace isobath
