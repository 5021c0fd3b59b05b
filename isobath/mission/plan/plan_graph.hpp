// PlanGraph: a plan as actions (nodes) and the events that lead from one to the next (arcs), which may branch and join;
// PlanExecutor steps through it (Herman 1988, 2 and 3.3; ledger S2-06, S2-07, S2-08).
//
//   PlanGraph graph{"two points"};
//   const auto first = graph.add("point 1", {"go to", {{"point", 0.0}}});
//   const auto end = graph.add("end", {"surface"});
//   graph.join(first, PlanEvent::fact("point reached", 0), end);
//   graph.join(first, PlanEvent::below("battery", 0.2), end);
//   graph.join(first, PlanEvent::timeout(60), end);
//
// An event is a predicate over a database of quantities: of the world ("range" below 10), of the system itself
// ("battery" below 0.2), of the mission (the fact "point reached" of point 0), or a time since the arrival at the node.
// A quantity that the database does not know makes no event true, neither below nor above.
//
// Executor: the arrival at a node issues its action. Each cycle tests the arcs that leave the node, in the order in
// which they were joined, and follows the first whose event is true, at most one per cycle. An event that was true
// before the arrival fires in the first cycle after it. Pure functions of database and time. One thread at a time.
#pragma once

#include <isobath/base/error.hpp>
#include <isobath/base/time.hpp>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace isobath {

/// "go to", "hold", "surface" ..., with numbers and names.
struct PlanAction {
  std::string name;
  std::map<std::string, std::variant<double, std::string>> parameters = {};

  /// Empty where there is no such parameter, or it is a text.
  [[nodiscard]] std::optional<double> number(const std::string& parameter) const;
  bool operator==(const PlanAction&) const = default;
};

struct PlanEvent {
  enum class Test : std::uint8_t { kFact, kBelow, kAbove, kTimeout };
  Test test = Test::kFact;
  std::string quantity;   ///< "range", "battery", "point reached"; empty with kTimeout
  std::optional<int> of;  ///< index, where there are several: of the point, of the vehicle
  double limit = 0;       ///< for kBelow and kAbove; s for kTimeout

  /// True while the quantity is known and not 0.
  static PlanEvent fact(std::string quantity, std::optional<int> of = {});
  static PlanEvent below(std::string quantity, double limit, std::optional<int> of = {});
  static PlanEvent above(std::string quantity, double limit, std::optional<int> of = {});
  static PlanEvent timeout(double after_s);
  bool operator==(const PlanEvent&) const = default;
};
/// "range below 10", "point reached (0)", "timeout 60 s".
std::string to_text(const PlanEvent& event);

struct PlanNode {
  std::string name;
  PlanAction action;
  bool operator==(const PlanNode&) const = default;
};

struct PlanArc {
  std::size_t from = 0;
  PlanEvent event;
  std::size_t to = 0;
  bool operator==(const PlanArc&) const = default;
};

struct PlanGraph {
  std::string title;
  std::vector<PlanNode> nodes = {};  ///< the first is the start
  std::vector<PlanArc> arcs = {};

  std::size_t add(std::string name, PlanAction action);
  void join(std::size_t from, PlanEvent event, std::size_t to);
  /// Whether no arc leaves the node.
  [[nodiscard]] bool terminal(std::size_t node) const;
  bool operator==(const PlanGraph&) const = default;
};

/// Throws Error where there is no node, a name is empty or taken twice, an action has no name, an arc has no event or
/// leads nowhere, a number is not finite, a node cannot be reached from the first, or no node is terminal.
void check_plan_graph(const PlanGraph& graph);

/// JSON text that reads back equal.
std::string write_plan_graph(const PlanGraph& graph);
/// Throws Error with the byte of a syntax error or the key of what is wrong, and as check_plan_graph.
PlanGraph read_plan_graph(std::string_view text, const std::string& file);

/// The quantities that an executor asks for.
class PlanDatabase {
 public:
  PlanDatabase() = default;
  PlanDatabase(const PlanDatabase&) = delete;
  PlanDatabase& operator=(const PlanDatabase&) = delete;
  virtual ~PlanDatabase() = default;
  /// Empty where the quantity is unknown.
  [[nodiscard]] virtual std::optional<double> value(const std::string& quantity, std::optional<int> of) const = 0;
};

class PlanExecutor {
 public:
  /// Throws Error like check_plan_graph.
  explicit PlanExecutor(PlanGraph graph);

  /// Arrives at the first node, also when the executor was started before.
  const PlanAction& start(Time now);
  /// The action of a node that was reached in this cycle, or null. `start` must have been called.
  const PlanAction* cycle(Time now, const PlanDatabase& database);

  /// A newer graph replaces what is not executed yet (S2-24). Where it has a node with the action of the present one,
  /// and that is not terminal, the executor goes on there, without a new arrival, and the result is null; else it
  /// arrives at the first node, and the result is its action. Throws Error like check_plan_graph, and then changes
  /// nothing.
  const PlanAction* update(PlanGraph newer, Time now);

  [[nodiscard]] bool started() const { return node_.has_value(); }
  /// Whether the node is terminal.
  [[nodiscard]] bool finished() const { return node_ && graph_.terminal(*node_); }
  [[nodiscard]] std::size_t node() const { return node_.value_or(0); }
  [[nodiscard]] Time arrived() const { return arrived_; }
  /// The arc that led to this node; null at the start.
  [[nodiscard]] const PlanArc* followed() const { return followed_ ? &graph_.arcs[*followed_] : nullptr; }
  [[nodiscard]] const PlanGraph& graph() const { return graph_; }

 private:
  PlanGraph graph_;
  std::optional<std::size_t> node_;
  std::optional<std::size_t> followed_;  ///< arc
  Time arrived_;
};

}  // namespace isobath
