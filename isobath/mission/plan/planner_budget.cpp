#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/plan/planner_budget.hpp>

namespace isobath {
namespace {

constexpr const char* kPlanner = "planner";

}  // namespace

Health planner_report(Time time, double share) {
  Health health{time, kPlanner, share < 1 ? HealthState::kDegraded : HealthState::kOk, 1, false, {}};
  health.note = fmt::format("{} of its budget", share);
  return health;
}

std::optional<double> budget_share(const Health& health) {
  if (health.source != kPlanner) return std::nullopt;
  double share = 1;
  const char* const begin = health.note.data();
  const bool number = std::from_chars(begin, begin + health.note.size(), share).ec == std::errc();
  return number && std::isfinite(share) && share >= 0 ? share : 1;
}

}  // namespace isobath
