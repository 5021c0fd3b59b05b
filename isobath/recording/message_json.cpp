#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/map/occupancy/whole_obstacle.hpp>
#include <isobath/recording/exact_json.hpp>
#include <isobath/recording/message_json.hpp>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using Content = nlohmann::ordered_json;

Content pose_content(const Pose& X) {
  const Eigen::Quaterniond& q = X.rotation.quaternion();
  return {{"place", components_of<3>(X.translation)},
          {"rotation_wxyz", {exact_enough(q.w()), exact_enough(q.x()), exact_enough(q.y()), exact_enough(q.z())}}};
}
Content waypoints_content(const std::vector<Waypoint>& waypoints) {
  Content list = Content::array();
  for (const Waypoint& w : waypoints) {
    list.push_back({{"north", exact_enough(w.north)},
                    {"east", exact_enough(w.east)},
                    {"depth", exact_enough(w.depth)},
                    {"speed", exact_enough(w.speed)}});
  }
  return list;
}
Content setpoint_content(const Setpoint& s) {
  return {{"heading", exact_enough(s.heading)},
          {"depth", exact_enough(s.depth)},
          {"speed", exact_enough(s.speed)},
          {"sway_speed", exact_enough(s.sway_speed)}};
}
Content point_content(const MissionPoint& p) {
  return {{"name", p.name},
          {"north_east", components_of<2>(p.north_east)},
          {"depth", exact_enough(p.depth_m)},
          {"altitude", exact_enough(p.altitude_m)}};
}
Content plan_content(const std::shared_ptr<const MissionPlan>& plan) {
  if (!plan) return nullptr;
  return {{"title", plan->title}, {"points", plan->points.size()}};
}

// One function per message type; a type without one does not compile.

