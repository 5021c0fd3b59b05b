#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/plan/plan_graph.hpp>
#include <set>

namespace isobath {
namespace {

void check_node(const PlanNode& node, std::set<std::string>& names) {
  if (!names.insert(node.name).second) {
    throw Error("the name of a node is empty or taken: '" + node.name + "'", {}, "a unique name");
  }
  if (node.action.name.empty()) throw Error("the node '" + node.name + "' has no action");
  for (const auto& [name, value] : node.action.parameters) {
    const double* number = std::get_if<double>(&value);
    if (number && !std::isfinite(*number)) {
      throw Error(fmt::format("'{}' of the node '{}' is not finite", name, node.name), {}, "a finite number");
    }
  }
}

void check_arc(const PlanGraph& graph, const PlanArc& arc) {
  if (arc.from >= graph.nodes.size() || arc.to >= graph.nodes.size()) {
    throw Error(fmt::format("an arc leads from node {} to node {}", arc.from, arc.to), {},
                fmt::format("0 .. {}", graph.nodes.size() - 1));
  }
  const std::string where =
      fmt::format("the arc from '{}' to '{}'", graph.nodes[arc.from].name, graph.nodes[arc.to].name);
  const bool timeout = arc.event.test == PlanEvent::Test::kTimeout;
  if (arc.event.quantity.empty() != timeout) {
    throw Error(where + (timeout ? " waits for a time and for a quantity" : " has no event"), {}, "one event");
  }
  if (!std::isfinite(arc.event.limit) ||
      (timeout && (arc.event.limit < 0 || !representable_seconds(arc.event.limit)))) {
    throw Error(fmt::format("{} has the limit {}", where, arc.event.limit), {},
                timeout ? "from 0 s to 9.2e9 s" : "a finite number");
  }
}

std::vector<bool> reached_from_first(const PlanGraph& graph) {
  std::vector<std::vector<std::size_t>> next(graph.nodes.size());
  for (const PlanArc& arc : graph.arcs) next[arc.from].push_back(arc.to);
  std::vector<bool> reached(graph.nodes.size(), false);
  std::vector<std::size_t> open = {0};
  reached[0] = true;
  while (!open.empty()) {
    const std::size_t node = open.back();
    open.pop_back();
    for (const std::size_t to : next[node]) {
      if (!reached[to]) open.push_back(to);
      reached[to] = true;
    }
  }
  return reached;
}

bool is_true(const PlanEvent& event, const PlanDatabase& database, Duration since_arrival) {
  if (event.test == PlanEvent::Test::kTimeout) return since_arrival >= seconds(event.limit);
  const std::optional<double> value = database.value(event.quantity, event.of);
  if (!value || std::isnan(*value)) return false;
  switch (event.test) {
    case PlanEvent::Test::kFact: return *value != 0;
    case PlanEvent::Test::kBelow: return *value < event.limit;
    case PlanEvent::Test::kAbove: return *value > event.limit;
    case PlanEvent::Test::kTimeout: break;
  }
  return false;
}

}  // namespace

std::optional<double> PlanAction::number(const std::string& parameter) const {
  const auto found = parameters.find(parameter);
  if (found == parameters.end()) return std::nullopt;
  const auto* value = std::get_if<double>(&found->second);
  return value ? std::optional<double>(*value) : std::nullopt;
}

PlanEvent PlanEvent::fact(std::string quantity, std::optional<int> of) {
  return {Test::kFact, std::move(quantity), of, 0};
}
PlanEvent PlanEvent::below(std::string quantity, double limit, std::optional<int> of) {
  return {Test::kBelow, std::move(quantity), of, limit};
}
PlanEvent PlanEvent::above(std::string quantity, double limit, std::optional<int> of) {
  return {Test::kAbove, std::move(quantity), of, limit};
}
PlanEvent PlanEvent::timeout(double after_s) { return {Test::kTimeout, "", std::nullopt, after_s}; }

std::string to_text(const PlanEvent& event) {
  const std::string what = event.of ? fmt::format("{} ({})", event.quantity, *event.of) : event.quantity;
  switch (event.test) {
    case PlanEvent::Test::kFact: return what;
    case PlanEvent::Test::kBelow: return fmt::format("{} below {}", what, event.limit);
    case PlanEvent::Test::kAbove: return fmt::format("{} above {}", what, event.limit);
    case PlanEvent::Test::kTimeout: return fmt::format("timeout {} s", event.limit);
  }
  return "";
}

std::size_t PlanGraph::add(std::string name, PlanAction action) {
  nodes.push_back({std::move(name), std::move(action)});
  return nodes.size() - 1;
}

void PlanGraph::join(std::size_t from, PlanEvent event, std::size_t to) {
  arcs.push_back({from, std::move(event), to});
}

bool PlanGraph::terminal(std::size_t node) const {
  return std::none_of(arcs.begin(), arcs.end(), [&](const PlanArc& arc) { return arc.from == node; });
}

void check_plan_graph(const PlanGraph& graph) {
  if (graph.nodes.empty()) throw Error("a plan graph without nodes", {}, "at least one");
  std::set<std::string> names = {""};
  for (const PlanNode& node : graph.nodes) check_node(node, names);
  for (const PlanArc& arc : graph.arcs) check_arc(graph, arc);
  const std::vector<bool> reached = reached_from_first(graph);
  const auto lonely = static_cast<std::size_t>(std::find(reached.begin(), reached.end(), false) - reached.begin());
  if (lonely < graph.nodes.size()) {
    throw Error(
        fmt::format("no path leads from the node '{}' to the node '{}'", graph.nodes[0].name, graph.nodes[lonely].name),
        {}, "every node is reached from the first", "join it, or leave it out");
  }
  std::vector<bool> left(graph.nodes.size(), false);
  for (const PlanArc& arc : graph.arcs) left[arc.from] = true;
  if (std::find(left.begin(), left.end(), false) == left.end()) {
    throw Error("the plan graph has no end: an arc leaves every node", {}, "at least one terminal node");
  }
}

PlanExecutor::PlanExecutor(PlanGraph graph) : graph_(std::move(graph)) { check_plan_graph(graph_); }

const PlanAction& PlanExecutor::start(Time now) {
  node_ = 0;
  followed_.reset();
  arrived_ = now;
  return graph_.nodes[0].action;
}

const PlanAction* PlanExecutor::update(PlanGraph newer, Time now) {
  check_plan_graph(newer);
  const bool has_more = node_ && !graph_.terminal(*node_);
  const std::optional<PlanAction> present = has_more ? std::optional(graph_.nodes[*node_].action) : std::nullopt;
  graph_ = std::move(newer);
  followed_.reset();
  const auto same = std::ranges::find_if(graph_.nodes, [&](const PlanNode& node) { return node.action == present; });
  if (same == graph_.nodes.end()) return &start(now);
  node_ = static_cast<std::size_t>(same - graph_.nodes.begin());
  return nullptr;
}

const PlanAction* PlanExecutor::cycle(Time now, const PlanDatabase& database) {
  ISOBATH_ASSERT(node_.has_value());
  for (std::size_t i = 0; i < graph_.arcs.size(); ++i) {
    const PlanArc& arc = graph_.arcs[i];
    if (arc.from != node() || !is_true(arc.event, database, now - arrived_)) continue;
    node_ = arc.to;
    followed_ = i;
    arrived_ = now;
    return &graph_.nodes[arc.to].action;
  }
  return nullptr;
}

}  // namespace isobath
