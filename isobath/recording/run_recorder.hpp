// RunRecorder: records a run as it happens (docs/recording.md), so that it can be run again, replayed on the page
// (RecordedDisplay) and shown by other viewers (FoxgloveLog). It records every event, the ground truth if there is one,
// every message of the agents, decisions, set-points, the tracks of moving bodies, and the items of the live page.
// Scenario, mission, vehicle parameters and configuration are attachments.
//
//   RunRecorder recorder("run.mcap", configuration);
//   recorder.describe(simulator, scenario_toml);  recorder.describe(setup);
//   recorder.on_event(event);                     // each event, before it is handled
//   recorder.on_ping(ping); recorder.on_scan(scan);
//   recorder.on_message(envelope); recorder.setpoint(time, setpoint);
//   recorder.sample(time, items);                 // after each event: takes one every `display_s`
//   recorder.close();
//
// Display items: each sample writes the changes since the last one to /display. A complete sample goes to
// /display/whole first of all, and again when `keyframe_s` has passed and the changes since then take more bytes than
// the items themselves. The recording of the display thus takes at most about twice the bytes of its changes, and a
// seek reads at most about twice the bytes that the page then holds.
//
// The recorder is not essential to a vehicle. After the first failed write it writes nothing more, and `problem` says
// why; only the constructor throws. The same calls give the same bytes. Any number of threads.
#pragma once

#include <filesystem>
#include <functional>
#include <isobath/configuration/configuration.hpp>
#include <isobath/display/display_state.hpp>
#include <isobath/io/mcap/native_log.hpp>
#include <isobath/onboard/mission_setup.hpp>
#include <isobath/recording/foxglove_log.hpp>
#include <isobath/scenario/scenario.hpp>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

namespace isobath {

/// Names of the attachments.
inline constexpr const char* kScenarioAttachment = "scene.toml";
inline constexpr const char* kMissionAttachment = "mission.toml";
inline constexpr const char* kConfigurationAttachment = "configuration.toml";
/// The key that marks a live run in the details of a source.
inline constexpr const char* kLiveDetail = "live";
/// Topics.
inline constexpr const char* kDisplayTopic = "/display";
inline constexpr const char* kWholeDisplayTopic = "/display/whole";
inline constexpr const char* kMessagesTopic = "/messages";
inline constexpr const char* kTracksTopic = "/tracks";
inline constexpr const char* kServoTopic = "/servo";

class RunRecorder : public ResultSink, public SimulatedSource::TruthSink {
 public:
  /// Throws Error if the file cannot be created, or if its name does not end in .mcap.
  RunRecorder(const std::filesystem::path& file, const Configuration& configuration);
  RunRecorder(const RunRecorder&) = delete;
  RunRecorder& operator=(const RunRecorder&) = delete;
  ~RunRecorder() override = default;

  // The inputs of the run; call before the first event.
  /// `live`: a run with real threads, whose replay may decide otherwise (kLiveDetail).
  void describe(const Simulator& simulator, const std::string& scenario_toml, bool live = false);
  void describe(const SourceReport& source, bool live = false);
  void describe(const MissionSetup& setup);
  /// The geographic origin of W, once it is known; only the first call counts.
  void locate(const GeoOrigin& origin);

  // The run itself.
  void on_event(const Event& event);
  /// A fix as everything on board receives it, for the channels of other viewers.
  void on_fix(const Navigation& fix);
  void on_truth(const EchoTruth& echoes) override;
  void on_truth(const TrueMotion& motion) override;
  void on_ping(const PosedPing& ping) override;
  void on_vertical_ping(const PosedPing& ping) override { on_ping(ping); }
  void on_scan(const ScanResult& scan) override;
  /// A message of the agents; a decision is also written to its own channel.
  void on_message(const Envelope& envelope);
  /// Written only when it changes.
  void setpoint(Time time, const Setpoint& setpoint);
  /// Commands to the actuators (servo_json).
  void servo(Time time, std::uint64_t parent, const ActuatorVector& commands);
  /// Takes a sample of the display if one is due, or in any case with `at_once`, as at the end of the run. Returns
  /// whether it took one. No sample is taken at a time before the last one, and a second one at the same time only with
  /// `at_once`: changes after the last event get the time of that event.
  bool sample(Time time, const DisplayState& items, bool at_once = false);

  void close();

  /// Why nothing more is written; empty as long as all is well.
  [[nodiscard]] std::string problem() const;
  /// The number of writes left out after that.
  [[nodiscard]] std::uint64_t left_out() const;

 private:
  void guarded(const std::function<void()>& write);

  mutable std::mutex mutex_;
  RecorderConfig config_;
  NativeLogWriter log_;
  std::optional<FoxgloveLog> foxglove_;
  std::uint16_t display_ = 0, whole_ = 0;
  std::uint16_t messages_ = 0;  ///< channel, made with the first message: without a mission there are none
  std::uint16_t tracks_ = 0;    ///< channel, made with the first body that moves
  std::uint16_t servo_ = 0;     ///< channel, made with the first commands to actuators
  bool located_ = false;
  std::optional<Setpoint> last_setpoint_;
  std::optional<Time> sampled_, whole_at_;
  std::uint64_t stamp_ = 0;  ///< stamp of the display at the last sample
  std::uint64_t bytes_since_whole_ = 0;
  std::string problem_;
  std::uint64_t left_out_ = 0;
};

}  // namespace isobath
