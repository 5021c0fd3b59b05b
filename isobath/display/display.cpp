#include <algorithm>
#include <cmath>
#include <isobath/display/decision_json.hpp>
#include <isobath/display/display.hpp>
#include <isobath/display/display_bytes.hpp>
#include <isobath/mission/messages/group_words.hpp>
#include <limits>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using nlohmann::ordered_json;

constexpr Duration kVehicleInterval = std::chrono::milliseconds(95);
constexpr Duration kPlaceInterval = std::chrono::milliseconds(950);
constexpr Duration kCountInterval = std::chrono::milliseconds(950);
constexpr std::uint64_t kPlacesAChunk = 64;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Rounded to a millimetre, finer than any picture.
ordered_json tidy_m(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(value * 1e3) / 1e3;
}

ordered_json point_json(const Eigen::Vector2d& p) { return ordered_json::array({tidy_m(p.x()), tidy_m(p.y())}); }

template <class Points>
ordered_json outline_json(const Points& points) {
  ordered_json outline = ordered_json::array();
  for (const Eigen::Vector2d& p : points) outline.push_back(point_json(p));
  return outline;
}

std::string display_text(const ordered_json& json) {
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

/// Greatest standard deviation of the position, north or east, m.
std::optional<double> deviation_of(const Navigation& fix) {
  if (!fix.covariance) return std::nullopt;
  return std::sqrt(std::max((*fix.covariance)(0, 0), (*fix.covariance)(1, 1)));
}

ordered_json mission_points(const MissionPlan& plan) {
  ordered_json points = ordered_json::array();
  const SearchArea& area = plan.search;
  for (std::size_t i = 0; i < plan.points.size(); ++i) {
    const MissionPoint& p = plan.points[i];
    ordered_json point{{"name", p.name}, {"at", point_json(p.north_east)}};
    // Lanes are sailed in the order of the Commodore.
    if (area.on() && (i >= area.all_stations() || i % area.stations() == 0)) point["apart"] = true;
    if (!p.task.empty()) point["task"] = p.task;
    if (p.speed > 0) point["speed"] = p.speed;
    if (p.altitude_m) {
      point["altitude_m"] = tidy_m(*p.altitude_m);
    } else {
      point["depth_m"] = tidy_m(p.depth_m);
    }
    points.push_back(std::move(point));
  }
  return points;
}

ordered_json timing_json(const char* name, const StageTime& t) {
  return {
      {"name", name}, {"median_ms", t.median_ms}, {"p99_ms", t.p99_ms}, {"worst_ms", t.worst_ms}, {"count", t.count}};
}

}  // namespace

DisplayCounts display_counts(const Pipeline& pipeline, const DepthModel& depths) {
  DisplayCounts counts{pipeline.counts(), pipeline.rejected(), {}, {}, 0};
  for (const EmergencyFlags* flags : {&pipeline.emergencies(), &depths.emergencies()}) {
    for (const Alarm& alarm : alarms_of(*flags)) {
      if (alarm.lasting || !alarm.acknowledged) counts.alarms.push_back(present_text(alarm));
    }
  }
  if (counts.pipeline.pings > 0) counts.undecided = pipeline.undecided();
  return counts;
}

void Display::show(Time time, const DisplayScene& scene) {
  if (!start_) start_ = time;
  ordered_json json{{"title", scene.title},
                    {"source", scene.source},
                    {"simulated", scene.simulated},
                    {"start_ns", std::to_string(start_->time_since_epoch().count())}};
  if (scene.origin) {
    json["origin"] = {{"latitude", scene.origin->latitude_deg}, {"longitude", scene.origin->longitude_deg}};
  }
  if (scene.plan) {
    if (!scene.plan->fence.empty()) json["fence"] = outline_json(scene.plan->fence);
    json["mission"] = mission_points(*scene.plan);
    json["mission_number"] = scene.mission;
    json["mission_speed"] = scene.plan->speed;
    if (scene.plan->group.size() > 1) {
      ordered_json names = ordered_json::array();
      for (const GroupMember& member : scene.plan->group) names.push_back(member.name);
      json["group"] = {{"vehicles", std::move(names)}, {"own", scene.plan->own}};
    }
  }
  if (!scene.charted.empty()) {
    json["charted"] = ordered_json::array();
    for (const ChartObstacle& o : scene.charted) {
      json["charted"].push_back({{"a", point_json(o.a)}, {"b", point_json(o.b)}, {"radius_m", tidy_m(o.radius_m)}});
    }
  }
  if (!scene.bodies.empty()) {
    json["bodies"] = ordered_json::array();
    for (const TrueBody& b : scene.bodies) {
      json["bodies"].push_back({{"name", b.name}, {"outline", outline_json(b.outline)}});
    }
  }
  json["vehicle"] = {
      {"length_m", scene.vehicle_length_m}, {"radius_m", scene.vehicle_radius_m}, {"safe_m", scene.safe_m}};
  if (!scene.depth_datum.empty()) json["depth_datum"] = scene.depth_datum;
  items_.set(DisplayKind::kScene, 0, time, display_text(json));
}

