// RunDisplay: what a run shows and writes down as it goes: the items of the page, the recording, the film of the
// report.
//
//   RunDisplay display(request, setup, input);
//   onboard.show_to(display);
//   helm.show_messages_to([&](const Envelope& envelope) { display.heard(envelope); });
//   display.look(...); display.sample(time);  // after each event
//   display.finish(last);
//
// Of a run that takes its turns all of it is done here and now, in one order. A live run tells it from several threads:
// whoever senses and steers (on_event, take, on_setpoint, wants_scene, show, sample), whoever maps (all other on_*),
// the crew (heard). There a TaskThread does it, and nobody waits: what is told is copied, and handed over. The
// voxels alone are made into items by whoever maps, whose they are: an eighth of what has changed a look.
#pragma once

#include <isobath/base/task_thread.hpp>
#include <isobath/runtime/display.hpp>
#include <isobath/runtime/map_display.hpp>
#include <isobath/runtime/mission_setup.hpp>
#include <isobath/runtime/onboard_observer.hpp>
#include <isobath/runtime/run_film.hpp>
#include <isobath/runtime/run_recorder.hpp>
#include <isobath/runtime/run_request.hpp>
#include <isobath/runtime/run_source.hpp>
#include <memory>
#include <optional>
#include <vector>

namespace isobath {

class RunDisplay : public OnboardObserver, public SimulatedSource::TruthSink {
 public:
  /// That wait in a live run: 64 MiB of pings of 512 beams x 500 samples.
  static constexpr TaskThread::Bounds kWaiting{.pings = 256, .all = 4096};

  /// Throws Error where the recording cannot be made.
  RunDisplay(const RunRequest& request, const std::optional<MissionSetup>& setup, RunInput& input);

  /// Whether the run is shown, recorded or filmed at all; without it nothing else need be called.
  [[nodiscard]] bool on() const { return display_.has_value(); }
  [[nodiscard]] const RunRecorder* recorder() const { return recorder_ ? &*recorder_ : nullptr; }
  /// Null: the report is without.
  [[nodiscard]] RunFilm* film() { return film_ ? &*film_ : nullptr; }
  [[nodiscard]] const DisplayItems& items() const { return *shown_; }

  // Of whoever senses and steers.
  void on_event(const Event& event) override;
  void take(const EchoTruth& echoes) override;
  void take(const TrueMotion& motion) override;
  void on_setpoint(Time time, const Setpoint& setpoint) override;
  /// Whether to show the scene and the timings again.
  [[nodiscard]] bool wants_scene(Time time);
  void show(Time time, const DisplayScene& scene);
  /// Shown, not recorded: no two runs have the same. `lost_pings`: in a full queue before the map.
  void show(Time time, const MissionTimings& timings, std::uint64_t lost_pings);
  void sample(Time time);

  // Of whoever maps.
  void on_ping(const PosedPing& ping) override;
  void on_upright(const PosedPing& ping) override;
  void on_scan(const ScanResult& scan) override;
  void on_jump(const Eigen::Vector3d& by_W) override;
  void on_mapped(Time time, const Pipeline& pipeline, const DepthModel& depths, const VoxelModel& voxels) override;
  /// Maps and counts, of which each is looked at when it is time. Where the run takes its turns, after `show`.
  void look(Time time, const Pipeline& pipeline, const DepthModel& depths, const VoxelModel& voxels);

  /// Of the crew: every message.
  void heard(const Envelope& envelope);

  /// Live: waits until all that it was told is shown.
  void settle();
  /// After the last event, which was at `last`: the last sample, and the end of the recording. What is told later goes
  /// nowhere.
  void finish(Time last);
  /// Live: what could not be shown, and why nothing more was; after finish.
  [[nodiscard]] TaskThread::LeftOut left_out() const;
  [[nodiscard]] std::string problem() const;

 private:
  using Kind = TaskThread::Kind;
  struct KeptPing;
  struct KeptScan;
  void begin_recording(const RunRequest& request, const std::optional<MissionSetup>& setup, RunInput& input);
  /// Has something shown: here and now, or, live, by the display's thread, of a copy.
  template <class... Told>
  void post(Kind kind, void (RunDisplay::*show)(const Told&...), const Told&... told);
  static std::shared_ptr<const KeptPing> keep(const PosedPing& ping);
  static std::shared_ptr<const KeptScan> keep(const ScanResult& scan);
  template <class Told>
  static const Told& keep(const Told& told) {
    return told;
  }
  // What is posted.
  void show_event(const Event& event, const std::optional<GeoOrigin>& origin);
  void show_ping(const PosedPing& ping);
  void show_upright(const PosedPing& ping);
  void show_scan(const ScanResult& scan);
  void show_message(const Envelope& envelope);
  template <class Truth>
  void show_truth(const Truth& truth);
  void show_setpoint(const Time& time, const Setpoint& setpoint);
  void show_scene(const Time& time, const DisplayScene& scene);
  void show_timings(const Time& time, const MissionTimings& timings, const std::uint64_t& lost_pings);
  void show_depths(const Time& time, const std::shared_ptr<const DepthSnapshot>& snapshot);
  void take_counts(const Time& time, const DisplayCounts& counts);
  void show_counts(Time time);
  void show_sample(const Time& time);

  const RunInput& input_;          ///< which says where W lies as soon as that is known
  DisplayItems items_;             ///< where nobody looks on
  DisplayItems* shown_ = &items_;  ///< what a page is shown: these, or a program's own (RunWatch)
  std::optional<RunFilm> film_;
  std::optional<Display> display_;
  std::optional<RunRecorder> recorder_;

  // Live.
  std::optional<MapDisplay> voxels_;                          ///< of whoever maps
  std::optional<Time> scene_shown_, depths_shown_, counted_;  ///< the first of whoever senses, the others of who maps
  std::optional<DisplayCounts> counts_;                       ///< the rest of the display's thread
  std::uint64_t lost_pings_ = 0;
  std::optional<TaskThread> thread_;  ///< last: it uses all the others
};

}  // namespace isobath
