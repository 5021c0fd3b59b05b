#include <algorithm>
#include <isobath/vehicle/state_evaluator.hpp>

namespace isobath {

std::vector<Field> fields(StateEvaluatorConfig& c) {
  return {
      Field::real("periods", &c.periods, {1, 1000}, "1", "A module that is silent for more of its periods is lost."),
      Field::real("low_battery_share", &c.low_battery_share, {0, 1}, "1", "Below this share of a charge, fuel is low."),
  };
}

StateEvaluator::StateEvaluator(const StateEvaluatorConfig& config, const std::vector<WatchedModule>& modules,
                               Time start)
    : config_(config) {
  for (const WatchedModule& m : modules) {
    if (m.period.count() <= 0) throw Error("a module's period is not above 0", {{}, {}, {}, {}, m.name});
    periods_.push_back(m.period);
    table_.push_back({m.name, HealthState::kOk, start, 0});
  }
}

void StateEvaluator::beat(std::size_t module, Time time) {
  ISOBATH_ASSERT(module < table_.size());
  table_[module].last_beat = std::max(table_[module].last_beat, time);
}

void StateEvaluator::on_health(const Health& report) {
  const auto known =
      std::find_if(reports_.begin(), reports_.end(), [&](const Health& h) { return h.source == report.source; });
  if (known == reports_.end()) {
    reports_.push_back(report);
  } else if (report.time >= known->time) {
    *known = report;
  }
}

std::span<const ModuleStatus> StateEvaluator::evaluate(Time now, EmergencyFlags& flags) {
  bool lost = false;
  for (std::size_t i = 0; i < table_.size(); ++i) {
    ModuleStatus& m = table_[i];
    m.periods_silent = std::max(0.0, to_seconds(now - m.last_beat) / to_seconds(periods_[i]));
    m.state = m.periods_silent > config_.periods ? HealthState::kLost : HealthState::kOk;
    lost = lost || m.state == HealthState::kLost;
  }
  bool blind = false, leak = false, low = false;
  for (const Health& h : reports_) {
    lost = lost || (h.source == "vehicle" && h.state == HealthState::kLost);
    blind = blind || (h.source != "vehicle" && h.state == HealthState::kLost);
    leak = leak || h.leak;
    low = low || !(h.battery_share >= config_.low_battery_share);  // NaN counts as low
  }
  const auto tell = [&](Emergency e, bool up) { up ? flags.set(e, now) : flags.clear(e); };
  tell(Emergency::kModuleFailure, lost);
  tell(Emergency::kSensorFailure, blind);
  tell(Emergency::kLeak, leak);
  tell(Emergency::kLowFuel, low);
  return table_;
}

}  // namespace isobath
