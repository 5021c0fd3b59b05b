// SideLobes: a loud echo in one beam of a fan is heard in all others too, at the same range and weaker by what their
// side lobes let through. The floor straight below an echo sounder so draws an arc through the water on either side.
//
// An echo that is weaker than the loudest sample of the ping at its range, within kSmear bins, by more than kLevel is
// taken out, and its bin says nothing: what stands there may be a target that the side lobe hides. Bins without an echo
// are left as they are.
//
// kLevel, measured on four recordings of three Kongsberg sonars: what is heard of the loudest echo more than 15 degrees
// aside lies 32 to 50 dB below it (three recordings; a fourth of another mode up to 8 dB), the bottom that these sonars
// detect themselves at most 17 dB below the loudest at its range. Samples are amplitudes. Not for fans whose samples
// are compressed. After the first ping of a size nothing allocates.
#pragma once

#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/ping.hpp>
#include <vector>

namespace isobath {

class SideLobes {
 public:
  static constexpr float kLevel = 0.056F;  ///< -25 dB
  static constexpr int kSmear = 2;         ///< bins

  /// The ping passes check; decisions have its size.
  void leave_out(const Ping& ping, EchoDecisions& decisions);

 private:
  std::vector<float> beam_, loudest_, around_;
};

}  // namespace isobath
