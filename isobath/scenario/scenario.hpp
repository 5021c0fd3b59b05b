// Scenario: a scene with the mission of the same file, the orders of its operator, and the chart on board the vehicle.
// SimulatedSource: a scene as a source of events; `isobath run SCENARIO` runs it without a log file in between.
#pragma once

#include <deque>
#include <filesystem>
#include <isobath/cameras/camera_rig.hpp>
#include <isobath/configuration/configuration.hpp>
#include <isobath/event/event.hpp>
#include <isobath/mission/plan/mission_plan.hpp>
#include <isobath/scenario/simulated_operator.hpp>
#include <isobath/sim/simulator.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// Whether a path names a scene: it ends in .toml, or it is empty (the embedded scene).
bool is_scene(const std::filesystem::path& input);

/// The seed of a vehicle of a group; the first has that of the run.
int seed_of_vehicle(int seed, std::size_t vehicle);

/// Scene and mission of one vehicle, or of a group: the vehicles of a scene with a group share the mission's search
/// area.
struct Scenario {
  Scene scene;
  MissionPlan mission;                ///< without points if the file has no mission
  std::vector<OperatorOrder> orders;  ///< [[operator]]
  DepthPriorConfig prior;             ///< [prior]: used if the configuration names no prior

  /// The scenario of one vehicle of the group: it is [vehicle], its mission knows which vehicle it is, the others are
  /// bodies of the scene, and its seed is its own. `vehicle` counts from 0, which is [vehicle] of the file.
  [[nodiscard]] Scenario of_vehicle(std::size_t vehicle) const;
  /// Leaves the first vehicles of the group only.
  void keep_vehicles(std::size_t count);
  /// In the scene of a vehicle: the index of another vehicle's body.
  [[nodiscard]] std::size_t body_of(std::size_t other) const;

  /// The configuration, with the prior of the scenario if it names none itself.
  [[nodiscard]] Configuration with_prior(Configuration configuration) const;
};
/// Throws Error with line and column.
Scenario load_scenario(const std::string& file);
Scenario parse_scenario(std::string_view text, const std::string& file);

/// From a file; an empty path is the embedded scenario (scenarios/pandan.toml). Throws Error.
Scenario open_scenario(const std::filesystem::path& input = {});
/// Only the scene, for runs along its own way-points.
Scene open_scene(const std::filesystem::path& input = {});
/// The text of the embedded scenario; the text of any scenario.
std::string_view embedded_scene();
std::string scenario_text(const std::filesystem::path& input);

/// The events of a simulated vehicle. Ground truth is delivered to the truth sinks before the event that it describes.
/// Pairs of pictures of the scene's cameras come as swaths of ranges, and carry the fixes (CameraRig).
/// Frames of an operator come as events; `answer` takes the frames of the vehicle for the operator.
/// Agents, the operator's link and the planner are not parts of the simulator. When a fault of one of them begins or
/// ends, a health report states it, so that a log of the events holds the fault: state lost, with the note kHangs for
/// an agent that hangs, or the planner_report of the planner.
class SimulatedSource : public Source {
 public:
  class TruthSink {
   public:
    virtual ~TruthSink() = default;
    virtual void on_truth(const EchoTruth& echoes) = 0;
    virtual void on_truth(const TrueMotion& motion) = 0;
  };

  explicit SimulatedSource(Scene scene, const SimulationConfig& config = {}, int threads = 1,
                           const CamerasConfig& cameras = {});

  std::optional<Event> next() override;
  [[nodiscard]] const SourceReport& report() const override { return report_; }
  /// Adds a receiver of ground truth; it must outlive the source.
  void tell_truth_to(TruthSink& sink) { truth_.push_back(&sink); }
  /// Adds an operator with timed orders; without orders there is no operator. `plan`: the plan of a start order.
  void add_operator(const std::vector<OperatorOrder>& orders, const MissionPlan& plan);
  /// An operator gives this order now; without an operator, one is added.
  void order(OperatorCommand command, const MissionPlan& plan);
  /// A packet from another vehicle arrives.
  void hear(OperatorFrame frame) { told_.emplace_back(std::move(frame)); }
  /// Frames that the vehicle sends to the operator now.
  void answer(const std::vector<FrameBytes>& frames);
  /// Null: there is no operator.
  [[nodiscard]] const SimulatedOperator* at_the_link() const { return operator_ ? &*operator_ : nullptr; }
  [[nodiscard]] Simulator& simulator() { return simulator_; }

 private:
  void watch_host();

  Simulator simulator_;
  std::vector<std::unique_ptr<CameraRig>> rigs_;  ///< of each pair of cameras of the scene; null: it is off
  SourceReport report_;
  std::vector<TruthSink*> truth_;
  struct HostPart {
    std::string source;
    bool lost = false;
  };
  std::vector<HostPart> host_;  ///< agents, link and planner, as far as the scene has faults of them
  std::optional<SimulatedOperator> operator_;
  std::deque<Event> told_;  ///< health reports and operator frames that `next` returns first
};

}  // namespace isobath
