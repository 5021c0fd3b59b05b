// The pages of a mission: a chart of its way with every replan where it happened, the clearance over time, and the
// table of decisions with their reasons (ledger S6-56, S6-59).
//
// The chart stands in the water as the vehicle believes to be in it; the true way and the true bodies of a simulated
// run are drawn where they are: their distance from what is believed is the error of navigation. Numbers on the chart
// are those of the table. A decision has its number drawn where the vehicle was, if it changed the way or overruled
// it.
#pragma once

#include <isobath/runtime/html_report.hpp>
#include <isobath/runtime/mission_outcome.hpp>
#include <string>

namespace isobath {

/// PNG; empty where there is nothing to draw.
struct MissionPictures {
  std::string chart, clearance;
};

/// `planned_clearance_m`: from the hull, what way-points are planned with; for the limits of the chart of clearances.
MissionPictures draw_mission(const MissionOutcome& outcome, double planned_clearance_m);

void add_mission(HtmlReport& page, const MissionOutcome& outcome, const MissionPictures& pictures);

/// The outcome in a few sentences for a terminal, one line each: how it ended, and each decision that changed the way.
std::vector<std::string> mission_summary(const MissionOutcome& outcome);

}  // namespace isobath
