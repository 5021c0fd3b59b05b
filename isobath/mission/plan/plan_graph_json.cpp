// The file form of a plan graph:
//
//   {"title": "two points",
//    "nodes": [{"name": "point 1", "action": "go to", "parameters": {"point": 0.0}}, {"name": "end", "action":
//    "hold"}], "arcs": [{"from": "point 1", "to": "end", "event": {"fact": "point reached", "of": 0}},
//             {"from": "point 1", "to": "end", "event": {"quantity": "battery", "below": 0.2}},
//             {"from": "point 1", "to": "end", "event": {"timeout_s": 60.0}}]}
#include <algorithm>
#include <fmt/format.h>
#include <isobath/mission/plan/plan_graph.hpp>
#include <nlohmann/json.hpp>
#include <set>

namespace isobath {
namespace {

using Json = nlohmann::ordered_json;

Json json(const PlanAction& action) {
  Json parameters = Json::object();
  for (const auto& parameter : action.parameters) {
    if (const double* number = std::get_if<double>(&parameter.second)) parameters[parameter.first] = *number;
    if (const auto* text = std::get_if<std::string>(&parameter.second)) parameters[parameter.first] = *text;
  }
  return parameters;
}

Json json(const PlanEvent& event) {
  Json j = Json::object();
  switch (event.test) {
    case PlanEvent::Test::kTimeout: return {{"timeout_s", event.limit}};
    case PlanEvent::Test::kFact: j["fact"] = event.quantity; break;
    case PlanEvent::Test::kBelow: j = {{"quantity", event.quantity}, {"below", event.limit}}; break;
    case PlanEvent::Test::kAbove: j = {{"quantity", event.quantity}, {"above", event.limit}}; break;
  }
  if (event.of) j["of"] = *event.of;
  return j;
}

/// One object of the file; reads its members by name, strictly.
class Reader {
 public:
  Reader(const Json& object, std::string file, std::string key)
      : object_(object), file_(std::move(file)), key_(std::move(key)) {
    if (!object.is_object()) fail(key_, "not an object", "{...}");
  }

  [[noreturn]] void fail(const std::string& key, const std::string& problem, const std::string& allowed) const {
    throw Error(problem, {file_, {}, {}, {}, key}, allowed);
  }
  void only(const std::set<std::string>& names) const {
    for (const auto& item : object_.items()) {
      if (!names.contains(item.key()))
        fail(inside(item.key()), "unknown key", fmt::format("{}", fmt::join(names, ", ")));
    }
  }
  [[nodiscard]] bool has(const char* name) const { return object_.contains(name); }
  [[nodiscard]] std::string text(const char* name) const {
    const Json& j = member(name, "a text");
    return j.is_string() ? j.get<std::string>() : (fail(inside(name), "not a text", "a text"), "");
  }
  [[nodiscard]] double number(const char* name) const {
    const Json& j = member(name, "a number");
    if (!j.is_number()) fail(inside(name), "not a number", "a number");
    return j.get<double>();
  }
  [[nodiscard]] int whole(const char* name) const {
    const Json& j = member(name, "a whole number");
    const double value = j.is_number_integer() ? j.get<double>() : 0.5;
    if (value != static_cast<double>(static_cast<std::int32_t>(std::clamp(value, -2e9, 2e9)))) {
      fail(inside(name), "not a whole number", "-2e9 .. 2e9");
    }
    return static_cast<int>(value);
  }
  [[nodiscard]] Reader object(const char* name) const { return {member(name, "{...}"), file_, inside(name)}; }
  [[nodiscard]] std::vector<Reader> list(const char* name) const {
    const Json& j = member(name, "[...]");
    if (!j.is_array()) fail(inside(name), "not a list", "[...]");
    std::vector<Reader> all;
    for (std::size_t i = 0; i < j.size(); ++i) all.emplace_back(j[i], file_, fmt::format("{}[{}]", inside(name), i));
    return all;
  }
  [[nodiscard]] const std::string& key() const { return key_; }
  [[nodiscard]] const Json& json() const { return object_; }
  [[nodiscard]] std::string inside(const std::string& name) const { return key_.empty() ? name : key_ + "." + name; }