Content content_of(const Navigation& m) {
  Content content{{"pose", pose_content(m.X_WB)}};
  if (m.v_WB) content["velocity"] = components_of<3>(*m.v_WB);
  return content;
}
Content content_of(const RangeReading& m) {
  return {{"range", exact_enough(m.range_m)}, {"max_range", exact_enough(m.max_range_m)}};
}
Content content_of(const Health& m) {
  return {{"source", m.source},
          {"state", to_text(m.state)},
          {"battery", exact_enough(m.battery_share)},
          {"leak", m.leak},
          {"note", m.note}};
}
Content content_of(const SonarHealthSample& m) {
  return {{"sonar", m.sonar},
          {"digest", fmt::format("{:016x}", m.digest)},
          {"mean", exact_enough(m.mean)},
          {"full_scale", exact_enough(m.full_scale)},
          {"silent", exact_enough(m.silent)}};
}
Content content_of(const SonarEchoes& m) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& p : m.echoes_L) nearest = std::min(nearest, p.norm());
  return {{"echoes", m.echoes_L.size()}, {"nearest", exact_enough(nearest)}};
}
Content content_of(const Sweep& m) {
  return {{"number", m.number},
          {"posed", m.posed},
          {"sigma", exact_enough(m.sigma_m)},
          {"obstacles", m.map ? whole_obstacles(m.map->obstacles).size() : 0},
          {"obstacle_pieces", m.map ? m.map->obstacles.size() : 0},
          {"cells", m.map ? m.map->cells.size() : 0}};
}
Content content_of(const ObstacleScan& m) {
  return {{"number", m.number}, {"posed", m.posed}, {"hazards", m.hazards.size()}};
}
Content content_of(const ChartedHazards& m) {
  Content content{{"hazards", m.hazards ? m.hazards->size() : 0}};
  if (m.looked_ahead) content["looked_ahead_ns"] = m.looked_ahead->time_since_epoch().count();
  return content;
}
Content content_of(const GroupHazards& m) { return {{"hazards", m.hazards.size()}}; }
Content content_of(const PlanStep& m) {
  Content content{{"node", m.node}, {"text", text_of_step(m)}};
  if (m.other_graph && m.graph) content["graph"] = Content::parse(write_plan_graph(*m.graph));
  return content;
}
Content content_of(const PassageWait& m) { return {{"waits", m.waits}, {"why", m.why}}; }
Content content_of(const GroupObstacles& m) {
  Content all = Content::array();
  for (const ToldObstacle& o : m.obstacles) {
    all.push_back({{"vehicle", o.teller},
                   {"key", o.key},
                   {"north_east", components_of<2>(o.centre_W)},
                   {"radius", exact_enough(o.radius_m)},
                   {"sigma", exact_enough(o.sigma_m)}});
  }
  return {{"obstacles", std::move(all)}};
}
Content content_of(const LevelPlan& m) {
  return {{"of_level", to_text(m.level)}, {"horizon_s", exact_enough(m.horizon_s)}, {"changed", m.changed}};
}
Content content_of(const SonarOrder& m) {
  Content content{{"as_configured", !m.scan}};
  if (!m.scan) return content;
  if (m.scan->sector) content["sector"] = exact_enough(*m.scan->sector);
  if (m.scan->middle) content["middle"] = exact_enough(*m.scan->middle);
  if (m.scan->range_m) content["range"] = exact_enough(*m.scan->range_m);
  return content;
}
Content content_of(const OperatorCommand& m) {
  static constexpr const char* kNames[] = {"start",       "abort",       "hold",   "resume",   "beat",
                                           "acknowledge", "new mission", "return", "hand over"};
  Content content{{"command", kNames[static_cast<std::size_t>(m.kind)]}, {"plan", plan_content(m.plan)}};
  if (!m.by.empty()) content["by"] = m.by;
  return content;
}
Content content_of(const MissionOrder& m) {
  Content content{{"order", to_text(m.kind)}, {"plan", plan_content(m.plan)}, {"end", to_text(m.end)}, {"why", m.why}};
  if (m.replaces) content["replaces"] = true;
  return content;
}
Content content_of(const VisitOrder& m) {
  return {{"version", m.version}, {"points", m.points}, {"last", m.last}, {"given_up", m.given_up}, {"why", m.why}};
}
Content content_of(const PointMoved& m) { return {{"point", m.point}, {"north_east", components_of<2>(m.north_east)}}; }
Content content_of(const RouteRequest& m) {
  Content content{{"id", m.id}, {"point", m.point}, {"target", point_content(m.target)}, {"last", m.last}};
  if (m.then_W) content["then"] = components_of<2>(*m.then_W);
  return content;
}
Content content_of(const RoutePlanned& m) {
  Content content{{"request", m.request},
                  {"version", m.version},
                  {"waypoints", waypoints_content(m.waypoints)},
                  {"avoiding", m.avoiding},
                  {"why", m.why}};
  if (m.then_W) content["then"] = components_of<2>(*m.then_W);
  return content;
}
Content content_of(const RouteRefused& m) {
  Content content{{"reason", to_text(m.reason)}, {"request", m.request}, {"point", m.point}, {"why", m.why}};
  if (m.safe_nearby) content["safe_nearby"] = components_of<2>(*m.safe_nearby);
  return content;
}
Content content_of(const PointReport& m) {
  static constexpr const char* kNames[] = {"reached", "dropped", "taken", "avoiding", "task", "told"};
  Content content{{"report", kNames[static_cast<std::size_t>(m.kind)]}, {"point", m.point}, {"why", m.why}};
  if (m.no_way) content["no_way"] = true;
  return content;
}
Content content_of(const MissionReport& m) {
  return {{"phase", to_text(m.phase)}, {"reached", m.reached}, {"dropped", m.dropped}, {"why", m.why}};
}
Content content_of(const FollowOrder& m) {
  Content content{{"version", m.version},
                  {"waypoints", waypoints_content(m.waypoints)},
                  {"altitude", exact_enough(m.altitude_m)},
                  {"surface", m.surface}};
  if (m.then_W) content["then"] = components_of<2>(*m.then_W);
  return content;
}
Content content_of(const WaypointPassed& m) {
  return {{"version", m.version}, {"index", m.index}, {"reached", m.reached}, {"last", m.last}};
}
Content content_of(const StillHazards& m) { return {{"hazards", m.hazards ? m.hazards->size() : 0}}; }
Content content_of(const MotionOrder& m) {
  return {{"version", m.version},
          {"waypoint", m.waypoint},
          {"place", components_of<2>(m.place_W)},
          {"velocity", components_of<2>(m.velocity_W)},
          {"at_ns", m.at.time_since_epoch().count()}};
}
Content content_of(const HelmOrder& m) { return {{"setpoint", setpoint_content(m.setpoint)}}; }
Content content_of(const SafetyAction& m) {
  return {{"action", to_text(m.kind)}, {"setpoint", setpoint_content(m.setpoint)}, {"fault", m.fault}, {"why", m.why}};
}
Content content_of(const SafetyReport& m) {
  return {{"fault", m.fault}, {"active", m.active}, {"abort", m.abort}, {"end", to_text(m.end)}, {"why", m.why}};
}
Content content_of(const AgentLost& m) { return {{"agent", m.agent}, {"hung", m.hung}, {"why", m.why}}; }
Content content_of(const StatusReport& m) {
  return {{"phase", to_text(m.phase)}, {"point", m.point}, {"points", m.points}, {"text", m.text}};
}
Content content_of(const TaskCall& m) { return {{"id", m.id}, {"task", m.task}, {"at", point_content(m.at)}}; }
Content content_of(const TaskBid& m) {
  return {{"id", m.id}, {"driver", m.driver}, {"suitability", exact_enough(m.suitability)}};
}
Content content_of(const TaskAward& m) { return {{"id", m.id}, {"driver", m.driver}}; }
Content content_of(const TaskPlan& m) {
  return {{"id", m.id}, {"driver", m.driver}, {"waypoints", waypoints_content(m.waypoints)}};
}
Content content_of(const Decision& m) {
  Content content{{"number", m.number}, {"agent", m.agent}, {"what", m.what}, {"reason", m.reason}};
  if (m.obstacle_number > 0) content["obstacle_number"] = m.obstacle_number;
  if (m.obstacle) content["obstacle"] = components_of<2>(*m.obstacle);
  if (m.leg) content["leg"] = *m.leg;
  if (m.margin_m) content["margin"] = exact_enough(*m.margin_m);
  if (m.approach) {
    content["approach"] = {{"in_s", exact_enough(m.approach->in_s)}, {"gap_m", exact_enough(m.approach->gap_m)}};
  }
  if (!m.way.empty()) content["way"] = m.way.size();
  return content;
}
Content content_of(const WorldSnapshot& m) {
  Content content{{"objects", m.objects ? m.objects->size() : 0}};
  content["depths"] = m.depths != nullptr;
  if (m.voxels) {
    const VoxelIndex& size = m.voxels->size();
    content["voxels"] = {{"voxel", exact_enough(m.voxels->voxel_m())}, {"size", {size.x(), size.y(), size.z()}}};
  }
  if (m.looked_ahead) content["looked_ahead_ns"] = m.looked_ahead->time_since_epoch().count();
  return content;
}
Content content_of(const LinkFrame& m) {
  static constexpr const char* kWays[] = {"to operator", "from operator", "to group", "from group"};
  return {{"way", kWays[static_cast<std::size_t>(m.way)]}, {"bytes", fmt::format("{:02x}", fmt::join(m.bytes, ""))}};
}

}  // namespace

