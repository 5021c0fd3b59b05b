// RunDisplay: what a run shows and writes down as it goes: the items of the page, the recording, the film of the
// report.
//
//   RunDisplay display(request, setup, input);
//   display.hear(event, origin); display.on_ping(ping); display.heard(envelope); display.steered(...);
//   display.look(...); display.sample(time);  // after each event
//   display.finish(last);
//
// Of a run that takes its turns all of it is done here and now, in one order. A live run tells it from several threads:
// whoever senses and steers (hear, take, steered, wants_scene, show, sample), whoever maps (on_*, look), the crew
// (heard). There a DisplayThread does it, and nobody waits: what is told is copied, and handed over. The voxels alone
// are made into items by whoever maps, whose they are: an eighth of what has changed a look.
#pragma once

#include <isobath/runtime/display.hpp>
#include <isobath/runtime/display_thread.hpp>
#include <isobath/runtime/map_display.hpp>
#include <isobath/runtime/mission_run.hpp>
#include <isobath/runtime/run.hpp>
#include <isobath/runtime/run_film.hpp>
#include <isobath/runtime/run_recorder.hpp>
#include <isobath/runtime/run_source.hpp>
#include <optional>
#include <vector>

namespace isobath {

class RunDisplay : public ResultSink, public SimulatedSource::TruthSink {
 public:
  /// Throws Error where the recording cannot be made.
  RunDisplay(const RunRequest& request, const std::optional<MissionSetup>& setup, RunInput& input);

  /// Whether the run is shown, recorded or filmed at all; without it nothing else need be called.
  [[nodiscard]] bool on() const { return display_.has_value(); }
  [[nodiscard]] const RunRecorder* recorder() const { return recorder_ ? &*recorder_ : nullptr; }
  /// Null: the report is without.
  [[nodiscard]] RunFilm* film() { return film_ ? &*film_ : nullptr; }
  [[nodiscard]] const DisplayItems& items() const { return *shown_; }

  // Of whoever senses and steers.
  /// Before anybody else has the event. `origin`: of W, as soon as it is known.
  void hear(const Event& event, const std::optional<GeoOrigin>& origin);
  void take(const EchoTruth& echoes) override { take_truth(echoes); }
  void take(const TrueMotion& motion) override { take_truth(motion); }
  /// What the vehicle is told, and, where the run takes its turns, all that was decided so far.
  void steered(Time time, const Setpoint& setpoint, const std::vector<Decision>& decisions);
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
  /// Maps and counts, of which each is looked at when it is time.
  void look(Time time, const Pipeline& pipeline, const DepthModel& depths, const VoxelModel& voxels);

  /// Of the crew: every message.
  void heard(const Envelope& envelope);

  /// Live: waits until all that it was told is shown.
  void settle();
  /// After the last event, which was at `last`: the last sample, and the end of the recording. What is told later goes
  /// nowhere.
  void finish(Time last);
  /// Live: what could not be shown, and why nothing more was; after finish.
  [[nodiscard]] DisplayThread::LeftOut left_out() const;
  [[nodiscard]] std::string problem() const;

 private:
  using Kind = DisplayThread::Kind;
  struct KeptPing;
  struct KeptScan;
  void begin_recording(const RunRequest& request, const std::optional<MissionSetup>& setup, RunInput& input);
  template <class Truth>
  void take_truth(const Truth& truth);
  void take_ping(const PosedPing& ping, void (RunDisplay::*show)(const PosedPing&));
  // What a note does: by the display's thread, where there is one.
  void show_event(const Event& event, const std::optional<GeoOrigin>& origin);
  void show_ping(const PosedPing& ping);
  void show_upright(const PosedPing& ping);
  void show_scan(const ScanResult& scan);
  void show_message(const Envelope& envelope);
  void show_counts(Time time);
  void show_sample(Time time);

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
  std::vector<Decision> decisions_;
  std::optional<DisplayThread> thread_;  ///< last: it uses all the others
};

}  // namespace isobath