 private:
  const Json& member(const char* name, const char* allowed) const {
    const auto found = object_.find(name);
    if (found == object_.end()) fail(inside(name), "missing", allowed);
    return *found;
  }

  const Json& object_;
  std::string file_;
  std::string key_;
};

PlanEvent event_of(const Reader& r) {
  r.only({"fact", "quantity", "below", "above", "of", "timeout_s"});
  const bool of = r.has("of");
  const std::size_t size = r.json().size();
  PlanEvent event;
  if (r.has("timeout_s") && size == 1) return PlanEvent::timeout(r.number("timeout_s"));
  if (r.has("fact") && size == (of ? 2U : 1U)) {
    event = PlanEvent::fact(r.text("fact"));
  } else if (r.has("quantity") && r.has("below") && size == (of ? 3U : 2U)) {
    event = PlanEvent::below(r.text("quantity"), r.number("below"));
  } else if (r.has("quantity") && r.has("above") && size == (of ? 3U : 2U)) {
    event = PlanEvent::above(r.text("quantity"), r.number("above"));
  } else {
    r.fail(r.key(), "not one event", "fact [of], quantity below [of], quantity above [of], or timeout_s");
  }
  if (of) event.of = r.whole("of");
  return event;
}

PlanAction action_of(const Reader& node) {
  PlanAction action{node.text("action")};
  if (!node.has("parameters")) return action;
  const Reader parameters = node.object("parameters");
  for (const auto& item : parameters.json().items()) {
    if (item.value().is_number()) {
      action.parameters[item.key()] = item.value().get<double>();
    } else if (item.value().is_string()) {
      action.parameters[item.key()] = item.value().get<std::string>();
    } else {
      parameters.fail(parameters.inside(item.key()), "neither number nor text", "a number or a text");
    }
  }
  return action;
}

Json parse(std::string_view text, const std::string& file) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& e) {
    throw Error("not JSON", {file, e.byte, {}, {}, ""}, "", e.what());
  } catch (const Json::exception& e) {  // a number out of range
    throw Error("not JSON", {file, {}, {}, {}, ""}, "", e.what());
  }
}

}  // namespace

std::string write_plan_graph(const PlanGraph& graph) {
  check_plan_graph(graph);
  Json nodes = Json::array();
  for (const PlanNode& node : graph.nodes) {
    nodes.push_back({{"name", node.name}, {"action", node.action.name}, {"parameters", json(node.action)}});
  }
  Json arcs = Json::array();
  for (const PlanArc& arc : graph.arcs) {
    arcs.push_back(
        {{"from", graph.nodes[arc.from].name}, {"to", graph.nodes[arc.to].name}, {"event", json(arc.event)}});
  }
  const Json all = {{"title", graph.title}, {"nodes", std::move(nodes)}, {"arcs", std::move(arcs)}};
  try {
    return all.dump(1) + "\n";
  } catch (const Json::exception& e) {
    throw Error("a text of the plan graph is not UTF-8", {}, "UTF-8", e.what());
  }
}

PlanGraph read_plan_graph(std::string_view text, const std::string& file) {
  const Json all = parse(text, file);
  const Reader top(all, file, "");
  top.only({"title", "nodes", "arcs"});
  PlanGraph graph{top.text("title")};
  std::map<std::string, std::size_t> index;
  for (const Reader& node : top.list("nodes")) {
    node.only({"name", "action", "parameters"});
    const std::string name = node.text("name");
    index[name] = graph.add(name, action_of(node));
  }
  const auto node_of = [&](const Reader& arc, const char* end) {
    const auto found = index.find(arc.text(end));
    if (found == index.end())
      arc.fail(arc.inside(end), "no node has this name: '" + arc.text(end) + "'", "the name of a node");
    return found->second;
  };
  for (const Reader& arc : top.list("arcs")) {
    arc.only({"from", "to", "event"});
    graph.join(node_of(arc, "from"), event_of(arc.object("event")), node_of(arc, "to"));
  }
  try {
    check_plan_graph(graph);
  } catch (const Error& e) {
    throw Error(e.what(), {file, {}, {}, {}, ""});
  }
  return graph;
}

}  // namespace isobath
