// The plan graphs of the Executive Officer: of a whole mission, of the points that are to be visited, of an end.
#include <fmt/format.h>
#include <isobath/mission/agents/executive_officer.hpp>
#include <numeric>

namespace isobath {
namespace {

constexpr double kAtSurface = 0.5;  // m of depth

PlanAction at_point(const char* name, std::size_t point) { return {name, {{"point", static_cast<double>(point)}}}; }

int index(std::size_t point) { return static_cast<int>(point); }

// Adds the nodes of an ending; returns the first of them.
std::size_t add_end(PlanGraph& graph, MissionEnd end, const std::string& name, std::size_t points,
                    const ExecutiveConfig& config) {
  if (end == MissionEnd::kHold) return graph.add(name, {"finish"});
  const std::size_t first = graph.add(name, {end == MissionEnd::kReturn ? "return" : "surface"});
  const std::size_t finish = graph.add(name + ", finished", {"finish"});
  std::size_t surface = first;
  if (end == MissionEnd::kReturn) {
    surface = graph.add(name + ", no way back", {"surface"});
    graph.join(first, PlanEvent::fact("returned"), finish);
    graph.join(first, PlanEvent::above("waited", config.route_timeout_s, index(points)), surface);
  }
  graph.join(surface, PlanEvent::below("depth", kAtSurface), finish);
  graph.join(surface, PlanEvent::timeout(config.surface_wait_s), finish);
  return first;
}

/// A name for the nodes of a point that no other point's nodes have: "the wreck (point 3)".
std::string node_name(const MissionPlan& plan, std::size_t point) {
  const std::string number = fmt::format("point {}", point + 1);
  const std::string& name = plan.points[point].name;
  return name.empty() || name == number ? number : fmt::format("{} ({})", name, number);
}

/// A node that leads on when the event is true.
struct NodeExit {
  std::size_t node;
  PlanEvent event;
};

void join_all(PlanGraph& graph, const std::vector<NodeExit>& exits, std::size_t to) {
  for (const NodeExit& exit : exits) graph.join(exit.node, exit.event, to);
}

/// The event that ends a step.
std::optional<PlanEvent> end_of(const TaskStep& step, std::size_t point) {
  if (const auto event = step_event_of(step)) return event;
  if (step.pilot == "hold") return std::nullopt;
  if (step.pilot == "surface") return PlanEvent::below("depth", kAtSurface);
  return PlanEvent::fact("task done", index(point));
}

/// Adds a node for each step of the task of a point (`own`), after `before`. Returns what leads to the next point.
std::vector<NodeExit> add_steps(PlanGraph& graph, const MissionPlan& plan, std::size_t point,
                                const std::vector<std::size_t>& own, const std::vector<NodeExit>& before,
                                const ExecutiveConfig& config) {
  std::map<std::size_t, std::size_t> nodes;
  for (const std::size_t k : own) {
    nodes[k] = graph.add(fmt::format("{}: {}", node_name(plan, point), plan.steps[k].name),
                         {"step", {{"point", static_cast<double>(point)}, {"step", static_cast<double>(k)}}});
  }
  join_all(graph, before, nodes[own.front()]);
  std::vector<NodeExit> exits;
  for (const std::size_t k : own) {
    const TaskStep& step = plan.steps[k];
    const auto lead = [&](PlanEvent event, const std::string& name) {
      const auto next = step_after(plan.steps, k, name);
      if (next) {
        graph.join(nodes[k], std::move(event), nodes[*next]);
      } else {
        exits.push_back({nodes[k], std::move(event)});
      }
    };
    if (auto event = end_of(step, point)) lead(*std::move(event), step.then);
    lead(PlanEvent::timeout(step.at_most_s > 0 ? step.at_most_s : config.task_wait_s), step.or_else);
  }
  return exits;
}

/// Where the vehicle waits: at the last point, if that is a waiting place, else where it is.
std::size_t add_wait(PlanGraph& graph, const MissionPlan& plan, std::span<const std::size_t> points) {
  const bool at_place = !points.empty() && points.back() >= plan.search.all_stations();
  return graph.add("wait", at_place ? at_point("wait", points.back()) : PlanAction{"wait"});
}

}  // namespace

PlanGraph mission_graph(const MissionPlan& plan, const ExecutiveConfig& config) {
  std::vector<std::size_t> all(plan.points.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return visit_graph(plan, all, true, config);
}

PlanGraph visit_graph(const MissionPlan& plan, std::span<const std::size_t> points, bool last,
                      const ExecutiveConfig& config) {
  PlanGraph graph{plan.title};
  struct Nodes {
    std::size_t go, drop;
    std::vector<NodeExit> exits;  // of the work at the point
  };
  std::vector<Nodes> at;
  for (const std::size_t i : points) {
    const MissionPoint& p = plan.points[i];
    const std::string name = node_name(plan, i);
    const std::size_t go = graph.add(name, at_point("go to", i));
    Nodes nodes{
        go, graph.add(name + ", drop", at_point("drop", i)), {{go, PlanEvent::fact("point reached", index(i))}}};
    graph.join(go, PlanEvent::above("waited", config.route_timeout_s, index(i)), nodes.drop);
    const auto then = [&](const char* what, const std::vector<PlanEvent>& over) {
      const std::size_t node = graph.add(fmt::format("{}, {}", name, what), at_point(what, i));
      join_all(graph, nodes.exits, node);
      nodes.exits.clear();
      for (const PlanEvent& event : over) nodes.exits.push_back({node, event});
    };
    if (p.hold_s > 0) then("hold", {PlanEvent::timeout(p.hold_s)});
    if (const auto steps = steps_of(plan.steps, p.task); !steps.empty()) {
      nodes.exits = add_steps(graph, plan, i, steps, nodes.exits, config);
    } else if (!p.task.empty()) {
      then("task", {PlanEvent::fact("task done", index(i)), PlanEvent::timeout(config.task_wait_s)});
    }
    at.push_back(std::move(nodes));
  }
  const std::size_t all = plan.points.size();
  const std::size_t over = last ? add_end(graph, plan.at_end, "end", all, config) : add_wait(graph, plan, points);
  const std::size_t dropped =
      at.empty() || !last ? over : add_end(graph, plan.if_dropped, "end after a drop", all, config);
  for (std::size_t k = 0; k < at.size(); ++k) {
    const std::size_t i = points[k];
    const bool is_last = k + 1 == at.size();
    const std::size_t next = is_last ? over : at[k + 1].go;
    const std::size_t next_after_drop = is_last ? dropped : next;
    join_all(graph, at[k].exits, next);
    graph.join(at[k].go, PlanEvent::fact("point dropped", index(i)), next_after_drop);
    graph.join(at[k].drop, PlanEvent::fact("point dropped", index(i)), next_after_drop);
  }
  return graph;
}

PlanGraph end_graph(MissionEnd end, std::size_t points, const ExecutiveConfig& config) {
  PlanGraph graph{"end"};
  add_end(graph, end, "end", points, config);
  return graph;
}

}  // namespace isobath
