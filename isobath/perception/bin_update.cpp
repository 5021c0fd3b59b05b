#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/map/occupancy/body_grid.hpp>
#include <isobath/perception/bin_update.hpp>

namespace isobath {
namespace {

// Writes to `others` for each cell the probability that any other cell fires, 1 - prod_{i != x} (1 - fire_i), given
// fire_i in `fire`. Overwrites `fire`.
void any_other(std::span<double> fire, std::span<double> others) {
  double before = 0;
  for (std::size_t i = 0; i < fire.size(); ++i) {
    others[i] = before;
    before += fire[i] * (1 - before);
  }
  double after = 0;
  for (std::size_t i = fire.size(); i-- > 0;) {
    others[i] += after * (1 - others[i]);
    after += fire[i] * (1 - after);
  }
}

void hit(std::span<double> log_odds, std::span<const double> share, double gain, double false_alarm,
         std::span<double> scratch) {
  const std::size_t n = log_odds.size();
  ISOBATH_ASSERT(share.size() == n && scratch.size() >= 2 * n);
  const std::span<double> fire = scratch.first(n);
  const std::span<double> others = scratch.subspan(n, n);
  for (std::size_t i = 0; i < n; ++i) fire[i] = gain * share[i] * probability_of(log_odds[i]);
  any_other(fire, others);
  for (std::size_t i = 0; i < n; ++i) {
    const double empty = false_alarm + (1 - false_alarm) * others[i];
    log_odds[i] += std::log(1 + (1 - false_alarm) * gain * share[i] * (1 - others[i]) / empty);
  }
}

}  // namespace

// Uses log(1 + x) although log1p(x) keeps more digits of small increments: they are added to log-odds of the order of
// 1, whose last digit is as coarse, and log takes a third of the time.
double clear_increment(double gain, double share) {
  constexpr double kSmall = 0.01;  // the remainder after six terms is below 2e-15
  const double x = gain * share;
  if (x < kSmall) return -x * (1 + x * (1.0 / 2 + x * (1.0 / 3 + x * (1.0 / 4 + x * (1.0 / 5 + x / 6)))));
  return std::max(std::log(1 - std::min(x, 1.0)), -50.0);
}

void update_hit(std::span<double> log_odds, std::span<const double> share, const Likelihood& sensor,
                std::span<double> scratch) {
  hit(log_odds, share, sensor.gain(), sensor.false_alarm, scratch);
}

void update_hit_printed(std::span<double> log_odds, std::span<const double> share, const Likelihood& sensor, int block,
                        std::span<double> scratch) {
  hit(log_odds, share, sensor.gain(), -std::expm1(block * std::log1p(-sensor.false_alarm)), scratch);
}

void update_any_target(bool hit, std::span<double> log_odds, std::span<const double> share, const Likelihood& sensor,
                       std::span<double> scratch) {
  const std::size_t n = log_odds.size();
  ISOBATH_ASSERT(share.size() == n && scratch.size() >= 2 * n);
  const std::span<double> occupied = scratch.first(n);
  const std::span<double> others = scratch.subspan(n, n);
  for (std::size_t i = 0; i < n; ++i) occupied[i] = share[i] * probability_of(log_odds[i]);
  any_other(occupied, others);
  const double rise = sensor.p_detect - sensor.false_alarm;
  // P(S | cell free) and P(S | cell occupied); an impossible S changes nothing.
  const double certain = hit ? sensor.p_detect : 1 - sensor.p_detect;
  const double change = hit ? -rise : rise;
  for (std::size_t i = 0; i < n; ++i) {
    const double if_free = certain + change * (1 - others[i]);
    const double if_occupied = certain + change * (1 - others[i]) * (1 - share[i]);
    if (if_free > 0) log_odds[i] += std::log(std::max(if_occupied / if_free, 1e-22));
  }
}

}  // namespace isobath