void Display::want(const Setpoint& wanted) {
  wanted_ = wanted;
  signals_.set(Signal::kSpeedSetpoint, wanted.speed);
  signals_.set(Signal::kDepthSetpoint, wanted.depth);
  signals_.set(Signal::kHeadingSetpoint, wanted.heading.wrapped_positive().degrees());
}

void Display::on_event(const Event& event) {
  if (!start_) start_ = time_of(event);
  if (const auto* health = std::get_if<Health>(&event)) {
    parts_[health->source] = *health;
    const auto least = std::ranges::min_element(parts_, {}, [](const auto& part) { return part.second.battery_share; });
    signals_.set(Signal::kBattery, 100 * least->second.battery_share);
  }
  if (const auto* range = std::get_if<RangeReading>(&event)) {
    const bool down = (range->X_BS.rotation * Eigen::Vector3d::UnitX()).z() > 0.9;
    if (down && range->range_m > 0) {
      altitude_m_ = *range->range_m;
      signals_.set(Signal::kAltitude, *range->range_m);
    }
  }
  const auto* fix = std::get_if<Navigation>(&event);
  if (!fix || !fix->X_WB.is_finite()) return;
  add_to_track(fix->time, fix->X_WB.translation);
  measure(*fix);
  if (!show_again(vehicle_shown_, fix->time, kVehicleInterval)) return;
  vehicle_shown_ = fix->time;
  show_vehicle(*fix);
}

void Display::measure(const Navigation& fix) {
  const Rotation& R_WB = fix.X_WB.rotation;
  signals_.set(Signal::kDepth, fix.X_WB.translation.z());
  signals_.set(Signal::kHeading, R_WB.heading().wrapped_positive().degrees());
  signals_.set(Signal::kRoll, R_WB.roll().degrees());
  signals_.set(Signal::kPitch, R_WB.pitch().degrees());
  signals_.set(Signal::kSpeed, fix.v_WB ? fix.v_WB->head<2>().norm() : kNaN);
  signals_.set(Signal::kDeviation, deviation_of(fix).value_or(kNaN));
  signals_.sample(fix.time, *start_);
}

void Display::show_vehicle(const Navigation& fix) {
  const Eigen::Vector3d& place = fix.X_WB.translation;
  const Rotation& R_WB = fix.X_WB.rotation;
  DisplayBytes bytes;
  for (const double metres : {place.x(), place.y(), place.z()}) bytes.add(metres);
  bytes.add_floats({R_WB.roll().radians(), R_WB.pitch().radians(), R_WB.heading().radians()});
  const Eigen::Vector3d v_B = fix.v_WB ? Eigen::Vector3d(R_WB.inverse() * *fix.v_WB) : Eigen::Vector3d::Constant(kNaN);
  bytes.add_floats({v_B.x(), v_B.y(), v_B.z()});
  bytes.add_floats({deviation_of(fix).value_or(0), altitude_m_.value_or(kNaN)});
  if (wanted_) {
    bytes.add_floats({wanted_->heading.radians(), wanted_->depth, wanted_->speed});
  } else {
    bytes.add_floats({kNaN, kNaN, kNaN});
  }
  items_.set(DisplayKind::kVehicle, 0, fix.time, bytes.add(0.0F).take());
}

void Display::add_to_track(Time time, const Eigen::Vector3d& place) {
  if (!show_again(last_place_, time, kPlaceInterval)) return;
  last_place_ = time;
  if (places_ % kPlacesAChunk == 0) chunk_.clear();
  DisplayBytes bytes;
  bytes.add_floats({to_seconds(time - *start_), place.x(), place.y(), place.z()});
  chunk_ += bytes.take();
  items_.set(DisplayKind::kTrack, places_ / kPlacesAChunk, time, chunk_);
  ++places_;
}

