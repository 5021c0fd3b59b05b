// GroupOutcome: the results of a run of several vehicles in one water, and its files group.json and group.png (ledger
// S2-50, S2-51).
#pragma once

#include <isobath/report/run_outcome.hpp>
#include <isobath/scenario/group_record.hpp>
#include <string>
#include <vector>

namespace isobath {

struct GroupOutcome {
  GroupRecord record;
  GroupScore score;
  std::vector<RunOutcome> runs;  ///< by vehicle

  /// What went wrong, as one line; empty: nothing. A vehicle that the scene loses is no failure.
  [[nodiscard]] std::string failure() const;
};

/// The text of group.json.
std::string group_text(const GroupOutcome& outcome);
/// PNG: the lanes and the true tracks.
std::string draw_group(const GroupRecord& record, const std::string& title);
/// Lines for a terminal.
std::vector<std::string> group_summary(const GroupOutcome& outcome);

}  // namespace isobath
