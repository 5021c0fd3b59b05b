// Onboard: all that runs on a vehicle, composed once: gate, poses, perception, the maps, and the agents at the helm
// (design, 3; ledger S6-57). `run`, `serve`, `eval`, live runs and tests differ in where events come from, in where
// set-points go and in who looks on; what they run is this.
//
//   event -> observers -> helm hears -> gate, poses, echoes, maps -> helm hears of pings and scans -> set-point
//
//   Onboard onboard(configuration, depths, {.helm = &helm});
//   onboard.show_to(recorder);
//   while (auto event = source.next()) {
//     onboard.take(std::move(*event));
//     vehicle.command(onboard.steer());
//   }
//   onboard.finish();
//
// A function of the events and the configuration, unless it is live: then mapping has a thread of its own,
// so that planning never blocks it and it never blocks the thread that senses (ledger S6-31), and what is decided
// depends on who is faster. A queue that is full loses its oldest ping; navigation, ranges and health reports are never
// lost. Where mapping throws, the next take or settle throws the same. take, steer, settle and finish belong to one
// thread; what the other one uses may be asked for after settle, until the next take.
#pragma once

#include <filesystem>
#include <isobath/base/task_thread.hpp>
#include <isobath/runtime/depth_model.hpp>
#include <isobath/runtime/helm.hpp>
#include <isobath/runtime/onboard_observer.hpp>
#include <isobath/runtime/stage_load.hpp>
#include <isobath/runtime/stage_times.hpp>
#include <isobath/runtime/voxel_model.hpp>
#include <memory>
#include <optional>
#include <vector>

namespace isobath {

struct OnboardParts {
  Helm* helm = nullptr;                    ///< must outlive it; null: nobody steers
  std::shared_ptr<StageTimes> times = {};  ///< that the seats of the helm are timed by; null: its own
  std::filesystem::path voxel_file = {};   ///< that voxels spill to, where they are configured to
  bool voxels = true;                      ///< whether a map in three dimensions is kept
  bool live = false;                       ///< mapping has a thread of its own; then so must the helm's agents
};

class Onboard : private ResultSink {
 public:
  static constexpr std::size_t kLongestQueue = 1024;  ///< events that wait to be mapped

  /// `depths` must outlive it. Throws Error where the configuration cannot work.
  Onboard(const Configuration& configuration, DepthModel& depths, OnboardParts parts);

  /// Before the first event. `observer` must outlive it.
  void show_to(OnboardObserver& observer) { observers_.push_back(&observer); }

  void take(Event event);
  /// After each event. Of no use without a helm.
  Setpoint steer();
  /// Waits until all that was taken is mapped, heard and answered. Live; else there is nothing to wait for.
  void settle();
  /// After the last event: what still waits, the sweep that was not finished, the depth map.
  void finish();

  [[nodiscard]] Pipeline& pipeline() { return pipeline_; }
  [[nodiscard]] const VoxelModel& voxels() const { return voxels_; }
  [[nodiscard]] const DepthModel& depths() const { return depths_; }
  /// Where mapping is live: pings that a full queue lost.
  [[nodiscard]] std::uint64_t lost_pings() const { return mapping_ ? mapping_->left_out().pings : 0; }
  [[nodiscard]] MissionTimings timings() const { return times_->timings(); }
  /// Time of each ping in the pipeline, ms.
  [[nodiscard]] const std::vector<double>& ping_ms() const { return ping_ms_; }
  /// Work by stage; `beside`: of the thread that senses and steers.
  [[nodiscard]] RunLoad load() const { return load_of(load_, beside_); }
  [[nodiscard]] StageLoad& beside() { return beside_; }

 private:
  using Clock = StageTimes::Clock;
  void map(Event event, Clock::time_point taken);

  // What the pipeline finds.
  void on_ping(const PosedPing& ping) override;
  void on_scan(const ScanResult& scan) override;
  void on_upright(const PosedPing& ping) override;
  void on_soundings(const Swath& swath, const Pose& X_WB) override;
  void on_jump(const Eigen::Vector3d& by_W) override;
  [[nodiscard]] bool hears_faint() const override { return voxels_.listens(); }
  [[nodiscard]] const SpaceGrid* heights() const override { return heights_.get(); }

  Helm* helm_;
  std::shared_ptr<StageTimes> times_;
  DepthModel& depths_;
  VoxelModel voxels_;
  std::shared_ptr<const SpaceGrid> heights_;  ///< as of the last scan at which there was news
  double reach_m_;
  std::vector<OnboardObserver*> observers_;
  StageLoad load_, beside_;  ///< of the thread that maps, of the one that senses and steers
  std::vector<double> ping_ms_;
  Time now_;
  Pipeline pipeline_;
  std::optional<TaskThread> mapping_;  ///< last: it uses the others
};

}  // namespace isobath