void Display::on_scan(const ScanResult& scan) {
  const Detection& found = scan.detection;
  if (!vehicle_shown_) show_vehicle({found.time, found.X_WB, {}, {}, {}});  // without navigation it stands still
  maps_.show(found.time, scan.grid, found.X_WB);
  if (!start_) start_ = found.time;
  obstacles_.update(scan, *start_);
  const auto nearest = std::ranges::min_element(found.obstacles, {}, &Obstacle::range_m);
  signals_.set(Signal::kNearestObstacle, nearest == found.obstacles.end() ? kNaN : nearest->range_m);
}

void Display::on_jump(const Eigen::Vector3d& /*by_W*/) { maps_.voxels_moved(vehicle_shown_.value_or(Time{})); }

/// Another vehicle of the group, as it tells where it is.
void Display::show_partner(Time time, const LinkFrame& frame) {
  const auto word = group_word_of(frame.bytes);
  const auto* status = word ? std::get_if<GroupStatus>(&*word) : nullptr;
  if (status == nullptr) return;
  ordered_json json{{"at", point_json(status->place_W)}, {"over", status->over}};
  if (status->lane) json["lane"] = *status->lane + 1;
  items_.set(DisplayKind::kPartner, status->from, time, display_text(json));
}

void Display::on_message(const Envelope& envelope) {
  const Time time = envelope.time;
  agents_.insert(envelope.sender);
  levels_.on_message(envelope);
  if (const auto* decision = std::get_if<Decision>(&envelope.message)) {
    std::optional<Eigen::Vector2d> then_W;
    if (decision->approach) {
      const Time then = decision->time + seconds(decision->approach->in_s);
      then_W = obstacles_.predicted(decision->obstacle_number, then);
    }
    items_.set(DisplayKind::kDecision, decision->number, time, decision_json(*decision, then_W));
  } else if (const auto* frame = std::get_if<LinkFrame>(&envelope.message)) {
    if (frame->way == LinkFrame::Way::kFromGroup) show_partner(time, *frame);
  } else if (const auto* route = std::get_if<RoutePlanned>(&envelope.message)) {
    way_ = *route;
    show_way(time);
  } else if (const auto* report = std::get_if<MissionReport>(&envelope.message)) {
    mission_ = *report;
    show_way(time);
  } else if (const auto* point = std::get_if<PointReport>(&envelope.message)) {
    mission_.update(*point);
    show_way(time);
  } else if (const auto* request = std::get_if<RouteRequest>(&envelope.message)) {
    target_ = request->point;
    show_way(time);
  } else if (const auto* scan = std::get_if<ObstacleScan>(&envelope.message)) {
    if (!start_) start_ = time;
    obstacles_.update(scan->known, time, *start_);
  } else if (const auto* fault = std::get_if<SafetyReport>(&envelope.message)) {
    if (fault->active) {
      ActiveFault& active = faults_.try_emplace(fault->fault, ActiveFault{time, {}, {}}).first->second;
      active.why = fault->why;
      if (fault->abort) active.action = std::string("abort, then ") + to_text(fault->end);
    } else {
      faults_.erase(fault->fault);
    }
    counted_.reset();  // a fault is shown at once
  } else if (const auto* action = std::get_if<SafetyAction>(&envelope.message)) {
    const auto active = faults_.find(action->fault);
    if (active != faults_.end()) active->second.action = to_text(action->kind);
  } else if (const auto* lost = std::get_if<AgentLost>(&envelope.message)) {
    agents_.insert(lost->agent);
    agents_lost_[lost->agent] = lost->why;
    counted_.reset();
  }
}

void Display::show_way(Time time) {
  ordered_json points = ordered_json::array();
  for (const Waypoint& p : way_.waypoints) {
    points.push_back(ordered_json::array({tidy_m(p.north), tidy_m(p.east), tidy_m(p.depth)}));
  }
  ordered_json way{{"version", way_.version},          {"points", points},
                   {"avoiding", way_.avoiding},        {"why", way_.why},
                   {"phase", to_text(mission_.phase)}, {"reached", mission_.reached},
                   {"dropped", mission_.dropped},      {"mission_why", mission_.why}};
  if (target_) way["target"] = *target_;
  items_.set(DisplayKind::kWay, 0, time, display_text(way));
}

