// RunSinks: all who hear what a run finds, each in its turn: the mission's crew, the voxels, the folder of results,
// and, where there are any, the judge who knows the truth, and page and recording (run_display.hpp).
//
// Whoever maps calls on_*; where mapping has a thread of its own, there is no judge. Truth comes from whoever senses.
#pragma once

#include <isobath/runtime/mission_run.hpp>
#include <isobath/runtime/run.hpp>
#include <isobath/runtime/run_display.hpp>
#include <isobath/runtime/run_folder.hpp>
#include <isobath/runtime/run_source.hpp>
#include <isobath/runtime/stage_load.hpp>
#include <isobath/runtime/true_track.hpp>
#include <isobath/runtime/truth_judge.hpp>
#include <isobath/runtime/voxel_model.hpp>
#include <optional>

namespace isobath {

class RunSinks : public ResultSink, public SimulatedSource::TruthSink {
 public:
  /// `folder` and `input` must outlive it. Throws Error where the crew or the recording cannot be made.
  RunSinks(const RunRequest& request, const std::optional<MissionSetup>& setup, RunFolder& folder, RunInput& input);

  void on_ping(const PosedPing& ping) override;
  void on_scan(const ScanResult& scan) override;
  void on_upright(const PosedPing& ping) override;
  void on_soundings(const Swath& swath, const Pose& X_WB) override;
  void on_jump(const Eigen::Vector3d& by_W) override;
  void take(const EchoTruth& echoes) override { tell(echoes); }
  void take(const TrueMotion& motion) override { tell(motion); }

  StageLoad load;  ///< of whoever maps
  VoxelModel voxels;
  RunDisplay display;                 ///< the crew tells it
  std::optional<MissionRun> mission;  ///< after it: its threads end first
  std::optional<TruthJudge> judge;
  std::optional<TrueTrack> track;

 private:
  template <class Truth>
  void tell(const Truth& truth) {
    if (judge) judge->take(truth);
    if (track) track->take(truth);
    display.take(truth);
  }

  RunFolder& folder_;
  double reach_m_;
};

}  // namespace isobath
