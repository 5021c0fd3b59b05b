// Missions of the scenario files, sailed by all agents; and what their stories are told from.
#pragma once

#include <gtest/gtest.h>
#include <isobath/display/decision_json.hpp>
#include <isobath/onboard/mission_setup.hpp>
#include <isobath/report/mission_outcome.hpp>
#include <isobath/run/closed_loop.hpp>
#include <isobath/scenario/mission_chart.hpp>
#include <string>
#include <tests/support/data.hpp>

namespace isobath::test {

inline Scenario scenario_of(const std::string& name) {
  return load_scenario((source_folder() / "scenarios" / (name + ".toml")).string());
}

struct Sailed {
  LoopResult result;
  std::vector<Event> events;
  std::vector<std::pair<Time, std::vector<SeenObstacle>>> scans;  ///< what each scan showed, where it was believed
  std::string all() const {
    std::string text;
    for (const Decision& d : result.decisions) text += decision_json(d) + "\n";
    return text;
  }
};

/// Keeps events and scans.
class ScanLog : public OnboardObserver {
 public:
  explicit ScanLog(Sailed& sailed) : sailed_(sailed) {}
  void on_event(const Event& event) override { sailed_.events.push_back(event); }
  void on_scan(const ScanResult& scan) override {
    auto& seen = sailed_.scans.emplace_back(scan.detection.time, std::vector<SeenObstacle>{}).second;
    for (const Obstacle& o : scan.detection.obstacles) {
      seen.push_back({scan.detection.time, world_outline(o, scan.detection.X_WB), o.existence});
    }
  }

 private:
  Sailed& sailed_;
};

inline Sailed sail(const Scenario& scenario, LoopRequest request = {}) {
  Sailed sailed;
  ScanLog log(sailed);
  request.observers.push_back(&log);
  sailed.result = run_closed_loop(scenario, request);
  return sailed;
}

/// The first decision of this kind at or after `from`; the number of decisions where there is none.
inline std::size_t find_decision(const std::vector<Decision>& decisions, const std::string& agent,
                                 const std::string& what, std::size_t from = 0) {
  std::size_t i = from;
  while (i < decisions.size() && (decisions[i].agent != agent || decisions[i].what != what)) ++i;
  return i;
}

}  // namespace isobath::test
