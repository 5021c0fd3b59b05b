// Runs of a group of vehicles in a suite, and their scores (ledger S2-48, S2-50, S2-51).
#pragma once

#include <isobath/scenario/group_record.hpp>
#include <vector>

namespace isobath {

struct ComparedMethod;
struct ShownRun;
struct SuiteRun;
struct RunScore;

/// The score of a run of a group; without vehicles: the run had no group.
struct GroupRunScore {
  int vehicles = 0;
  double searched = 0, overlap = 0;  ///< GroupScore
  double all_searched_s = -1;        ///< -1: never
  double separation_m = -1;          ///< least, between two hulls; -1: one vehicle
  double lost_s = -1;                ///< when a vehicle was lost; -1: none
  double reassigned_s = -1;          ///< from then until its lanes were shared anew; -1: they were not
  double bit_rate = 0;               ///< of the vehicle that sent most, bit/s
};

/// A run of a group, with the score that RunScore gives to each run: the nearest of all vehicles to a body counts, and
/// the goal is reached when the area was searched whole and the mission of each vehicle that was not lost has ended.
/// The decisions of the result are those of all vehicles by time, each agent with the name of its vehicle.
ShownRun run_group_method(const ComparedMethod& method, const SuiteRun& run, RunScore& score);

}  // namespace isobath
