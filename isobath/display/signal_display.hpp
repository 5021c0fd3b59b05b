// SignalDisplay: what the vehicle measures and what it is told to do, a sample a second, for the plots of the page.
// One thread.
#pragma once

#include <array>
#include <cstdint>
#include <isobath/base/time.hpp>
#include <isobath/display/display_state.hpp>
#include <optional>
#include <string>

namespace isobath {

/// Angles in degrees, lengths in metres, speeds in m/s; the battery in percent, pings a second.
enum class Signal : std::uint8_t {
  kSpeed,
  kSpeedSetpoint,
  kDepth,
  kDepthSetpoint,
  kAltitude,
  kHeading,
  kHeadingSetpoint,
  kRoll,
  kPitch,
  kDeviation,  ///< of the position
  kNearestObstacle,
  kBattery,
  kPings,
};
inline constexpr std::size_t kSignalCount = static_cast<std::size_t>(Signal::kPings) + 1;

class SignalDisplay {
 public:
  explicit SignalDisplay(DisplayState& items);

  /// The value from now on; NaN: unknown.
  void set(Signal signal, double value);
  /// Shows the values, if the last sample is a second old. `start`: of the run.
  void sample(Time time, Time start);

 private:
  DisplayState& items_;
  std::array<float, kSignalCount> values_{};
  std::string rows_;  ///< samples since the last full item
  std::uint64_t samples_ = 0;
  std::optional<Time> last_;
};

}  // namespace isobath
