// EchoTruth: the true origin of each sample of a simulated ping. Detectors never see it; it serves their evaluation.
#pragma once

#include <cstdint>
#include <isobath/base/time.hpp>
#include <string>
#include <vector>

namespace isobath {

/// Path of an echo.
enum class EchoPath : std::uint8_t {
  kNoise,  ///< no echo above the background
  kDirect,
  kSideLobe,       ///< direct, received by the side lobe of a beam
  kSurfaceBounce,  ///< over the surface, on the outward or return path or both
  kBottomBounce,
  kBodyBounce,
  kMultiple,    ///< twice between a wall and the sonar's own housing
  kVolume,      ///< scattered in the water
  kRinging,     ///< the transmit pulse itself
  kSpurious,    ///< a false echo
  kDisturbance  ///< another sonar, a streak, a burst
};

/// Target of an echo (0 nothing, 1 surface, 2 bottom, 3 and up: bodies in the order of World::bodies), in 12 bits, and
/// its path.
class EchoLabel {
 public:
  EchoLabel() = default;
  EchoLabel(int target, EchoPath path)
      : code_(static_cast<std::uint16_t>((target & 0xfff) << 4 | static_cast<int>(path))) {}
  [[nodiscard]] int target() const { return code_ >> 4; }
  [[nodiscard]] EchoPath path() const { return static_cast<EchoPath>(code_ & 0xf); }
  [[nodiscard]] std::uint16_t code() const { return code_; }
  bool operator==(const EchoLabel&) const = default;

 private:
  std::uint16_t code_ = 0;
};

struct EchoTruth {
  Time time;          ///< time of the ping
  std::string sonar;  ///< its name
  int beams = 0, bins = 0;
  std::vector<EchoLabel> labels;  ///< beam by beam
};

}  // namespace isobath
