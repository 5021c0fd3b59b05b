// RunLog: a simulated run written down as it happens, so that it can be run again: every event that the vehicle gave,
// the truth beside it, what was decided and what the vehicle was told to do; with the scenario, the mission, the
// vehicle's sheet and the configuration as attachments. io/native_log.hpp says how.
#pragma once

#include <isobath/io/native_log.hpp>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/mission_run.hpp>
#include <isobath/runtime/scenario.hpp>

namespace isobath {

/// Names of what is attached.
inline constexpr const char* kScenarioAttachment = "scene.toml";
inline constexpr const char* kMissionAttachment = "mission.toml";
inline constexpr const char* kVehicleAttachment = "vehicle_sheet.toml";
inline constexpr const char* kConfigurationAttachment = "configuration.toml";

class RunLog : public SimulatedSource::TruthSink {
 public:
  /// Throws Error where the file cannot be made, or has no name that ends in .mcap.
  RunLog(const std::filesystem::path& file, const Simulator& simulator, const std::string& scenario_toml,
         const Configuration& configuration);
  /// Of a run with a mission.
  void attach(const MissionSetup& setup);

  void write(const Event& event) { log_.write(event); }
  void take(const EchoTruth& echoes) override { log_.write(echoes); }
  void take(const TrueMotion& motion) override { log_.write(motion); }
  /// A set-point is written where it changes.
  void write(Time time, const Setpoint& setpoint, const std::vector<Decision>& decisions);
  void close() { log_.close(); }

 private:
  NativeLogWriter log_;
  std::optional<Setpoint> last_;
  std::size_t decided_ = 0;  ///< decisions that are in the log
};

}  // namespace isobath
