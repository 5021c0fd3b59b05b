// FaultConfig: one fault of a simulated vehicle, as [[fault]] of a scene states it.
//
// A fault begins `after_s` after `at_s` on the clock of the run, or after the first event named `when`. It lasts for
// `for_s` (0: to the end); the instant of its end is excluded. It belongs to a source: "sonar", "sonar.2", "altimeter",
// "altimeter.2", "compass", "ahrs", "gyro", "dvl", "depth", "gps", "lbl", "navigation", "thruster" (all), "thruster.2"
// (counted from 1), "vehicle", or a part of the host: "agent.NAME", "link" (to the operator), "health" (its reports),
// "disk", "planner".
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
#pragma once

#include <cstdint>
#include <isobath/base/config.hpp>
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
  static constexpr int kMaxThrusters = 16;  ///< thrusters that a source can name

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
/// Throws Error for an unknown source, a kind that its source cannot have, or an invalid amount or time.
void check_fault(const FaultConfig& fault);
/// The number in "sonar.2"; 0 if there is none, -1 if it is not in 1 .. 99 (thrusters: 1 .. kMaxThrusters).
int number_of_source(std::string_view source);
/// [[fault]]: appends to `faults`, which must outlive the schema.
SectionList section_list(std::vector<FaultConfig>& faults);

}  // namespace isobath
