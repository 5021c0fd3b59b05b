// RunDisplay: shows and records a run while it goes on: the items of the live page, the recording, and the replay in
// the report.
//
//   RunDisplay display(request, setup, input);
//   onboard.show_to(display);
//   helm.show_messages_to([&](const Envelope& envelope) { display.on_message(envelope); });
//   display.look(...); display.sample(time);  // after each event
//   display.finish(last);
//
// In a sequential run every call does its work at once. In a live run several threads call: the source thread
// (on_event, on_fix, take, on_setpoint, wants_scene, show, sample), the mapping thread (all other on_*) and the agents'
// threads (on_message). Each call then copies its arguments and posts them to a TaskThread, the display thread, so that
// no caller waits. Only voxels are encoded by the mapping thread, one eighth of the changed blocks per call.
#pragma once

#include <isobath/base/task_thread.hpp>
#include <isobath/display/display.hpp>
#include <isobath/display/map_display.hpp>
#include <isobath/onboard/mission_setup.hpp>
#include <isobath/onboard/onboard_observer.hpp>
#include <isobath/recording/run_recorder.hpp>
#include <isobath/report/embedded_replay.hpp>
#include <isobath/run/run_request.hpp>
#include <isobath/run/run_source.hpp>
#include <memory>
#include <optional>
#include <vector>

namespace isobath {

/// Commands to the actuators of a simulated vehicle.
struct ServoCommands {
  ActuatorVector values;  ///< VehiclePlant::commands
  std::string text;       ///< the same with their names
};

class RunDisplay : public OnboardObserver, public SimulatedSource::TruthSink {
 public:
  /// Bounds of the queue of a live run: 64 MiB of pings of 512 beams x 500 samples.
  static constexpr TaskThread::Bounds kWaiting{.pings = 256, .all = 4096};

  /// Throws Error if the recording cannot be created.
  RunDisplay(const RunRequest& request, const std::optional<MissionSetup>& setup, RunInput& input);

  /// Whether the run is shown, recorded or embedded in the report. If not, no other call is needed.
  [[nodiscard]] bool on() const { return display_.has_value(); }
  [[nodiscard]] const RunRecorder* recorder() const { return recorder_ ? &*recorder_ : nullptr; }
  /// Null: the report has no replay.
  [[nodiscard]] EmbeddedReplay* replay() { return replay_ ? &*replay_ : nullptr; }
  [[nodiscard]] const DisplayState& items() const { return *shown_; }

  // Called by the source thread.
  void on_event(const Event& event) override;
  void on_fix(const Navigation& fix) override;
  void on_truth(const EchoTruth& echoes) override;
  void on_truth(const TrueMotion& motion) override;
  void on_setpoint(Time time, const Setpoint& setpoint) override;
  /// Commands to the actuators, and the number of the message that they serve.
  void servo(Time time, std::uint64_t parent, const ServoCommands& commands);
  /// Whether the scene and the timings are due again.
  [[nodiscard]] bool wants_scene(Time time);
  void show(Time time, const DisplayScene& scene);
  /// Shown but not recorded, because timings differ from run to run. `lost_pings`: dropped from the mapping queue.
  void show(Time time, const MissionTimings& timings, std::uint64_t lost_pings);
  void sample(Time time);

  // Called by the mapping thread.
  void on_ping(const PosedPing& ping) override;
  void on_vertical_ping(const PosedPing& ping) override;
  void on_scan(const ScanResult& scan) override;
  void on_jump(const Eigen::Vector3d& by_W) override;
  void on_sphere(Time time, const std::shared_ptr<const GridSnapshot>& sphere) override;
  void on_contacts(Time time, std::span<const Contact> contacts) override;
  void on_mapped(Time time, const Pipeline& pipeline, const DepthModel& depths, const VoxelModel& voxels) override;
  /// Shows those maps and counts that are due. In a sequential run the caller calls it after `show`.
  void look(Time time, const Pipeline& pipeline, const DepthModel& depths, const VoxelModel& voxels);

  /// Every message of the agents; called by their threads.
  void on_message(const Envelope& envelope);

  /// Live: waits until everything posted is shown.
  void settle();
  /// Call after the last event, whose time is `last`: takes the last sample and ends the recording. Later calls have no
  /// effect.
  void finish(Time last);
  /// Live, after finish: what was dropped, and why the display failed, if it did.
  [[nodiscard]] TaskThread::LeftOut left_out() const;
  [[nodiscard]] std::string problem() const;

 private:
  using Kind = TaskThread::Kind;
  struct KeptPing;
  struct KeptScan;
  void begin_recording(const RunRequest& request, const std::optional<MissionSetup>& setup, RunInput& input);
  void show_to(ViewerFeed& viewers, const FoxgloveConfig& config);
  /// Shows something: at once, or, live, a copy of it in the display thread.
  void show_servo(const Time& time, const std::uint64_t& parent, const ServoCommands& commands);
  template <class... Told>
  void post(Kind kind, void (RunDisplay::*show)(const Told&...), const Told&... told);
  static std::shared_ptr<const KeptPing> keep(const PosedPing& ping);
  static std::shared_ptr<const KeptScan> keep(const ScanResult& scan);
  template <class Told>
  static const Told& keep(const Told& told) {
    return told;
  }
  // The posted work.
  void show_event(const Event& event, const std::optional<GeoOrigin>& origin);
  void show_fix(const Navigation& fix);
  void show_ping(const PosedPing& ping);
  void show_vertical_ping(const PosedPing& ping);
  void show_scan(const ScanResult& scan);
  void show_message(const Envelope& envelope);
  template <class Truth>
  void show_truth(const Truth& truth);
  void show_setpoint(const Time& time, const Setpoint& setpoint);
  void show_scene(const Time& time, const DisplayScene& scene);
  void show_timings(const Time& time, const MissionTimings& timings, const std::uint64_t& lost_pings);
  void show_sphere(const Time& time, const std::shared_ptr<const GridSnapshot>& sphere);
  void show_contacts(const Time& time, const std::vector<Contact>& contacts);
  void show_depths(const Time& time, const std::shared_ptr<const DepthSnapshot>& snapshot);
  void take_counts(const Time& time, const DisplayCounts& counts);
  void show_counts(Time time);
  void show_sample(const Time& time);

  const RunInput& input_;          ///< knows the origin of W as soon as the input states it
  DisplayState items_;             ///< used if no page watches
  DisplayState* shown_ = &items_;  ///< the items in use: items_, or those of the program that watches (RunWatch)
  std::optional<EmbeddedReplay> replay_;
  std::optional<Display> display_;
  std::optional<RunRecorder> recorder_;
  ViewerFeed* viewers_ = nullptr;        ///< null: there can be none
  std::optional<FoxgloveLog> foxglove_;  ///< to the viewers
  std::optional<Time> foxglove_sampled_;
  std::uint64_t foxglove_stamp_ = 0;  ///< of the items at the last sample

  // Live.
  std::optional<MapDisplay> voxels_;                          ///< mapping thread
  std::optional<Time> scene_shown_, depths_shown_, counted_;  ///< the first: source thread; the others: mapping thread
  std::optional<DisplayCounts> counts_;                       ///< this and lost_pings_: display thread
  std::uint64_t lost_pings_ = 0;
  std::optional<TaskThread> thread_;  ///< last, because its tasks use all other members
};

}  // namespace isobath
