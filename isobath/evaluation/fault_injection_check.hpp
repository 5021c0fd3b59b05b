// FaultInjectionCheck: checks that a closed loop with an injected fault behaves as the fault's row of the fault table
// says (design: every fault of the table is injected, and a test shows the action within its limit; ledger S6-39,
// S2-28, S1-43, S1-44).
//
// A row passes if it is raised by its deadline and, except at the fence, not before its cause; if the action of the
// row, or an equivalent one, is in force at the helm with the next cycle; if the mission ends where the row lasted
// until that was due; and if the hull came nowhere nearer than 1 m to a body and touched nothing. Each row has one
// scene of its name: scenarios/faults.
#pragma once

#include <isobath/mission/safety/fault_table.hpp>
#include <isobath/run/closed_loop.hpp>
#include <string>

namespace isobath {

struct FaultInjectionCheck {
  std::string fault;    ///< name of the row; empty: the run tests no row
  double after_s = -1;  ///< from the start of the deadline until the row was raised; -1: unknown
  std::string failure;  ///< what failed; empty: passed
};

/// `config`: that of the Safety Officer in the run.
FaultInjectionCheck prove(const FaultRow& row, const Scenario& scenario, const SafetyConfig& config,
                          const LoopResult& result);

/// The configuration for the row's scene. If only the Safety Officer is to see what is ahead, the grid reports no
/// obstacles.
Configuration proving(const FaultRow& row, Configuration configuration);

}  // namespace isobath
