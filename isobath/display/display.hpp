// Display: turns what the vehicle sees, maps, plans and decides into items for a page (docs/live-page.md).
//
//   events, results of the pipeline, messages of the agents, maps  ->  DisplayState  ->  live page, recording, report
//
// The display changes no decision. All items but kTimes are a function of the run: the same run shows the same items at
// the same times of its own clock, so that a recording of them has the same bytes. Only kTimes holds real time.
//
// Cost of a run of 512 x 500 pings at 10 Hz: see `make bench` (DisplayOfAFan, live_run_bench). One thread writes; any
// may read the items.
#pragma once

#include <isobath/base/task_thread.hpp>
#include <isobath/display/display_state.hpp>
#include <isobath/display/level_display.hpp>
#include <isobath/display/map_display.hpp>
#include <isobath/display/obstacle_display.hpp>
#include <isobath/display/signal_display.hpp>
#include <isobath/display/sonar_display.hpp>
#include <isobath/event/event.hpp>
#include <isobath/mission/command/bus.hpp>
#include <isobath/mission/plan/mission_plan.hpp>
#include <isobath/onboard/pipeline.hpp>
#include <isobath/onboard/stage_times.hpp>
#include <isobath/scenario/ground_truth_trajectory.hpp>
#include <isobath/world/depth_model.hpp>
#include <isobath/world/voxel_model.hpp>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace isobath {

/// The facts of a run that change seldom or never.
struct DisplayScene {
  std::string title, source;
  bool simulated = false;
  std::optional<GeoOrigin> origin;
  std::optional<MissionPlan> plan;
  std::uint32_t mission = 0;  ///< number of the missions that replaced the first one
  std::vector<ChartObstacle> charted;
  std::vector<TrueBody> bodies;  ///< ground truth
  double vehicle_length_m = 1.6, vehicle_radius_m = 0.36, safe_m = 0;
  std::string depth_datum;
};

/// Counts of a run, for the health panel.
struct DisplayCounts {
  PipelineCounts pipeline;
  std::map<std::string, std::uint64_t> refused;  ///< by reason
  std::vector<std::string> alarms;
  std::string undecided;
  std::uint64_t lost_pings = 0;
  std::optional<TaskThread::LeftOut> left_out = {};  ///< of a live run: dropped from page and recording
};
/// The current counts. Call it from the mapping thread.
DisplayCounts display_counts(const Pipeline& pipeline, const DepthModel& depths);

class Display : public ResultSink {
 public:
  explicit Display(DisplayState& items)
      : items_(items), sonars_(items), maps_(items), obstacles_(items), levels_(items), signals_(items) {}

  /// Call it at the first event, and again when the scene has changed.
  void show(Time time, const DisplayScene& scene);
  void on_event(const Event& event);
  void on_ping(const PosedPing& ping) override { sonars_.on_ping(ping); }
  void on_vertical_ping(const PosedPing& ping) override { sonars_.on_ping(ping); }
  void on_scan(const ScanResult& scan) override;
  void on_jump(const Eigen::Vector3d& by_W) override;
  /// Every message of the agents.
  void on_message(const Envelope& envelope);
  /// The set-point from now on.
  void want(const Setpoint& wanted);

  /// Commands to the actuators (LevelDisplay::on_servo).
  void on_servo(Time time, std::uint64_t parent, const std::string& text) { levels_.on_servo(time, parent, text); }

  /// Call it after each event: shows the maps and counts that are due.
  void look(Time time, const Pipeline& pipeline, const DepthModel& depths, const VoxelModel& voxels);
  /// Shows the depths alone.
  void show(Time time, std::shared_ptr<const DepthSnapshot> depths) { maps_.show(time, std::move(depths)); }
  /// Shows the spherical grid, if it is due.
  void show(Time time, const GridSnapshot& sphere) { maps_.show(time, sphere); }
  /// Shows the sounds that a passive array hears.
  void show(Time time, std::span<const Contact> contacts);
  /// Whether the last counts are a second old.
  [[nodiscard]] bool wants_counts(Time time) const;
  void show(Time time, const DisplayCounts& counts);
  void show(Time time, const MissionTimings& timings);

 private:
  struct ActiveFault {
    Time since;
    std::string why, action;
  };
  void add_to_track(Time time, const Eigen::Vector3d& place);
  void show_vehicle(const Navigation& fix);
  void measure(const Navigation& fix);
  void show_partner(Time time, const LinkFrame& frame);
  void show_way(Time time);

  DisplayState& items_;
  SonarDisplay sonars_;
  MapDisplay maps_;
  ObstacleDisplay obstacles_;
  LevelDisplay levels_;
  SignalDisplay signals_;
  std::optional<Time> start_, vehicle_shown_, counted_;
  std::optional<Setpoint> wanted_;
  std::optional<double> altitude_m_;

  std::string chunk_;  ///< points of the track since the last full chunk
  std::uint64_t places_ = 0;
  std::optional<Time> last_place_;
  std::optional<std::pair<Time, std::uint64_t>> pings_;  ///< how many until when

  RoutePlanned way_;
  MissionReport mission_;
  std::optional<std::size_t> target_;

  std::map<std::string, ActiveFault> faults_;
  std::map<std::string, std::string> agents_lost_;
  std::set<std::string> agents_;
  std::map<std::string, Health> parts_;  ///< the last report of each
};

}  // namespace isobath
