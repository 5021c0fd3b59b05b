// Scenario: a scene, with the mission that stands in the same file; and a scene as a source of events: `isobath run
// SCENARIO` runs it without a file between.
#pragma once

#include <deque>
#include <filesystem>
#include <isobath/io/event.hpp>
#include <isobath/mission/mission_plan.hpp>
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
  MissionPlan mission;  ///< without points where the file holds none
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
/// Faults of parts that no simulator has, agents and the operator's link, are told by health reports when they begin
/// and end: state lost, and of an agent that hangs the note kHangs; so a log of the events holds them.
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
  void tell_truth_to(TruthSink* sink) { truth_ = sink; }
  [[nodiscard]] Simulator& simulator() { return simulator_; }

 private:
  void watch_host();

  Simulator simulator_;
  SourceReport report_;
  TruthSink* truth_ = nullptr;
  struct HostPart {
    std::string source;
    bool lost = false;
  };
  std::vector<HostPart> host_;  ///< those that have faults
  std::deque<Health> told_;     ///< of them, to be given next
};

}  // namespace isobath
