// Pipeline: handles an event from the gate to the list of obstacles. Live runs, replay and simulation use the same
// code; only the source and the sink differ.
//
//   alarms -> gate -> pose at the transmit time -> echoes to decisions -> decisions to tracks of bodies; those of still
//   water to the body grid -> grid and moving bodies to obstacles, once per scan; ranges and soundings to the depth
//   map; soundings in the water to the body grid, too
//
// A vertical fan that looks straight down (an echo sounder) receives the bottom at the same ranges in every ping. If
// the detection method is left open (echoes.method auto, no model), noise learnt from the pings would be the bottom
// itself; so the ordered statistic of the neighbouring bins decides, and echoes of side lobes are left out. The bottom
// echoes of such a fan are what it is for, and are not separated from others.
//
// Depth and altitude tell which echoes come from the bottom or the surface (S6-69). The altitude comes from the last
// sensor that looked down, else from the depth map. If neither knows it, bottom echoes count like any others, and the
// pings are counted.
//
// Maps take the world for still. The echoes of a body that moves (moving_bodies.hpp) go to its track and to no map; the
// obstacles of a scan are those of the grid and the bodies that move, with their velocities.
//
// A fix that corrects the position at once (PoseBuffer: a jump) does not change the distance from vehicle to obstacle.
// The body grid therefore does not move with the jump, and on_jump lets other maps of the surroundings in W move along
// (S6-53). The depth map stays: it is a chart of the world, and its readings carry their position uncertainty.
//
// Source: Ganesan 2015, chapter 3, figure 3.1; Oskard 1990; ledger S6-03, S6-15, S6-20 to S6-30, S1-02. Time is that of
// the events, so a run is a function of its input and configuration. One thread. After warm-up, mapping allocates
// nothing and throws nothing.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/map/occupancy/body_grid.hpp>
#include <isobath/map/occupancy/obstacle.hpp>
#include <isobath/map/occupancy/obstacle_numbers.hpp>
#include <isobath/onboard/altitude_estimator.hpp>
#include <isobath/onboard/emergency_alarms.hpp>
#include <isobath/onboard/event_gate.hpp>
#include <isobath/onboard/moving_bodies.hpp>
#include <isobath/onboard/onboard_configuration.hpp>
#include <isobath/onboard/pose_buffer.hpp>
#include <isobath/onboard/stage_cpu_time.hpp>
#include <isobath/perception/grid_mapper.hpp>
#include <isobath/perception/obstacle_detector.hpp>
#include <isobath/perception/sounding_fan.hpp>
#include <isobath/perception/water_label.hpp>
#include <isobath/sonar/echo_detector.hpp>
#include <isobath/sonar/side_lobes.hpp>
#include <isobath/sonar/sweep.hpp>
#include <isobath/world/result_sinks.hpp>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

namespace isobath {

struct PipelineCounts {
  std::uint64_t pings = 0;     ///< mapped pings
  std::uint64_t unposed = 0;   ///< mapped pings without any navigation
  std::uint64_t vertical = 0;  ///< pings of vertical fans; not included in `pings`
  std::uint64_t navigation = 0;
  std::uint64_t ranges = 0;
  std::uint64_t swaths = 0;
  std::uint64_t scans = 0;
  std::uint64_t bins = 0;           ///< decided bins, without those in the blind zone
  std::uint64_t hits = 0;           ///< bins decided as echo
  std::uint64_t dim = 0;            ///< decided bins in which bottom or surface may hide a target (S6-69)
  std::uint64_t blind = 0;          ///< dim bins in which a target would be hidden: they carry no information
  std::uint64_t dead_reckoned = 0;  ///< pings whose motion was known only from a model of the thruster (S6-22)
  std::uint64_t no_bottom = 0;      ///< pings with unknown altitude
  MovingBodies::Counts bodies;      ///< that were tracked
  std::uint64_t of_moving = 0;      ///< echoes of these, which went to no map
  std::uint64_t jumps = 0;          ///< jumps of the position from one fix to the next
  double farthest_jump_m = 0;
};

/// The model that sensor.model names: one of the two kinds, or neither.
struct SonarModels {
  std::optional<SensorModel> sensor;
  std::shared_ptr<const FanModel> fan;
};

class Pipeline {
 public:
  /// `depths` keeps the depth map; null: there is none. Throws Error if the configuration cannot work.
  Pipeline(const OnboardConfiguration& configuration, ResultSink& sink, SoundingSink* depths = nullptr);
  ~Pipeline();

  /// For logs, before the first event: learns the noise of the sonars from a ping of the log, so that echoes are
  /// detected from the first ping on. Returns whether enough has been learnt.
  bool listen(const Ping& ping);
  /// Ends the learning: the log is shorter than the warm-up, and the noise learnt so far is used.
  void end_learning();

