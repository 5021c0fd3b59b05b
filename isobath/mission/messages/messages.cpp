#include <fmt/format.h>
#include <isobath/mission/messages/messages.hpp>

namespace isobath {

const char* to_text(MissionPhase phase) {
  switch (phase) {
    case MissionPhase::kWaiting: return "waiting";
    case MissionPhase::kUnderWay: return "under way";
    case MissionPhase::kHolding: return "holding";
    case MissionPhase::kFinished: return "finished";
    case MissionPhase::kAborted: return "aborted";
  }
  return "";
}

const char* to_text(MissionOrder::Kind kind) {
  switch (kind) {
    case MissionOrder::Kind::kStart: return "start";
    case MissionOrder::Kind::kHold: return "hold";
    case MissionOrder::Kind::kResume: return "resume";
    case MissionOrder::Kind::kAbort: return "abort";
  }
  return "";
}

const char* to_text(RouteRefused::Reason reason) {
  switch (reason) {
    case RouteRefused::Reason::kStartBlocked: return "the vehicle is inside an obstacle";
    case RouteRefused::Reason::kGoalBlocked: return "an obstacle at the point";
    case RouteRefused::Reason::kNoPath: return "no path";
    case RouteRefused::Reason::kOutOfBudget: return "no path within the budget";
    case RouteRefused::Reason::kOutsideFence: return "the point is outside the fence";
    case RouteRefused::Reason::kNoMap: return "there was no scan for too long";
  }
  return "";
}

const char* to_text(SafetyActionKind kind) {
  switch (kind) {
    case SafetyActionKind::kNone: return "none";
    case SafetyActionKind::kSlow: return "slow";
    case SafetyActionKind::kStop: return "stop";
    case SafetyActionKind::kTurn: return "turn";
    case SafetyActionKind::kSurface: return "surface";
  }
  return "";
}

std::string to_text(const Decision& decision) {
  return to_text(decision.time) + " " + decision.agent + ": " + decision.what + ": " + decision.reason;
}

std::optional<ScanCommand> scan_of(const TaskStep& step) {
  if (step.sector <= Angle{}) return std::nullopt;
  ScanCommand scan;
  scan.sector = step.sector;
  scan.middle = step.look;
  if (step.sonar_range_m > 0) scan.range_m = step.sonar_range_m;
  return scan;
}

std::string text_of_step(const PlanStep& step) {
  if (!step.graph || step.node >= step.graph->nodes.size()) return {};
  constexpr std::size_t kMostNext = 4;
  const PlanGraph& graph = *step.graph;
  std::string text =
      fmt::format("\"{}\" (node {} of {})", graph.nodes[step.node].name, step.node + 1, graph.nodes.size());
  std::size_t next = 0;
  for (const PlanArc& arc : graph.arcs) {
    if (arc.from != step.node || ++next > kMostNext) continue;
    PlanEvent event = arc.event;
    event.of.reset();  // the node says of which point it is
    text += fmt::format("{} \"{}\" on {}", next == 1 ? "; next" : ",", graph.nodes[arc.to].name, to_text(event));
  }
  return text;
}

}  // namespace isobath
