#include <isobath/evaluation/baseline_helms.hpp>
#include <isobath/evaluation/evaluation.hpp>
#include <isobath/evaluation/traffic_helms.hpp>
#include <isobath/onboard/mission_setup.hpp>
#include <isobath/scenario/mission_chart.hpp>
#include <limits>

namespace isobath {
namespace {

constexpr const char* kOurs = "isobath";

std::unique_ptr<Helm> make_ours(const Scenario& scenario, const VehicleParameters& vehicle,
                                const Configuration& configuration) {
  return make_serial_helm({scenario.mission, vehicle, chart_of(scenario, configuration)}, configuration);
}

/// The method as the paper prints it: its update of the grid (ledger S6-E01 ff.), route cells of 5 m, corners cut, no
/// memory beyond the grid.
Configuration as_printed(Configuration configuration) {
  configuration.update.update = GridMapperConfig::Update::kPrinted;
  configuration.grid.shifting = BodyGridConfig::Shifting::kPrinted;
  configuration.mission.route = RouteConfig::as_printed();
  configuration.executor.arbiter.safety_officer.clear();  // the paper's watches only the fence
  configuration.mission.fls_detector.memory_radius_m = 0;
  configuration.mission.fls_detector.margin_cells = 0;
  return configuration;
}

/// The grid follows every fix, also those that correct the position (ledger S6-62; Ganesan 2015, 2.2).
Configuration world_fixed(Configuration configuration) {
  configuration.poses.jump_m = std::numeric_limits<double>::infinity();
  return configuration;
}

ComparedMethod baseline_of(Baseline baseline, const Configuration& configuration) {
  ComparedMethod method{to_text(baseline), configuration, make_ours};
  switch (baseline) {
    case Baseline::kNoAvoidance:
      method.make = [](const Scenario& scenario, const VehicleParameters& vehicle, const Configuration&) {
        return std::make_unique<LineOfSightHelm>(scenario.mission, vehicle);
      };
      break;
    case Baseline::kPotentialField:
      method.make = [](const Scenario& scenario, const VehicleParameters& vehicle, const Configuration& c) {
        return std::make_unique<PotentialFieldHelm>(scenario.mission, vehicle,
                                                    PotentialFieldConfig{.clearance_m = c.mission.route.clearance_m});
      };
      break;
    case Baseline::kImageThreshold:
      method.make = [](const Scenario& scenario, const VehicleParameters& vehicle, const Configuration& c) {
        return std::make_unique<ImageThresholdHelm>(scenario.mission, vehicle,
                                                    ImageThresholdConfig{.route = c.mission.route});
      };
      break;
    case Baseline::kHistogramThreshold:
      method.make = [](const Scenario& scenario, const VehicleParameters& vehicle, const Configuration& c) {
        return std::make_unique<ImageThresholdHelm>(
            scenario.mission, vehicle,
            ImageThresholdConfig{.threshold = ImageThreshold::kBetweenModes, .scans = 2, .route = c.mission.route});
      };
      break;
    case Baseline::kVelocityObstacles:
      method.make = [](const Scenario& scenario, const VehicleParameters& vehicle, const Configuration&) {
        return std::make_unique<VelocityObstacleHelm>(scenario.mission, vehicle, discs_of(scenario.scene),
                                                      VelocityObstacleConfig{});
      };
      break;
    case Baseline::kStopAndWait:
      method.make = [](const Scenario& scenario, const VehicleParameters& vehicle, const Configuration& c) {
        return std::make_unique<StopAndWaitHelm>(scenario.mission, vehicle,
                                                 StopAndWaitConfig{.clearance_m = c.mission.route.clearance_m});
      };
      break;
    case Baseline::kAsPrinted: method.configuration = as_printed(configuration); break;
    case Baseline::kWorldFixedGrid: method.configuration = world_fixed(configuration); break;
  }
  return method;
}

}  // namespace

std::vector<ComparedMethod> methods_of(const Suite& suite, const Configuration& configuration) {
  std::vector<ComparedMethod> all{{kOurs, configuration, make_ours}};
  for (const Baseline baseline : suite.baselines) all.push_back(baseline_of(baseline, configuration));
  return all;
}

}  // namespace isobath
