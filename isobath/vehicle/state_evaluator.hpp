// StateEvaluator: the health of every control module and sensor, and the emergency bits that follow (Oskard 1990, I;
// ledger S1-05).
//
// A module beats once a period; it is lost when its last beat is more than `periods` of its periods old, and well again
// with its next beat. A module that never beat counts from the start. Health reports of the vehicle and its sensors are
// kept by their source. `evaluate` sets and clears
//   module failure   a module is lost, or the vehicle says that it is
//   sensor failure   a sensor says that it is lost
//   leak, low fuel   the last report that named them; fuel by `low_battery_share`
// so that a bit goes up in the first cycle in which its cause is seen.
//
// Times are those of the events. One thread at a time (the flags may be watched from any); `beat` and `evaluate`
// allocate nothing, `hear` only at a source's first report.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/vehicle/emergency_flags.hpp>
#include <isobath/vehicle/health.hpp>
#include <span>
#include <string>
#include <vector>

namespace isobath {

struct StateEvaluatorConfig {
  double periods = 3;
  double low_battery_share = 0.2;
};

std::vector<Field> fields(StateEvaluatorConfig& config);

struct WatchedModule {
  std::string name;
  Duration period = std::chrono::milliseconds(600);  ///< the cycle of S1-05
};

struct ModuleStatus {
  std::string name;
  HealthState state = HealthState::kOk;
  Time last_beat;
  double periods_silent = 0;
};

class StateEvaluator {
 public:
  /// Periods must be above 0.
  StateEvaluator(const StateEvaluatorConfig& config, const std::vector<WatchedModule>& modules, Time start);

  /// `module`: its place in the list. A beat older than the last one is not taken.
  void beat(std::size_t module, Time time);
  void hear(const Health& report);
  /// The table as it stands at `now`; valid until the next call.
  std::span<const ModuleStatus> evaluate(Time now, EmergencyFlags& flags);
  /// The last report of each source, in the order of their first ones.
  [[nodiscard]] std::span<const Health> reports() const { return reports_; }

 private:
  StateEvaluatorConfig config_;
  std::vector<Duration> periods_;
  std::vector<ModuleStatus> table_;
  std::vector<Health> reports_;
};

}  // namespace isobath
