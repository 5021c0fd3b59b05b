#include <algorithm>
#include <bit>
#include <fmt/format.h>
#include <isobath/mission/agents/commodore.hpp>
#include <numeric>

namespace isobath {

using Eigen::Vector2d;

namespace {

LaneBits bit_of(std::size_t lane) { return LaneBits{1} << lane; }

/// "lanes 3 to 5, 8", counted from 1.
std::string text_of_lanes(std::vector<std::size_t> lanes) {
  if (lanes.empty()) return "no lane";
  std::ranges::sort(lanes);
  std::string text;
  for (std::size_t i = 0; i < lanes.size();) {
    std::size_t j = i;
    while (j + 1 < lanes.size() && lanes[j + 1] == lanes[j] + 1) ++j;
    text += text.empty() ? "" : ", ";
    text += j > i ? fmt::format("{} to {}", lanes[i] + 1, lanes[j] + 1) : fmt::format("{}", lanes[i] + 1);
    i = j + 1;
  }
  return (lanes.size() > 1 ? "lanes " : "lane ") + text;
}

/// The lanes of a vehicle in the order of a plan, without those that are done.
std::vector<std::size_t> lanes_of_vehicle(const GroupPlan& plan, std::size_t vehicle, LaneBits done) {
  std::vector<std::size_t> lanes;
  for (std::size_t k = 0; k < plan.owner.size(); ++k) {
    if (plan.owner[k] && *plan.owner[k] == vehicle && (done & bit_of(k)) == 0) lanes.push_back(k);
  }
  if (!plan.ascending) std::ranges::reverse(lanes);
  return lanes;
}

/// Enters the lanes of these vehicles, in the order of the shares, into a plan.
void enter(const LaneShares& shares, const std::vector<std::size_t>& vehicles, GroupPlan& plan) {
  plan.ascending = shares.ascending;
  for (std::size_t i = 0; i < vehicles.size(); ++i) {
    for (const std::size_t k : shares.lanes[i]) plan.owner[k] = static_cast<std::uint8_t>(vehicles[i]);
  }
}

}  // namespace

std::vector<Field> fields(CommodoreConfig& c) {
  return {Field::real("slot_s", &c.slot_s, {0.1, 600}, "s", "Time in which one vehicle may send a packet."),
          Field::integer("lost_turns", &c.lost_turns, {1, 1000}, "1",
                         "A vehicle that is not heard for so many turns of all vehicles counts as lost."),
          Field::real("replan_s", &c.replan_s, {0.1, 3600}, "s", "Time between two divisions of the lanes."),
          Field::real("turn_s", &c.turn_s, {0, 600}, "s", "Time that a turn into the next lane is taken to cost."),
          Field::integer("told_obstacles", &c.told_obstacles, {0, static_cast<int>(kMostTold)}, "1",
                         "How many obstacles a packet tells of, at most."),
          Field::real("passage_wait_s", &c.passage_wait_s, {0, 86400}, "s",
                      "A vehicle that waits longer for its turn in a passage takes the passage for blocked.")};
}

void Commodore::on_message(const Message& message, Time now, Outbox& out) {
  if (const auto* fix = std::get_if<Navigation>(&message)) {
    here_W_ = fix->X_WB.translation.head<2>();
    sigma_m_ = sigma_m_of(*fix).value_or(sigma_m_);
  }
  if (const auto* order = std::get_if<MissionOrder>(&message)) {
    if (order->kind == MissionOrder::Kind::kStart) begin(*order, now, out);
  }
  if (!plan_) return;
  if (const auto* report = std::get_if<PointReport>(&message)) on(*report, now, out);
  if (const auto* scan = std::get_if<ObstacleScan>(&message)) on(*scan);
  note_way(message, now);
  if (const auto* report = std::get_if<MissionReport>(&message)) {
    over_ = report->phase == MissionPhase::kFinished || report->phase == MissionPhase::kAborted;
  }
  if (const auto* frame = std::get_if<LinkFrame>(&message)) {
    if (frame->way == LinkFrame::Way::kFromGroup) on_frame(*frame, now, out);
  }
}

void Commodore::begin(const MissionOrder& order, Time now, Outbox& out) {
  const bool shares = order.plan && order.plan->search.on() && order.plan->own < order.plan->group.size();
  plan_ = shares ? order.plan : nullptr;
  if (!shares) return;
  lanes_ = lanes_of(plan_->search);
  stations_ = plan_->search.stations();
  own_ = plan_->own;
  members_.assign(plan_->group.size(), Member{now, {}, false, now});
  for (std::size_t i = 0; i < members_.size(); ++i) members_[i].status.place_W = plan_->group[i].start;
  if (members_.size() == 1) members_[0].status.place_W = here_W_;
  done_ = 0;
  lane_.reset();
  visits_.clear();
  hazards_.clear();
  sightings_.clear();
  visited_.assign(lanes_.size() * stations_, 0);
  over_ = told_done_ = plan_last_ = at_waiting_place_ = false;
  replanned_ = started_ = now;
  meets_ = plan_->search.together_s > 0 && members_.size() > 1 && plan_->points.size() > plan_->search.all_stations();
  ready_ = false;
  begin_at_.reset();
  passages_ = PassageTurns(
      members_.size() > 1 ? std::span<const GroupPassage>(plan_->passages) : std::span<const GroupPassage>(),
      config_.passage_wait_s);
  turns_.clear();
  told_wait_ = false;
  without_way_.clear();
  given_up_ = 0;
  points_without_way_ = lanes_without_way_ = 0;
  no_way_ = told_given_up_ = false;
  // All vehicles make the same first plan.
  std::vector<std::size_t> open(lanes_.size()), vehicles(members_.size());
  std::iota(open.begin(), open.end(), std::size_t{0});
  std::iota(vehicles.begin(), vehicles.end(), std::size_t{0});
  std::vector<LaneSailor> sailors;
  for (const Member& member : members_) sailors.push_back({member.status.place_W, 0});
  GroupPlan first{0, 1, true, 0, {}};
  first.owner.resize(lanes_.size());
  enter(share_lanes(lanes_, open, sailors, {plan_->speed, config_.turn_s}), vehicles, first);
  take(first, "the first plan, which all vehicles make alike", now, out);
}

void Commodore::on(const PointReport& report, Time now, Outbox& out) {
  const bool visited = report.kind == PointReport::Kind::kReached || report.kind == PointReport::Kind::kDropped;
  if (!visited || std::erase(visits_, report.point) == 0) return;
  if (meets_) {
    ready_ = at_waiting_place_ = true;
    return;
  }
  at_waiting_place_ = report.point >= visited_.size();
  if (at_waiting_place_) return;
  lane_ = report.point / stations_;
  if (report.no_way) {
    note_no_way(report.point, now, out);
    if (!lane_) return;
  } else {
    points_without_way_ = 0;
    if (report.kind == PointReport::Kind::kReached) lanes_without_way_ = 0;
    note_station(report.point);
  }
  const bool goes_on = std::ranges::any_of(visits_, [this](std::size_t point) { return point / stations_ == *lane_; });
  if (goes_on) return;
  done_ |= bit_of(*lane_);
  lane_.reset();
  if (all_done()) order("all lanes are done", now, out);
}

void Commodore::note_station(std::size_t point) {
  visited_[point] = 1;
  // A run-out matters only to the vehicle that turns on it.
  const std::size_t station = point % stations_;
  if (station > 0 && plan_->search.is_run_out(station - 1)) visited_[point - 1] = 1;
  if (station + 1 < stations_ && plan_->search.is_run_out(station + 1)) visited_[point + 1] = 1;
}

/// Whether the vehicle has to visit a point: no vehicle has visited it, or none has sailed from it to the next one.
bool Commodore::is_left(std::size_t point) const {
  if (visited_[point] == 0) return true;
  const std::size_t station = point % stations_;
  return (station > 0 && visited_[point - 1] == 0) || (station + 1 < stations_ && visited_[point + 1] == 0);
}

bool Commodore::sails(std::size_t vehicle) const {
  return vehicle == own_ ? !over_ : !members_[vehicle].lost && !members_[vehicle].status.over;
}

std::optional<std::size_t> Commodore::leader() const {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    if (sails(i)) return i;
  }
  return std::nullopt;
}