  void on_event(Event event);
  /// A jump that is known: the fixes from now on contain a correction of the position, m in W.
  void jump(const Eigen::Vector3d& by_W);
  /// Reports the stage of its work to `load` from now on.
  void watch(StageCpuTime* load) { load_ = load; }
  /// Call after the last event: maps the pings that still wait for a fix, and reports the obstacles of the open sweep.
  void finish();

  [[nodiscard]] const PipelineCounts& counts() const { return counts_; }
  /// Counts of rejected data, by reason.
  [[nodiscard]] const std::map<std::string, std::uint64_t>& rejected() const { return gate_.rejected(); }
  /// Emergencies according to raw readings and health reports; they do not depend on a map.
  [[nodiscard]] const EmergencyFlags& emergencies() const { return alarms_.flags(); }
  /// The operator has seen the alarms. Any thread.
  void acknowledge_alarms() { alarms_.flags().acknowledge(~std::uint32_t{0}); }
  /// Why echoes could not be decided in the last ping (warming up, no fitting model); empty if they were.
  [[nodiscard]] std::string undecided() const;
  /// How far the pings of the fan depart from the fan model that sensor.model names; empty: it names no fan model.
  [[nodiscard]] std::optional<FanDeparture> departure() const { return echoes_.departure(); }
  /// Standard deviation of the position in the plane, as the newest fix states it, m; 0: not stated.
  [[nodiscard]] double position_sigma_m() const { return poses_.sigma_m(); }
  [[nodiscard]] const MovingBodies& bodies() const { return bodies_; }
  /// The grid; empty before the first ping.
  [[nodiscard]] const BodyGrid* grid() const { return mapper_ ? &mapper_->grid() : nullptr; }

 private:
  void enter(Stage stage) {
    if (load_) load_->enter(stage);
  }
  void restart();
  using Waiting = std::variant<Ping, RangeReading, Swath, PassiveBearing>;
  void add_fix(const Navigation& fix);
  void follow(const Eigen::Vector3d& jump);
  void hold(Waiting sensed);
  void release(Time now, bool all);
  void place(const Waiting& sensed);
  void place(const PassiveBearing& heard);
  void map_ping(const Ping& ping, const Pose& X_WB, bool posed);
  EchoDetector& detector_of(const Ping& ping);
  void map_vertical(const Ping& ping, const Pose& X_WB, bool posed);
  void map_soundings(const Swath& swath, const Pose& X_WB, bool posed);
  void map_depth(const Waiting& sensed, const PoseEstimate& pose);
  void fit_map(const Ping& ping, bool posed);
  [[nodiscard]] bool motion_is_measured(bool posed) const { return !posed || poses_.knows_its_motion(); }
  void update_grid(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB, bool posed);
  void note_mapped(const Ping& ping, const Pose& X_WB, bool posed, const WaterColumn& water);
  void take_bodies(const Ping& ping, EchoDecisions& decisions, FanLooks* looks, const Pose& X_WB);
  void count(const EchoDecisions& decisions);
  [[nodiscard]] WaterColumn water_at(const Ping& ping, const Pose& X_WB, bool posed) const;
  void end_scan();

  OnboardConfiguration configuration_;
  ResultSink& sink_;
  SoundingSink* depths_;
  StageCpuTime* load_ = nullptr;
  Alarms alarms_;
  EventGate gate_;
  PoseBuffer poses_;
  Eigen::Vector3d jumped_ = Eigen::Vector3d::Zero();  ///< sum of all jumps
  std::vector<Waiting> waiting_;                      ///< measurements that wait for the next fix, oldest first
  AltitudeEstimator bottom_;
  std::shared_ptr<const LikelihoodRatios> ratios_;           ///< of the histogram model; null: none
  std::shared_ptr<const LikelihoodRatios> vertical_ratios_;  ///< of the vertical fans
  SonarModels models_;
  EchoDetector echoes_, vertical_echoes_, sounder_echoes_;
  SideLobes side_lobes_;
  EchoDecisions decisions_;
  SoundingFan soundings_;
  SweepSegmenter sweeps_;
  MovingBodies bodies_;
  std::unique_ptr<GridMapper> mapper_;
  ObstacleDetector detector_;
  ObstacleNumbers numbers_;
  PipelineCounts counts_;

  struct Placed {
    Time time;
    bool posed;
    HeardFrom from;
  };
  std::optional<Placed> last_;  ///< the ping mapped last
  bool sweep_open_ = false;     ///< pings were mapped since the last scan
};

}  // namespace isobath
