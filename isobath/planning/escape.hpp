// EscapeSearch: whether a vehicle that cannot stop still has a way out: a turn to either side, and then straight on, or
// round and round, that meets nothing of what is known (ledger S6-51, S6-F04; promise 1 of the design).
//
// Such a vehicle is safe only as long as it has a way out; a place from which it has none must not be entered, however
// far the nearest obstacle still is. So whoever steers it asks, for the order that stands, whether there would be a way
// out a moment later, and if not, takes the one that there is now (a "backup trajectory"; the states without one are
// the inevitable collision states of Fraichard and Asama 2004).
//
// Motion: ahead at a constant speed over ground, carried sideways by a constant drift; the turn comes up and dies away
// with a lag. Obstacles are points, as far apart as they are wide at most; the hull is a disc. A vehicle that stands
// too near to one may leave, getting away from all by 0.2 m/s at least. Frame: that of the vehicle at the start, x
// ahead, y to starboard; turns are positive to starboard. SI units. Pure; costs about 40 ns a point and manoeuvre that
// comes to it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

struct EscapeTask {
  double speed = 1;                                 ///< ahead, over ground; above 0
  Eigen::Vector2d drift = Eigen::Vector2d::Zero();  ///< over ground, on top of that
  double turn_rate = 0.2;                           ///< the greatest, rad/s; above 0
  double turn_now = 0;                              ///< rad/s
  double lag_s = 0.6;                               ///< time constant of a turn that comes up
  double room_m = 2;                                ///< wanted from the vehicle's middle to a point
  double horizon_s = 15;                            ///< for so long it must be free
};

/// On as it goes for `wait_s`, a turn by `turn` (of a full circle or more: round and round), then straight on.
struct Escape {
  double wait_s = 0;
  double turn = 0;                            ///< rad
  double free_s = 0;                          ///< until it first comes too near; the horizon if it does not
  double room_m = 0;                          ///< least distance to a point until then; infinite without points
  std::optional<Eigen::Vector2d> meets = {};  ///< the point that it comes too near to
};

class EscapeSearch {
 public:
  /// Points that are not finite are left out.
  EscapeSearch(std::span<const Eigen::Vector2d> points, const EscapeTask& task);

  [[nodiscard]] bool free(const Escape& escape) const { return escape.free_s >= task_.horizon_s; }
  /// What comes of one turn, begun after a while.
  [[nodiscard]] Escape take(double turn, double wait_s = 0) const {
    return take(State{.rate = task_.turn_now}, turn, wait_s);
  }
  /// What comes of a turn by `ordered` for `after_s`, and then of the best way out. The `turn` is that of the way out,
  /// from the heading that the vehicle then has.
  [[nodiscard]] Escape after(double ordered, double after_s) const;
  /// The best way out now: the one that is free the longest, and of equal ones the one with the most room, as far as
  /// twice the room that is wanted; of equal ones the least turn, the soonest.
  [[nodiscard]] Escape best() const { return best(State{.rate = task_.turn_now}); }

 private:
  struct State {
    Eigen::Vector2d place = Eigen::Vector2d::Zero();
    double heading = 0, rate = 0;
  };
  void step(State& state, double heading) const;
  [[nodiscard]] Escape take(State state, double turn, double wait_s) const;
  [[nodiscard]] Escape best(const State& state) const;
  /// The point that a place is too near to after so long; `least2` becomes the least distance to any, squared.
  [[nodiscard]] std::optional<Eigen::Vector2d> met_at(const Eigen::Vector2d& place, double s, double& least2) const;

  EscapeTask task_;
  std::vector<Eigen::Vector2d> points_;
  double at_start_ = 0;  ///< the least distance to a point
};

}  // namespace isobath
