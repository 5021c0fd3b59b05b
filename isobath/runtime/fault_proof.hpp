// FaultProof: whether a closed loop in which something breaks shows what its row of the fault table says (design: every
// fault of the table is injected, and a test shows the action within its limit; ledger S6-39, S2-28, S1-43, S1-44).
//
// Shown is a row that is raised by its deadline and, where that counts from an instant, not before; with the action of
// the row, or what stands for it, in force at the helm with the next cycle; with the end of the mission where the row
// lasted until that was due; and a hull that came nowhere nearer than 1 m to a body and touched nothing. One scene a
// row, named like it: scenarios/faults.
#pragma once

#include <isobath/mission/fault_table.hpp>
#include <isobath/runtime/closed_loop.hpp>
#include <string>

namespace isobath {

struct FaultProof {
  std::string fault;    ///< name of the row; empty: nothing was to be shown
  double after_s = -1;  ///< from what the deadline counts from until it was raised; -1: not known
  std::string failure;  ///< what was not shown; empty: all was
};

/// `config`: that of the Safety Officer in the run.
FaultProof prove(const FaultRow& row, const Scenario& scenario, const SafetyConfig& config, const LoopResult& result);

/// The configuration to sail the row's scene with: where the Safety Officer alone is to see what is ahead, the map is
/// blinded.
Configuration proving(const FaultRow& row, Configuration configuration);

}  // namespace isobath
