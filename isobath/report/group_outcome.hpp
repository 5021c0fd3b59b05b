// GroupOutcome: the results of a run of several vehicles in one water, and its files group.json, group.png and
// report.html (ledger S2-50 to S2-52).
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
/// One page for all vehicles: tracks, figures, levels of command and decisions; it links to the reports of the
/// vehicles, which lie in folders of their names. `png`: as of draw_group.
std::string group_report(const GroupOutcome& outcome, const std::string& png);
/// What the vehicles did together, one fact a line.
std::vector<std::string> group_facts(const GroupOutcome& outcome);
/// The same and a line for each vehicle, for a terminal.
std::vector<std::string> group_summary(const GroupOutcome& outcome);
/// A share as "97.3 %".
std::string percent_text(double share);

}  // namespace isobath
