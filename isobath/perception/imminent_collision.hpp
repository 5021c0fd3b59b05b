// ImminentCollision: a backup collision check on raw ranges, so that neither a delay nor a defect of a map can hide an
// obstacle (Oskard 1990, III-D; ledger S1-44 S1-F10).
//
//   dangerous  <=>  R - v t_react - v^2 / (2 b) < margin,        v >= 0 closing speed, b braking, m/s2
//
// A reading counts if the direction of travel lies within its cone, widened by `cone_slack`. The echo may then be right
// ahead, so v is the whole speed. One spurious short reading does not raise the alarm and one missed echo does not
// clear it: the alarm is raised while `hits` of the last `looks` readings of a sensor were dangerous (two in three). A
// reading without an echo counts as not dangerous. A reading without a usable number is not a look, and is counted. If
// the direction of travel leaves a sensor's cone, its next looks clear it one by one. A vehicle at rest counts as
// travelling ahead; one whose velocity is not known as travelling ahead at `unknown_speed`.
//
// As long as t_react covers the time to the second dangerous reading (two cycles of 0.6 s by default), the vehicle
// stops with the margin left; each look lost at that moment costs the distance travelled in one period. No map is used.
// Frames: velocity over ground in B. One thread at a time; update allocates nothing.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <isobath/sonar/range_reading.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct ImminentCollisionConfig {
  double reaction_s = 1.2;
  double braking = 0.25;  ///< m/s2
  double margin_m = 3;
  int hits = 2;
  int looks = 3;
  Angle cone_slack = Angle::degrees(5);
  double unknown_speed = 2;   ///< m/s
  double min_confidence = 0;  ///< minimum confidence of a reading
};

std::vector<Field> fields(ImminentCollisionConfig& config);

class ImminentCollision {
 public:
  /// Throws Error if `hits` is above `looks`.
  ImminentCollision(const ImminentCollisionConfig& config, std::size_t sensors);

  /// Returns whether the alarm is raised. `v_B`: velocity of B over ground, components in B; empty: not known.
  bool update(std::size_t sensor, const RangeReading& reading, const std::optional<Eigen::Vector3d>& v_B);
  [[nodiscard]] bool raised() const { return raised_; }
  [[nodiscard]] std::uint64_t unusable() const { return unusable_; }
  /// Range below which an echo ahead is dangerous, m.
  [[nodiscard]] double danger_range(double closing_speed) const;

 private:
  [[nodiscard]] bool dangerous(const RangeReading& reading, const std::optional<Eigen::Vector3d>& v_B) const;

  ImminentCollisionConfig config_;
  std::vector<std::uint32_t> looks_;  ///< by sensor, the newest look in bit 0
  bool raised_ = false;
  std::uint64_t unusable_ = 0;
};

}  // namespace isobath
