// Faults: what breaks on a simulated vehicle, and when (design: a test injects every fault of the Safety Officer's
// table).
//
// A fault begins `after_s` after `at_s` on the clock of the run, or after the first event named `when`, and lasts for
// `for_s` (0: to the end), the last instant excluded. It belongs to a source: "sonar", "sonar.2", "altimeter",
// "altimeter.2", "compass", "ahrs", "gyro", "dvl", "depth", "gps", "lbl", "navigation", "thruster" (all), "thruster.2"
// (counted from 1), "vehicle", or of the host: "agent.NAME", "link" (to the operator), "health" (its reports), "disk",
// "planner". Several may hold at once; they act in the order of the list.
//
//   kind           on              does                                                  amount (period_s)
//   off            any reading,    none comes; an agent dies; nobody is heard over the    -
//                  agent, link,    link; no health is reported; nothing more can be
//                  health, disk    written
//   stuck          any reading,    repeats the last good one under new times; an agent    -
//                  agent           hangs
//   garbage        any reading     values at random, now and then not finite; of a ping  -
//                                  the samples only: sizes and finiteness stay valid
//   wrong_scale    any reading,    multiplied; of a ping the ranges (start, bin), not    factor, not 1
//                  planner         samples; of the planner its budget
//   wrong_gain     sonar           samples multiplied, up to full scale                  factor, not 1
//   slow           any reading     one a period at most                                  - (period)
//   delayed        any reading     comes late, with its own time                         s
//   intermittent   any reading,    lost with this probability; of a reading with a       share
//                  link            period: in the first share of each period
//   drifting       reading but no  value + amount x time since the beginning: heading,   per second: m, rad, m/s, rad/s
//                  ping            roll, forward velocity, yaw rate, depth, range, north
//   jump           the same        the same value + amount, from the beginning on        m, rad, m/s, rad/s
//   blind_side     sonar           samples 0 to port (-1) or starboard (+1) of boresight  -1 or 1
//   saturated      sonar           samples at full scale                                  -
//   leak           vehicle         water inside                                          -
//   battery        vehicle         charge lost, at once or evenly over a period           share (period)
//   thruster_loss  thruster        thrust lost                                           share
//   clock_jump     vehicle         its clock is off                                      s
//
// The last four change no reading: `vehicle_faults` says what holds, and the simulator acts on it; on those of the host
// whoever plays the host does, as `active` says. A source without an
// active fault passes bit for bit. Errors: Error (tier 2) with file, line and column for an unknown source, a kind that
// its source cannot have, or an amount that makes no sense; nothing after construction. One thread. Time is
// that of the caller's clock; random numbers come from the seed and the place in the list.
#pragma once

#include <array>
#include <cstdint>
#include <isobath/base/config.hpp>
#include <isobath/base/random.hpp>
#include <isobath/base/time.hpp>
#include <isobath/sim/navigation_sensors.hpp>
#include <isobath/sonar/ping.hpp>
#include <isobath/sonar/range_reading.hpp>
#include <isobath/vehicle/navigation.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

enum class FaultKind : std::uint8_t {
  kOff,
  kStuck,
  kGarbage,
  kWrongScale,
  kWrongGain,
  kSlow,
  kDelayed,
  kIntermittent,
  kDrifting,
  kJump,
  kBlindSide,
  kSaturated,
  kLeak,
  kBattery,
  kThrusterLoss,
  kClockJump
};
const char* to_text(FaultKind kind);

struct FaultConfig {
  Place place = {};  ///< where it stands in a file, for errors
  std::string source = "vehicle";
  FaultKind kind = FaultKind::kOff;
  double at_s = 0;
  std::string when = {};  ///< name of the event that it waits for; empty: `at_s` counts
  double after_s = 0;
  double for_s = 0;
  double amount = 0;
  double period_s = 0;
};
std::vector<Field> fields(FaultConfig& config);
/// [[fault]]: appends to `faults`, which must outlive the schema.
SectionList section_list(std::vector<FaultConfig>& faults);

/// What does not concern a reading, at one instant.
struct VehicleFaults {
  static constexpr int kMaxThrusters = 16;

  bool leak = false;
  double battery_lost = 0;  ///< share of a full charge that faults have taken so far; it does not come back
  std::array<double, kMaxThrusters> thrust_share{};  ///< of its thrust that each thruster still gives, 0..1
  Duration clock_offset{};                           ///< the vehicle's clock minus the true one
};

class FaultSchedule {
 public:
  /// Throws Error. `start` is the instant 0 of `at_s`.
  FaultSchedule(std::vector<FaultConfig> faults, std::uint64_t seed, Time start = {});

  /// Something has happened: faults that wait for it begin. Only the first time counts.
  void raise(std::string_view event, Time now);
  /// The first active fault of the source; null: sound.
  [[nodiscard]] const FaultConfig* active(std::string_view source, Time now) const;
  [[nodiscard]] VehicleFaults vehicle_faults(Time now) const;

  [[nodiscard]] const std::vector<FaultConfig>& faults() const { return faults_; }
  /// When fault i began, if it is active.
  [[nodiscard]] std::optional<Time> active_since(std::size_t i, Time now) const;
  [[nodiscard]] std::uint64_t seed() const { return seed_; }

 private:
  std::vector<FaultConfig> faults_;
  std::vector<std::optional<Time>> begin_;
  std::uint64_t seed_;
};

/// The way of the readings of one source through its faults. T: NavReading, RangeReading, Navigation or Ping, whose
/// `storage` must own its samples. The schedule must outlive it.
template <class T>
class FaultyChannel {
 public:
  FaultyChannel(const FaultSchedule& schedule, const std::string& source);

  /// A reading that the sensor has made now.
  void push(Time now, T reading);
  /// The next reading that has arrived by now, oldest arrival first; empty: none left. Call after each push, too, since
  /// delayed ones fall due on their own.
  std::optional<T> pop(Time now);

 private:
  struct Fault {
    std::size_t index;  ///< in the schedule
    Random random;
    std::optional<Time> last_passed = {};
    std::optional<T> held = {};
  };
  struct Waiting {
    Time arrival;
    T reading;
  };
  /// False: the reading is lost.
  bool apply(Fault& fault, Time since, Time now, T& reading, Duration& delay);

  const FaultSchedule* schedule_;
  std::vector<Fault> faults_;
  std::optional<T> last_good_;
  std::vector<Waiting> waiting_;  ///< in order of arrival
};

extern template class FaultyChannel<NavReading>;
extern template class FaultyChannel<RangeReading>;
extern template class FaultyChannel<Navigation>;
extern template class FaultyChannel<Ping>;

}  // namespace isobath
