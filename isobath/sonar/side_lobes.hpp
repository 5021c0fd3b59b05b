// SideLobes: removes side-lobe echoes from the decisions of a fan. All beams receive a loud echo of one beam at the
// same range, weaker by the attenuation of their side lobes. The bottom straight below an echo sounder so draws an arc
// through the water on either side.
//
// An echo is removed, and its bin loses its information, if it is weaker by more than kLevel than the loudest sample of
// the ping at its range (within kSmear bins). A target hidden by the side lobe may be there. Bins without an echo stay
// unchanged.
//
// kLevel, measured on four recordings of three Kongsberg sonars: more than 15 degrees aside, the loudest echo appears
// 32 to 50 dB weaker (three recordings; in a fourth, of another mode, up to 8 dB). The bottom that these sonars detect
// themselves is at most 17 dB below the loudest echo at its range. Samples are amplitudes. Not for fans with compressed
// samples. After the first ping of a size nothing allocates.
#pragma once

#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/ping.hpp>
#include <vector>

namespace isobath {

class SideLobes {
 public:
  static constexpr float kLevel = 0.056F;  ///< -25 dB
  static constexpr int kSmear = 2;         ///< bins

  /// The ping must pass `check`; the decisions have its size.
  void leave_out(const Ping& ping, EchoDecisions& decisions);

 private:
  std::vector<float> beam_, loudest_, around_;
};

}  // namespace isobath
