// The main job: an input in; map, obstacles, decisions, pictures and a report out, in one folder.
//
// The same input, configuration and seed give the same bytes in every file, on any number of threads, but for a live
// run. Measured times are therefore in the outcome (and on the terminal), and in the report only if they are asked for.
//
// Live: a mission in a scene with real threads, one for mapping and one for each agent, as on a vehicle: what it
// decides depends on who is faster, so what was seen is not held against what was there, and a recording of it is of
// what happened: run again, the crew hears the same and may decide otherwise.
#pragma once

#include <filesystem>
#include <functional>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/depth_outcome.hpp>
#include <isobath/runtime/display_items.hpp>
#include <isobath/runtime/mission_outcome.hpp>
#include <isobath/runtime/pipeline.hpp>
#include <isobath/runtime/stage_load.hpp>
#include <isobath/runtime/truth_judge.hpp>
#include <isobath/runtime/voxel_model.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// Who looks on while it runs, from other threads: neither must wait.
struct RunWatch {
  DisplayItems* display = nullptr;  ///< filled as it goes
  double speed = 0;                 ///< times real time at most; 0: as fast as it goes, or as live_speed says
  std::function<bool()> stopped;    ///< asked before each event: whether to end here, as if the input did
  /// Asked before each event of a simulated mission: what somebody at the page orders.
  std::function<std::optional<OperatorCommand::Kind>()> ordered;
};

struct RunRequest {
  std::filesystem::path input;  ///< log, folder of frames, or scene (.toml); empty: the embedded scene
  std::filesystem::path out;    ///< made if absent
  std::filesystem::path map;    ///< folder of a depth map to continue or to begin; empty: none is kept
  /// Mission file or scenario whose mission is run instead of the input's own: a scene runs in a closed loop, a log is
  /// heard by the same crew. Empty: the scene's own mission, if it has one.
  std::filesystem::path mission;
  std::filesystem::path record;  ///< recording (.mcap) to write of the run; empty: none
  Configuration configuration;
  /// Live, at so many times real time; 0: as fast as it goes, and then all threads are waited for ten times a simulated
  /// second. Empty: not live.
  std::optional<double> live_speed;
  std::optional<RunWatch> watch;
  int threads = 2;       ///< 1: reading and mapping take turns; 2: reading goes ahead on a thread of its own
  bool timings = false;  ///< measured times in the report; its bytes then differ from run to run
  std::function<void(const SourceReport&, const PipelineCounts&)> progress;  ///< called now and then
};

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

/// Throws Error if the input cannot be opened, nothing in it can be used, or the folder cannot be written.
RunOutcome run(const RunRequest& request);

}  // namespace isobath