std::string message_json(const Envelope& envelope) {
  Content json{{"number", envelope.number},
               {"time_ns", envelope.time.time_since_epoch().count()},
               {"sender", envelope.sender},
               {"type", message_name(envelope.message)},
               {"content", std::visit([](const auto& message) { return content_of(message); }, envelope.message)}};
  if (envelope.link) {
    json["level"] = to_text(envelope.link->level);
    json["parent"] = envelope.link->parent;
  }
  return json.dump(-1, ' ', false, Content::error_handler_t::replace);
}

std::string servo_json(Time time, std::uint64_t parent, const ActuatorVector& commands) {
  Content values = Content::array();
  for (const double value : commands) values.push_back(exact_enough(value));
  return Content{{"time_ns", time.time_since_epoch().count()},
                 {"level", to_text(CommandLevel::kServo)},
                 {"parent", parent},
                 {"commands", values}}
      .dump();
}

const char* servo_schema() {
  return R"({"title": "isobath.Servo", "type": "object", "properties": {"time_ns": {"type": "integer"},
"level": {"type": "string"}, "parent": {"type": "integer"}, "commands": {"type": "array", "items": {"type": "number"}}},
"required": ["time_ns", "level", "parent", "commands"]})";
}

const char* message_schema() {
  return R"({"title": "isobath.Message", "type": "object", "properties": {"number": {"type": "integer"},
"time_ns": {"type": "integer"}, "sender": {"type": "string"}, "type": {"type": "string"},
"content": {"type": "object"}, "level": {"type": "string"}, "parent": {"type": "integer"}}, "required": ["number", "time_ns", "sender", "type", "content"]})";
}

}  // namespace isobath
