// PlanClock: when a level of command is to plan again, and what it tells of its plans (ledger S2-25, S2-38, S2-41).
#pragma once

#include <isobath/mission/messages/agent.hpp>
#include <optional>

namespace isobath {

class PlanClock {
 public:
  static constexpr Duration kOften = std::chrono::seconds(1);

  /// `replan_s`: longest time between two plans.
  PlanClock(CommandLevel level, double replan_s) : level_(level), replan_(seconds(replan_s)) {}

  [[nodiscard]] bool is_due(Time now) const { return !planned_ || now - *planned_ >= replan_; }

  /// The level has planned. It says so with each plan that is new, else at most once in kOften. `horizon_s`: how far
  /// ahead the plan reaches, 0 where there is nothing to plan.
  void note(Time now, double horizon_s, bool changed, Outbox& out) {
    planned_ = now;
    if (!changed && told_ && now - *told_ < std::min(kOften, replan_)) return;
    told_ = now;
    out.say(LevelPlan{level_, horizon_s, changed});
  }

 private:
  CommandLevel level_;
  Duration replan_;
  std::optional<Time> planned_, told_;
};

}  // namespace isobath
