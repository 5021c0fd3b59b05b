// RunStore: the finished runs of an evaluation in a file, one JSON object a line, so that one that was killed goes on
// where it was.
#pragma once

#include <filesystem>
#include <fstream>
#include <isobath/runtime/run_score.hpp>
#include <map>
#include <optional>

namespace isobath {

class RunStore {
 public:
  /// Reads what is there; lines of another fingerprint, and what is no such line, are dropped, from the file too.
  /// Throws Error where the file cannot be written.
  RunStore(std::filesystem::path file, std::string fingerprint);

  [[nodiscard]] const std::map<std::uint64_t, ScoredRun>& runs() const { return runs_; }
  /// Adds a line and has it written.
  void add(const ScoredRun& run);
  /// Puts the lines in the order of their seeds: the same file however the runs were shared out.
  void close();

 private:
  void rewrite();

  std::filesystem::path file_;
  std::string fingerprint_;
  std::map<std::uint64_t, ScoredRun> runs_;
  std::ofstream out_;
};

std::string to_line(const ScoredRun& run, const std::string& fingerprint);
/// Empty for what is no whole line of this fingerprint.
std::optional<ScoredRun> from_line(const std::string& line, const std::string& fingerprint);

}  // namespace isobath
