// StateEvaluator: the health of every control module and sensor, and the resulting emergency bits (Oskard 1990, I;
// ledger S1-05).
//
// A module sends a heartbeat once a period. It is lost when its last heartbeat is more than `periods` of its periods
// old, and well again at its next one. A module without a heartbeat counts from the start. The last health report of
// the vehicle and of each sensor is kept by source. `evaluate` sets and clears
//   module failure   a module is lost, or the vehicle reports that it is
//   sensor failure   a sensor reports that it is lost
//   leak, low fuel   the last report that named them; fuel by `low_battery_share`
// so that a bit is raised in the first cycle that sees its cause.
//
// Times are those of the events. One thread at a time (any thread may watch the flags). `beat` and `evaluate` allocate
// nothing, `on_health` only at a source's first report.
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

  /// `module`: its index in the list. Ignores a beat that is older than the last one.
  void beat(std::size_t module, Time time);
  void on_health(const Health& report);
  /// The table at `now`; valid until the next call.
  std::span<const ModuleStatus> evaluate(Time now, EmergencyFlags& flags);
  /// The last report of each source, in the order of their first reports.
  [[nodiscard]] std::span<const Health> reports() const { return reports_; }

 private:
  StateEvaluatorConfig config_;
  std::vector<Duration> periods_;
  std::vector<ModuleStatus> table_;
  std::vector<Health> reports_;
};

}  // namespace isobath
