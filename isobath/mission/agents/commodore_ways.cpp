// What the Commodore does about passages, which the vehicles go through in turn, and about lanes to which there is no
// way.
#include <algorithm>
#include <fmt/format.h>
#include <isobath/mission/agents/commodore.hpp>

namespace isobath {

using Eigen::Vector2d;

namespace {

constexpr double kAskAhead_turns = 4;  // of the link, before a passage: the ask and its answer may be lost once each

}  // namespace

/// The way that is ahead, or would be.
void Commodore::note_way(const Message& message, Time now) {
  const auto places_of = [](const std::vector<Waypoint>& waypoints) {
    std::vector<Vector2d> places_W;
    for (const Waypoint& w : waypoints) places_W.emplace_back(w.north, w.east);
    return places_W;
  };
  if (const auto* route = std::get_if<RoutePlanned>(&message)) passages_.offer_way(places_of(route->waypoints));
  if (const auto* follow = std::get_if<FollowOrder>(&message)) {
    passages_.set_way(places_of(follow->waypoints), now);
    follow_version_ = follow->version;
    passed_ = 0;
  }
  const auto* passed = std::get_if<WaypointPassed>(&message);
  if (passed == nullptr || passed->version != follow_version_ || passed->index < passed_) return;
  passages_.pass(passed->index + 1 - passed_);
  passed_ = passed->index + 1;
}

const std::optional<PassageAsk>& Commodore::ask_of(std::size_t vehicle) const {
  return vehicle == own_ ? passages_.ask() : members_[vehicle].status.ask;
}

/// Asks for the passage that is next on the way, and gives it back.
void Commodore::pass(Time now, Outbox& out) {
  if (members_.size() < 2 || plan_->passages.empty()) return;
  const auto before = passages_.ask();
  passages_.move(here_W_, plan_->speed * kAskAhead_turns * turn_s() + PassageTurns::kWait_m, now);
  const auto& ask = passages_.ask();
  if (ask && (!before || before->number != ask->number)) asked_ = now;
  const auto name_of = [this](const PassageAsk& of) { return plan_->passages[of.passage].name; };
  if (before && before->passing && !ask) decide(now, "leave passage", name_of(*before) + " is free again", out);
  if (before && !before->passing && !ask) {
    decide(now, "passage blocked",
           fmt::format("no turn in {} within {:.0f} s: it counts as blocked", name_of(*before), config_.passage_wait_s),
           out);
  }
  if (!told_wait_ && passages_.waits()) {
    told_wait_ = true;
    std::string why = "it is not this vehicle's turn in " + name_of(*ask) + " yet";
    decide(now, "wait for passage", why, out);
    out.say(PassageWait{true, std::move(why)});
  }
  end_wait("its way leads elsewhere", out);
  give_turns(now, out);
}

/// Who gives the turns: the first vehicle that is heard, also when its mission is over.
std::size_t Commodore::gate_keeper() const {
  std::size_t v = 0;
  while (v != own_ && members_[v].lost) ++v;
  return v;
}

/// As gate keeper: the vehicle that asked first, and of several at one time the first in the list, has the next turn.
void Commodore::give_turns(Time now, Outbox& out) {
  if (gate_keeper() != own_) return turns_.clear();
  const auto asks_for = [&](std::size_t v, std::size_t passage) {
    const auto& ask = ask_of(v);
    if (!ask || ask->passage != passage) return false;
    if (v == own_ || !members_[v].lost) return true;
    // One that is heard no more may be in the passage: only its link may have failed.
    const auto turn = turns_.find(passage);
    const bool may_pass = ask->passing || (turn != turns_.end() && turn->second.vehicle == v);
    return may_pass && to_seconds(now - members_[v].heard) < config_.passage_wait_s / 2;
  };
  for (std::size_t k = 0; k < plan_->passages.size(); ++k) {
    const auto turn = turns_.find(k);
    const bool goes_on = turn != turns_.end() && asks_for(turn->second.vehicle, k) &&
                         ask_of(turn->second.vehicle)->number == turn->second.number;
    if (goes_on) continue;
    turns_.erase(k);
    std::optional<std::size_t> next;
    const auto rank = [this](std::size_t v) {  // one that is inside comes before all others
      return std::pair(!ask_of(v)->passing, v == own_ ? asked_ : members_[v].asked);
    };
    for (std::size_t v = 0; v < members_.size(); ++v) {
      if (asks_for(v, k) && (!next || rank(v) < rank(*next))) next = v;
    }
    if (!next) continue;
    turns_[k] = {static_cast<std::uint8_t>(k), static_cast<std::uint8_t>(*next), ask_of(*next)->number};
    if (*next == own_) take_turn(now, out);
  }
}

void Commodore::take_turn(Time now, Outbox& out) {
  if (!passages_.ask() || passages_.ask()->passing) return;
  passages_.take_turn(now);
  std::string why = "it is this vehicle's turn in " + plan_->passages[passages_.ask()->passage].name;
  decide(now, "take passage", why, out);
  end_wait(why, out);
}

void Commodore::end_wait(const std::string& why, Outbox& out) {
  if (!told_wait_ || passages_.waits()) return;
  told_wait_ = false;
  out.say(PassageWait{false, why});
}

void Commodore::hear_turns(const GroupStatus& status, Time now, Outbox& out) {
  const auto& ask = passages_.ask();
  for (const PassageTurn& turn : status.turns) {
    if (ask && turn == PassageTurn{ask->passage, static_cast<std::uint8_t>(own_), ask->number}) take_turn(now, out);
  }
}

bool Commodore::takes_lanes(std::size_t vehicle) const {
  return sails(vehicle) && !(vehicle == own_ ? no_way_ : members_[vehicle].status.no_way);
}

void Commodore::note_no_way(std::size_t point, Time now, Outbox& out) {
  without_way_.insert(point);
  if (++points_without_way_ >= kNoWayPoints) give_up_lane(now, out);
}

void Commodore::give_up_lane(Time now, Outbox& out) {
  const std::size_t lane = *lane_;
  lane_.reset();
  points_without_way_ = 0;
  given_up_ |= LaneBits{1} << lane;
  decide(now, "give up lane", fmt::format("{} stations in a row of lane {} have no way", kNoWayPoints, lane + 1), out);
  if (++lanes_without_way_ >= kNoWayLanes) {
    no_way_ = true;
    replanned_.reset();
    decide(now, "give up lanes", fmt::format("{} lanes in a row have no way; the others may try the rest", kNoWayLanes),
           out);
  }
  order("there is no way", now, out);
}

/// Tells the Captain, once no vehicle finds a way any more.
void Commodore::give_up_if_all_do(Time now, Outbox& out) {
  if (!no_way_ || told_given_up_ || all_done()) return;
  for (std::size_t v = 0; v < members_.size(); ++v) {
    if (takes_lanes(v)) return;
  }
  told_given_up_ = true;
  std::string why = "no vehicle of the group finds a way to the lanes that are left";
  decide(now, "give up area", why, out);
  out.say(VisitOrder{++orders_, {}, false, std::move(why), true});
}

}  // namespace isobath
