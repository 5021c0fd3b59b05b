// Bin update: Bayes' rule for the cells that one range bin overlaps, for S = 1 (echo) or S = 0 (clear) (Ganesan 2015,
// 3.3, corrected; ledger S6-13 to S6-18 and "Derivation of the measurement update").
//
// Input and output: log-odds of the overlapped cells; input: the share a of each cell that lies in the bin. Cells are
// independent. The bin has one false-alarm source f, and each occupied part is detected with d = (p_D - f) / (1 - f).
// With x_i = d a_i p_i and E_x = 1 - prod_{i != x} (1 - x_i), the odds of cell x are multiplied by
//
//     S = 0:  1 - d a_x
//     S = 1:  [f + (1 - f)(E_x + d a_x (1 - E_x))] / [f + (1 - f) E_x]
//
// This is S6-16 without its cancellation: E is composed by e1 + e2 (1 - e1), sums of positive terms only. The result is
// accurate to 1e-14 and never NaN for f > 0. Nothing is clamped here. Pure functions; `scratch` has twice as many
// elements as there are cells.
#pragma once

#include <span>

namespace isobath {

struct Likelihood {
  double p_detect = 0.8;      ///< P(S = 1 | target), above false_alarm
  double false_alarm = 0.02;  ///< P(S = 1 | no target), above 0

  [[nodiscard]] double gain() const { return (p_detect - false_alarm) / (1 - false_alarm); }
};

/// S = 0: what a cell's log-odds change by, ln(1 - d a), at least -50, so that a certainly clear cell stays finite.
double clear_increment(double gain, double share);

void update_hit(std::span<double> log_odds, std::span<const double> share, const Likelihood& sensor,
                std::span<double> scratch);

/// The printed form with its index errors corrected: each of `block` cells has its own false alarm (S6-17, S6-E01 to
/// S6-E03). S = 0 is the same in both forms.
void update_hit_printed(std::span<double> log_odds, std::span<const double> share, const Likelihood& sensor, int block,
                        std::span<double> scratch);

/// Simpler model: S = 1 has probability p_D if any overlapped part is occupied, however many are (S6-18, S6-E04).
void update_any_target(bool hit, std::span<double> log_odds, std::span<const double> share, const Likelihood& sensor,
                       std::span<double> scratch);

}  // namespace isobath
