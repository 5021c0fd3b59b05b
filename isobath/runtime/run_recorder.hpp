// RunRecorder: a run written down as it happens (docs/recording.md), so that it can be run again, looked at again
// (RecordedDisplay), and shown by other viewers (FoxgloveLog): every event, the truth where there is one, every message
// of the crew, what was decided and what the vehicle was told to do, and what the live page showed; with scenario,
// mission, the vehicle's sheet and the configuration as attachments.
//
//   RunRecorder recorder("run.mcap", configuration);
//   recorder.describe(simulator, scenario_toml);  recorder.describe(setup);
//   recorder.take(event);                         // each, before anybody else has it
//   recorder.on_ping(ping); recorder.on_scan(scan); recorder.heard(envelope);
//   recorder.heard(envelope); recorder.setpoint(time, setpoint);
//   recorder.sample(time, items);                 // after each event: takes one every `display_s`
//   recorder.close();
//
// The display: what has changed since the last sample goes to /display; all of it goes to /display/whole with the first
// sample, and again whenever the changes since then outweigh it and `whole_s` has passed. So a recording of the display
// is at most about twice its changes, and what a seek must read at most about twice what the page holds then.
//
// The recorder is not essential to a vehicle: once something could not be written, nothing more is, and `problem` says
// why; only the constructor throws. The same calls give the same bytes. Any number of threads.
#pragma once

#include <filesystem>
#include <functional>
#include <isobath/io/native_log.hpp>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/display_items.hpp>
#include <isobath/runtime/foxglove_log.hpp>
#include <isobath/runtime/mission_setup.hpp>
#include <isobath/runtime/scenario.hpp>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

namespace isobath {

/// Names of what is attached.
inline constexpr const char* kScenarioAttachment = "scene.toml";
inline constexpr const char* kMissionAttachment = "mission.toml";
inline constexpr const char* kConfigurationAttachment = "configuration.toml";
/// Among the details of a source: a live run.
inline constexpr const char* kLiveDetail = "live";
/// Topics.
inline constexpr const char* kDisplayTopic = "/display";
inline constexpr const char* kWholeDisplayTopic = "/display/whole";
inline constexpr const char* kMessagesTopic = "/messages";

class RunRecorder : public ResultSink, public SimulatedSource::TruthSink {
 public:
  /// Throws Error where the file cannot be made, or has no name that ends in .mcap.
  RunRecorder(const std::filesystem::path& file, const Configuration& configuration);
  RunRecorder(const RunRecorder&) = delete;
  RunRecorder& operator=(const RunRecorder&) = delete;
  ~RunRecorder() override = default;

  // What the run is made of: before the first event.
  /// `live`: by real threads, so that it may be decided otherwise when it is heard again (kLiveDetail).
  void describe(const Simulator& simulator, const std::string& scenario_toml, bool live = false);
  void describe(const SourceReport& source);
  void describe(const MissionSetup& setup);
  /// Where on the globe the origin of W is, once that is known; the first word counts.
  void locate(const GeoOrigin& origin);

  // What happens.
  void take(const Event& event);
  void take(const EchoTruth& echoes) override;
  void take(const TrueMotion& motion) override;
  void on_ping(const PosedPing& ping) override;
  void on_upright(const PosedPing& ping) override { on_ping(ping); }
  void on_scan(const ScanResult& scan) override;
  /// A message of the crew; a decision is written apart, too.
  void heard(const Envelope& envelope);
  /// Written where it changes.
  void setpoint(Time time, const Setpoint& setpoint);
  /// A sample of the display, when one is due, or `at_once`, such as at the end. Whether there was one; none is taken
  /// at a time before that of the last, and a second one at the same time only at once: what was changed after the last
  /// event is seen at its time.
  bool sample(Time time, const DisplayItems& items, bool at_once = false);

  void close();

  /// Why no more is written; empty as long as all is well.
  [[nodiscard]] std::string problem() const;
  /// What came after that and is not in the file.
  [[nodiscard]] std::uint64_t left_out() const;

 private:
  void guarded(const std::function<void()>& write);

  mutable std::mutex mutex_;
  RecorderConfig config_;
  NativeLogWriter log_;
  std::optional<FoxgloveLog> foxglove_;
  std::uint16_t display_ = 0, whole_ = 0;
  std::uint16_t messages_ = 0;  ///< made with the first: without a mission there are none
  bool located_ = false;
  std::optional<Setpoint> last_setpoint_;
  std::optional<Time> sampled_, whole_at_;
  std::uint64_t stamp_ = 0;  ///< of the display, up to which it is in the log
  std::uint64_t bytes_since_whole_ = 0;
  std::string problem_;
  std::uint64_t left_out_ = 0;
};

}  // namespace isobath