/// The lane that a vehicle is sailing.
std::optional<std::size_t> Commodore::lane_of(std::size_t vehicle) const {
  const auto lane = vehicle == own_ ? lane_ : std::optional<std::size_t>(members_[vehicle].status.lane);
  return lane && *lane < lanes_.size() ? lane : std::nullopt;
}

/// Where a vehicle will begin its next lane, and when: at the end of the lane that it is sailing, which is taken to be
/// the farther one.
LaneSailor Commodore::sailor_of(std::size_t vehicle) const {
  const Vector2d place_W = vehicle == own_ ? here_W_ : members_[vehicle].status.place_W;
  const auto lane = lane_of(vehicle);
  if (!lane) return {place_W, 0};
  const Lane& sailed = lanes_[*lane];
  const double to_first_m = (sailed.from_W - place_W).norm(), to_second_m = (sailed.to_W - place_W).norm();
  return to_first_m > to_second_m ? LaneSailor{sailed.from_W, to_first_m / plan_->speed}
                                  : LaneSailor{sailed.to_W, to_second_m / plan_->speed};
}

/// How long the own lanes take.
double Commodore::rest_s() const {
  if (!shared_ || over_) return 0;
  std::vector<std::size_t> lanes = lanes_of_vehicle(*shared_, own_, done_);
  if (lane_) std::erase(lanes, *lane_);
  const LaneSailor sailor = sailor_of(own_);
  return lanes.empty() ? sailor.ready_s : sailing_s(lanes_, lanes, sailor, {plan_->speed, config_.turn_s});
}

