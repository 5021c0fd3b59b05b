#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <isobath/evaluation/fault_injection_check.hpp>
#include <isobath/geometry/polygon.hpp>
#include <vector>

namespace isobath {
namespace {

constexpr double kTouched_m = 1;   // nearer than this counts as a contact
constexpr double kCycle_s = 0.25;  // one cycle of the Safety Officer, and the latency of a reading
constexpr double kNeverSure = 10;  // above any sum of the probabilities of nine cells

const Decision* first_of(const std::vector<Decision>& decisions, const std::string& agent, const std::string& what) {
  const auto found = std::find_if(decisions.begin(), decisions.end(),
                                  [&](const Decision& d) { return d.agent == agent && d.what == what; });
  return found != decisions.end() ? &*found : nullptr;
}

/// Decisions of the Safety Officer about the row, in order.
std::vector<Decision> about(const FaultRow& row, const std::vector<Decision>& decisions) {
  std::vector<Decision> own;
  std::copy_if(decisions.begin(), decisions.end(), std::back_inserter(own), [&](const Decision& d) {
    return d.agent == "safety officer" && d.reason.starts_with(std::string(row.name) + ":");
  });
  return own;
}

std::optional<double> decided_at(const Decision* decision) {
  return decision ? std::optional(to_seconds(decision->time)) : std::nullopt;
}

/// When the vehicle truly left the fence.
std::optional<double> crossing(const Polygon& fence, const std::vector<TrueMotion>& track) {
  for (const TrueMotion& motion : track) {
    if (!encloses(fence, motion.state.X_WB.translation.head<2>())) return to_seconds(motion.time);
  }
  return std::nullopt;
}

/// By how much the fault sets the clock of the decisions forward, s: they may have any time in between.
double jump_of(const Scenario& scenario) {
  const auto& faults = scenario.scene.faults;
  return !faults.empty() && faults.front().kind == FaultKind::kClockJump ? std::max(0.0, faults.front().amount) : 0;
}

/// When a deadline starts, by the clock of the decisions, s; empty: it never did, or the deadline is no time.
std::optional<double> origin(Deadline::From from, const Scenario& scenario, const LoopResult& result) {
  const std::optional<double> start = decided_at(first_of(result.decisions, "captain", "start"));
  switch (from) {
    case Deadline::From::kInjection: {
      if (scenario.scene.faults.empty()) return std::nullopt;
      return scenario.scene.faults.front().at_s + jump_of(scenario);
    }
    case Deadline::From::kStart: return start;
    case Deadline::From::kOvertime:
      return start ? std::optional(*start + scenario.mission.limits.max_duration_s) : std::nullopt;
    case Deadline::From::kRefusal: return decided_at(first_of(result.decisions, "navigator", "refuse"));
    case Deadline::From::kCrossing: return crossing(scenario.mission.fence, result.track);
    case Deadline::From::kNearness: break;
  }
  return std::nullopt;
}

std::string out_of_time(const Deadline& deadline, double raised_s, std::optional<double> since_s, double jump_s) {
  if (deadline.from == Deadline::From::kNearness) return "";  // too_near() checks the ground truth
  const bool before = deadline.from == Deadline::From::kCrossing;
  if (!since_s) return before && deadline.value == 0 ? "" : "its cause did not occur";
  const double after_s = raised_s - *since_s;
  if (after_s > deadline.value) return fmt::format("raised after {:.2f} s, {:g} s allowed", after_s, deadline.value);
  if (after_s < -jump_s && !before) return fmt::format("raised {:.2f} s before its cause", -after_s);
  return "";
}

std::string too_near(const Deadline& deadline, const LoopResult& result) {
  if (result.contact_s >= 0) return fmt::format("touched {} at {:.1f} s", result.contact_with, result.contact_s);
  if (result.min_clearance_m < kTouched_m) {
    return fmt::format("came within {:.2f} m of {}", result.min_clearance_m, result.nearest_body);
  }
  if (deadline.from != Deadline::From::kNearness) return "";
  const double nearest_m = std::min(result.min_clearance_m, result.min_altitude_m);
  return nearest_m < deadline.value ? fmt::format("{:.2f} m away, {:g} m allowed", nearest_m, deadline.value) : "";
}

/// A vehicle that cannot stop, or is to surface, surfaces instead of stopping, or does what the row has for it; one
/// that is to end its mission at once aborts.
bool is_action(const FaultRow& row, const std::string& what) {
  if (what == "abort") return row.abort.when == After::When::kAtOnce;
  if (row.action == SafetyActionKind::kNone) return what == "report";
  return what == to_text(row.action) ||
         (row.unstoppable != SafetyActionKind::kNone && what == to_text(row.unstoppable)) ||
         (row.action == SafetyActionKind::kStop && what == to_text(SafetyActionKind::kSurface));
}

/// The safety action in force at the helm at `by_s`, by the decisions of the helm gate.
SafetyActionKind at_the_helm(const std::vector<Decision>& decisions, double by_s) {
  SafetyActionKind kind = SafetyActionKind::kNone;
  for (const Decision& d : decisions) {
    if (d.agent != "helm gate" || to_seconds(d.time) > by_s) continue;
    kind = SafetyActionKind::kNone;
    for (const auto one :
         {SafetyActionKind::kSlow, SafetyActionKind::kStop, SafetyActionKind::kTurn, SafetyActionKind::kSurface}) {
      if (d.what == to_text(one)) kind = one;
    }
  }
  return kind;
}

std::string wrong_action(const FaultRow& row, const Decision& raised, const std::vector<Decision>& all) {
  if (!is_action(row, raised.what)) return "wrong action: " + raised.what;
  const SafetyActionKind taken = at_the_helm(all, to_seconds(raised.time) + kCycle_s);
  return taken < row.action ? fmt::format("not in force at the helm: {}", to_text(row.action)) : "";
}

std::string wrong_end(const FaultRow& row, const SafetyConfig& config, const std::vector<Decision>& own,
                      const LoopResult& result) {
  const auto asked = std::find_if(own.begin(), own.end(), [](const Decision& d) { return d.what == "abort"; });
  const bool aborted = result.report.phase == MissionPhase::kAborted;
  if (asked != own.end() && !aborted) return fmt::format("mission end requested, but {}", to_text(result.report.phase));
  const bool asks = row.fault != Fault::kLinkLost || config.link_policy != LinkPolicy::kContinue;
  if (row.abort.when == After::When::kNever || !asks) return "";
  const double held_s = row.abort.when == After::When::kLater ? config.*row.abort.wait : 0;
  const double due_s = to_seconds(own.front().time) + held_s;
  if (asked != own.end()) {
    const double late_s = to_seconds(asked->time) - due_s;
    return late_s > kCycle_s ? fmt::format("mission end requested {:.2f} s late", late_s) : "";
  }
  const auto over = std::find_if(own.begin(), own.end(), [](const Decision& d) { return d.what == "over"; });
  const double until_s = over != own.end() ? to_seconds(over->time) : result.duration_s;
  const bool goes_on = !aborted && result.report.phase != MissionPhase::kFinished;
  return goes_on && until_s > due_s + kCycle_s ? "mission end not requested" : "";
}

}  // namespace

FaultInjectionCheck prove(const FaultRow& row, const Scenario& scenario, const SafetyConfig& config,
                          const LoopResult& result) {
  FaultInjectionCheck proof;
  proof.fault = row.name;
  std::vector<std::string> failures{too_near(row.deadline, result)};
  const std::vector<Decision> own = about(row, result.decisions);
  if (own.empty()) {
    failures.emplace_back("not raised");
  } else {
    const Decision& raised = own.front();
    const std::optional<double> since_s = origin(row.deadline.from, scenario, result);
    if (since_s) proof.after_s = to_seconds(raised.time) - *since_s;
    failures.push_back(out_of_time(row.deadline, to_seconds(raised.time), since_s, jump_of(scenario)));
    failures.push_back(wrong_action(row, raised, result.decisions));
    failures.push_back(wrong_end(row, config, own, result));
  }
  std::erase(failures, "");
  proof.failure = fmt::format("{}", fmt::join(failures, "; "));
  return proof;
}

Configuration proving(const FaultRow& row, Configuration configuration) {
  const bool unseen = row.fault == Fault::kCollisionAhead || row.fault == Fault::kCollisionUnavoidable;
  if (unseen) configuration.grid.threshold = kNeverSure;
  return configuration;
}

}  // namespace isobath
