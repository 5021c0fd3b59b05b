#include <algorithm>
#include <fmt/format.h>
#include <isobath/evaluation/evaluation_report.hpp>

namespace isobath {
namespace {

std::string cell_text(const Share& s) {
  return fmt::format("{} of {}: {:.1f} % ({:.1f} to {:.1f})", s.count, s.of, 100 * s.value(), 100 * s.low,
                     100 * s.high);
}

std::string cell_text(const RowSummary& row) {
  if (row.shown.of == 0) return "not run";
  const std::string latest = row.latest_s < 0 ? "" : fmt::format(", within {:.2f} s", row.latest_s);
  return fmt::format("{} of {}{}", row.shown.count, row.shown.of, latest);
}

std::string cell_text(const Spread& s, int digits) {
  if (s.count == 0) return "none";
  return fmt::format("{:.{}f} ({:.{}f} to {:.{}f})", s.median, digits, s.low, digits, s.high, digits);
}

std::string cell_text(int count, const Share& runs) {
  return fmt::format("{}: {:.2f} per run", count,
                     static_cast<double>(count) / std::max(1.0, static_cast<double>(runs.of)));
}

std::string percent(const Spread& s, double value) {
  return s.count == 0 ? "none" : fmt::format("{:.1f}", 100 * value);
}

Spread in_percent(Spread s) {
  for (double* value : {&s.least, &s.low, &s.median, &s.high, &s.most}) *value *= 100;
  return s;
}

std::vector<std::vector<std::string>> group_table(const Evaluation& evaluation) {
  std::vector<std::vector<std::string>> rows;
  const auto row = [&](const std::string& what, const auto& cell) {
    std::vector<std::string>& line = rows.emplace_back(1, what);
    for (const Summary& s : evaluation.summaries) line.push_back(cell(s));
  };
  row("", [](const Summary& s) { return s.name; });
  row("all lanes done, missions ended", [](const Summary& s) { return cell_text(s.goals); });
  row("collision", [](const Summary& s) { return cell_text(s.collisions); });
  row("area searched, %", [](const Summary& s) { return cell_text(in_percent(s.group.searched), 1); });
  row("... least", [](const Summary& s) { return percent(s.group.searched, s.group.searched.least); });
  row("... by two or more, %", [](const Summary& s) { return cell_text(in_percent(s.group.overlap), 1); });
  row("... most", [](const Summary& s) { return percent(s.group.overlap, s.group.overlap.most); });
  row("last lane done, s", [](const Summary& s) { return cell_text(s.group.all_searched_s, 0); });
  row("separation of two hulls, m", [](const Summary& s) { return cell_text(s.group.separation_m, 1); });
  row("... least", [](const Summary& s) { return fmt::format("{:.2f}", s.group.separation_m.least); });
  row("vehicle lost, its lanes shared anew", [](const Summary& s) { return cell_text(s.group.reassigned); });
  row("... after, s", [](const Summary& s) { return cell_text(s.group.reassigned_s, 0); });
  row("two in one passage, s, most", [](const Summary& s) {
    return s.group.passage_shared_s.count > 0 ? fmt::format("{:.1f}", s.group.passage_shared_s.most) : std::string();
  });
  row("bit/s of the vehicle that sent most", [](const Summary& s) { return cell_text(s.group.bit_rate, 1); });
  row("minimum clearance, m", [](const Summary& s) { return cell_text(s.clearance_m, 1); });
  row("stations dropped", [](const Summary& s) { return cell_text(s.points_dropped, s.goals); });
  row("replans", [](const Summary& s) { return cell_text(s.replans, s.goals); });
  row("safety actions", [](const Summary& s) { return cell_text(s.safety_actions, s.goals); });
  return rows;
}

std::vector<std::vector<std::string>> group_variant_table(const Evaluation& evaluation) {
  std::vector<std::vector<std::string>> rows;
  rows.push_back({"variant", "runs", "done", "collision", "searched, %", "least", "twice, %", "most", "last lane, s",
                  "least separation, m", "shared anew after, s", "most", "bit/s"});
  const auto text = [](const Spread& s, double value, int digits) {
    return s.count == 0 ? std::string("none") : fmt::format("{:.{}f}", value, digits);
  };
  for (const Summary& s : evaluation.variants) {
    const GroupSummary& g = s.group;
    rows.push_back({s.name, fmt::format("{}", g.runs), fmt::format("{}", s.goals.count),
                    fmt::format("{}", s.collisions.count), percent(g.searched, g.searched.median),
                    percent(g.searched, g.searched.least), percent(g.overlap, g.overlap.median),
                    percent(g.overlap, g.overlap.most), text(g.all_searched_s, g.all_searched_s.median, 0),
                    text(g.separation_m, g.separation_m.least, 1), text(g.reassigned_s, g.reassigned_s.median, 0),
                    text(g.reassigned_s, g.reassigned_s.most, 0), text(g.bit_rate, g.bit_rate.most, 1)});
  }
  return rows;
}

}  // namespace

std::vector<std::vector<std::string>> evaluation_table(const Evaluation& evaluation) {
  if (evaluation.summaries.front().group.runs > 0) return group_table(evaluation);
  std::vector<std::vector<std::string>> rows;
  const auto row = [&](const std::string& what, const auto& cell) {
    std::vector<std::string>& line = rows.emplace_back(1, what);
    for (const Summary& s : evaluation.summaries) line.push_back(cell(s));
  };
  row("", [](const Summary& s) { return s.name; });
  row("goal reached", [](const Summary& s) { return cell_text(s.goals); });
  row("... without a collision", [](const Summary& s) { return cell_text(s.safe_goals); });
  row("collision", [](const Summary& s) { return cell_text(s.collisions); });
  row("near miss", [](const Summary& s) { return cell_text(s.near_misses); });
  row("encounter", [](const Summary& s) { return cell_text(s.encounters); });
  row("refused, with a reason", [](const Summary& s) { return cell_text(s.refused); });
  row("... where no path exists", [](const Summary& s) { return fmt::format("{}", s.no_way_there); });
  row("neither goal nor reason", [](const Summary& s) { return cell_text(s.lost); });
  row("path ratio", [](const Summary& s) { return cell_text(s.path_ratio, 3); });
  row("time ratio", [](const Summary& s) { return cell_text(s.time_ratio, 3); });
  row("minimum clearance, m", [](const Summary& s) { return cell_text(s.clearance_m, 1); });
  row("detection delay, pings", [](const Summary& s) { return cell_text(s.delay_pings, 0); });
  row("range at detection, m", [](const Summary& s) { return cell_text(s.first_range_m, 1); });
  row("range error of compact bodies, m rms", [](const Summary& s) { return cell_text(s.range_error_m, 2); });
  const auto& all = evaluation.summaries;
  if (std::any_of(all.begin(), all.end(), [](const Summary& s) { return s.openings_known.of > 0; })) {
    row("opening known to be free", [](const Summary& s) { return cell_text(s.openings_known); });
    row("... from, m before it", [](const Summary& s) { return cell_text(s.opening_known_m, 1); });
    row("... share known at the decision", [](const Summary& s) { return cell_text(s.opening_share, 2); });
  }
  if (std::any_of(all.begin(), all.end(), [](const Summary& s) { return s.moving_known.of > 0; })) {
    row("moving bodies known to move", [](const Summary& s) { return cell_text(s.moving_known); });
    row("... after, s", [](const Summary& s) { return cell_text(s.moving_known_s, 1); });
    row("... error of their velocity, m/s rms", [](const Summary& s) { return cell_text(s.velocity_rms, 2); });
    row("tracks against moving bodies (OSPA), m", [](const Summary& s) { return cell_text(s.ospa_m, 2); });
  }
  using OfEncounters = std::pair<const char*, Share Summary::*>;
  for (const auto& [what, of] : {OfEncounters("crossing from starboard, passed astern", &Summary::passed_astern),
                                 OfEncounters("head-on, passed port to port", &Summary::passed_port_to_port),
                                 OfEncounters("stood on until 12 s before", &Summary::stood_on)}) {
    const auto share = of;
    if (std::ranges::any_of(all, [share](const Summary& s) { return (s.*share).of > 0; })) {
      row(what, [share](const Summary& s) { return cell_text(s.*share); });
    }
  }
  row("false obstacles per scan", [](const Summary& s) { return fmt::format("{:.3f}", s.false_obstacles); });
  row("... within 20 m", [](const Summary& s) { return fmt::format("{:.3f}", s.near_false_obstacles); });
  row("... remembered, out of view", [](const Summary& s) { return fmt::format("{:.3f}", s.unseen_false_obstacles); });
  row("mission points dropped", [](const Summary& s) { return cell_text(s.points_dropped, s.goals); });
  row("replans", [](const Summary& s) { return cell_text(s.replans, s.goals); });
  row("false replans", [](const Summary& s) { return cell_text(s.false_replans, s.goals); });
  row("safety actions", [](const Summary& s) { return cell_text(s.safety_actions, s.goals); });
  const std::vector<StageSummary>& stages = evaluation.summaries.front().stages;
  if (!stages.empty()) row("the whole story", [](const Summary& s) { return cell_text(s.story); });
  for (std::size_t i = 0; i < stages.size(); ++i) {
    row("... " + stages[i].name, [i](const Summary& s) {
      const StageSummary& stage = s.stages[i];
      return fmt::format("{}; after {} s, {} scans", cell_text(stage.shown), cell_text(stage.after_s, 1),
                         cell_text(stage.scans, 0));
    });
  }
  if (evaluation.summaries.front().rows.empty()) return rows;
  row("faults handled as the table says", [](const Summary& s) { return cell_text(s.shown); });
  for (std::size_t i = 0; i < fault_table().size(); ++i) {
    row(fault_table()[i].name, [i](const Summary& s) { return cell_text(s.rows[i]); });
  }
  return rows;
}

std::vector<std::vector<std::string>> variant_table(const Evaluation& evaluation) {
  std::vector<std::vector<std::string>> rows;
  if (evaluation.variants.empty()) return rows;
  if (evaluation.variants.front().group.runs > 0) return group_variant_table(evaluation);
  rows.push_back({"variant", "runs", "goal", "collision", "refused", "path ratio", "minimum clearance, m",
                  "false obstacles", "within 20 m"});
  const auto count = [](const Share& share) { return fmt::format("{}", share.count); };
  const auto median = [](const Spread& s, int digits) {
    return s.count == 0 ? std::string("none") : fmt::format("{:.{}f}", s.median, digits);
  };
  for (const Summary& s : evaluation.variants) {
    rows.push_back({s.name, fmt::format("{}", s.goals.of), count(s.goals), count(s.collisions), count(s.refused),
                    median(s.path_ratio, 3), median(s.clearance_m, 1), fmt::format("{:.3f}", s.false_obstacles),
                    fmt::format("{:.3f}", s.near_false_obstacles)});
  }
  return rows;
}

std::vector<std::string> comparison_lines(const Evaluation& evaluation) {
  std::vector<std::string> lines;
  const Summary& ours = evaluation.summaries.front();
  for (std::size_t i = 1; i < evaluation.summaries.size(); ++i) {
    const Summary& other = evaluation.summaries[i];
    const ShareDifference goals = difference(ours.safe_goals, other.safe_goals);
    const ShareDifference collisions = difference(other.collisions, ours.collisions);
    lines.push_back(fmt::format(
        "against {}: {:+.1f} percentage points of goals without a collision ({:+.1f} to {:+.1f}), {:+.1f} percentage "
        "points of collisions avoided ({:+.1f} to {:+.1f})",
        other.name, 100 * goals.value, 100 * goals.low, 100 * goals.high, 100 * collisions.value, 100 * collisions.low,
        100 * collisions.high));
  }
  return lines;
}

}  // namespace isobath
