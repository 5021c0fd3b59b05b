#include <algorithm>
#include <cmath>
#include <isobath/evaluation/rules_score.hpp>
#include <numbers>
#include <optional>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kSeen_m = 60, kSettled_s = 10, kUntilAct_s = 12, kMean_s = 2, kShortest_s = 3;
constexpr double kKeptCourse = 10 * std::numbers::pi / 180, kKeptSpeed = 0.2;

/// The place of the vehicle in the target's frame: x ahead of the target, y to its starboard.
struct Beside {
  double t_s = 0;
  Vector2d place;
};

Vector2d target_at(const Body& target, double t_s) {
  return Vector2d(target.path[1], target.path[2]) + displacement(target, t_s).head<2>();
}

Vector2d velocity_of(const Body& target) { return target_at(target, 1) - target_at(target, 0); }

std::vector<Beside> beside(std::span<const TrueMotion> track, const Body& target) {
  const Vector2d ahead = velocity_of(target).normalized(), starboard(-ahead.y(), ahead.x());
  std::vector<Beside> all;
  for (const TrueMotion& motion : track) {
    const double t_s = to_seconds(motion.time);
    const Vector2d from = motion.state.X_WB.translation.head<2>() - target_at(target, t_s);
    all.push_back({t_s, {from.dot(ahead), from.dot(starboard)}});
  }
  return all;
}

/// At the closest approach; empty: the target was not passed.
std::optional<Vector2d> place_at_closest(const std::vector<Beside>& all) {
  const auto closest = std::ranges::min_element(all, {}, [](const Beside& b) { return b.place.norm(); });
  if (closest == all.end() || closest + 1 == all.end()) return std::nullopt;
  return closest->place;
}

bool passes_astern(const std::vector<Beside>& all, const Vector2d& closest) {
  for (std::size_t i = 1; i < all.size(); ++i) {
    if ((all[i - 1].place.y() < 0) != (all[i].place.y() < 0)) return all[i].place.x() < 0;
  }
  return closest.x() < 0;
}

Vector2d place_of_vehicle(const TrueMotion& motion) { return motion.state.X_WB.translation.head<2>(); }

/// While the vehicle stands on: from the first of these samples until a time, with this velocity over ground.
struct StandOn {
  std::size_t first = 0;
  double begin_s = 0, until_s = 0;
  Vector2d velocity_W;
};

/// Mean over kMean_s until a sample.
Vector2d mean_velocity(std::span<const TrueMotion> track, std::size_t i) {
  std::size_t before = i;
  while (before > 0 && to_seconds(track[i].time - track[before].time) < kMean_s) --before;
  return (place_of_vehicle(track[i]) - place_of_vehicle(track[before])) /
         to_seconds(track[i].time - track[before].time);
}

std::optional<StandOn> stand_on(std::span<const TrueMotion> track, const Body& target) {
  for (std::size_t i = 0; i < track.size(); ++i) {
    const double t_s = to_seconds(track[i].time);
    const Vector2d to = target_at(target, t_s) - place_of_vehicle(track[i]);
    if (t_s - to_seconds(track[0].time) < kSettled_s || to.norm() > kSeen_m) continue;
    const Vector2d velocity = mean_velocity(track, i), closing = velocity - velocity_of(target);
    return StandOn{i, t_s, t_s + to.dot(closing) / std::max(closing.squaredNorm(), 1e-9) - kUntilAct_s, velocity};
  }
  return std::nullopt;
}

bool keeps_velocity(std::span<const TrueMotion> track, const StandOn& stretch) {
  const Vector2d& kept = stretch.velocity_W;
  for (std::size_t i = stretch.first; i < track.size() && to_seconds(track[i].time) <= stretch.until_s; ++i) {
    const Vector2d velocity = mean_velocity(track, i);
    const double turned = std::atan2(kept.x() * velocity.y() - kept.y() * velocity.x(), kept.dot(velocity));
    if (std::abs(turned) > kKeptCourse || std::abs(velocity.norm() - kept.norm()) > kKeptSpeed) return false;
  }
  return true;
}

/// For all targets of a situation in which the vehicle stands on for each.
void score_stand_on(std::span<const TrueMotion> track, std::span<const Body> targets, RulesScore& score) {
  std::vector<StandOn> all;
  for (const Body& target : targets) {
    if (const auto one = stand_on(track, target)) all.push_back(*one);
  }
  if (all.empty()) return;
  const double first_s = std::ranges::min_element(all, {}, &StandOn::until_s)->until_s;
  for (StandOn& one : all) {
    one.until_s = first_s;
    if (first_s - one.begin_s < kShortest_s || first_s > to_seconds(track.back().time)) continue;
    ++score.stand_on;
    score.stood_on += keeps_velocity(track, one);
  }
}

}  // namespace

RulesScore rules_score(std::span<const TrueMotion> track, std::span<const Body> targets,
                       const EncounterSituation& situation) {
  RulesScore score;
  const auto is_stood_on_for = [](EncounterKind kind) {
    return kind == EncounterKind::kFromPort || kind == EncounterKind::kOvertaking;
  };
  const bool only_stands_on = std::ranges::all_of(situation, is_stood_on_for);
  for (std::size_t i = 0; i < situation.size() && i < targets.size(); ++i) {
    const std::vector<Beside> places = beside(track, targets[i]);
    const auto closest = place_at_closest(places);
    if (!closest) continue;
    if (situation[i] == EncounterKind::kFromStarboard) {
      ++score.give_way;
      score.passed_astern += passes_astern(places, *closest);
    }
    if (situation[i] == EncounterKind::kHeadOn) {
      ++score.head_on;
      score.passed_port_to_port += closest->y() < 0;
    }
  }
  if (only_stands_on) score_stand_on(track, targets, score);
  return score;
}

}  // namespace isobath
