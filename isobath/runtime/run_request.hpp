// RunRequest: what is asked of a run (run.hpp).
#pragma once

#include <filesystem>
#include <functional>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/display_items.hpp>
#include <isobath/runtime/pipeline.hpp>
#include <optional>

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

}  // namespace isobath
