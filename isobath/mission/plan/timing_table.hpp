// TimingTable: how often each level of command plans, and how far ahead (Herman 1988, 5; ledger S2-38, S2-E01 to
// S2-E05).
//
//   level      commands come every  plans every  plans reach
//   mission    -                    30 min       2 h
//   group      30 min               5 min        60 min
//   vehicle    5 min                1 min        10 min
//   move       1 min                10 s         2 min
//   primitive  10 s                 2 s          20 s
//   servo      2 s                  0.6 s        4 s
//
// A level gets commands as often as the level above plans. The intervals are the longest ones that are allowed: an
// event lets a level plan at once, and most levels plan with every scan or every tick. A run states beside this table
// what its levels did (LevelOutcome).
#pragma once

#include <array>
#include <isobath/base/config.hpp>
#include <isobath/mission/plan/command_level.hpp>
#include <string>
#include <vector>

namespace isobath {

struct LevelTiming {
  double replan_s = 0;   ///< longest time between two plans
  double horizon_s = 0;  ///< how far ahead a plan is to reach
};

struct TimingTable {
  std::array<LevelTiming, kCommandLevels> levels{{{1800, 7200}, {300, 3600}, {60, 600}, {10, 120}, {2, 20}, {0.6, 4}}};

  [[nodiscard]] const LevelTiming& of(CommandLevel level) const { return levels[static_cast<std::size_t>(level)]; }
  /// Longest time between two commands from the level above; for the mission, which gets one, its own interval.
  [[nodiscard]] double input_s(CommandLevel level) const;
};

/// Bound to `table`: "mission_replan_s", "mission_horizon_s", "group_replan_s" ...
std::vector<Field> fields(TimingTable& table);

/// Throws Error where a level plans no more often than the one above it, or where a plan would end before the next
/// command comes. Returns one sentence for each departure from the rules of the paper: a level plans 3 to 6.5 times as
/// often as the one above; a plan reaches twice as far as the next command, that of the mission four times as far as
/// the next plan, to 10 %.
std::vector<std::string> check_timing(const TimingTable& table);

}  // namespace isobath
