// ScanningHead: makes pings of one beam from the echo lines of a mechanically scanned sonar (ledger S6-01).
//
// The bearing of a line becomes the azimuth of the fan, clockwise seen from above; the direction of bearing zero in the
// body (mount_heading) is in X_BS. There is one fan per bearing, so that equal pointers mean equal directions.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/input/input_config.hpp>
#include <map>

namespace isobath {

struct BeamSize {
  Angle width;
  Angle height;
};
/// The beam size of the configuration, else that of the device.
BeamSize beam_size(const InputConfig& config, BeamSize device);

/// X_BS of a sonar at the origin of the body, turned by mount_heading.
Pose mounted(const InputConfig& config);

class ScanningHead {
 public:
  ScanningHead(const InputConfig& config, BeamSize device);

  /// `bearing`: from the head's zero direction, in the device's direction of growth. `samples`: window.bins bytes that
  /// `owner` keeps alive.
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