void Commodore::lead(Time now, Outbox& out) {
  if (leader() != own_ || all_done() || (replanned_ && to_seconds(now - *replanned_) < config_.replan_s)) return;
  replanned_ = now;
  const SailingRules rules{plan_->speed, config_.turn_s};
  std::vector<std::size_t> vehicles;
  std::vector<LaneSailor> sailors;
  LaneBits taken = done_;
  GroupPlan next{static_cast<std::uint8_t>(own_), 1, true, done_, {}};
  next.owner.resize(lanes_.size());
  for (std::size_t v = 0; v < members_.size(); ++v) {
    if (!takes_lanes(v)) continue;
    vehicles.push_back(v);
    sailors.push_back(sailor_of(v));
    const auto lane = lane_of(v);
    if (!lane) continue;
    taken |= bit_of(*lane);
    next.owner[*lane] = static_cast<std::uint8_t>(v);
  }
  if (vehicles.empty()) return plans_.note(now, 0, false, out);
  std::vector<std::size_t> open;
  for (std::size_t k = 0; k < lanes_.size(); ++k) {
    if ((taken & bit_of(k)) == 0) open.push_back(k);
  }
  // How long the vehicles take for the plan in force, and which lanes it gives to vehicles that can sail.
  double present_s = 0;
  LaneBits given = taken;
  for (std::size_t i = 0; i < vehicles.size() && shared_; ++i) {
    const std::vector<std::size_t> mine = lanes_of_vehicle(*shared_, vehicles[i], taken);
    for (const std::size_t k : mine) given |= bit_of(k);
    present_s = std::max(present_s, sailing_s(lanes_, mine, sailors[i], rules));
  }
  const bool somebody_is_missing = !shared_ || std::popcount(given) < static_cast<int>(lanes_.size());
  const LaneShares shares = share_lanes(lanes_, open, sailors, rules);
  const bool better = shares.last_s < (1 - kGain) * present_s - kGain_s;
  if (!somebody_is_missing && !better) return plans_.note(now, rest_s(), false, out);
  enter(shares, vehicles, next);
  if (shared_) next.version = static_cast<std::uint16_t>(shared_->version + 1);
  take(next,
       somebody_is_missing
           ? std::string("lanes of a vehicle that does not sail them go to the others")
           : fmt::format("the last vehicle is done in {:.0f} s instead of {:.0f} s", shares.last_s, present_s),
       now, out);
}

void Commodore::take(const GroupPlan& plan, const std::string& why, Time now, Outbox& out) {
  shared_ = plan;
  std::string text = why + ": ";
  for (std::size_t v = 0; v < members_.size(); ++v) {
    text +=
        fmt::format("{}{} {}", v > 0 ? "; " : "", name_of_vehicle(v), text_of_lanes(lanes_of_vehicle(plan, v, done_)));
  }
  decide(now, "share lanes", text, out);
  order(why, now, out);
  plans_.note(now, rest_s(), true, out);
}

/// Two vehicles may follow two plans for a while: the lane is that of the one that began it.
bool Commodore::is_sailed_by_another(std::size_t lane) const {
  for (std::size_t v = 0; v < members_.size(); ++v) {
    if (v != own_ && sails(v) && lane_of(v) == lane && lane_ != lane) return true;
  }
  return false;
}

