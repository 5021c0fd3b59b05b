// Planner budget: the share of its search budget that an overloaded computer leaves the planner, as a health report of
// "planner". The report is degraded below a share of 1, and its note begins with the share ("0.001 of its budget"). A
// log of the events thus contains it, and a replay plans as the run did.
#pragma once

#include <isobath/vehicle/health.hpp>
#include <optional>

namespace isobath {

Health planner_report(Time time, double budget_share);
/// The share, at least 0; 1 where the note does not begin with one; empty for a report of another source.
std::optional<double> budget_share(const Health& health);

}  // namespace isobath
