// Onboard: everything that runs on a vehicle, composed once: gate, poses, perception, the maps, and the helm with its
// agents (design, 3; ledger S6-57). `run`, `serve`, `eval`, live runs and tests all use this class. They differ in the
// source of events, the receiver of set-points and the observers.
//
//   event -> observers -> corner fixes (poses only) -> helm -> gate, poses, echoes, maps -> helm (pings and scans) ->
//   set-point
//
//   Onboard onboard(configuration, depths, {.helm = &helm});
//   onboard.show_to(recorder);
//   while (auto event = source.next()) {
//     onboard.on_event(std::move(*event));
//     vehicle.command(onboard.steer());
//   }
//   onboard.finish();
//
// Set-points are a function of the events and the configuration, unless the run is live. In a live run mapping has a
// thread of its own, so that planning never blocks mapping and mapping never blocks the source thread (ledger S6-31);
// decisions then depend on the timing of the threads. A full queue drops its oldest ping; navigation, ranges and health
// reports are never dropped. If mapping throws, the next take or settle throws the same. take, steer, settle and finish
// belong to the source thread. It may read what the mapping thread uses after settle, until the next take.
#pragma once

#include <filesystem>
#include <isobath/base/task_thread.hpp>
#include <isobath/onboard/helm.hpp>
#include <isobath/onboard/onboard_configuration.hpp>
#include <isobath/onboard/onboard_observer.hpp>
#include <isobath/onboard/passive_contacts.hpp>
#include <isobath/onboard/pipeline.hpp>
#include <isobath/onboard/scan_steering.hpp>
#include <isobath/onboard/stage_cpu_time.hpp>
#include <isobath/onboard/stage_times.hpp>
#include <isobath/world/depth_model.hpp>
#include <isobath/world/spherical_model.hpp>
#include <isobath/world/voxel_model.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace isobath {

struct OnboardParts {
  Helm* helm = nullptr;                     ///< must outlive Onboard; null: the vehicle is not steered
  std::shared_ptr<StageTimes> times = {};   ///< the times that the agents of the helm report to; null: its own
  std::filesystem::path voxel_file = {};    ///< file for voxels that leave memory, if so configured
  bool voxels = true;                       ///< whether to keep a voxel map
  bool sphere = true;                       ///< whether to keep a spherical grid, if the configuration asks for it
  std::vector<ChartedCorner> corners = {};  ///< of charted walls, for corner_fix
  bool live = false;                        ///< gives mapping its own thread; the agents must then have theirs, too
};

class Onboard : private ResultSink {
 public:
  static constexpr std::size_t kLongestQueue = 1024;  ///< maximum number of events that wait to be mapped

  /// `depths` must outlive Onboard. Throws Error if the configuration cannot work.
  Onboard(const OnboardConfiguration& configuration, DepthModel& depths, OnboardParts parts);

  /// Call before the first event. `observer` must outlive Onboard.
  void show_to(OnboardObserver& observer) { observers_.push_back(&observer); }

  void on_event(Event event);
  /// Call after each event. Requires a helm.
  Setpoint steer();
  /// A command for the scanning sonar since the last call: of the helm or, while that orders nothing, by the spherical
  /// grid, if the configuration steers it. Any thread.
  std::optional<ScanCommand> take_scan_command();
  /// Live: waits until all events are mapped and the agents have handled all messages. Otherwise returns at once.
  void settle();
  /// Call after the last event: handles the pings that still wait, ends the open sweep, completes the depth map.
  void finish();

  [[nodiscard]] Pipeline& pipeline() { return pipeline_; }
  [[nodiscard]] const Pipeline& pipeline() const { return pipeline_; }
  [[nodiscard]] const VoxelModel& voxels() const { return voxels_; }
  [[nodiscard]] const SphericalModel& sphere() const { return sphere_; }
  [[nodiscard]] const CornerNavigation& corner_fixes() const { return corner_fixes_; }
  [[nodiscard]] const PassiveContacts& contacts() const { return contacts_; }
  [[nodiscard]] const DepthModel& depths() const { return depths_; }
  /// Live: pings that a full queue dropped.
  [[nodiscard]] std::uint64_t lost_pings() const { return mapping_ ? mapping_->left_out().pings : 0; }
  [[nodiscard]] MissionTimings timings() const { return times_->timings(); }
  /// Time of each ping in the pipeline, ms.
  [[nodiscard]] const std::vector<double>& ping_ms() const { return ping_ms_; }
  /// Processor time by stage, of both threads. `beside`: that of the source thread.
  [[nodiscard]] RunLoad load() const { return load_of(load_, beside_); }
  [[nodiscard]] StageCpuTime& beside() { return beside_; }

 private:
  using Clock = StageTimes::Clock;
  std::optional<CornerMove> correct(Event& event);
  void map(Event event, const std::optional<CornerMove>& move, Clock::time_point taken);
  void tell_depths(Time time);
  void tell_sphere(Time time);
  void tell_contacts(Time time);

  // Results of the pipeline.
  void on_ping(const PosedPing& ping) override;
  void on_scan(const ScanResult& scan) override;
  void on_vertical_ping(const PosedPing& ping) override;
  void on_reading(const RangeReading& reading, const Pose& X_WB) override;
  void on_bearing(const PassiveBearing& heard, const ListeningPose& pose) override;
  void on_soundings(const Swath& swath, const Pose& X_WB) override;
  void on_jump(const Eigen::Vector3d& by_W) override;
  [[nodiscard]] const OccupancySnapshot* heights() const override { return world_.voxels.get(); }

  Helm* helm_;
  std::shared_ptr<StageTimes> times_;
  DepthModel& depths_;
  VoxelModel voxels_;
  SphericalModel sphere_;
  ScanSteering scan_steering_;
  CornerNavigation corner_fixes_;
  PassiveContacts contacts_;
  std::mutex scan_mutex_;
  std::optional<ScanCommand> scan_command_;  ///< guarded by scan_mutex_
  bool scan_ordered_ = false;                ///< the helm has ordered how the sonar looks; guarded by scan_mutex_
  WorldSnapshot world_;                      ///< what the helm gets
  double reach_m_;
  Duration depths_interval_;               ///< 0: the helm does not get the depth map
  std::optional<Time> depths_told_ = {};   ///< when the helm last got it
  std::uint64_t depth_readings_told_ = 0;  ///< how many readings it had then
  bool sphere_steers_;                     ///< whether the helm gets the spherical grid
  std::uint64_t sphere_told_ = 0;          ///< the version that was told last
  std::vector<OnboardObserver*> observers_;
  StageCpuTime load_, beside_;  ///< of the mapping thread, of the source thread
  std::vector<double> ping_ms_;
  Time now_;
  Pipeline pipeline_;
  std::optional<TaskThread> mapping_;  ///< last, because its tasks use the other members
};

}  // namespace isobath
