// Pipeline: what happens to an event, from the gate to the list of obstacles. One code path for live, replay and
// simulation: only the source and the sink differ.
//
//   alarms -> gate -> pose of the transmit time -> echoes to decisions -> decisions to the body grid -> grid to
//   obstacles, once a scan; ranges and soundings to the depth map
//
// A fan that looks straight down hears the bottom at the same ranges all the time: where the method of detection is
// left open (echoes.method auto, no model), noise learnt from pings would be the bottom, and the ordered statistic of
// the neighbouring bins decides, side lobes left out. Its echoes of the bottom are what it is for, and are not told
// from others.
//
// Which echoes are of the bottom or the surface follows from depth and altitude (S6-69): of the last sensor that looked
// down, else of the depth map. Where neither says, echoes of the bottom count as any others, and the pings are counted.
//
// A fix that corrects the position at once (PoseBuffer: a jump) says nothing of the water between vehicle and obstacle:
// the body grid does not move by it, and who keeps a map of the surroundings in W is told to move it along (S6-53). The
// depth map stays where it is: a chart of the world, whose readings carry the uncertainty of their place.
//
// Source: Ganesan 2015, chapter 3, figure 3.1; Oskard 1990; ledger S6-03, S6-15, S6-20 to S6-30, S1-02. Time is the
// time of the events: a run is a function of its input and configuration. One thread. After warm-up, mapping allocates
// nothing and throws nothing.
#pragma once

#include <isobath/io/event.hpp>
#include <isobath/map/body_grid.hpp>
#include <isobath/map/obstacle.hpp>
#include <isobath/perception/grid_mapper.hpp>
#include <isobath/perception/obstacle_detector.hpp>
#include <isobath/perception/water_label.hpp>
#include <isobath/runtime/alarms.hpp>
#include <isobath/runtime/bottom_below.hpp>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/event_gate.hpp>
#include <isobath/runtime/pose_buffer.hpp>
#include <isobath/runtime/stage_load.hpp>
#include <isobath/sonar/echo_detector.hpp>
#include <isobath/sonar/side_lobes.hpp>
#include <isobath/sonar/sweep.hpp>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

namespace isobath {

/// A ping with the pose of its transmit time. Without navigation the vehicle is taken to stand still.
struct PosedPing {
  const Ping& ping;
  Pose X_WB;
  const EchoDecisions& decisions;   ///< a sample each
  const FanLooks* looks = nullptr;  ///< the same as looks that do not depend on each other; null: samples are such
  /// A sample each at the rate `echoes.false_alarm`: fainter echoes, for voxels, which weigh many of them. Null:
  /// `decisions` are such, or nobody hears them.
  const EchoDecisions* faint = nullptr;

  [[nodiscard]] const Ping& look_ping() const { return looks ? looks->ping : ping; }
  [[nodiscard]] const EchoDecisions& look_decisions() const { return looks ? looks->decisions : decisions; }
  [[nodiscard]] const EchoDecisions& faint_decisions() const { return faint ? *faint : decisions; }
};

/// The end of one sweep: what is believed now, and the obstacles in it.
struct ScanResult {
  int number = 0;              ///< from 1
  bool posed = false;          ///< whether the pose comes from navigation
  const Detection& detection;  ///< with the time and the pose of the last ping
  const BodyGrid& grid;
};

/// A pose of the vehicle and how sure its place in the plane is: standard deviation in m, 0 where nobody says.
struct PoseEstimate {
  Pose X_WB;
  double sigma_m = 0;
};

/// Takes results. References hold only during the call.
class ResultSink {
 public:
  virtual ~ResultSink() = default;
  virtual void on_ping(const PosedPing& ping) = 0;
  virtual void on_scan(const ScanResult& scan) = 0;
  /// A ping of a fan that stands upright: it has no place in the map of the plane.
  virtual void on_upright(const PosedPing& /*ping*/) {}
  /// Whether PosedPing::faint is of use; they are not decided otherwise. Asked before every ping.
  [[nodiscard]] virtual bool hears_faint() const { return true; }
  /// What sensors that tell height have measured around the vehicle (W), for the labels of obstacles; null: nothing.
  [[nodiscard]] virtual const SpaceGrid* heights() const { return nullptr; }
  /// The position jumped, m in W: what is right relative to the vehicle moves along. Poses of all that follows, also of
  /// what was sensed before and had to wait, are in line with the new place.
  virtual void on_jump(const Eigen::Vector3d& /*by_W*/) {}
  /// Soundings, each of them once; without any navigation the vehicle is taken to stand still.
  virtual void on_soundings(const Swath& /*swath*/, const Pose& /*X_WB*/) {}
};

/// Takes what tells of depth, each with the pose of its time, in order. References hold only during the call.
class SoundingSink {
 public:
  virtual ~SoundingSink() = default;
  virtual void on_range(const RangeReading& reading, const PoseEstimate& pose) = 0;
  virtual void on_swath(const Swath& swath, const PoseEstimate& pose) = 0;
  /// A place that the vehicle has come to.
  virtual void on_passage(Time time, const Pose& X_WB) = 0;
  /// Depth of the bottom at a place (north, east), m below the datum; empty: not known.
  [[nodiscard]] virtual std::optional<double> bottom_depth(const Eigen::Vector2d& /*north_east*/) const { return {}; }
};

/// Whether the beams of a fan lie beside each other rather than above each other, however far it is tilted down or up;
/// the fan of a sounder, which looks straight down and athwart, does not lie flat.
bool lies_flat(const Ping& ping);

/// Whether the vehicle's down axis lies within a fan: an echo sounder, which measures the bottom.
bool looks_down(const Ping& ping);

struct PipelineCounts {
  std::uint64_t pings = 0;    ///< that reached the map
  std::uint64_t unposed = 0;  ///< of these, without any navigation
  std::uint64_t upright = 0;  ///< pings of upright fans: no part of `pings`
  std::uint64_t navigation = 0;
  std::uint64_t ranges = 0;
  std::uint64_t swaths = 0;
  std::uint64_t scans = 0;
  std::uint64_t bins = 0;           ///< decided, blind ones left out
  std::uint64_t hits = 0;           ///< decided as echo
  std::uint64_t dim = 0;            ///< of the decided bins, those in which bottom or surface may hide a target (S6-69)
  std::uint64_t blind = 0;          ///< of these, those in which they hide it: they say nothing
  std::uint64_t dead_reckoned = 0;  ///< pings, of which the motion was known by a model of the thruster alone (S6-22)
  std::uint64_t no_bottom = 0;      ///< pings of which nobody knew how far below the bottom was
  std::uint64_t jumps = 0;          ///< of the position, from one fix to the next
  double farthest_jump_m = 0;
};

/// What sensor.model names: one of both, or neither.
struct SonarModels {
  std::optional<SensorModel> sensor;
  std::shared_ptr<const FanModel> fan;
};

class Pipeline {
 public:
  /// Throws Error where the configuration cannot work.
  /// `depths`: whoever keeps the depth map; null: nobody.
  Pipeline(const Configuration& configuration, ResultSink& sink, SoundingSink* depths = nullptr);
  ~Pipeline();