void Display::look(Time time, const Pipeline& pipeline, const DepthModel& depths, const VoxelModel& voxels) {
  if (maps_.wants_depths(time)) {
    if (auto snapshot = depths.snapshot()) maps_.show(time, std::move(snapshot));
  }
  if (const VoxelMap* map = voxels.map()) maps_.show(time, *map);
  if (!wants_counts(time)) return;
  show(time, display_counts(pipeline, depths));
}

bool Display::wants_counts(Time time) const { return show_again(counted_, time, kCountInterval); }

void Display::show(Time time, const DisplayCounts& counts) {
  counted_ = time;
  const PipelineCounts& n = counts.pipeline;
  const std::uint64_t pings = n.pings + n.vertical;
  if (pings_ && time > pings_->first)
    signals_.set(Signal::kPings, static_cast<double>(pings - pings_->second) / to_seconds(time - pings_->first));
  pings_.emplace(time, pings);
  ordered_json json{{"counts",
                     {{"pings", n.pings},
                      {"upright pings", n.vertical},
                      {"scans", n.scans},
                      {"echoes", n.hits},
                      {"bins", n.bins},
                      {"fixes", n.navigation},
                      {"ranges", n.ranges},
                      {"swaths", n.swaths},
                      {"pings without a place", n.unposed},
                      {"pings lost before the map", counts.lost_pings}}},
                    {"refused", ordered_json::object()},
                    {"alarms", counts.alarms},
                    {"faults", ordered_json::array()},
                    {"agents", ordered_json::array()},
                    {"parts", ordered_json::array()}};
  if (counts.left_out) {
    json["counts"]["pings and scans not shown"] = counts.left_out->pings;
    json["counts"]["events and messages not shown"] = counts.left_out->notes;
  }
  for (const auto& [reason, count] : counts.refused) json["refused"][reason] = count;
  if (!counts.undecided.empty()) json["undecided"] = counts.undecided;
  for (const auto& [name, fault] : faults_) {
    json["faults"].push_back({{"fault", name},
                              {"why", fault.why},
                              {"action", fault.action},
                              {"active", true},
                              {"since_s", start_ ? std::round(10 * to_seconds(fault.since - *start_)) / 10 : 0}});
  }
  for (const std::string& name : agents_) {
    const auto lost = agents_lost_.find(name);
    ordered_json agent{{"name", name}, {"state", lost == agents_lost_.end() ? "ok" : "lost"}};
    if (lost != agents_lost_.end()) agent["why"] = lost->second;
    json["agents"].push_back(std::move(agent));
  }
  for (const auto& [name, health] : parts_) {
    json["parts"].push_back({{"name", name},
                             {"state", to_text(health.state)},
                             {"battery_share", std::round(1e3 * health.battery_share) / 1e3},
                             {"leak", health.leak},
                             {"note", health.note}});
  }
  items_.set(DisplayKind::kHealth, 0, time, display_text(json));
}

void Display::show(Time time, std::span<const Contact> contacts) {
  ordered_json sounds = ordered_json::array();
  for (const Contact& c : contacts) {
    ordered_json sound{{"number", c.number},
                       {"frequency_hz", tidy_m(c.frequency_hz)},
                       {"bearing_deg", tidy_m(c.bearing.degrees())},
                       {"sigma_deg", tidy_m(c.sigma.degrees())},
                       {"from", point_json(c.p_W)},
                       {"origin", to_text(c.origin)}};
    if (c.origin == Contact::Origin::kObstacle) {
      sound["obstacle"] = c.obstacle;
      sound["probability"] = tidy_m(c.probability);
      sound["to"] = point_json(c.nearest);
    } else {
      if (c.origin == Contact::Origin::kNone) sound["probability"] = tidy_m(c.none);
      if (c.place) sound["to"] = point_json(c.place->mean);
    }
    sounds.push_back(std::move(sound));
  }
  items_.set(DisplayKind::kSounds, 0, time, display_text(sounds));
}

void Display::show(Time time, const MissionTimings& t) {
  const ordered_json json = {timing_json("agents: handling of an event", t.event_to_agents),
                             timing_json("mapping: a ping into the grid", t.ping_to_grid),
                             timing_json("detection: obstacles of a scan", t.detection),
                             timing_json("planning: the Navigator's turn", t.planning),
                             timing_json("scan to decision", t.scan_to_decision)};
  items_.set(DisplayKind::kTimes, 0, time, display_text(json));
}

}  // namespace isobath
