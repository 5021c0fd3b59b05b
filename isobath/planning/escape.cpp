#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/planning/escape.hpp>
#include <limits>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

constexpr double kStep = 0.25;       // s
constexpr double kNearer = 0.1;      // m that a vehicle too near at the start may come nearer
constexpr double kLeaving = 0.2;     // m/s at which it must then get away
constexpr double kPlenty = 2;        // times the wanted room: more is no better
constexpr double kAsMuch = 0.8;      // share of the most room that an escape towards the goal may have instead
constexpr double kRound = 100 * pi;  // rad: more than any horizon holds
/// The small ones find the way through a gap: at 15 m before a gap of 4 m, 30 degrees miss it.
constexpr std::array<double, 11> kTurns = {pi / 36, pi / 18,    pi / 10,    pi / 6, pi / 4, pi / 3,
                                           pi / 2,  2 * pi / 3, 5 * pi / 6, pi,     kRound};
constexpr std::array<double, 3> kWaits = {0, 1.5, 3};  // s

}  // namespace

EscapeSearch::EscapeSearch(std::span<const ObstaclePoint> points, const EscapeTask& task)
    : task_(task), at_start_(std::numeric_limits<double>::infinity()) {
  ISOBATH_ASSERT(task.speed > 0 && task.turn_rate > 0 && task.horizon_s > 0);
  const double reach = (task.speed + task.drift.norm() + 2 * task.astern) * task.horizon_s + task.room_m;
  for (const ObstaclePoint& p : points) {
    if (!(p.place.norm() <= reach + p.velocity.norm() * task.horizon_s)) continue;
    points_.push_back(p);
    at_start_ = std::min(at_start_, p.place.norm());
  }
}

void EscapeSearch::step(State& state, double heading) const {
  const double lag = std::max(task_.lag_s, kStep);
  const double wanted = std::clamp((heading - state.heading) / lag, -task_.turn_rate, task_.turn_rate);
  const double rate = state.rate + (wanted - state.rate) * kStep / lag;
  const double course = state.heading + rate * kStep / 2;
  const Vector2d ahead(std::cos(course), std::sin(course));
  state.place += kStep * (task_.speed * ahead + task_.drift);
  state.carried += kStep * task_.astern * (Vector2d::UnitX() - ahead);
  state.heading += rate * kStep;
  state.rate = rate;
  state.time_s += kStep;
}

std::optional<Vector2d> EscapeSearch::met_at(const State& state, double s, double& least2) const {
  const double room = std::clamp(at_start_ - kNearer + kLeaving * s, 0.0, task_.room_m);
  std::optional<Vector2d> met;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (state.time_s > task_.moving_s && !points_[i].velocity.isZero(0)) continue;
    const Vector2d point = points_[i].place + state.time_s * points_[i].velocity;
    const Vector2d to = point - state.place;
    double away2 = to.squaredNorm();
    if (task_.astern > 0) away2 = std::min(away2, (to - state.carried).squaredNorm());
    least2 = std::min(least2, away2);
    if (away2 < room * room) met = point;
  }
  return met;
}

Escape EscapeSearch::try_turn(State state, double turn, double wait_s) const {
  Escape escape{wait_s, turn};
  const double before = state.heading, then = before + turn;
  double least2 = std::numeric_limits<double>::infinity();
  while (escape.free_s < task_.horizon_s) {
    step(state, escape.free_s < wait_s ? before : then);
    escape.meets = met_at(state, escape.free_s + kStep, least2);
    if (escape.meets) break;
    escape.free_s += kStep;
  }
  escape.room_m = std::sqrt(least2);
  return escape;
}

/// Between the direction in which an escape by this turn ends and the wanted one, rad. Circles end in none.
double EscapeSearch::off_course(double turn) const {
  return std::abs(turn) > 2 * pi ? pi : std::abs(std::remainder(turn - *task_.towards, 2 * pi));
}

Escape EscapeSearch::best() const {
  const State now{.rate = task_.turn_now};
  const Escape safest_of_all = safest(now);
  if (!task_.towards || !free(safest_of_all)) return safest_of_all;
  const double enough = kAsMuch * std::min(safest_of_all.room_m, kPlenty * task_.room_m);
  Escape best = safest_of_all;
  for (const double turn : kTurns) {
    for (const double side : {turn, -turn}) {
      if (off_course(side) >= off_course(best.turn)) continue;
      const Escape other = try_turn(now, side, 0);
      if (free(other) && other.room_m >= enough) best = other;
    }
  }
  return best;
}

Escape EscapeSearch::safest(const State& state) const {
  const double plenty = kPlenty * task_.room_m;
  Escape best = try_turn(state, 0, 0);
  const auto offer = [&](double turn, double wait_s) {
    if (free(best) && best.room_m >= plenty) return;
    const Escape other = try_turn(state, turn, wait_s);
    const bool longer = other.free_s > best.free_s;
    if (longer || (other.free_s == best.free_s && other.room_m > best.room_m)) best = other;
  };
  for (const double wait_s : kWaits) {
    for (const double turn : kTurns) {
      offer(turn, wait_s);
      offer(-turn, wait_s);
    }
    if (free(best)) break;
  }
  return best;
}

Escape EscapeSearch::after(double ordered, double after_s) const {
  State state{.rate = task_.turn_now};
  double least2 = std::numeric_limits<double>::infinity();
  for (double s = 0; s < after_s; s += kStep) {
    step(state, ordered);
    const auto met = met_at(state, s + kStep, least2);
    if (met) return {0, 0, s, std::sqrt(least2), met};
  }
  return safest(state);
}

}  // namespace isobath
