// SoundingFan: the soundings in the water of one swath as a ping of a flat fan with its decisions, so that what a 3-D
// sonar has found ahead becomes an obstacle of the body grid like any other echo.
//
// A sounding counts as an echo if it lies within `band_m` above or below the vehicle. The water in front of the nearest
// echo of a beam is clear, what lies behind it is hidden. In a beam without an echo, water is clear as far as a ray to
// any sounding stays within the band. All other bins have no information: a direction without a sounding may be clear
// or absorb the sound.
//
// Swaths count from the first sounding within the band on: an echo sounder that looks down makes no scans.
//
// Frame: points are levelled (roll and pitch removed) about the vehicle; beams are 1 degree wide. After the largest
// swath nothing allocates. One thread.
#pragma once

#include <isobath/geometry/pose.hpp>
#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/ping.hpp>
#include <isobath/sonar/swath.hpp>
#include <memory>
#include <vector>

namespace isobath {

class SoundingFan {
 public:
  explicit SoundingFan(double band_m) : band_m_(band_m) {}

  /// Returns false if the swath has no sounding in the water, in the body frame, or none lay within the band so far.
  bool update(const Swath& swath, const Pose& X_WB);
  /// The results for the last swath that update() accepted. The ping has no samples.
  [[nodiscard]] const Ping& ping() const { return ping_; }
  [[nodiscard]] const EchoDecisions& decisions() const { return decisions_; }
  [[nodiscard]] EchoDecisions& decisions() { return decisions_; }

 private:
  struct Heard {
    double azimuth = 0, range_m = 0, clear_m = 0;  ///< rad, horizontal; as far as the ray stays in the band
    bool in_band = false;
  };
  void gather(const Swath& swath, const Pose& X_WB);
  void fit();
  void decide();
  [[nodiscard]] int beam_of(double azimuth) const;

  double band_m_;
  bool begun_ = false;  ///< a sounding lay within the band
  Ping ping_;
  EchoDecisions decisions_;
  std::vector<Heard> heard_;
  std::vector<int> clear_to_;  ///< of each beam: the first bin that no ray out of the band clears
};

}  // namespace isobath
