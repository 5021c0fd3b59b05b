// MissionRun: a mission beside a run, whether what it hears is simulated, recorded or sensed: the helm, what it
// decides, how long that takes, and what the pages say of it.
//
// For each event, in this order: hear, begin, then the pipeline with this object among its sinks, then steer. With real
// threads one hears and steers, another begins and maps.
#pragma once

#include <filesystem>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/live_helm.hpp>
#include <isobath/runtime/mission_outcome.hpp>
#include <isobath/runtime/scenario.hpp>
#include <isobath/runtime/stage_times.hpp>
#include <optional>
#include <utility>
#include <vector>

namespace isobath {

/// What a crew is made for.
struct MissionSetup {
  MissionPlan plan;
  VehicleSheet vehicle;
  ChartUpdate chart = {};
};
/// A vehicle's sheet as a file has it: [vehicle].
std::vector<Section> vehicle_sections(VehicleSheet& sheet);

/// For an input that is a scenario or a log: `mission` names a mission file or another scenario, or, empty, leaves it
/// to the scenario itself. The vehicle is the simulator's; of a log the one that it was recorded with, else the
/// default one. Empty where there is no mission point. Throws Error.
std::optional<MissionSetup> mission_setup(const std::filesystem::path& mission, const std::filesystem::path& input,
                                          const Simulator* simulator);
/// All agents, the Safety Officer and those of libraries among them. Throws Error where one cannot be made.
std::vector<Seat> whole_crew(const MissionSetup& setup, const Configuration& configuration);
/// The whole crew at the helm, in one thread, or each agent in its own. Throws Error where it cannot be made.
std::unique_ptr<MissionHelm> make_mission_helm(const MissionSetup& setup, const Configuration& configuration);
std::unique_ptr<LiveHelm> make_live_helm(const MissionSetup& setup, const Configuration& configuration);

/// How many decisions, from the first on, are those that the log holds, and how many it holds; empty where the input is
/// no log with decisions.
struct Recorded {
  std::uint64_t decisions = 0, the_same = 0;
};
std::optional<Recorded> compare_with_log(const std::vector<Decision>& decisions, const std::filesystem::path& input);

class MissionRun : public ResultSink {
 public:
  /// `live`: each agent in a thread of its own (live_helm.hpp); then mapping may have one, too. Throws Error where the
  /// crew cannot be made.
  MissionRun(const MissionSetup& setup, const Configuration& configuration, bool live);

  /// From now on; before the first event, if it is to hear all. Live, it is called from all threads, one at a time.
  void show_messages_to(const Recorder& recorder) { helm_->show_messages_to(recorder); }
  void hear(const Event& event);
  /// Of whoever maps, before the pipeline has the event that was taken at this time.
  void begin(StageTimes::Clock::time_point taken) { times_->begin(taken); }
  void on_ping(const PosedPing& ping) override;
  void on_scan(const ScanResult& scan) override;
  void on_space(Time time, const std::shared_ptr<const SpaceGrid>& space) { helm_->on_space(time, space); }
  /// Of whoever maps: what was done for others since on_ping or on_scan is no part of the stages.
  void resume() { times_->resume(); }
  Setpoint steer() { return helm_->steer(); }

  [[nodiscard]] Helm& helm() { return *helm_; }
  [[nodiscard]] MissionTimings timings() const { return times_->timings(); }
  /// So far, without what only the truth knows. With real threads: after settle, and while nobody maps.
  [[nodiscard]] MissionOutcome outcome() const;

 private:
  MissionPlan plan_;
  std::shared_ptr<StageTimes> times_;
  std::unique_ptr<Helm> helm_;
  std::vector<BelievedPlace> believed_;
  std::vector<SeenObstacle> seen_;
};

}  // namespace isobath
