#include <isobath/runtime/baseline_helms.hpp>
#include <isobath/runtime/evaluation.hpp>

namespace isobath {
namespace {

std::unique_ptr<Helm> make_baseline(Baseline baseline, const Scenario& scenario, const VehicleSheet& vehicle) {
  switch (baseline) {
    case Baseline::kPotentialField:
      return std::make_unique<PotentialFieldHelm>(scenario.mission, vehicle, PotentialFieldConfig{});
    case Baseline::kImageThreshold:
      return std::make_unique<ImageThresholdHelm>(scenario.mission, vehicle, ImageThresholdConfig{});
    default: return std::make_unique<LineOfSightHelm>(scenario.mission, vehicle);
  }
}

}  // namespace

std::vector<Competitor> competitors_of(const Suite& suite, const Configuration& configuration) {
  std::vector<Competitor> all;
  for (const Baseline baseline : suite.baselines) {
    if (baseline == Baseline::kAsPrinted) continue;
    all.push_back({to_text(baseline), configuration,
                   [baseline](const Scenario& scenario, const VehicleSheet& vehicle, const Configuration&) {
                     return make_baseline(baseline, scenario, vehicle);
                   }});
  }
  return all;
}

}  // namespace isobath
