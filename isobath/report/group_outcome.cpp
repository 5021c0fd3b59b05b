#include <cmath>
#include <fmt/format.h>
#include <isobath/report/group_outcome.hpp>
#include <nlohmann/json.hpp>

namespace isobath {

std::string GroupOutcome::failure() const {
  if (record.least_separation_m <= 0) {
    return fmt::format("two vehicles touched each other at {:.1f} s", record.least_separation_s);
  }
  for (std::size_t v = 0; v < runs.size(); ++v) {
    if (record.vehicles[v].lost_s || !runs[v].mission) continue;
    const std::string why = runs[v].mission->failure();
    if (!why.empty()) return record.vehicles[v].name + ": " + why;
  }
  return score.all_searched_s ? "" : "the area was not searched whole";
}

std::string group_text(const GroupOutcome& outcome) {
  const GroupRecord& record = outcome.record;
  const GroupScore& score = outcome.score;
  const auto or_null = [](const std::optional<double>& value) {
    return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
  };
  nlohmann::ordered_json json;
  json["lanes"] = record.plan.search.lanes();
  json["searched"] = score.searched;
  json["overlap"] = score.overlap;
  json["all_searched_s"] = or_null(score.all_searched_s);
  json["reassigned_s"] = or_null(score.reassigned_s);
  json["duration_s"] = record.duration_s;
  json["least_separation_m"] =
      or_null(std::isfinite(record.least_separation_m) ? std::optional(record.least_separation_m) : std::nullopt);
  json["least_separation_s"] = record.least_separation_s;
  json["passage_shared_s"] =
      or_null(record.plan.passages.empty() ? std::nullopt : std::optional(record.passage_shared_s));
  json["failure"] = outcome.failure();
  json["vehicles"] = nlohmann::ordered_json::array();
  for (std::size_t v = 0; v < record.vehicles.size(); ++v) {
    const GroupVehicleRecord& vehicle = record.vehicles[v];
    const LinkCounts& n = vehicle.link;
    nlohmann::ordered_json one;
    one["name"] = vehicle.name;
    one["phase"] = to_text(vehicle.report.phase);
    one["lost_s"] = or_null(vehicle.lost_s);
    one["lanes"] = record.lanes(v);
    one["searched"] = score.searched_by[v];
    one["link"] = {{"packets", n.packets}, {"bytes", n.bytes},       {"bit_rate", record.bit_rate(v)},
                   {"dropped", n.dropped}, {"received", n.received}, {"out_of_range", n.out_of_range},
                   {"deaf", n.deaf},       {"collided", n.collided}, {"lost", n.lost}};
    json["vehicles"].push_back(std::move(one));
  }
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string percent_text(double share) { return fmt::format("{:.1f} %", 100 * share); }

std::vector<std::string> group_facts(const GroupOutcome& outcome) {
  const GroupRecord& record = outcome.record;
  const GroupScore& score = outcome.score;
  std::vector<std::string> lines;
  lines.push_back(fmt::format("{} vehicles searched {} of an area of {} lanes in {:.0f} s, and {} of it twice or more",
                              record.vehicles.size(), percent_text(score.searched), record.plan.search.lanes(),
                              record.duration_s, percent_text(score.overlap)));
  if (score.all_searched_s) lines.push_back(fmt::format("the last lane was done at {:.0f} s", *score.all_searched_s));
  if (score.reassigned_s) {
    lines.push_back(fmt::format("the lanes of the lost vehicle were shared anew after {:.0f} s", *score.reassigned_s));
  }
  if (std::isfinite(record.least_separation_m)) {
    lines.push_back(fmt::format("least separation of two hulls: {:.1f} m, at {:.0f} s", record.least_separation_m,
                                record.least_separation_s));
  }
  if (!record.plan.passages.empty()) {
    lines.push_back(record.passage_shared_s > 0
                        ? fmt::format("two vehicles were in one passage for {:.1f} s", record.passage_shared_s)
                        : std::string("no two vehicles were in one passage at a time"));
  }
  return lines;
}

std::vector<std::string> group_summary(const GroupOutcome& outcome) {
  const GroupRecord& record = outcome.record;
  const GroupScore& score = outcome.score;
  std::vector<std::string> lines = group_facts(outcome);
  for (std::size_t v = 0; v < record.vehicles.size(); ++v) {
    const GroupVehicleRecord& vehicle = record.vehicles[v];
    const LinkCounts& n = vehicle.link;
    std::string line = fmt::format(
        "  {}: {}, {} lanes, {} of the area", vehicle.name,
        vehicle.lost_s ? fmt::format("lost at {:.0f} s", *vehicle.lost_s) : std::string(to_text(vehicle.report.phase)),
        record.lanes(v), percent_text(score.searched_by[v]));
    line += fmt::format("; sent {} packets, {:.1f} bit/s; {} received, {} lost, {} collided, {} unheard", n.packets,
                        record.bit_rate(v), n.received, n.lost, n.collided, n.deaf + n.out_of_range);
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace isobath
