// Envelope: the last word on a set-point before it leaves: nothing goes out that vehicle or mission do not allow.
//
// Depth is held in its range and above the least altitude, speed in its range; a set-point speeds up and turns no
// faster than the limits, but a reduction of speed passes at once: a stop is never delayed. Sway gives way where both
// together would be too fast. A number that is not finite makes a safe set-point: hold heading and depth at the least
// speed. Everything that was cut is counted.
//
// Pure apart from the set-point before; nothing allocates or throws. Units SI. One thread at a time.
#pragma once

#include <cstdint>
#include <isobath/vehicle/autopilot.hpp>
#include <isobath/vehicle/vehicle_sheet.hpp>
#include <optional>

namespace isobath {

struct EnvelopeLimits {
  double min_depth = 0;  ///< m
  double max_depth = 100;
  double min_altitude = 0;      ///< m, where the bottom is known; stands above min_depth, not above the surface
  double min_speed = 0;         ///< m/s; above 0: the vehicle never stops nor goes astern
  double max_speed = 2;         ///< ahead and astern, over ground
  double max_acceleration = 1;  ///< m/s2
  /// A second. Twice the vehicle's own by default: a set-point that turns no faster would hold the vehicle back.
  Angle max_turn_rate = Angle::degrees(60);
};

/// What the vehicle allows; a mission narrows it.
EnvelopeLimits limits_of(const VehicleSheet& sheet);

/// How many set-points were changed in what respect.
struct EnvelopeCounts {
  std::uint64_t set_points = 0;
  std::uint64_t not_finite = 0;
  std::uint64_t depth = 0;
  std::uint64_t altitude = 0;
  std::uint64_t speed = 0;
  std::uint64_t acceleration = 0;
  std::uint64_t turn_rate = 0;
};

class Envelope {
 public:
  /// Throws Error where a limit is not finite or a range is empty.
  explicit Envelope(const EnvelopeLimits& limits);

  /// `bottom_depth` below the vehicle, m. dt: since the set-point before, s.
  Setpoint limit(const Setpoint& wanted, const Pose& X_WB, const std::optional<double>& bottom_depth, double dt);

  [[nodiscard]] const EnvelopeLimits& limits() const { return limits_; }
  [[nodiscard]] const EnvelopeCounts& counts() const { return counts_; }

 private:
  [[nodiscard]] Setpoint safe(const Pose& X_WB) const;
  [[nodiscard]] double limited_speed(double wanted, double before, double dt);

  EnvelopeLimits limits_;
  EnvelopeCounts counts_;
  std::optional<Setpoint> last_;
};

}  // namespace isobath
