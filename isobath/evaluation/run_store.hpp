// RunStore: keeps the finished runs of an evaluation in a file, one JSON object per line. An evaluation that was killed
// can thus continue.
#pragma once

#include <filesystem>
#include <fstream>
#include <isobath/evaluation/run_score.hpp>
#include <map>
#include <optional>

namespace isobath {

class RunStore {
 public:
  /// Reads the file. Lines with another fingerprint, and damaged lines, are dropped and removed from the file. Throws
  /// Error if the file cannot be written.
  RunStore(std::filesystem::path file, std::string fingerprint);

  [[nodiscard]] const std::map<std::uint64_t, ScoredRun>& runs() const { return runs_; }
  /// Adds a line and flushes the file.
  void add(const ScoredRun& run);
  /// Sorts the lines by seed, so that the file does not depend on how the runs were distributed.
  void close();

 private:
  void rewrite();

  std::filesystem::path file_;
  std::string fingerprint_;
  std::map<std::uint64_t, ScoredRun> runs_;
  std::ofstream out_;
};

std::string to_line(const ScoredRun& run, const std::string& fingerprint);
/// Empty if `line` is not a complete line with this fingerprint.
std::optional<ScoredRun> from_line(const std::string& line, const std::string& fingerprint);

}  // namespace isobath
