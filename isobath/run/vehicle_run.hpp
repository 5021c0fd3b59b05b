// VehicleRun: a run of one vehicle, or of a log, from its input to its folder: the input, Onboard and the observers.
#pragma once

#include <chrono>
#include <isobath/onboard/onboard.hpp>
#include <isobath/report/run_outcome.hpp>
#include <isobath/run/closed_loop.hpp>
#include <isobath/run/cycle_watch.hpp>
#include <isobath/run/level_notes.hpp>
#include <isobath/run/mission_in_force.hpp>
#include <isobath/run/mission_notes.hpp>
#include <isobath/run/moving_fan.hpp>
#include <isobath/run/run_display.hpp>
#include <isobath/run/run_folder.hpp>
#include <isobath/run/run_pace.hpp>
#include <isobath/run/run_request.hpp>
#include <isobath/run/run_source.hpp>
#include <isobath/run/stepped_run.hpp>
#include <isobath/scenario/detection_scorer.hpp>
#include <isobath/scenario/ground_truth_trajectory.hpp>
#include <isobath/scenario/mission_chart.hpp>
#include <isobath/scenario/scenario.hpp>
#include <isobath/world/depth_model.hpp>
#include <limits>
#include <memory>
#include <utility>

namespace isobath {

class VehicleRun final : public SteppedRun {
 public:
  explicit VehicleRun(const RunRequest& asked);

  /// The events of a log are handled to the end.
  bool advance(double until_s) override;
  [[nodiscard]] bool mission_is_over() const override { return mission_over_; }
  [[nodiscard]] Simulator* simulator() override {
    return input_.simulated() ? &input_.simulated()->simulator() : nullptr;
  }
  [[nodiscard]] const Scenario& scenario() const override { return *scenario_; }
  [[nodiscard]] std::vector<FrameBytes> take_packets() override { return std::exchange(packets_, {}); }
  void hear(OperatorFrame packet) override { input_.simulated()->hear(std::move(packet)); }
  /// Ends the run and writes its folder. To be called once.
  RunOutcome outcome();

 private:
  std::optional<MissionSetup> mission();
  std::unique_ptr<Helm> make_helm() const;
  void invite_observers();
  std::optional<Event> next();
  /// Handles one event completely. Returns false if the run is to end.
  bool take(Event event);
  /// Sends the set-point of the helm to the vehicle. Returns false once the mission has been over for long enough.
  bool steer();
  void steer_aboard(const Setpoint& setpoint);
  [[nodiscard]] bool is_live() const { return request_.has_real_threads(); }
  /// Null: no page plans.
  [[nodiscard]] MissionDesk* desk() const { return request_.watch ? request_.watch->desk : nullptr; }
  /// Notes the commands to the actuators, once a cycle of the executors (S2-39).
  void note_servo(Time time);
  void show(Time time);
  void show_scene(Time time);
  MissionOutcome mission_outcome();
  void add_voxels(RunOutcome& outcome);
  [[nodiscard]] double vehicle_radius_m() const;
  void finish_display(RunOutcome& outcome);

  const std::optional<Scenario> scenario_;
  const RunRequest request_;
  const std::vector<std::string> priors_;
  const std::string fingerprint_;       ///< of the input, if it goes into a stored map
  const std::optional<MapVisit> held_;  ///< the visit that brought this log into the map before
  DepthModel depths_;
  RunInput input_;
  std::vector<std::string> timing_;  ///< departures of the timing table from its rules
  const std::optional<MissionSetup> setup_;

  // Observers.
  RunFolder folder_;
  std::optional<MovingFan> fan_;  ///< for logs
  std::optional<DetectionScorer> judge_;
  std::optional<MapDelayScorer> map_judge_;
  std::optional<GroundTruthTrajectory> track_;
  MissionNotes notes_;
  MissionInForce in_force_;
  LevelNotes levels_{request_.configuration.mission.timing};
  std::optional<Time> servo_due_;  ///< of the next note of the actuators
  RunDisplay display_;

  const std::shared_ptr<StageTimes> times_ = std::make_shared<StageTimes>();
  const std::unique_ptr<Helm> helm_;  ///< null: no mission
  Onboard onboard_;

  std::optional<LivePace> live_;
  std::optional<CycleWatch> cycles_;  ///< live at a stated speed
  std::optional<WatchedPace> watched_;
  std::string live_datum_;             ///< live: the depth datum; depths_ itself belongs to the mapping thread
  std::optional<DisplayScene> scene_;  ///< as last shown
  EndOfMission end_;
  Time first_ = Time::max(), last_ = Time::min();
  std::vector<FrameBytes> packets_;
  bool begun_ = false, over_ = false, mission_over_ = false;
  const std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();  ///< only for timings
};

}  // namespace isobath
