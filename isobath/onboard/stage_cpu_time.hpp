// StageCpuTime: the processor time that each stage of a run takes. It is the time of the working thread, so other load
// on the machine has little effect. No result depends on it.
//
//   load.enter(Stage::kVoxels);  // begins a stage and ends the one before
//   ...
//   load.leave();
//
// One thread at a time.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace isobath {

enum class Stage : std::uint8_t { kEchoes, kPlane, kVoxels, kSphere, kDepths, kObstacles, kAgents, kSource, kReport };
inline constexpr std::size_t kStages = 9;
/// "echoes", "plan view", "voxels", "spherical grid", "depth map", "obstacles", "planning and agents", "input",
/// "report".
const char* to_text(Stage stage);

class StageCpuTime {
 public:
  void enter(Stage stage);
  void leave();
  [[nodiscard]] double seconds(Stage stage) const;

 private:
  std::array<std::int64_t, kStages> nanoseconds_{};
  Stage stage_ = Stage::kReport;
  std::int64_t since_ = -1;  ///< processor time of the thread at `enter`; -1: no stage is open
};

/// Processor time of the calling thread so far, ns.
std::int64_t thread_nanoseconds();

/// Processor time of a run by stage, s. The sum excludes the input (a simulator, a reader) and the report.
struct RunLoad {
  std::array<double, kStages> stage_s{};
  void add(Stage stage, double seconds) { stage_s[static_cast<std::size_t>(stage)] += seconds; }
  [[nodiscard]] double of(Stage stage) const { return stage_s[static_cast<std::size_t>(stage)]; }
  [[nodiscard]] double sum_s() const;
};
/// The sum of two loads: of two threads, or of two parts of one thread.
RunLoad load_of(const StageCpuTime& one, const StageCpuTime& other);

/// One line for `pings` in `log_s` of log: the sum, and each stage in ms per ping. Empty if there were no pings.
std::string load_text(const RunLoad& load, std::uint64_t pings, double log_s);

}  // namespace isobath
