// RunOutcome: what came of a run (run.hpp).
#pragma once

#include <filesystem>
#include <isobath/runtime/depth_outcome.hpp>
#include <isobath/runtime/mission_outcome.hpp>
#include <isobath/runtime/pipeline.hpp>
#include <isobath/runtime/stage_load.hpp>
#include <isobath/runtime/truth_judge.hpp>
#include <isobath/runtime/voxel_model.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

struct RunTimings {
  double wall_s = 0;          ///< reading and mapping
  double ping_median_ms = 0;  ///< mapping alone, a ping
  double ping_p99_ms = 0;
  RunLoad load;  ///< processor time, stage by stage
};

/// What real threads could not keep up with.
struct LiveOutcome {
  std::uint64_t lost_pings = 0;  ///< in a full queue before the map
  /// Of a full queue before page and recording: pings and scans; events, messages and all else.
  std::uint64_t unshown_pings = 0, unshown_notes = 0;
  std::string display_problem;  ///< why nothing more was shown or recorded; empty where all went well
};

struct RunOutcome {
  std::vector<Alarm> alarms;  ///< raised on the way
  PipelineCounts counts;
  SourceReport source;
  std::map<std::string, std::uint64_t> rejected;  ///< by the source and by the pipeline
  double log_s = 0;                               ///< time from the first event to the last
  RunTimings timings;
  std::vector<Obstacle> obstacles;           ///< at the end
  std::vector<std::filesystem::path> files;  ///< written, relative to the folder, in order
  std::optional<TruthScore> truth;           ///< of a simulated run
  std::optional<DepthOutcome> depth;         ///< where ranges or soundings had a place
  std::optional<VoxelOutcome> voxels;        ///< where a fan of beams was heard
  std::optional<MissionOutcome> mission;     ///< where there was one
  std::optional<FanDeparture> fan;           ///< where sensor.model names a fan model and pings were decided by it
  std::optional<LiveOutcome> live;           ///< of a live run
  std::string recording_problem;             ///< why the recording ends before the run does; empty where it does not
  std::uint64_t not_recorded = 0;            ///< what came after that
  std::string undecided;                     ///< why no echo of a ping was decided at the end; else empty
  /// One line where the input itself is wrong (cut in the middle of a record, poses that are no numbers, time that runs
  /// backwards); empty when all is well. What could be used was used.
  std::string problem;
};

}  // namespace isobath
