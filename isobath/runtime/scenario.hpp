// Scenario: a scene, with the mission that stands in the same file, what its operator asks for, and the chart that the
// vehicle has been given; and a scene as a source of events: `isobath run SCENARIO` runs it without a file between.
#pragma once

#include <deque>
#include <filesystem>
#include <isobath/io/event.hpp>
#include <isobath/mission/mission_plan.hpp>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/simulated_operator.hpp>
#include <isobath/sim/simulator.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// Whether a file names a scene: by its ending, .toml.
bool is_scene(const std::filesystem::path& input);

struct Scenario {
  Scene scene;
  MissionPlan mission;                ///< without points where the file holds none
  std::vector<OperatorOrder> orders;  ///< [[operator]]
  DepthPriorConfig prior;             ///< [prior]: for a configuration that names none

  /// The configuration, with the scenario's own prior where it names none.
  [[nodiscard]] Configuration with_prior(Configuration configuration) const;
};
/// Throws Error with line and column.
Scenario load_scenario(const std::string& file);
Scenario parse_scenario(std::string_view text, const std::string& file);

/// From a file; the embedded one (scenarios/pandan.toml) for an empty path. Throws Error.
Scenario open_scenario(const std::filesystem::path& input);
/// Its scene alone: what runs by way-points of its own.
Scene open_scene(const std::filesystem::path& input);
/// The text of the embedded scenario, or of any.
std::string_view embedded_scene();
std::string scenario_text(const std::filesystem::path& input);

/// The events that the vehicle gives; the truths are handed to whoever asks for them, before what they are about.
/// Frames of an operator come as events, what the vehicle says to him goes by `answer`.
/// Faults of parts that no simulator has, agents, the operator's link and the planner, are told by health reports when
/// they begin and end: state lost, of an agent that hangs the note kHangs, of the planner its planner_report; so a log
/// of the events holds them.
inline constexpr const char* kHangs = "hangs";
class SimulatedSource : public Source {
 public:
  class TruthSink {
   public:
    virtual ~TruthSink() = default;
    virtual void take(const EchoTruth& echoes) = 0;
    virtual void take(const TrueMotion& motion) = 0;
  };

  SimulatedSource(Scene scene, const SimulationConfig& config, int threads);

  std::optional<Event> next() override;
  [[nodiscard]] const SourceReport& report() const override { return report_; }
  /// To each of those that it was given; they must outlive it.
  void tell_truth_to(TruthSink& sink) { truth_.push_back(&sink); }
  /// An operator who orders at times; without orders there is none. `plan`: what is started.
  void add_operator(const std::vector<OperatorOrder>& orders, const MissionPlan& plan);
  /// Somebody at the link now: an operator who orders this, one who has ordered before or a new one.
  void order(OperatorCommand::Kind command, const MissionPlan& plan);
  /// What the vehicle says to him now.
  void answer(const std::vector<FrameBytes>& frames);
  /// Null: there is none.
  [[nodiscard]] const SimulatedOperator* at_the_link() const { return operator_ ? &*operator_ : nullptr; }
  [[nodiscard]] Simulator& simulator() { return simulator_; }

 private:
  void watch_host();

  Simulator simulator_;
  SourceReport report_;
  std::vector<TruthSink*> truth_;
  struct HostPart {
    std::string source;
    bool lost = false;
  };
  std::vector<HostPart> host_;  ///< those that have faults
  std::optional<SimulatedOperator> operator_;
  std::deque<Event> told_;  ///< of the host and of the operator, to be given next
};

}  // namespace isobath
