// add_mission: the pages of a mission: a chart of the track with every replan at its place, the clearance over time,
// and the table of decisions with their reasons (ledger S6-56, S6-59).
//
// The chart uses estimated positions. The true track and the true bodies of a simulated run are drawn at their true
// positions, so their distance from the estimates shows the navigation error. Numbers on the chart are those of the
// table. A decision that changed or overruled the route has its number drawn at the position of the vehicle.
#pragma once

#include <isobath/report/html_report.hpp>
#include <isobath/report/mission_outcome.hpp>
#include <isobath/report/plot/chart_layout.hpp>
#include <string>

namespace isobath {

/// PNG files; empty if there is nothing to draw.
struct MissionPictures {
  std::string chart, clearance;
};

/// `planned_clearance_m`: clearance from the hull that routes are planned with; drawn as a limit in that chart. The
/// chart names the `source`.
MissionPictures draw_mission(const MissionOutcome& outcome, double planned_clearance_m, const ChartSource& source);

/// What the levels of command did, beside the timing table; nothing without levels.
void add_command_levels(HtmlReport& page, const std::vector<LevelOutcome>& levels, const std::string& heading);
void add_mission(HtmlReport& page, const MissionOutcome& outcome, const MissionPictures& pictures);

/// The outcome as lines for a terminal: how the mission ended, and each decision that changed the route.
std::vector<std::string> mission_summary(const MissionOutcome& outcome);

}  // namespace isobath
