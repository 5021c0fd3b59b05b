// Plans as graphs of actions and events, and the executor that steps through them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <isobath/mission/plan/plan_graph.hpp>
#include <limits>
#include <rapidcheck/gtest.h>
#include <tests/mission/agent_script.hpp>

namespace isobath::plan_graph_test {
namespace {

using testing::HasSubstr;

struct Facts : PlanDatabase {
  std::map<std::pair<std::string, int>, double> known;
  [[nodiscard]] std::optional<double> value(const std::string& quantity, std::optional<int> of) const override {
    const auto found = known.find({quantity, of.value_or(-1)});
    return found == known.end() ? std::nullopt : std::optional<double>(found->second);
  }
  void set(const std::string& quantity, double value, int of = -1) { known[{quantity, of}] = value; }
};

/// Two points, an end that both ways join, and a way out.
PlanGraph two_points() {
  PlanGraph graph{"two points"};
  const auto first = graph.add("point 1", {"go to", {{"point", 0.0}, {"task", "sample"}}});
  const auto second = graph.add("point 2", {"go to", {{"point", 1.0}}});
  const auto end = graph.add("end", {"hold"});
  const auto out = graph.add("aborted", {"surface"});
  for (const auto node : {first, second}) graph.join(node, PlanEvent::fact("aborted"), out);
  graph.join(first, PlanEvent::fact("point reached", 0), second);
  graph.join(first, PlanEvent::fact("point dropped", 0), second);
  graph.join(second, PlanEvent::fact("point reached", 1), end);
  graph.join(second, PlanEvent::timeout(60), end);
  return graph;
}

std::string refusal(const PlanGraph& graph) {
  try {
    check_plan_graph(graph);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

// ledger: S2-06
TEST(PlanGraph, RefusesWhatIsNoPlan) {
  EXPECT_EQ(refusal(two_points()), "");
  EXPECT_THAT(refusal(PlanGraph{"nothing"}), HasSubstr("without nodes"));

  PlanGraph lonely = two_points();
  lonely.add("island", {"hold"});
  EXPECT_THAT(refusal(lonely), HasSubstr("'island'"));

  PlanGraph no_event = two_points();
  no_event.join(0, PlanEvent{}, 1);
  EXPECT_THAT(refusal(no_event), HasSubstr("the arc from 'point 1' to 'point 2' has no event"));

  PlanGraph both = two_points();
  both.join(0, {PlanEvent::Test::kTimeout, "range", {}, 5}, 1);
  EXPECT_THAT(refusal(both), HasSubstr("waits for a time and for a quantity"));

  PlanGraph endless{"endless"};
  endless.add("a", {"hold"});
  endless.join(0, PlanEvent::timeout(1), 0);
  EXPECT_THAT(refusal(endless), HasSubstr("no end"));

  PlanGraph nowhere = two_points();
  nowhere.join(0, PlanEvent::timeout(1), 4);
  EXPECT_THAT(refusal(nowhere), HasSubstr("0 .. 3"));

  PlanGraph twice = two_points();
  twice.nodes[1].name = "point 1";
  EXPECT_THAT(refusal(twice), HasSubstr("taken"));

  PlanGraph idle = two_points();
  idle.nodes[2].action.name.clear();
  EXPECT_THAT(refusal(idle), HasSubstr("no action"));

  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double bad : {kInfinity, -kInfinity, std::numeric_limits<double>::quiet_NaN()}) {
    PlanGraph limit = two_points();
    limit.join(0, PlanEvent::below("range", bad), 1);
    EXPECT_NE(refusal(limit), "");
    PlanGraph parameter = two_points();
    parameter.nodes[0].action.parameters["depth"] = bad;
    EXPECT_THAT(refusal(parameter), HasSubstr("'depth'"));
  }
  for (const double bad : {-1.0, 1e12}) {
    PlanGraph timeout = two_points();
    timeout.join(0, PlanEvent::timeout(bad), 1);
    EXPECT_NE(refusal(timeout), "");
  }
  EXPECT_THROW(PlanExecutor{lonely}, Error);
  EXPECT_THROW(write_plan_graph(lonely), Error);
}

TEST(PlanGraph, ParametersAreNumbersOrTexts) {
  const PlanAction action = two_points().nodes[0].action;
  EXPECT_EQ(action.number("point"), 0.0);
  EXPECT_EQ(std::get<std::string>(action.parameters.at("task")), "sample");
  EXPECT_EQ(action.number("task"), std::nullopt);
  EXPECT_EQ(action.number("depth"), std::nullopt);
}

TEST(PlanGraph, EventsReadAsPeopleSayThem) {
  EXPECT_EQ(to_text(PlanEvent::below("range", 10)), "range below 10");
  EXPECT_EQ(to_text(PlanEvent::above("depth", 2.5, 3)), "depth (3) above 2.5");
  EXPECT_EQ(to_text(PlanEvent::fact("point reached", 0)), "point reached (0)");
  EXPECT_EQ(to_text(PlanEvent::timeout(60)), "timeout 60 s");
}

// ledger: S2-07
TEST(PlanExecutor, EventsLeadFromActionToAction) {
  Facts facts;
  PlanExecutor executor(two_points());
  EXPECT_FALSE(executor.started());
  EXPECT_EQ(executor.start(at(0)).number("point"), 0.0);
  EXPECT_EQ(executor.cycle(at(1), facts), nullptr);
  EXPECT_EQ(executor.followed(), nullptr);
  facts.set("point reached", 1, 0);
  const PlanAction* second = executor.cycle(at(2), facts);
  ASSERT_NE(second, nullptr);
  EXPECT_EQ(second->number("point"), 1.0);
  EXPECT_EQ(to_text(executor.followed()->event), "point reached (0)");
  EXPECT_EQ(executor.arrived(), at(2));
  EXPECT_EQ(executor.cycle(at(3), facts), nullptr);  // point 0 says nothing about point 1
  EXPECT_FALSE(executor.finished());
  EXPECT_EQ(executor.cycle(at(61.9), facts), nullptr);
  const PlanAction* end = executor.cycle(at(62), facts);  // 60 s after it arrived at this node, not at the first
  ASSERT_NE(end, nullptr);
  EXPECT_EQ(end->name, "hold");
  EXPECT_TRUE(executor.finished());
  EXPECT_EQ(executor.cycle(at(1000), facts), nullptr);
  EXPECT_EQ(executor.start(at(1001)).number("point"), 0.0);
  EXPECT_FALSE(executor.finished());
}

// ledger: S2-07
TEST(PlanExecutor, WhatWasTrueBeforeArrivalFiresInTheFirstCycleAndOneArcACycle) {
  Facts facts;
  facts.set("point reached", 1, 0);
  facts.set("point reached", 1, 1);
  PlanExecutor executor(two_points());
  executor.start(at(0));
  ASSERT_NE(executor.cycle(at(0), facts), nullptr);
  EXPECT_EQ(executor.node(), 1u);
  ASSERT_NE(executor.cycle(at(0), facts), nullptr);
  EXPECT_EQ(executor.node(), 2u);
}

// ledger: S2-07
TEST(PlanExecutor, OfSeveralTrueEventsTheFirstArcWins) {
  Facts facts;
  facts.set("point reached", 1, 0);
  facts.set("aborted", 1);
  PlanExecutor executor(two_points());
  executor.start(at(0));
  EXPECT_EQ(executor.cycle(at(0), facts)->name, "surface");
}

// ledger: S2-08
TEST(PlanExecutor, BranchesOnTheWorldAndOnItsOwnState) {
  PlanGraph graph{"watch"};
  const auto go = graph.add("go", {"go ahead"});
  const auto turn = graph.add("turn", {"turn away"});
  const auto home = graph.add("home", {"go home"});
  graph.join(go, PlanEvent::below("range", 10), turn);
  graph.join(go, PlanEvent::below("battery", 0.2), home);
  graph.join(turn, PlanEvent::above("range", 15), go);
  PlanExecutor executor(graph);
  executor.start(at(0));
  Facts facts;
  EXPECT_EQ(executor.cycle(at(0.6), facts), nullptr);  // what is not known is neither near nor far
  facts.set("range", std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(executor.cycle(at(0.6), facts), nullptr);
  facts.set("range", 10);
  facts.set("battery", 0.2);
  EXPECT_EQ(executor.cycle(at(0.6), facts), nullptr);
  facts.set("range", 9.99);
  EXPECT_EQ(executor.cycle(at(1.2), facts)->name, "turn away");
  facts.set("range", 15.01);
  EXPECT_EQ(executor.cycle(at(1.8), facts)->name, "go ahead");
  facts.set("battery", 0.19);
  EXPECT_EQ(executor.cycle(at(2.4), facts)->name, "go home");
}

int draw(int low, int high) { return *rc::gen::resize(100, rc::gen::inRange(low, high)); }

PlanEvent any_event() {
  const std::string quantity = "q" + std::to_string(draw(0, 3));
  const std::optional<int> of = draw(0, 2) == 0 ? std::nullopt : std::optional<int>(draw(0, 2));
  const double limit = draw(-50, 50) / 7.0;
  switch (draw(0, 4)) {
    case 0: return PlanEvent::fact(quantity, of);
    case 1: return PlanEvent::below(quantity, limit, of);
    case 2: return PlanEvent::above(quantity, limit, of);
    default: return PlanEvent::timeout(std::abs(limit));
  }
}

/// A chain that reaches every node and ends, and any arcs back and forth besides.
PlanGraph any_graph() {
  PlanGraph graph{"any \"graph\" \xC3\xA9"};
  const int nodes = draw(1, 8);
  for (int i = 0; i < nodes; ++i) {
    PlanAction action{"act"};
    if (draw(0, 2) == 1) action.parameters["x"] = draw(-1000, 1000) / 3.0;
    if (draw(0, 2) == 1) action.parameters["name"] = std::string("n\n") + std::to_string(i);
    graph.add("node " + std::to_string(i), action);
  }
  const int more = nodes > 1 ? draw(0, 12) : 0;
  for (int i = 0; i < more; ++i) {
    const int from = draw(0, nodes - 1);
    const int to = draw(0, nodes);
    graph.join(static_cast<std::size_t>(from), any_event(), static_cast<std::size_t>(to));
  }
  for (int i = 0; i + 1 < nodes; ++i) {
    graph.join(static_cast<std::size_t>(i), any_event(), static_cast<std::size_t>(i) + 1);
  }
  return graph;
}

// ledger: S2-06
RC_GTEST_PROP(PlanGraph, ReloadsEqual, ()) {
  const PlanGraph graph = any_graph();
  RC_ASSERT(read_plan_graph(write_plan_graph(graph), "plan.json") == graph);
}

/// The rule in other words: a table from node to its arcs, walked with plain numbers.
std::size_t next_by_table(const std::map<std::size_t, std::vector<PlanArc>>& table, std::size_t node, double waited_s,
                          const Facts& facts) {
  const auto arcs = table.find(node);
  if (arcs == table.end()) return node;
  for (const PlanArc& arc : arcs->second) {
    const auto known = facts.known.find({arc.event.quantity, arc.event.of.value_or(-1)});
    bool fires = arc.event.test == PlanEvent::Test::kTimeout && waited_s >= arc.event.limit;
    if (arc.event.test != PlanEvent::Test::kTimeout && known != facts.known.end()) {
      const double v = known->second;
      if (arc.event.test == PlanEvent::Test::kFact) fires = v < 0 || v > 0;
      if (arc.event.test == PlanEvent::Test::kBelow) fires = v < arc.event.limit;
      if (arc.event.test == PlanEvent::Test::kAbove) fires = arc.event.limit < v;
    }
    if (fires) return arc.to;
  }
  return node;
}

// ledger: S2-07 S2-08
RC_GTEST_PROP(PlanExecutor, FollowsItsTable, ()) {
  const PlanGraph graph = any_graph();
  std::map<std::size_t, std::vector<PlanArc>> table;
  for (const PlanArc& arc : graph.arcs) table[arc.from].push_back(arc);
  PlanExecutor executor(graph);
  executor.start(at(0));
  Facts facts;
  std::size_t node = 0;
  double arrived = 0;
  for (int step = 1; step < 40; ++step) {
    const std::string quantity = "q" + std::to_string(draw(0, 3));
    const int of = draw(-1, 2);
    facts.set(quantity, draw(-8, 8), of);
    const std::size_t expected = next_by_table(table, node, step - arrived, facts);
    const PlanAction* action = executor.cycle(at(step), facts);
    RC_ASSERT(executor.node() == expected);
    if (action != nullptr) {
      RC_ASSERT(*action == graph.nodes[expected].action);
      arrived = step;
    } else {
      RC_ASSERT(expected == node);
    }
    node = expected;
  }
}

std::string read_refusal(const std::string& text) {
  try {
    read_plan_graph(text, "plan.json");
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

/// A plan of one node with this list of arcs.
std::string with_arcs(const std::string& arcs) {
  return R"({"title": "t", "nodes": [{"name": "a", "action": "go"}, {"name": "b", "action": "hold"}], "arcs": [)" +
         arcs + "]}";
}

// A newer graph replaces what is not executed yet: the present action goes on, and is neither repeated nor skipped.
// ledger: S2-24
TEST(PlanExecutor, GoesOnWithItsActionInANewerGraph) {
  Facts facts;
  PlanExecutor executor(two_points());
  const PlanAction first = executor.start(at(0));
  PlanGraph newer{"newer"};
  const auto before = newer.add("before", {"hold"});
  const auto same = newer.add("the same", first);
  const auto after = newer.add("after", {"surface"});
  newer.join(before, PlanEvent::fact("never"), same);
  newer.join(same, PlanEvent::timeout(60), after);
  EXPECT_EQ(executor.update(newer, at(30)), nullptr);
  EXPECT_EQ(executor.node(), same);
  EXPECT_EQ(executor.arrived(), at(0)) << "it has been at it since then";
  EXPECT_EQ(executor.cycle(at(59), facts), nullptr);
  ASSERT_NE(executor.cycle(at(60), facts), nullptr);
  EXPECT_EQ(executor.node(), after);
  // It is at its end now, which is nothing to go on with; and a graph without the action begins.
  ASSERT_NE(executor.update(newer, at(61)), nullptr);
  EXPECT_EQ(executor.node(), before);
  PlanGraph other{"other"};
  other.add("elsewhere", {"return"});
  ASSERT_NE(executor.update(other, at(62)), nullptr);
  EXPECT_EQ(executor.arrived(), at(62));
  EXPECT_THROW(executor.update(PlanGraph{"no nodes"}, at(63)), Error);
  EXPECT_EQ(executor.graph(), other);
}

// ledger: S2-06
TEST(PlanGraphFile, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(read_refusal(with_arcs(R"({"from": "a", "to": "b", "event": {"fact": "done"}})")), "");
  EXPECT_THAT(read_refusal("{\"title\": "), HasSubstr("plan.json: byte 11: not JSON"));
  EXPECT_THAT(read_refusal("[]"), HasSubstr("not an object"));
  EXPECT_THAT(read_refusal(R"({"title": "t", "nodes": []})"), HasSubstr("arcs: missing"));
  EXPECT_THAT(read_refusal(R"({"title": "t", "nodes": [], "arcs": [], "arc": 1})"), HasSubstr("arc: unknown key"));
  EXPECT_THAT(read_refusal(R"({"title": 1, "nodes": [], "arcs": []})"), HasSubstr("title: not a text"));
  EXPECT_THAT(read_refusal(R"({"title": "t", "nodes": {}, "arcs": []})"), HasSubstr("nodes: not a list"));
  EXPECT_THAT(read_refusal(R"({"title": "t", "nodes": [3], "arcs": []})"), HasSubstr("nodes[0]: not an object"));
  EXPECT_THAT(read_refusal(R"({"title": "t", "nodes": [{"name": "a", "action": "go", "parameters": {"x": []}}],
                               "arcs": []})"),
              HasSubstr("nodes[0].parameters.x: neither number nor text"));
  EXPECT_THAT(read_refusal(R"({"title": "t", "nodes": [{"name": "a", "action": "go", "parameters": {"x": 1e999}}],
                               "arcs": []})"),
              HasSubstr("not JSON"));
  EXPECT_THAT(read_refusal(with_arcs("")), HasSubstr("no path leads"));
  EXPECT_THAT(read_refusal(with_arcs(R"({"from": "a", "to": "c", "event": {"fact": "done"}})")),
              HasSubstr("arcs[0].to: no node has this name: 'c'"));
  EXPECT_THAT(read_refusal(with_arcs(R"({"from": "a", "to": "b"})")), HasSubstr("arcs[0].event: missing"));
  for (const char* event : {"{}", R"({"fact": "a", "below": 1})", R"({"quantity": "a"})",
                            R"({"timeout_s": 1, "of": 1})", R"({"quantity": "a", "below": 1, "above": 2})",
                            R"({"fact": "a", "of": 1.5})", R"({"fact": "a", "of": 3000000000})",
                            R"({"fact": "", "of": 1})", R"({"timeout_s": -1})", R"({"timeout_s": "1"})"}) {
    EXPECT_NE(read_refusal(with_arcs(fmt::format(R"({{"from": "a", "to": "b", "event": {}}})", event))), "") << event;
  }
}

TEST(PlanGraphFile, ACutFileIsRefusedAtEveryByte) {
  const std::string text = write_plan_graph(two_points());
  for (std::size_t n = 0; n + 2 < text.size(); ++n) {
    EXPECT_NE(read_refusal(text.substr(0, n)), "") << n;
  }
}

TEST(PlanGraphFile, TextThatIsNoUtf8IsNotWritten) {
  PlanGraph graph = two_points();
  graph.title = "\xFF";
  EXPECT_THROW(write_plan_graph(graph), Error);
}

}  // namespace
}  // namespace isobath::plan_graph_test
