// StageLoad: how much of one core each stage of a run takes: processor time of the thread that does it, so that
// neighbours on the same machine count little. No result depends on it.
//
//   load.enter(Stage::kVoxels);  // from here on; what was under way ends
//   ...
//   load.leave();
//
// One thread at a time.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace isobath {

enum class Stage : std::uint8_t { kEchoes, kPlane, kVoxels, kDepths, kObstacles, kAgents, kSource, kReport };
inline constexpr std::size_t kStages = 8;
/// "echoes", "plan view", "voxels", "depth map", "obstacles", "planning and agents", "input", "report".
const char* to_text(Stage stage);

class StageLoad {
 public:
  void enter(Stage stage);
  void leave();
  [[nodiscard]] double seconds(Stage stage) const;

 private:
  std::array<std::int64_t, kStages> nanoseconds_{};
  Stage stage_ = Stage::kReport;
  std::int64_t since_ = -1;  ///< processor time of the thread; -1: nothing is under way
};

/// Processor time of the calling thread so far, ns.
std::int64_t thread_nanoseconds();

/// The work of a run by stage, s; what the input (a simulator, a reader) and the report take is no part of its sum.
struct RunLoad {
  std::array<double, kStages> stage_s{};
  void add(Stage stage, double seconds) { stage_s[static_cast<std::size_t>(stage)] += seconds; }
  [[nodiscard]] double sum_s() const;
};
/// Of two threads, or of one that is watched in two places.
RunLoad load_of(const StageLoad& one, const StageLoad& other);

/// As one line, of `pings` that took `log_s`: the sum, and each stage in ms a ping. Empty where there were none.
std::string load_text(const RunLoad& load, std::uint64_t pings, double log_s);

}  // namespace isobath
