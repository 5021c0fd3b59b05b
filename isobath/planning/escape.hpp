// EscapeSearch: whether a vehicle that cannot stop still has an escape manoeuvre: a turn to either side, and then a
// straight line, or circles, that meet no known obstacle (ledger S6-51, S6-F04; promise 1 of the design).
//
// Such a vehicle is safe only as long as it has an escape manoeuvre. It must not enter a state without one, however far
// the nearest obstacle still is. The Safety Officer therefore asks whether, under the current order, there would still
// be an escape a moment later; if not, it takes the one that exists now (a "backup trajectory"; the states without one
// are the inevitable collision states of Fraichard and Asama 2004).
//
// Motion: ahead at a constant speed over ground, carried by a constant drift; a turn builds up and dies away with a
// lag. Where a part of the speed may be a current from astern, a manoeuvre is free only if it is so with and without
// it. The hull is a disc, and an obstacle is a row of points no farther apart than twice `room_m`. A vehicle that is
// too near to a point at the start may leave, if it gets away from all points at 0.2 m/s or more. Points that move keep
// their velocity. Frame: that of the vehicle at the start, x ahead, y to starboard; turns are positive to starboard. SI
// units. Pure; costs about 40 ns per point and tried manoeuvre.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

struct EscapeTask {
  double speed = 1;   ///< ahead, over ground; above 0
  double astern = 0;  ///< how much of `speed` may be a current from astern, which goes on in the turn
  Eigen::Vector2d drift = Eigen::Vector2d::Zero();  ///< over ground, on top of that
  double turn_rate = 0.2;                           ///< maximum, rad/s; above 0
  double turn_now = 0;                              ///< rad/s
  double lag_s = 0.6;                               ///< time constant with which a turn builds up
  double room_m = 2;                                ///< wanted distance from the vehicle's middle to a point
  double horizon_s = 15;                            ///< how long a manoeuvre must be free
  double moving_s = 3;                              ///< the same of points that move: later their place is not known
  std::optional<double> towards = {};               ///< rad: where the vehicle wants to go; empty: anywhere
};

/// Holds its heading for `wait_s`, turns by `turn` (a full circle or more: circles), then goes straight on.
struct Escape {
  double wait_s = 0;
  double turn = 0;                            ///< rad
  double free_s = 0;                          ///< time until it first comes too near; the horizon if it does not
  double room_m = 0;                          ///< minimum distance to a point until then; infinite without points
  std::optional<Eigen::Vector2d> meets = {};  ///< the point that it comes too near to, where it then is
};

/// A point of an obstacle now, and its velocity.
struct ObstaclePoint {
  Eigen::Vector2d place;
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
};

class EscapeSearch {
 public:
  /// Points that are not finite are left out.
  EscapeSearch(std::span<const ObstaclePoint> points, const EscapeTask& task);

  [[nodiscard]] bool free(const Escape& escape) const { return escape.free_s >= task_.horizon_s; }
  /// The result of one turn, begun after a wait.
  [[nodiscard]] Escape try_turn(double turn, double wait_s = 0) const {
    return try_turn(State{.rate = task_.turn_now}, turn, wait_s);
  }
  /// The result of a turn by `ordered` for `after_s`, followed by the best escape. `turn` is that of the escape, from
  /// the heading that the vehicle then has.
  [[nodiscard]] Escape after(double ordered, double after_s) const;
  /// The best escape now: the one that is free longest; of equal ones the one with the most room, up to twice the
  /// wanted room; of equal ones the smallest turn, the soonest. Of the free ones with nearly as much room, the one that
  /// ends nearest to the direction `towards`: before a row of pylons, the turn through the gap and not along the row.
  [[nodiscard]] Escape best() const;

 private:
  struct State {
    Eigen::Vector2d place = Eigen::Vector2d::Zero();
    double heading = 0, rate = 0;
    double time_s = 0;
    Eigen::Vector2d carried = Eigen::Vector2d::Zero();  ///< how far off `place` a current from astern takes it
  };
  void step(State& state, double heading) const;
  [[nodiscard]] Escape try_turn(State state, double turn, double wait_s) const;
  [[nodiscard]] Escape safest(const State& state) const;
  [[nodiscard]] double off_course(double turn) const;
  /// The point that it is too near to after `s` seconds, with the current from astern or without; `least2` becomes the
  /// minimum squared distance to any point.
  [[nodiscard]] std::optional<Eigen::Vector2d> met_at(const State& state, double s, double& least2) const;

  EscapeTask task_;
  std::vector<ObstaclePoint> points_;
  double at_start_ = 0;  ///< minimum distance to a point at the start
};

}  // namespace isobath
