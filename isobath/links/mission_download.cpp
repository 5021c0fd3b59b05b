#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/links/mission_download.hpp>
#include <nlohmann/json.hpp>
#include <utility>

namespace isobath {
namespace {

using mavlink::MissionItem;
using mavlink::MissionKind;
using PlanJson = nlohmann::ordered_json;

constexpr Duration kPatience = std::chrono::milliseconds(700);
constexpr double kDegree = 1e-7;

// MAV_CMD of fence and rally points.
enum FenceCommand : std::uint16_t { kPolygonIn = 5001, kPolygonOut = 5002, kCircleIn = 5003, kCircleOut = 5004 };

const char* text_of_kind(MissionKind kind) {
  switch (kind) {
    case MissionKind::kMission: return "mission";
    case MissionKind::kFence: return "fence";
    case MissionKind::kRally: return "rally points";
  }
  return "list";
}

PlanJson number_or_null(double value) { return std::isfinite(value) ? PlanJson(value) : PlanJson(); }

PlanJson item_json(const MissionItem& item) {
  return {{"type", "SimpleItem"},
          {"command", item.command},
          {"frame", item.frame},
          {"autoContinue", item.goes_on != 0},
          {"doJumpId", item.sequence},
          {"params",
           {number_or_null(item.params[0]), number_or_null(item.params[1]), number_or_null(item.params[2]),
            number_or_null(item.params[3]), item.x * kDegree, item.y * kDegree, number_or_null(item.z)}}};
}

PlanJson fence_json(const std::vector<MissionItem>& items) {
  PlanJson polygons = PlanJson::array(), circles = PlanJson::array();
  for (std::size_t i = 0; i < items.size();) {
    const MissionItem& item = items[i];
    const bool inside = item.command == kPolygonIn || item.command == kCircleIn;
    if (item.command == kPolygonIn || item.command == kPolygonOut) {
      const float stated = item.params[0];  // untrusted, may be no number
      const auto corners = stated >= 1 ? static_cast<std::size_t>(std::min(stated, 1e4F)) : std::size_t{1};
      PlanJson path = PlanJson::array();
      for (; path.size() < corners && i < items.size() && items[i].command == item.command; ++i) {
        path.push_back({items[i].x * kDegree, items[i].y * kDegree});
      }
      polygons.push_back({{"version", 1}, {"inclusion", inside}, {"polygon", path}});
      continue;
    }
    if (item.command == kCircleIn || item.command == kCircleOut) {
      circles.push_back({{"version", 1},
                         {"inclusion", inside},
                         {"circle", {{"center", {item.x * kDegree, item.y * kDegree}}, {"radius", item.params[0]}}}});
    }
    ++i;
  }
  return {{"version", 2}, {"polygons", polygons}, {"circles", circles}};
}

}  // namespace

std::string qground_text(const AutopilotPlan& plan) {
  PlanJson items = PlanJson::array(), rally = PlanJson::array(), home;
  for (const MissionItem& item : plan.mission) {
    if (item.sequence == 0) {
      home = {item.x * kDegree, item.y * kDegree, number_or_null(item.z)};
    } else {
      items.push_back(item_json(item));
    }
  }
  for (const MissionItem& item : plan.rally)
    rally.push_back({item.x * kDegree, item.y * kDegree, number_or_null(item.z)});
  const PlanJson root{
      {"fileType", "Plan"},
      {"groundStation", "an autopilot, by the mission protocol"},
      {"version", 1},
      {"mission", {{"version", 2}, {"firmwareType", 3}, {"plannedHomePosition", home}, {"items", items}}},
      {"geoFence", fence_json(plan.fence)},
      {"rallyPoints", {{"version", 2}, {"points", rally}}}};
  return root.dump(2) + "\n";
}

MissionDownload::MissionDownload(std::uint8_t system, std::uint8_t component, Send send)
    : system_(system), component_(component), send_(std::move(send)) {}

std::vector<MissionItem>& MissionDownload::items() {
  if (kind_ == MissionKind::kFence) return plan_.fence;
  return kind_ == MissionKind::kRally ? plan_.rally : plan_.mission;
}

void MissionDownload::on_frame(const MavlinkFrame& frame, Time now) {
  if (done_ || !problem_.empty() || frame.system != system_) return;
  const MavlinkPayload p(frame.payload);
  if (frame.id == mavlink::MissionCount::kId && !count_) {
    const auto answer = mavlink::MissionCount::of(p);
    if (answer.kind != kind_) return;
    if (answer.count > kMostItems) {
      problem_ = fmt::format("the {} of the autopilot has {} items, more than {}", text_of_kind(kind_), answer.count,
                             kMostItems);
      return;
    }
    count_ = answer.count;
    tries_ = 0;
    if (answer.count == 0) return next_list(now);
    ask(now);
  } else if (frame.id == mavlink::MissionItem::kId && count_) {
    const auto item = mavlink::MissionItem::of(p);
    if (item.kind != kind_ || item.sequence != items().size()) return;  // a repeated answer
    items().push_back(item);
    tries_ = 0;
    if (items().size() == *count_) return next_list(now);
    ask(now);
  } else if (frame.id == mavlink::MissionAck::kId && !count_) {
    const auto ack = mavlink::MissionAck::of(p);
    if (ack.kind == kind_ && ack.result != 0) next_list(now);  // an autopilot without this list
  }
}

void MissionDownload::next_list(Time now) {
  send_(mavlink::MissionAck::kId, mavlink::MissionAck{system_, component_, 0, kind_}.body());
  count_.reset();
  tries_ = 0;
  if (kind_ == MissionKind::kRally) {
    done_ = true;
    return;
  }
  kind_ = kind_ == MissionKind::kMission ? MissionKind::kFence : MissionKind::kRally;
  ask(now);
}

void MissionDownload::ask(Time now) {
  asked_ = now;
  ++tries_;
  if (!count_) {
    send_(mavlink::MissionRequestList::kId, mavlink::MissionRequestList{system_, component_, kind_}.body());
  } else {
    const auto next = static_cast<std::uint16_t>(items().size());
    send_(mavlink::MissionRequest::kId, mavlink::MissionRequest{next, system_, component_, kind_}.body());
  }
}

void MissionDownload::on_tick(Time now) {
  if (done_ || !problem_.empty() || now - asked_ < kPatience) return;
  if (tries_ >= kMostTries) {
    problem_ = fmt::format("the autopilot does not answer a request for its {}", text_of_kind(kind_));
    return;
  }
  ask(now);
}

}  // namespace isobath
