// MovingBodies: tracks of the bodies around the vehicle from its own sonars, and what the maps must not keep of those
// that move (Rodin, Amin c. 1988, 2.1; ledger S3-04, S3-15, S3-21).
//
// Each ping gives readings of bodies (body_looks.hpp), which a tracker takes (body_tracker.hpp). A confirmed track
// moves if it is improbable that it lies still, its speed is well known and at least `min_speed`, it has left the place
// where it was read some time ago (kTrail readings at most), in the world and as seen from the vehicle, and the grid
// knows the water ahead of it as free. On a surface that lies still, such as a hull, a glint slides along with the
// vehicle, and reverberation goes along with it. Where the way of a track cannot be that of a glint, it need leave its
// place by half of its size only; or the water ahead need only not be known as occupied, if the track is read often.
// (A track of rare looks may join several things that lie still, one after the other.) A track that moves does so
// until it has probably lain still for kStopped_s: a body that turns back stops for a moment.
//
// Maps take the world for still. So the echoes of a body that moves go to its track: `withhold` makes their bins ones
// without information, for all maps. The maps clear the water behind it by the pings that pass through. What a map took
// in before the body was known to move, its trail, is cleared by `clear_trails`. Obstacles of moving bodies come from
// the tracks, also while they are out of view, until their position is less certain than `max_sigma_m`.
//
// While a body moves, and kTraffic_s after that, a confirmed track that probably does not lie still, but is not known
// to move yet, may move. (Where nothing moves it is a glint or reverberation about what lies still.) Its echoes go to
// the maps, because it is an obstacle; but the memory must not keep it, and when it has had no reading for
// kForgotten_s, because it left the view, its trail is cleared like that of a body that moves.
//
// The error of the own position moves all tracks alike; a jump of the position moves them with it (`shift`). Slow drift
// below `min_speed` does not make still bodies move. Frame W, m, s. Bounded: BodyTrackerConfig::max_tracks, kTrail
// places a trail. One thread.
#pragma once

#include <isobath/map/occupancy/body_grid.hpp>
#include <isobath/map/occupancy/obstacle.hpp>
#include <isobath/perception/tracking/body_looks.hpp>
#include <map>
#include <optional>

namespace isobath {

struct MovingBodiesConfig {
  bool on = true;
  double min_speed = 0.15;
  double max_still = 0.01;
  double max_speed_sigma = 0.2;
  int min_readings = 15;
  double may_move = 0.1;
  double margin_m = 0.5;
  double max_sigma_m = 8;
  BodyLooksConfig looks;
  BodyTrackerConfig tracker = {.clutter = 1e-4, .unseen = 1e-5, .survival_s = 60};
  MotionFilterConfig motion;
};

std::vector<Field> fields(MovingBodiesConfig& config);

class MovingBodies {
 public:
  static constexpr std::size_t kTrail = 64, kWakes = 512;
  static constexpr double kSlow = 0.1;  ///< m/s
  static constexpr double kForgotten_s = 5, kWake_s = 60, kTraffic_s = 60, kStopped_s = 4;

  explicit MovingBodies(const MovingBodiesConfig& config);

  /// The grid before a ping, and its pose.
  struct Water {
    const BodyGrid& grid;
    Pose X_WB;

    /// Whether the grid knows a place of W as free, or knows of no echo there.
    [[nodiscard]] bool is_free(const Eigen::Vector2d& p_W) const;
    [[nodiscard]] bool is_unoccupied(const Eigen::Vector2d& p_W) const;
    [[nodiscard]] std::optional<Cell> cell_at(const Eigen::Vector2d& p_W) const;
  };
  /// Takes the echoes of a ping that lies flat. Without a grid nothing is found to move.
  void look(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB, const std::optional<Water>& water);
  /// Takes the echoes of moving bodies out of decisions of the ping that was looked at last: those in the place of a
  /// body, and those joined to them. Returns their number.
  int withhold(const Ping& ping, const Pose& X_WB, EchoDecisions& decisions) const;
  /// Clears the trails of moving bodies in a grid at this time and pose: all that a body has left since the last call,
  /// and what had its last echo kForgotten_s ago where a body passed in the last kWake_s. (A long body, whose middle
  /// echoes from one place as it passes, leaves that behind where no beam comes any more.)
  void clear_trails(BodyGrid& grid, Time time, const Pose& X_WB);
  /// Sets `may_move` and the motion, without the number of the track, of obstacles of a scan at this time and pose on
  /// which a track lies that may move.
  void mark_doubtful(Time time, const Pose& X_WB, std::vector<Obstacle>& obstacles) const;
  /// The bodies that move, as obstacles of a scan at this time and pose; not numbered.
  [[nodiscard]] std::vector<Obstacle> obstacles(Time time, const Pose& X_WB) const;

