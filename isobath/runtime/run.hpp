// The main job: an input in; map, obstacles, pictures and a report out, in one folder.
//
// The same input, configuration and seed give the same bytes in every file, on any number of threads. Measured times
// are therefore in the outcome (and on the terminal), and in the report only if they are asked for.
#pragma once

#include <filesystem>
#include <functional>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/pipeline.hpp>
#include <isobath/runtime/truth_judge.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

struct RunRequest {
  std::filesystem::path input;  ///< log, folder of frames, or scene (.toml); empty: the embedded scene
  std::filesystem::path out;    ///< made if absent
  Configuration configuration;
  int threads = 2;       ///< 1: reading and mapping take turns; 2: reading goes ahead on a thread of its own
  bool timings = false;  ///< measured times in the report; its bytes then differ from run to run
  std::function<void(const SourceReport&, const PipelineCounts&)> progress;  ///< called now and then
};

struct RunTimings {
  double wall_s = 0;          ///< reading and mapping
  double ping_median_ms = 0;  ///< mapping alone, a ping
  double ping_p99_ms = 0;
};

struct RunOutcome {
  PipelineCounts counts;
  SourceReport source;
  std::map<std::string, std::uint64_t> rejected;  ///< by the source and by the pipeline
  double log_s = 0;                               ///< time from the first event to the last
  RunTimings timings;
  std::vector<Obstacle> obstacles;           ///< at the end
  std::vector<std::filesystem::path> files;  ///< written, relative to the folder, in order
  std::optional<TruthScore> truth;           ///< of a simulated run
  std::string undecided;                     ///< why no echo was decided at the end; empty when they were
  /// One line where the input itself is wrong (cut in the middle of a record, poses that are no numbers, time that runs
  /// backwards); empty when all is well. What could be used was used.
  std::string problem;
};

/// Throws Error if the input cannot be opened, nothing in it can be used, or the folder cannot be written.
RunOutcome run(const RunRequest& request);

}  // namespace isobath
