// GroupRunScore: the score of a run of several vehicles in a suite (ledger S2-48, S2-50, S2-51).
#pragma once

namespace isobath {

/// The score of a run of a group; without vehicles: the run had no group.
struct GroupRunScore {
  int vehicles = 0;
  double searched = 0, overlap = 0;  ///< GroupScore
  double all_searched_s = -1;        ///< -1: never
  double separation_m = -1;          ///< least, between two hulls; -1: one vehicle
  double lost_s = -1;                ///< when a vehicle was lost; -1: none
  double reassigned_s = -1;          ///< from then until its lanes were shared anew; -1: they were not
  double passage_shared_s = -1;      ///< two vehicles were within one passage for so long; -1: there is none
  double bit_rate = 0;               ///< of the vehicle that sent most, bit/s
};

}  // namespace isobath