/// The own points of the plan, from where the vehicle is.
void Commodore::order(const std::string& why, Time now, Outbox& out) {
  if (!shared_ || over_ || told_given_up_) return;
  std::vector<std::size_t> mine = lanes_of_vehicle(*shared_, own_, done_);
  std::erase_if(mine, [this](std::size_t lane) { return no_way_ || (given_up_ & bit_of(lane)) != 0; });
  // What it could not reach of its lanes stays undone, as stations do that an obstacle blocks.
  if (mine.empty() && !lane_ && !no_way_) done_ |= std::exchange(given_up_, 0);
  const bool last = all_done();
  std::erase_if(mine, [this](std::size_t lane) { return is_sailed_by_another(lane); });
  std::vector<std::size_t> points;
  Vector2d from_W = here_W_;
  if (lane_) {  // it sails this lane to its end
    std::erase(mine, *lane_);
    std::ranges::copy_if(visits_, std::back_inserter(points),
                         [this](std::size_t point) { return point / stations_ == *lane_; });
    from_W = plan_->points[points.back()].north_east;
  }
  const std::vector<LaneVisit> lanes = visits_of(lanes_, mine, from_W);
  const std::vector<std::size_t> rest = stations_of(lanes, plan_->search);
  std::ranges::copy_if(rest, std::back_inserter(points), [this](std::size_t point) { return is_left(point); });
  std::erase_if(points, [this](std::size_t point) { return without_way_.contains(point); });
  if (meets_ && !points.empty()) {
    const auto place = waiting_place(plan_->points[points.front()].north_east);
    points.clear();
    if (place && !ready_) points.push_back(*place);
  }
  const bool stays = points.empty() && at_waiting_place_;
  const auto waiting = waiting_place(points.empty() ? here_W_ : plan_->points[points.back()].north_east);
  if (waiting && !last && !stays && !meets_) points.push_back(*waiting);
  if (points == visits_ && last == plan_last_ && orders_ > 0) return;
  visits_ = points;
  plan_last_ = last;
  out.say(
      VisitOrder{++orders_, points, last, fmt::format("{}: {}", why, last ? "the mission ends" : text_of_lanes(mine))});
  if (last && !told_done_) {
    told_done_ = true;
    decide(now, "area searched", fmt::format("all {} lanes are done", lanes_.size()), out);
  }
}

/// The nearer one of the own waiting places, if the mission has some.
std::optional<std::size_t> Commodore::waiting_place(const Vector2d& from_W) const {
  const std::size_t first = visited_.size() + 2 * own_;
  if (first + 1 >= plan_->points.size()) return std::nullopt;
  const auto far_m = [&](std::size_t point) { return (plan_->points[point].north_east - from_W).norm(); };
  return far_m(first) <= far_m(first + 1) ? first : first + 1;
}

/// Tells where other vehicles wait and which passages count as blocked, when that has changed.
void Commodore::say_hazards(Outbox& out) {
  GroupHazards now;
  for (std::size_t k = 0; k < plan_->passages.size() && members_.size() > 1; ++k) {
    if (!passages_.is_blocked(k)) continue;
    now.hazards.push_back({plan_->passages[k].outline, 0, HazardKind::kBlocked, static_cast<std::uint32_t>(k)});
  }
  for (std::size_t v = 0; v < members_.size(); ++v) {
    const Member& member = members_[v];
    if (v == own_ || member.lost || member.status.lanes == 0 || lane_of(v)) continue;
    for (const std::size_t side : {0, 1}) {
      const std::size_t place = visited_.size() + 2 * v + side;
      if (place >= plan_->points.size()) break;
      const Vector2d& at_W = plan_->points[place].north_east;
      if ((member.status.place_W - at_W).norm() > kAtWaitingPlace_m) continue;
      now.hazards.push_back({{at_W}, kWaitingCircle_m, HazardKind::kVehicle, static_cast<std::uint32_t>(v)});
    }
  }
  if (now.hazards == hazards_) return;
  hazards_ = now.hazards;
  out.say(std::move(now));
}

bool Commodore::all_done() const { return static_cast<std::size_t>(std::popcount(done_)) == lanes_.size(); }

void Commodore::watch(Time now, Outbox& out) {
  const double lost_s = config_.lost_turns * turn_s();
  for (std::size_t v = 0; v < members_.size(); ++v) {
    Member& member = members_[v];
    if (v == own_ || member.lost || to_seconds(now - member.heard) <= lost_s) continue;
    member.lost = true;
    replanned_.reset();
    decide(now, "vehicle lost", fmt::format("{} was not heard for {:.0f} s", name_of_vehicle(v), lost_s), out);
    order(name_of_vehicle(v) + " is lost", now, out);
  }
}

void Commodore::tick(Time now, Outbox& out) {
  if (!plan_) return;
  watch(now, out);
  meet(now, out);
  pass(now, out);
  say_hazards(out);
  lead(now, out);
  give_up_if_all_do(now, out);
  if (plans_.is_due(now)) {  // a vehicle that does not lead looks at its own share again
    order("the plan of the group", now, out);
    plans_.note(now, rest_s(), false, out);
  }
  send(now, out);
}

void Commodore::decide(Time now, const char* what, std::string reason, Outbox& out) {
  out.say(Decision{now, "commodore", what, std::move(reason)});
}

}  // namespace isobath
