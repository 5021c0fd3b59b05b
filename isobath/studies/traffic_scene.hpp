// TrafficScene: bodies that cross a field and do not give way, and structures that stand in it, the same from the same
// numbers. The open scene is workload E of the project's benchmarks.
//
// The field is x -20..160 m, y -60..60 m; the vehicle starts at (0, 0), the goal is (140, 0). A disc has a radius of
// 0.5 to 3 m; its start is drawn again while it is nearer than 15 m and its radius to the start of the vehicle, or
// touches a structure. Its speed is 0.2 to 1 of the maximum, in any direction. It moves straight, is reflected where
// its centre meets a border of the field, and passes through other discs and through structures. The scenes:
//
// - open: no structures.
// - walls: three walls across the field, each with a gap of 6 to 14 m and two of 0.5 to 0.95 m, which are narrower than
//   the vehicle (S3-D02).
// - quay: a U of 16 to 36 m by 20 to 40 m about the straight way, open towards the vehicle (S3-13, S3-26).
// - harbour: a basin of 24 to 36 m about the goal, with a mouth of 3 to 8 m in one of its sides (S3-D03).
// - bar: a bar of 20 to 50 m about the straight way that turns at 0.04 to 0.2 rad/s (S3-D04).
// - crossing: no structures; the discs are in two lanes of 25 m, which they follow in opposite directions at 0.5 to 1
//   of the maximum (S3-D01).
#pragma once

#include <array>
#include <cstdint>
#include <Eigen/Geometry>
#include <isobath/base/random.hpp>
#include <isobath/planning/traffic/moving_body.hpp>
#include <string>
#include <vector>

namespace isobath {

enum class TrafficScenery : std::uint8_t { kOpen, kWalls, kQuay, kHarbour, kBar, kCrossing };
inline constexpr std::array kTrafficSceneries = {TrafficScenery::kOpen, TrafficScenery::kWalls,
                                                 TrafficScenery::kQuay, TrafficScenery::kHarbour,
                                                 TrafficScenery::kBar,  TrafficScenery::kCrossing};
/// "open", "walls", "quay", "harbour", "bar", "crossing".
std::string to_text(TrafficScenery scenery);

class TrafficScene {
 public:
  static constexpr double kStep_s = 0.1, kLimit_s = 400, kRest_s = 60, kRest_m = 5, kArrival_m = 2, kSpeed = 1.5,
                          kRadius_m = 0.5;

  TrafficScene(TrafficScenery scenery, std::uint64_t run, int discs, double max_speed);

  static Eigen::Vector2d goal() { return {140, 0}; }
  static Eigen::AlignedBox2d field() { return {Eigen::Vector2d(-20, -60), Eigen::Vector2d(160, 60)}; }
  void step();
  [[nodiscard]] const std::vector<MovingBody>& discs() const { return discs_; }
  /// With outlines. One that turns has its outline at the start, and the start as its time.
  [[nodiscard]] const std::vector<MovingBody>& structures() const { return structures_; }
  /// The discs whose centres are within reach, with their exact states, and the structures: all, or, in an unknown map,
  /// what has been within reach so far, in convex parts, and the bar when its middle is.
  void sense(const Eigen::Vector2d& p, double reach_m, bool is_known, std::vector<MovingBody>& seen);
  /// Between the vehicle's disc and the nearest body or structure, m.
  [[nodiscard]] double gap(const Eigen::Vector2d& p) const;
  /// Time from the start to the goal along the shortest path past the structures that stand still, without discs.
  [[nodiscard]] double free_time_s() const;
  [[nodiscard]] Time now() const { return now_; }

 private:
  void add_structure(const Polygon& outline_W);
  void add_walls(Random& random);
  void add_quay(Random& random);
  void add_harbour(Random& random);
  void add_bar(Random& random);
  void add_lanes(Random& random, int discs, double max_speed);
  void add_discs(Random& random, int discs, double max_speed);
  void see_parts(const Eigen::Vector2d& p, double reach_m);
  [[nodiscard]] bool touches_structure(const MovingBody& disc) const;

  TrafficScenery scenery_;
  std::vector<MovingBody> discs_, structures_;
  std::vector<Polygon> parts_;       ///< convex, of the structures, in W
  std::vector<Polygon> seen_parts_;  ///< of each, what has been within reach
  std::int64_t steps_ = 0;
  Time now_{};
};

}  // namespace isobath
