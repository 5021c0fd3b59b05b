// What an overloaded computer leaves its planner of the budget of a search: a health report of "planner", degraded
// below a share of 1, with the share at the beginning of its note ("0.001 of its budget"). So a log of the events holds
// it, and a replay plans as the run did.
#pragma once

#include <isobath/vehicle/health.hpp>
#include <optional>

namespace isobath {

Health planner_report(Time time, double budget_share);
/// The share, at least 0, 1 where the note does not begin with one; empty for a report of anything else.
std::optional<double> budget_share(const Health& health);

}  // namespace isobath
