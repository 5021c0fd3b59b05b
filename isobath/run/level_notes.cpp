#include <algorithm>
#include <isobath/run/level_notes.hpp>
#include <utility>

namespace isobath {

LevelNotes::LevelNotes(const TimingTable& timing) {
  for (std::size_t i = 0; i < kCommandLevels; ++i) {
    levels_[i].level = static_cast<CommandLevel>(i);
    levels_[i].timing = timing.levels[i];
  }
}

void LevelNotes::on_message(const Envelope& envelope) {
  if (const auto* plan = std::get_if<LevelPlan>(&envelope.message)) note_plan(envelope.time, *plan);
  if (!envelope.link) return;
  const std::lock_guard lock(mutex_);
  note(envelope.time, envelope.number, *envelope.link);
  commands_.push_back({envelope.number, *envelope.link});
  if (commands_.size() > kKept) commands_.pop_front();
}

void LevelNotes::note_plan(Time time, const LevelPlan& plan) {
  const std::lock_guard lock(mutex_);
  const auto at = static_cast<std::size_t>(plan.level);
  LevelOutcome& level = levels_[at];
  if (planned_[at]) level.longest_replan_s = std::max(level.longest_replan_s, to_seconds(time - *planned_[at]));
  planned_[at] = time;
  ++level.plans;
  if (plan.changed) ++level.changed_plans;
  if (plan.horizon_s <= 0) return;
  ++with_horizon_[at];
  level.mean_horizon_s += (plan.horizon_s - level.mean_horizon_s) / static_cast<double>(with_horizon_[at]);
}

void LevelNotes::on_servo(Time time, std::uint64_t parent) {
  const std::lock_guard lock(mutex_);
  note(time, 0, {CommandLevel::kServo, parent});
}

const LevelNotes::Command* LevelNotes::find(std::uint64_t number) const {
  const auto found = std::ranges::lower_bound(commands_, number, {}, &Command::number);
  return found != commands_.end() && found->number == number ? &*found : nullptr;
}

void LevelNotes::note(Time time, std::uint64_t number, const CommandLink& link) {
  const auto at = static_cast<std::size_t>(link.level);
  LevelOutcome& level = levels_[at];
  Newest& newest = newest_[at];
  if (level.commands > 0) {
    const double interval_s = to_seconds(time - newest.time);
    level.least_interval_s = level.commands > 1 ? std::min(level.least_interval_s, interval_s) : interval_s;
    level.longest_interval_s = std::max(level.longest_interval_s, interval_s);
    level.mean_interval_s += (interval_s - level.mean_interval_s) / static_cast<double>(level.commands);
  }
  ++level.commands;
  newest = {number, time};
  if (link.parent == 0) ++level.without_parent;
  // Up the chain: which command of each level above does it serve, and is that the newest one?
  std::array<bool, kCommandLevels> seen{};
  for (const Command* above = find(link.parent); above; above = find(above->link.parent)) {
    const auto up = static_cast<std::size_t>(above->link.level);
    // A level may hand a command on to itself (route, follow order, motion order): its newest is the first one met.
    if (up >= at || std::exchange(seen[up], true) || link.level == CommandLevel::kMove) continue;
    if (up == static_cast<std::size_t>(CommandLevel::kMove) || above->number >= newest_[up].number) continue;
    level.longest_stale_s = std::max(level.longest_stale_s, to_seconds(time - newest_[up].time));
  }
}

std::vector<LevelOutcome> LevelNotes::outcome() const {
  const std::lock_guard lock(mutex_);
  std::vector<LevelOutcome> all;
  std::ranges::copy_if(levels_, std::back_inserter(all), [](const LevelOutcome& one) { return one.commands > 0; });
  return all;
}

}  // namespace isobath
