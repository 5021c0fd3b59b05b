#include <algorithm>
#include <cmath>
#include <isobath/sonar/swath.hpp>

namespace isobath {

SwathFault check(const Swath& swath) {
  if (swath.soundings.size() > Swath::kMaxSoundings) return SwathFault::kTooMany;
  const auto finite = [](const Sounding& s) {
    return s.point.allFinite() && std::isfinite(s.range_m) && s.range_m >= 0 && std::isfinite(s.sigma_m) &&
           s.sigma_m >= 0 && std::isfinite(s.sigma_range_m) && s.sigma_range_m >= 0;
  };
  const bool head = std::isfinite(swath.sound_speed) && swath.beam_width.degrees() >= 0 &&
                    swath.beam_width.degrees() <= 360 && swath.beam_height.degrees() >= 0 &&
                    swath.beam_height.degrees() <= 360 && (!swath.heading || std::isfinite(swath.heading->radians()));
  return head && std::all_of(swath.soundings.begin(), swath.soundings.end(), finite) ? SwathFault::kNone
                                                                                     : SwathFault::kNotFinite;
}

const char* to_text(SwathFault fault) {
  switch (fault) {
    case SwathFault::kNone: return "no fault";
    case SwathFault::kNotFinite: return "swath not finite";
    case SwathFault::kTooMany: return "swath of more soundings than beams can be numbered";
  }
  return "unknown";
}

Pose frame_in_world(const Swath& swath, const Pose& X_WB) {
  if (swath.frame == Swath::Frame::kBody) return X_WB;
  Pose X_WF = X_WB;
  X_WF.rotation = Rotation::from_heading(swath.heading.value_or(X_WB.rotation.heading()));
  X_WF.translation.z() = 0;
  return X_WF;
}

}  // namespace isobath