  void shift(const Eigen::Vector2d& by_W);
  /// Forgets all tracks: the time starts anew.
  void restart();

  [[nodiscard]] const BodyTracker& tracker() const { return tracker_; }
  /// Bodies so far.
  struct Counts {
    std::uint64_t confirmed = 0;  ///< tracks
    std::uint64_t slow = 0;       ///< of these, with a speed below kSlow at their last reading
    std::uint64_t moving = 0;     ///< that were found to move
    std::uint64_t left_out = 0;   ///< readings and tracks above the most of a look and of the tracker
  };
  [[nodiscard]] Counts counts() const;

 private:
  /// An ellipse: the points p with (p - centre)' shape^-1 (p - centre) <= 1.
  struct Place {
    Eigen::Vector2d centre_W;
    Eigen::Matrix2d shape;
    Eigen::Vector2d own_W;  ///< where the vehicle was then

    /// Whether p lies in the ellipse, its axes scaled.
    [[nodiscard]] bool contains(const Eigen::Vector2d& p_W, double scale = 1) const;
    void move(const Eigen::Vector2d& by_W);
  };
  struct Body {
    std::vector<Place> trail;  ///< where it was read; of a moving body: where it still may be
    bool moves = false, may_move = false;
    double speed = 0;  ///< at the last reading, m/s
    Time moved;        ///< when a body that moves last did
  };
  struct Wake {
    Place place;
    Time left;
    bool is_new = true;  ///< not cleared yet
  };
  struct Head {
    Pose X_BS;
    BodyLooks looks;
  };
  static void add_to(Counts& counts, const Body& body);
  BodyLooks& looks_of(const Ping& ping);
  void judge(const std::optional<Water>& water);
  void take_over(const BodyTrack& track);
  [[nodiscard]] bool is_heard(const BodyTrack& track, const Ping& ping) const;
  void leave_trail(Body& body, const BodyTrack& track);
  void leave_all(Body& body);
  [[nodiscard]] bool may_move(const BodyTrack& track) const;
  static int withhold_box(const Ping& ping, const EchoBox& box, EchoDecisions& decisions);
  [[nodiscard]] bool begins_to_move(const BodyTrack& track, const Body& body, const Water& water) const;
  [[nodiscard]] bool may_be_glint(const Eigen::Vector2d& moved_W, const Eigen::Vector2d& own_way_W, double sigma) const;
  [[nodiscard]] bool lies_still(const BodyTrack& track) const;
  [[nodiscard]] Place place_of(const BodyTrack& track, Time time) const;
  template <class Use>
  void for_each_moving(double max_sigma_m, Use use) const;

  MovingBodiesConfig config_;
  std::vector<Head> heads_;  ///< one a sonar
  BodyTracker tracker_;
  Time time_{};
  std::optional<Time> moved_;  ///< when a body last moved
  Eigen::Vector2d own_W_ = Eigen::Vector2d::Zero();
  std::map<std::uint32_t, Body> bodies_;  ///< confirmed ones, by the number of the track
  std::vector<Wake> wakes_;               ///< that moving bodies have left, oldest first
  std::vector<EchoBox> boxes_;            ///< of moving bodies in the last ping
  Counts ended_;                          ///< of the tracks that ended, and all bodies that were found to move
};

}  // namespace isobath
