// TrafficScene: discs that cross a field and do not give way, the same from the same numbers (workload E of the
// project's benchmarks).
//
// The field is x -20..160 m, y -60..60 m. A disc has a radius of 0.5 to 3 m; its start is drawn again while it is
// nearer than 15 m and its radius to the start of the vehicle, (0, 0). Its speed is 0.2 to 1 of the maximum, in any
// direction. It moves straight, is reflected where its centre meets a border, and passes through others. The goal is
// (140, 0).
#pragma once

#include <cstdint>
#include <isobath/planning/traffic/moving_body.hpp>
#include <vector>

namespace isobath {

class TrafficScene {
 public:
  static constexpr double kStep_s = 0.1, kLimit_s = 400, kReach_m = 50, kArrival_m = 2, kSpeed = 1.5, kRadius_m = 0.5;

  TrafficScene(std::uint64_t run, int discs, double max_speed);

  static Eigen::Vector2d goal() { return {140, 0}; }
  void step();
  [[nodiscard]] const std::vector<MovingBody>& discs() const { return discs_; }
  /// Those whose centres are within reach, with their exact states.
  void sense(const Eigen::Vector2d& p, std::vector<MovingBody>& seen) const;
  /// Between the vehicle's disc and the nearest disc, m.
  [[nodiscard]] double gap(const Eigen::Vector2d& p) const;
  [[nodiscard]] Time now() const { return now_; }

 private:
  std::vector<MovingBody> discs_;
  Time now_{};
};

}  // namespace isobath