  /// Before the first event, where the events are there already (a log): learns the noise of the sonars from a ping, so
  /// that the first can be decided. Whether nothing more need be heard.
  bool listen(const Ping& ping);
  /// No more pings will be listened to: the log is shorter than the warm-up, and what was heard must do.
  void heard_all();

  void take(Event event);
  /// Says to it what it is doing, from now on.
  void watch(StageLoad* load) { load_ = load; }
  /// After the last event: pings that still wait for a fix, and the obstacles of a sweep that was not finished.
  void finish();

  [[nodiscard]] const PipelineCounts& counts() const { return counts_; }
  /// Every datum that was refused, by reason.
  [[nodiscard]] const std::map<std::string, std::uint64_t>& rejected() const { return gate_.rejected(); }
  /// Emergencies, by raw readings and health reports; with or without a map.
  [[nodiscard]] const EmergencyFlags& emergencies() const { return alarms_.flags(); }
  /// Why echoes could not be decided in the last ping (warming up, no fitting model); empty when they were.
  [[nodiscard]] std::string undecided() const;
  /// How far the pings of the fan depart from the model that sensor.model names; empty: it names none of a fan.
  [[nodiscard]] std::optional<FanDeparture> departure() const { return echoes_.departure(); }
  /// The grid; empty before the first ping.
  [[nodiscard]] const BodyGrid* grid() const { return mapper_ ? &mapper_->grid() : nullptr; }

 private:
  void enter(Stage stage) {
    if (load_) load_->enter(stage);
  }
  void restart();
  using Waiting = std::variant<Ping, RangeReading, Swath>;
  void add_fix(const Navigation& fix);
  void follow(const Eigen::Vector3d& jump);
  void hold(Waiting sensed);
  void release(Time now, bool all);
  void place(const Waiting& sensed);
  void map_ping(const Ping& ping, const Pose& X_WB, bool posed);
  EchoDetector& detector_of(const Ping& ping);
  void hear_upright(const Ping& ping, const Pose& X_WB, bool posed);
  void map_depth(const Waiting& sensed, const PoseEstimate& pose);
  void fit_map(const Ping& ping, bool posed);
  void count(const EchoDecisions& decisions);
  [[nodiscard]] WaterColumn water_at(const Ping& ping, const Pose& X_WB, bool posed) const;
  void end_scan();

  Configuration configuration_;
  ResultSink& sink_;
  SoundingSink* depths_;
  StageLoad* load_ = nullptr;
  Alarms alarms_;
  EventGate gate_;
  PoseBuffer poses_;
  Eigen::Vector3d jumped_ = Eigen::Vector3d::Zero();  ///< all jumps together
  std::vector<Waiting> waiting_;                      ///< for the fix that follows them, oldest first
  BottomBelow bottom_;
  std::shared_ptr<const LikelihoodRatios> ratios_;  ///< of the histogram model; null: none
  SonarModels models_;
  EchoDetector echoes_, upright_echoes_, sounder_echoes_;
  EchoDetector faint_echoes_;  ///< of fans that are decided by cells
  SideLobes side_lobes_;
  EchoDecisions decisions_, faint_;
  SweepFinder sweeps_;
  std::unique_ptr<GridMapper> mapper_;
  ObstacleDetector detector_;
  PipelineCounts counts_;

  struct Placed {
    Time time;
    bool posed;
    HeardFrom from;
  };
  std::optional<Placed> last_;  ///< the ping mapped last
  bool sweep_open_ = false;     ///< pings since the last scan
};

}  // namespace isobath
