// The report of a run of several vehicles.
#include <algorithm>
#include <fmt/format.h>
#include <isobath/report/group_outcome.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/report/mission_pages.hpp>

namespace isobath {

namespace {

void add_vehicles(HtmlReport& page, const GroupOutcome& outcome) {
  const GroupRecord& record = outcome.record;
  std::vector<HtmlReport::Row> rows;
  for (std::size_t v = 0; v < record.vehicles.size(); ++v) {
    const GroupVehicleRecord& vehicle = record.vehicles[v];
    const LinkCounts& n = vehicle.link;
    rows.push_back({vehicle.name,
                    vehicle.lost_s ? fmt::format("lost at {:.0f} s", *vehicle.lost_s) : to_text(vehicle.report.phase),
                    fmt::format("{}", record.lanes(v)), percent_text(outcome.score.searched_by[v]),
                    fmt::format("{}", n.packets), fmt::format("{:.1f}", record.bit_rate(v)),
                    fmt::format("{}", n.received), fmt::format("{}", n.lost),
                    fmt::format("{}", n.collided + n.deaf + n.out_of_range)});
  }
  page.table({"vehicle", "mission", "lanes", "searched", "packets sent", "bit/s", "received", "lost", "not heard"},
             rows);
}

/// All decisions of all vehicles in the order of time.
void add_all_decisions(HtmlReport& page, const GroupOutcome& outcome) {
  struct Entry {
    Time time;
    std::size_t vehicle;
    const Decision* decision;
  };
  std::vector<Entry> all;
  for (std::size_t v = 0; v < outcome.record.vehicles.size(); ++v) {
    for (const Decision& d : outcome.record.vehicles[v].decisions) all.push_back({d.time, v, &d});
  }
  std::ranges::stable_sort(all, {}, &Entry::time);
  std::vector<HtmlReport::Row> rows;
  for (const Entry& entry : all) {
    const Decision& d = *entry.decision;
    rows.push_back({to_text(d.time), outcome.record.vehicles[entry.vehicle].name, fmt::format("{}", d.number), d.agent,
                    d.what, d.reason});
  }
  page.heading("Decisions of all vehicles");
  page.table({"time", "vehicle", "", "by", "what", "why"}, rows);
}

}  // namespace

std::string group_report(const GroupOutcome& outcome, const std::string& png) {
  const GroupRecord& record = outcome.record;
  HtmlReport page(record.plan.title.empty() ? "Several vehicles" : record.plan.title,
                  fmt::format("{}.", fmt::join(group_facts(outcome), "; ")));
  const std::string failure = outcome.failure();
  if (!failure.empty()) page.warning("Failed: " + failure + ".");
  std::vector<std::pair<std::string, std::string>> reports;
  for (const GroupVehicleRecord& vehicle : record.vehicles) {
    reports.emplace_back("report of " + vehicle.name, vehicle.name + "/report.html");
  }
  page.links(reports);
  page.figure(png, "The lanes and the true tracks of the vehicles, with the bodies in the water.");
  add_vehicles(page, outcome);
  for (std::size_t v = 0; v < outcome.runs.size(); ++v) {
    if (!outcome.runs[v].mission) continue;
    add_command_levels(page, outcome.runs[v].mission->levels, "Levels of command of " + record.vehicles[v].name);
  }
  add_all_decisions(page, outcome);
  return page.html();
}

}  // namespace isobath
