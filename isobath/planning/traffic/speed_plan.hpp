// SpeedPlanner: when to be where along a fixed path, past bodies that move (path-velocity decomposition: Kant, Zucker
// 1986; Rodin, Amin c. 1988, 2.2; ledger S3-18).
//
// In the plane of place s along the path and time t each body, grown by k sigma and the kept distance, blocks a region
// (for a disc that crosses a straight leg an ellipse). The planner marks the blocked places at moments 1/8 s apart, and
// finds all places and speeds that can be reached in steps of 0.5 s with speeds from rest to the maximum that change at
// a constant rate in each step. The motion is the one of earliest arrival at the end of the path, beyond the horizon in
// open water, that can brake to rest on the path afterwards and stay clear for a time.
//
// 1. Blocked places: from place to place along the path by the distance to the body, until the next one is met.
// 2. Reachable places: one set of bits for each moment and speed; each change of speed shifts the set and takes away
//    what is blocked at four moments of the step.
// 3. The earliest arrival whose braking stays clear; its speeds, from the end to the start.
//
// Between moments the distance of a body that does not rotate is bounded by that at both of them: the shapes grow
// accordingly. So a motion that is found keeps the distance; one that just keeps it may be refused, within 0.1 m. The
// speeds are a grid: an arrival is later than the earliest possible one by up to about 0.5 s. Bodies keep their
// velocities. The path itself must be free of what lies still. Units: m, s.
#pragma once

#include <cstdint>
#include <isobath/base/error.hpp>
#include <isobath/planning/traffic/moving_body.hpp>
#include <isobath/planning/traffic/smooth_path.hpp>
#include <isobath/planning/traffic/vehicle_motion.hpp>
#include <vector>

namespace isobath {

struct SpeedRules {
  double horizon_s = 20;    ///< for which the motion must be clear
  double clear_s = 3;       ///< at rest, after braking from the horizon or the arrival
  double distance_m = 0.8;  ///< kept from the shape of each body
  double sigmas = 3;        ///< S3-30
  double arrival_m = 0;     ///< before the end of the path the vehicle has arrived
};

struct SpeedPlan {
  std::vector<double> speeds;  ///< after each step of `step_s`, m/s, from the given speed on
  double step_s = 0;
  double arrival_s = 0;  ///< at the end of the path; beyond the horizon in open water
  double free_s = 0;     ///< before the braking at the end

  /// The motion along the path, with the braking and the rest at its end.
  [[nodiscard]] Trajectory motion_along(const SmoothPath& path, double speed, const TrafficVehicle& vehicle,
                                        double clear_s) const;
};

struct SpeedRefusal {
  int body = -1;       ///< the number of the body that blocks the last place reached; -1: there is no room to brake
  double time_s = 0;   ///< until which a motion is clear
  double place_m = 0;  ///< along the path
};

/// Keeps its memory from plan to plan. One thread at a time.
class SpeedPlanner {
 public:
  explicit SpeedPlanner(const TrafficVehicle& vehicle);

  /// The vehicle is at the start of the path at `now`. Bodies must be valid.
  Result<SpeedPlan, SpeedRefusal> plan(const SmoothPath& path, double speed, std::span<const MovingBody> bodies,
                                       Time now, const SpeedRules& rules);

 private:
  using Word = std::uint64_t;
  struct Goal {
    double arrival_s;
    int step, level, place;
  };
  void mark(const MovingBody& body, Time now, const SpeedRules& rules);
  [[nodiscard]] double kept_from(const MovingBody& body, double ahead_s, const SpeedRules& rules) const;
  [[nodiscard]] bool is_clear(int moment, int place) const;
  [[nodiscard]] int offset(int level, int next, int part) const;
  void reach_first(double speed);
  void reach_next(int step);
  [[nodiscard]] bool brakes(const Goal& goal, double clear_s) const;
  [[nodiscard]] bool leads(int step, int level, int next, int place) const;
  void collect(int step, int steps, int arrival_place);
  [[nodiscard]] SpeedPlan written(const Goal& goal) const;
  [[nodiscard]] SpeedRefusal refusal(std::span<const MovingBody> bodies, Time now, const SpeedRules& rules) const;
  [[nodiscard]] Word* row(int step, int level) {
    return reached_.data() + (static_cast<std::size_t>(step) * levels_ + level) * words_;
  }
  [[nodiscard]] const Word* row(int step, int level) const {
    return reached_.data() + (static_cast<std::size_t>(step) * levels_ + level) * words_;
  }

  TrafficVehicle vehicle_;
  int levels_;           ///< of speed, from 0 to the maximum
  double rise_;          ///< between levels, m/s
  double place_m_;       ///< between places: half a level for a step
  int faster_, slower_;  ///< levels by which the speed may change in a step
  int places_ = 0;
  std::size_t words_ = 0;
  std::vector<Eigen::Vector2d> at_;  ///< by place
  std::vector<Word> clear_;          ///< by moment: places that no body blocks
  std::vector<Word> reached_;        ///< by step and level
  std::vector<Word> scratch_;
  std::vector<Goal> goals_;
};

}  // namespace isobath
