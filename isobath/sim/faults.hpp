// Faults: the faults of a simulated vehicle and their times (design: a test injects every fault of the Safety Officer's
// table).
//
// A fault begins `after_s` after `at_s` on the clock of the run, or after the first event named `when`. It lasts for
// `for_s` (0: to the end); the instant of its end is excluded. It belongs to a source: "sonar", "sonar.2", "altimeter",
// "altimeter.2", "compass", "ahrs", "gyro", "dvl", "depth", "gps", "lbl", "navigation", "thruster" (all), "thruster.2"
// (counted from 1), "vehicle", or a part of the host: "agent.NAME", "link" (to the operator), "health" (its reports),
// "disk", "planner". Several faults may be active at once; they act in the order of the list.
//
//   kind           sources         effect                                                amount (period_s)
//   off            any reading,    no reading arrives; an agent dies; the link is down;   -
//                  agent, link,    no health is reported; the disk is full
//                  health, disk
//   stuck          any reading,    the last good reading repeats under new times; an      -
//                  agent           agent hangs
//   garbage        any reading     random values, some of them not finite; of a ping      -
//                                  only the samples, which stay finite
//   wrong_scale    any reading,    values are multiplied; of a ping the ranges (start,   factor, not 1
//                  planner         bin), not the samples; of the planner its budget
//   wrong_gain     sonar           samples are multiplied, up to full scale              factor, not 1
//   slow           any reading     at most one reading per period                        - (period)
//   delayed        any reading     readings arrive late, with their own time             s
//   intermittent   any reading,    readings are lost with this probability; if there is  share
//                  link            a period, in the first share of each period
//   drifting       reading but no  value + amount x time since the start: heading,       per second: m, rad, m/s, rad/s
//                  ping            roll, forward velocity, yaw rate, depth, range, north
//   jump           the same        the same value + amount, from the start on            m, rad, m/s, rad/s
//   blind_side     sonar           samples 0 to port (-1) or starboard (+1) of boresight  -1 or 1
//   saturated      sonar           samples at full scale                                  -
//   leak           vehicle         water inside                                          -
//   battery        vehicle         charge is lost, at once or evenly over a period       share (period)
//   thruster_loss  thruster        thrust is lost                                        share
//   clock_jump     vehicle         the vehicle's clock is off                            s
//
// The last four kinds change no reading: `vehicle_faults` states them and the simulator applies them. The simulated
// host (agents, planner, link) applies the faults of its parts as `active` states them. Readings of a source without an
// active fault pass unchanged, bit for bit. Errors: the constructor throws Error (tier 2) with file, line and column
// for an unknown source, a kind that its source cannot have, or an invalid amount; nothing throws after construction.
// One thread. Times are on the caller's clock; random numbers come from the seed and the position in the list.
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
  Place place = {};  ///< position in the file, for errors
  std::string source = "vehicle";
  FaultKind kind = FaultKind::kOff;
  double at_s = 0;
  std::string when = {};  ///< name of the event that starts the fault; empty: `at_s` applies
  double after_s = 0;
  double for_s = 0;
  double amount = 0;
  double period_s = 0;
};
std::vector<Field> fields(FaultConfig& config);
/// [[fault]]: appends to `faults`, which must outlive the schema.
SectionList section_list(std::vector<FaultConfig>& faults);

/// The active faults that concern no reading, at one instant.
struct VehicleFaults {
  static constexpr int kMaxThrusters = 16;

  bool leak = false;
  double battery_lost = 0;  ///< share of a full charge that faults have drained so far; it never decreases
  std::array<double, kMaxThrusters> thrust_share{};  ///< remaining share of each thruster's thrust, 0..1
  Duration clock_offset{};                           ///< the vehicle's clock minus the true one
};

class FaultSchedule {
 public:
  /// Throws Error. `start`: the time at which `at_s` is 0.
  FaultSchedule(std::vector<FaultConfig> faults, std::uint64_t seed, Time start = {});

  /// Reports an event: faults that wait for it begin. Only the first report of an event counts.
  void raise(std::string_view event, Time now);
  /// The first active fault of the source; null: none.
  [[nodiscard]] const FaultConfig* active(std::string_view source, Time now) const;
  [[nodiscard]] VehicleFaults vehicle_faults(Time now) const;

  [[nodiscard]] const std::vector<FaultConfig>& faults() const { return faults_; }
  /// The start time of fault i; empty: not active.
  [[nodiscard]] std::optional<Time> active_since(std::size_t i, Time now) const;
  [[nodiscard]] std::uint64_t seed() const { return seed_; }

 private:
  std::vector<FaultConfig> faults_;
  std::vector<std::optional<Time>> begin_;
  std::uint64_t seed_;
};

/// Applies the faults of one source to its readings. T: NavReading, RangeReading, Navigation or Ping; the `storage` of
/// a Ping must own its samples. The schedule must outlive the channel.
template <class T>
class FaultyChannel {
 public:
  FaultyChannel(const FaultSchedule& schedule, const std::string& source);

  /// Adds a reading that the sensor has made at `now`.
  void push(Time now, T reading);
  /// The next reading that has arrived by `now`, oldest arrival first; empty: none left. Call it also without a push,
  /// since delayed readings become due on their own.
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
