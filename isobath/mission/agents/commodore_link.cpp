// What the Commodore says to the other vehicles of the group, and what it makes of what they say.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/geometry/segment.hpp>
#include <isobath/map/occupancy/obstacle_outline.hpp>
#include <isobath/mission/agents/commodore.hpp>

namespace isobath {

using Eigen::Vector2d;

namespace {

constexpr std::size_t kNobodyLeads = 255;
constexpr std::ptrdiff_t kMostStations = 255;
constexpr double kNearLane_m = 25;     // an obstacle that is nearer to a lane matters to the vehicle that sails it
constexpr double kMostRadius_m = 15;   // a circle about a longer obstacle would shut too much water
constexpr double kNearVehicle_m = 10;  // from where a vehicle was last heard, or is
constexpr double kRounding_m = 0.36;   // of a place on the link

std::int64_t whole_second(Time time) {
  return std::chrono::floor<std::chrono::seconds>(time.time_since_epoch()).count();
}

/// The time nearest to `now` whose whole second has these lower bits.
Time second_near(Time now, std::uint16_t bits) {
  const auto apart = static_cast<std::int16_t>(static_cast<std::uint16_t>(bits - whole_second(now)));
  return Time(std::chrono::seconds(whole_second(now) + apart));
}

}  // namespace

void Commodore::on(const ObstacleScan& scan) {
  if (!scan.known || members_.size() < 2) return;
  std::map<std::uint32_t, Sighting> now;
  for (const RememberedObstacle& o : scan.known->obstacles) {
    const Circle circle = circle_of(o.outline_W);
    if (o.told || circle.radius > kMostRadius_m) continue;
    const auto before = sightings_.find(o.id);
    const bool moved = before == sightings_.end() || (before->second.centre_W - circle.centre).norm() > kMoved_m;
    now[o.id] = moved ? Sighting{circle.centre, circle.radius, 0} : before->second;
  }
  sightings_ = std::move(now);
}

std::vector<ObstacleWord> Commodore::obstacles_to_tell() {
  // A vehicle of the group that waits looks like an obstacle.
  const auto is_vehicle = [&](const Sighting& seen) {
    for (std::size_t v = 0; v < members_.size(); ++v) {
      const Member& member = members_[v];
      const bool heard = v != own_ && !member.lost && member.status.lanes > 0;
      if (heard && (member.status.place_W - seen.centre_W).norm() <= kNearVehicle_m + seen.radius_m) return true;
    }
    return false;
  };
  const auto matters = [&](const Sighting& seen) {
    for (std::size_t k = 0; k < lanes_.size(); ++k) {
      if (is_done(k) || lane_ == k) continue;
      const Vector2d nearest = nearest_on_segment(lanes_[k].from_W, lanes_[k].to_W, seen.centre_W);
      if ((nearest - seen.centre_W).norm() <= kNearLane_m + seen.radius_m) return true;
    }
    return false;
  };
  std::vector<std::pair<std::uint32_t, Sighting*>> open;
  for (auto& [id, seen] : sightings_) {
    if (seen.tellings < kTellings && matters(seen) && !is_vehicle(seen)) open.emplace_back(id, &seen);
  }
  std::ranges::stable_sort(open, {}, [](const auto& one) { return one.second->tellings; });
  std::vector<ObstacleWord> words;
  for (const auto& [id, seen] : open) {
    if (words.size() == static_cast<std::size_t>(config_.told_obstacles)) break;
    ++seen->tellings;
    words.push_back({static_cast<std::uint8_t>(id), seen->centre_W, seen->radius_m + kRounding_m, sigma_m_});
  }
  return words;
}

void Commodore::on_frame(const LinkFrame& frame, Time now, Outbox& out) {
  const auto word = group_word_of(frame.bytes);
  if (!word) return;
  std::visit(
      [&](const auto& known) {
        if (known.from < members_.size() && known.from != own_) on(known, now, out);
      },
      *word);
}

/// What another vehicle has visited of the lane that it is sailing.
void Commodore::note_stations(const GroupStatus& status) {
  if (!status.lane || *status.lane >= lanes_.size()) return;
  const std::size_t count = std::min<std::size_t>(status.stations, stations_);
  const std::size_t first = *status.lane * stations_ + (status.backwards ? stations_ - count : 0);
  std::fill_n(visited_.begin() + static_cast<std::ptrdiff_t>(first), count, 1);
  if (count == stations_) done_ |= LaneBits{1} << *status.lane;
}

/// The same of the own lane.
void Commodore::state_stations(GroupStatus& status) const {
  if (!lane_) return;
  const auto first = visited_.begin() + static_cast<std::ptrdiff_t>(*lane_ * stations_);
  const auto last = first + static_cast<std::ptrdiff_t>(stations_);
  status.backwards = *first == 0;
  const auto count = status.backwards ? std::find(std::reverse_iterator(last), std::reverse_iterator(first), 0) -
                                            std::reverse_iterator(last)
                                      : std::find(first, last, 0) - first;
  status.stations = static_cast<std::uint8_t>(std::min(count, kMostStations));
}

void Commodore::note_heard(std::size_t vehicle, Time now, Outbox& out) {
  Member& member = members_[vehicle];
  member.heard = now;
  if (!member.lost) return;
  member.lost = false;
  replanned_.reset();
  decide(now, "heard again", name_of_vehicle(vehicle) + " is heard again", out);
}

void Commodore::on(const GroupStatus& status, Time now, Outbox& out) {
  Member& member = members_[status.from];
  const bool first = member.status.number == 0 && member.status.lanes == 0;
  if (status.lanes != lanes_.size()) return;  // another mission
  if (!first && !newer(status.number, member.status.number)) return;
  note_heard(status.from, now, out);
  const bool asks_anew = status.ask && (!member.status.ask || member.status.ask->passage != status.ask->passage ||
                                        member.status.ask->number != status.ask->number);
  if (asks_anew) member.asked = now;
  member.status = status;
  if (status.from == gate_keeper()) hear_turns(status, now, out);
  if (status.begin_s && !begin_at_) begin_at_ = second_near(now, *status.begin_s);
  GroupObstacles told;
  for (const ObstacleWord& o : status.obstacles) {
    // This vehicle itself, as the other one saw it.
    if ((o.centre_W - here_W_).norm() <= kNearVehicle_m + o.radius_m) continue;
    told.obstacles.push_back({status.from, o.key, o.centre_W, o.radius_m, o.sigma_m});
  }
  if (!told.obstacles.empty()) out.say(std::move(told));
  const bool was_done = all_done();
  done_ |= status.done;
  note_stations(status);
  if (!was_done && all_done()) return order("all lanes are done", now, out);
  const auto lane = lane_of(status.from);
  const auto is_of_lane = [&](std::size_t point) { return point / stations_ == *lane; };
  if (lane && lane != lane_ && std::ranges::any_of(visits_, is_of_lane)) {
    order(fmt::format("{} sails lane {}", name_of_vehicle(status.from), *lane + 1), now, out);
  }
}

void Commodore::on(const GroupPlan& plan, Time now, Outbox& out) {
  if (plan.owner.size() != lanes_.size()) return;
  note_heard(plan.from, now, out);
  done_ |= plan.done;
  const auto leads = leader();
  if (leads && plan.from > *leads) return;  // a vehicle before it leads
  const bool known = shared_ && shared_->from == plan.from && !newer(plan.version, shared_->version);
  if (!known) take(plan, fmt::format("{} shares the lanes anew", name_of_vehicle(plan.from)), now, out);
}

/// Waits for the others at its waiting place, until the agreed time.
void Commodore::meet(Time now, Outbox& out) {
  if (!meets_) return;
  if (begin_at_ && now >= *begin_at_) return begin_lanes("begin together", "as agreed", now, out);
  if (!begin_at_ && to_seconds(now - started_) >= plan_->search.together_s) {
    std::string missing;
    for (std::size_t v = 0; v < members_.size(); ++v) {
      if (v != own_ && !members_[v].status.ready) missing += (missing.empty() ? "" : ", ") + name_of_vehicle(v);
    }
    return begin_lanes("begin alone",
                       fmt::format("after {:.0f} s {} did not say to be ready", plan_->search.together_s,
                                   missing.empty() ? "the leader" : missing),
                       now, out);
  }
  if (begin_at_ || !ready_ || leader() != own_) return;
  for (std::size_t v = 0; v < members_.size(); ++v) {
    if (v != own_ && sails(v) && !members_[v].status.ready) return;
  }
  begin_at_ = std::chrono::ceil<std::chrono::seconds>(now + seconds(kAhead_turns * turn_s()));
}

void Commodore::begin_lanes(const char* what, const std::string& why, Time now, Outbox& out) {
  meets_ = false;
  decide(now, what, why, out);
  order(what, now, out);
}

void Commodore::send(Time now, Outbox& out) {
  if (members_.size() < 2) return;
  const double today_s = to_seconds(now.time_since_epoch()) / turn_s();
  const auto turn =
      static_cast<std::int64_t>(std::floor(today_s - static_cast<double>(own_) / static_cast<double>(members_.size())));
  if (sent_in_ == turn) return;
  const bool first = !sent_in_;
  sent_in_ = turn;
  if (first) return;  // the slot may be almost over
  const auto unknown_to = [&](std::size_t v) {
    const GroupStatus& heard = members_[v].status;
    return v != own_ && sails(v) && (heard.leader.value_or(kNobodyLeads) != own_ || heard.version != shared_->version);
  };
  bool news = false;
  for (std::size_t v = 0; v < members_.size() && shared_; ++v) news = news || unknown_to(v);
  if (news && leader() == own_ && shared_->from == own_ && shared_->version > 1 && turn % 2 == 0) {
    GroupPlan plan = *shared_;
    plan.done = done_;
    out.say(LinkFrame{LinkFrame::Way::kToGroup, to_bytes(plan)});
    return;
  }
  GroupStatus status;
  status.from = static_cast<std::uint8_t>(own_);
  status.number = ++number_;
  status.place_W = here_W_;
  if (lane_) status.lane = static_cast<std::uint8_t>(*lane_);
  state_stations(status);
  if (shared_) status.leader = shared_->from;
  status.version = shared_ ? shared_->version : 0;
  status.over = over_;
  status.ready = ready_;
  status.no_way = no_way_;
  status.ask = passages_.ask();
  for (const auto& [passage, given] : turns_) status.turns.push_back(given);
  if (begin_at_) status.begin_s = static_cast<std::uint16_t>(whole_second(*begin_at_));
  status.lanes = static_cast<std::uint8_t>(lanes_.size());
  status.done = done_;
  status.obstacles = obstacles_to_tell();
  out.say(LinkFrame{LinkFrame::Way::kToGroup, to_bytes(status)});
}

}  // namespace isobath
