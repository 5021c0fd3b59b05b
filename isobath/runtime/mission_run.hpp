// MissionRun: a mission beside a run, whether what it hears is simulated, recorded or sensed: the helm, what it
// decides, how long that takes, and what the pages say of it.
//
// For each event, in this order: hear, then the pipeline with this object among its sinks, then steer.
#pragma once

#include <chrono>
#include <filesystem>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/mission_helm.hpp>
#include <isobath/runtime/mission_outcome.hpp>
#include <isobath/runtime/scenario.hpp>
#include <optional>
#include <vector>

namespace isobath {

/// What a crew is made for.
struct MissionSetup {
  MissionPlan plan;
  VehicleSheet vehicle;
};
/// A vehicle's sheet as a file has it: [vehicle].
std::vector<Section> vehicle_sections(VehicleSheet& sheet);

/// For an input that is a scenario or a log: `mission` names a mission file or another scenario, or, empty, leaves it
/// to the scenario itself. The vehicle is the simulator's; of a log the one that it was recorded with, else the
/// default one. Empty where there is no mission point. Throws Error.
std::optional<MissionSetup> mission_setup(const std::filesystem::path& mission, const std::filesystem::path& input,
                                          const Simulator* simulator);
/// The whole crew at the helm. Throws Error where it cannot be made.
std::unique_ptr<MissionHelm> make_mission_helm(const MissionSetup& setup, const Configuration& configuration);

/// How many decisions, from the first on, are those that the log holds, and how many it holds; empty where the input is
/// no log with decisions.
struct Recorded {
  std::uint64_t decisions = 0, the_same = 0;
};
std::optional<Recorded> compare_with_log(const std::vector<Decision>& decisions, const std::filesystem::path& input);

class MissionRun : public ResultSink {
 public:
  /// Throws Error where the crew cannot be made.
  MissionRun(const MissionSetup& setup, const Configuration& configuration);

  void hear(const Event& event);
  void on_ping(const PosedPing& ping) override;
  void on_scan(const ScanResult& scan) override;
  Setpoint steer();
  /// Time that was spent for others between hear and steer: no part of the stages.
  void leave_out(double milliseconds) { left_out_ms_ += milliseconds; }

  [[nodiscard]] const Helm& helm() const { return *helm_; }
  /// So far, without what only the truth knows.
  [[nodiscard]] MissionOutcome outcome() const;

 private:
  using Clock = std::chrono::steady_clock;  // for timings alone: no result depends on it

  std::unique_ptr<MissionHelm> helm_;
  std::vector<BelievedPlace> believed_;
  std::vector<SeenObstacle> seen_;

  Clock::time_point begun_;
  bool pinged_ = false, swept_ = false;  ///< by the event that is under way
  double left_out_ms_ = 0;
  double crew_ms_ = 0;  ///< of what the pipeline was asked for, spent in the helm
  std::vector<double> event_ms_, ping_ms_, scan_ms_;
};

}  // namespace isobath
