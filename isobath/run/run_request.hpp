// RunRequest: the input, output and options of a run (run.hpp).
#pragma once

#include <filesystem>
#include <functional>
#include <isobath/configuration/configuration.hpp>
#include <isobath/display/display_state.hpp>
#include <isobath/display/viewer_feed.hpp>
#include <isobath/onboard/pipeline.hpp>
#include <isobath/scenario/scenario.hpp>
#include <optional>

namespace isobath {

class MissionDesk;

/// A page that watches a run from other threads. The functions must not block.
struct RunWatch {
  DisplayState* display = nullptr;  ///< filled during the run
  double speed = 0;                 ///< maximum, times real time; 0: no limit, or as live_speed says
  std::function<bool()> stopped;    ///< called before each event: whether to end here, as if the input ended
  /// Called before each event of a mission: an order from the page, if there is one.
  std::function<std::optional<OperatorCommand>()> ordered;
  MissionDesk* desk = nullptr;    ///< hears the agents, so that the page can plan; null: it cannot
  ViewerFeed* viewers = nullptr;  ///< filled during the run, for viewers of other makers
};

class Aboard;

struct RunRequest {
  std::filesystem::path input;              ///< log, folder of frames, or scene (.toml); empty: the embedded scene
  std::optional<Scenario> scenario = {};    ///< a run of a suite, whose file is `input`; empty: the scene of `input`
  std::optional<std::size_t> vehicle = {};  ///< the vehicle of a scene with a group (Scenario::of_vehicle)
  std::filesystem::path out;                ///< created if absent
  std::filesystem::path map;                ///< folder of a depth map to continue or to begin; empty: none is stored
  /// Mission file or scenario whose mission replaces that of the input. A scene runs in a closed loop; a log is
  /// replayed to the same agents. Empty: the mission of the scene, if it has one.
  std::filesystem::path mission;
  std::filesystem::path record;  ///< recording (.mcap) to write; empty: none
  Configuration configuration;
  /// A live run at this many times real time; 0: as fast as possible, with a wait for all threads ten times per
  /// simulated second. Empty: not live.
  std::optional<double> live_speed;
  Aboard* aboard = nullptr;  ///< a run on a vehicle: `input` is its file; the events come from its devices
  std::optional<RunWatch> watch;
  int threads = 2;       ///< 1: reading and mapping alternate; 2: a thread of its own reads ahead
  bool timings = false;  ///< measured times in the report, whose bytes then differ from run to run
  std::function<void(const SourceReport&, const PipelineCounts&)> progress;  ///< called after each event

  /// Whether mapping, agents and display have threads of their own.
  [[nodiscard]] bool has_real_threads() const { return live_speed || aboard; }
};

}  // namespace isobath
