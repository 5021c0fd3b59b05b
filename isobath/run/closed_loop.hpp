// ClosedLoop: runs a scene, a mission and a helm in a closed loop on the simulator's clock (Ganesan 2015, 6.1; ledger
// S6-57). The result holds the ground truth, for scoring.
//
// Onboard maps and steers, as in `isobath run`. The result is a function of scenario, configuration and helm: the same
// events and set-points on any number of threads. Live runs are not deterministic: the loop waits for all threads ten
// times a second of the simulator's clock, and decisions depend on the timing of the threads.
#pragma once

#include <isobath/configuration/configuration.hpp>
#include <isobath/mission/plan/mission_plan.hpp>
#include <isobath/onboard/corner_navigation.hpp>
#include <isobath/onboard/helm.hpp>
#include <isobath/onboard/onboard_observer.hpp>
#include <isobath/onboard/passive_contacts.hpp>
#include <isobath/onboard/pipeline.hpp>
#include <isobath/run/stepped_run.hpp>
#include <isobath/scenario/detection_scorer.hpp>
#include <isobath/scenario/ground_truth_trajectory.hpp>
#include <isobath/scenario/scenario.hpp>
#include <isobath/world/depth_model.hpp>
#include <memory>
#include <utility>

namespace isobath {

class Onboard;
class LivePace;

/// How long the run goes on after the end of the mission.
constexpr double kWatchAfterEnd_s = 5;

struct LoopRequest {
  Configuration configuration;
  int threads = 1;
  bool stop_at_contact = false;             ///< what a vehicle does after a collision is not scored
  bool judge = false;                       ///< whether to score detections against the ground truth; ignored if live
  bool live = false;                        ///< mapping has its own thread; needs a ThreadedHelm
  bool stop_when_done = true;               ///< end some seconds after the mission has finished or was aborted
  std::vector<OnboardObserver*> observers;  ///< must outlive the run
};

struct LoopResult : TrackTruth {
  std::vector<Decision> decisions;
  MissionReport report;
  PipelineCounts counts;
  CornerFixOutcome corner_fix;             ///< without any fix if the configuration asks for none
  std::optional<ContactOutcome> contacts;  ///< if a passive array heard anything
  double duration_s = 0;                   ///< simulated
  TruthScore sight;                        ///< how well the bodies were detected; if `judge`
  std::vector<OperatorAnswer> answers;     ///< received by the operator, if there is one
};

/// Detects the end of a run: kWatchAfterEnd_s after the mission was finished or aborted.
class EndOfMission {
 public:
  [[nodiscard]] bool reached(MissionPhase phase, double now_s);

 private:
  double since_s_ = -1;
};

/// A closed loop in steps, so that the vehicles of a group run side by side (vehicle_group.hpp).
class ClosedLoop final : public SteppedRun {
 public:
  /// `helm` must outlive the loop. `scenario`: of one vehicle.
  ClosedLoop(const Scenario& scenario, Helm& helm, const LoopRequest& request);
  ~ClosedLoop() override;

  bool advance(double until_s) override;
  [[nodiscard]] bool mission_is_over() const override { return mission_over_; }
  [[nodiscard]] Simulator* simulator() override { return &source_.simulator(); }
  [[nodiscard]] const Scenario& scenario() const override { return scenario_; }
  [[nodiscard]] std::vector<FrameBytes> take_packets() override { return std::exchange(packets_, {}); }
  void hear(OperatorFrame packet) override { source_.hear(std::move(packet)); }
  /// Ends the run. To be called once.
  LoopResult result();

 private:
  const Scenario scenario_;
  const LoopRequest request_;
  const Configuration configuration_;
  Helm& helm_;
  SimulatedSource source_;
  DepthModel depths_;
  std::unique_ptr<Onboard> onboard_;
  GroundTruthTrajectory truth_;
  std::optional<DetectionScorer> judge_;
  std::unique_ptr<OnboardObserver> eye_;
  std::unique_ptr<LivePace> pace_;
  EndOfMission end_;
  std::vector<FrameBytes> packets_;
  bool over_ = false, mission_over_ = false;
};

/// The agents of the scenario's mission steer; live, each in a thread of its own. Throws Error if they cannot be made.
LoopResult run_closed_loop(const Scenario& scenario, const LoopRequest& request = {});
/// This helm steers.
LoopResult run_closed_loop(const Scenario& scenario, Helm& helm, const LoopRequest& request);

/// Sends the set-point of the helm to the simulated vehicle, and its answers to the operator. Returns false once the
/// mission has been over for long enough.
bool steer_simulated(Onboard& onboard, Helm& helm, SimulatedSource& source, EndOfMission& end);

}  // namespace isobath
