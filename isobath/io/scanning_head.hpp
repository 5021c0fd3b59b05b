// ScanningHead: lines of echo of a mechanically scanned sonar, as pings of one beam (ledger S6-01).
//
// The bearing of a line goes into the fan's azimuth, clockwise seen from above; the direction of bearing zero in the
// body (mount_heading) goes into X_BS. Fans are made once a bearing, so that pointer equality says "same direction".
#pragma once

#include <isobath/io/event.hpp>
#include <isobath/io/input_config.hpp>
#include <map>

namespace isobath {

struct BeamSize {
  Angle width;
  Angle height;
};
/// What the user says, else what the device has.
BeamSize beam_size(const InputConfig& config, BeamSize device);

/// X_BS of a sonar that stands in the body's origin, turned by mount_heading.
Pose mounted(const InputConfig& config);

class ScanningHead {
 public:
  ScanningHead(const InputConfig& config, BeamSize device);

  /// `bearing` from the head's zero direction, in the sense of the device. `samples`: window.bins bytes kept by
  /// `owner`.
  Ping ping(Angle bearing, const RangeWindow& window, const std::byte* samples,
            const std::shared_ptr<const void>& owner);
  [[nodiscard]] const BeamSize& beam() const { return beam_; }
  [[nodiscard]] double sound_speed() const { return sound_speed_; }
  [[nodiscard]] const Pose& X_BS() const { return X_BS_; }

 private:
  std::shared_ptr<const BeamFan> fan(Angle azimuth);

  BeamSize beam_;
  Pose X_BS_;
  double sense_;  ///< +1 clockwise, -1 counter-clockwise
  double sound_speed_;
  std::map<double, std::shared_ptr<const BeamFan>> fans_;  ///< by azimuth, rad
};

}  // namespace isobath
