#include <algorithm>
#include <cmath>
#include <isobath/planning/traffic/traffic_search.hpp>
#include <limits>
#include <numbers>
#include <numeric>

namespace isobath {
namespace {

using std::numbers::pi;

constexpr double kCellSide_m = 0.75, kHeadingCell = 0.13, kSpeedCell = 0.1;
constexpr std::size_t kSlots = std::size_t{1} << 17;
constexpr double kHurry = 5;    ///< factor on the reward of depth, once half of the expansions are spent
constexpr int kFallBacks = 30;  ///< nodes of each step whose escape is tried where the search found no motion
constexpr int kMaxTurnSteps = 11;

/// For a heap with the earliest on top; equal priorities in the order in which they were added.
constexpr auto later = [](const auto& a, const auto& b) {
  return a.priority > b.priority || (a.priority == b.priority && a.node > b.node);
};

}  // namespace

std::vector<Field> fields(TrafficSearchConfig& c) {
  return {
      Field::real("horizon", &c.horizon_s, {2, 120}, "s", "Time for which a free motion is looked for."),
      Field::real("clear", &c.clear_s, {0, 60}, "s", "Time at rest that must stay clear at the end of each motion."),
      Field::real("depth_reward", &c.depth_reward, {0, 1}, "1",
                  "Delay accepted for each second of horizon; a higher value finds a motion sooner, and a later one."),
      Field::integer("max_expansions", &c.max_expansions, {1, 1'000'000}, "",
                     "States that one search expands at most."),
  };
}

TrafficSearch::TrafficSearch(const TrafficSearchConfig& config, const TrafficVehicle& vehicle)
    : config_(config), vehicle_(vehicle) {
  const double braking_s = (vehicle.max_speed - vehicle.min_speed) / vehicle.braking;
  horizon_ = static_cast<int>(std::ceil(config.horizon_s / kStep_s));
  escape_ = static_cast<int>(std::ceil((braking_s + config.clear_s) / kStep_s));
  nodes_.reserve(static_cast<std::size_t>(config.max_expansions) * 4 + 64);
  open_.reserve(nodes_.capacity());
  slots_.assign(kSlots, {0, 0, 0});
}

double TrafficSearch::chord_error_m() const {
  const double aside = vehicle_.max_speed * vehicle_.max_speed * vehicle_.max_curvature();
  const double piece_s = kStep_s / kPieces;
  return std::hypot(aside, std::max(vehicle_.acceleration, vehicle_.braking)) * piece_s * piece_s / 8;
}

bool TrafficSearch::goes_to_goal(int corner) const {
  return guide_ == nullptr || corner + 1 == static_cast<int>(guide_->corners_W.size());
}

std::optional<DirectMotion> TrafficSearch::direct_to(const MotionState& state, int corner) const {
  if (goes_to_goal(corner)) return direct_motion(vehicle_, state, goal_W_, arrival_m_);
  return direct_motion(vehicle_, state, guide_->corners_W[corner], 0);
}

int TrafficSearch::corner_from(const MotionState& state, int corner) const {
  while (!goes_to_goal(corner) && guide_->still->is_free(state.p_W, guide_->corners_W[corner + 1])) ++corner;
  return corner;
}

double TrafficSearch::arrival_of(const MotionState& state, int step, int corner) const {
  const auto direct = direct_to(state, corner);
  const double before = step * kStep_s;
  if (!goes_to_goal(corner)) {
    // Within the turning circle of a corner the vehicle need not go round: it passes the corner beside it.
    const double to_corner_s = (guide_->corners_W[corner] - state.p_W).norm() / vehicle_.max_speed;
    const double half_turn_s = pi / vehicle_.max_curvature() / vehicle_.max_speed;
    const double direct_s = direct ? direct->arrival_s : to_corner_s + half_turn_s;
    return before + std::min(direct_s, to_corner_s + half_turn_s) + guide_->rest_m[corner] / vehicle_.max_speed;
  }
  // The goal lies within the turning circle: the vehicle must go away first.
  const double around = 2 * pi / vehicle_.max_curvature() / vehicle_.max_speed;
  return before + (direct ? direct->arrival_s : around);
}

TrafficSearch::Slot& TrafficSearch::slot_of(const Node& node) {
  const auto cell = [](double value, double side) {
    return static_cast<std::int64_t>(std::floor(value / side)) & 0xfff;
  };
  const double heading = node.state.heading - 2 * pi * std::floor(node.state.heading / (2 * pi));
  const std::uint64_t key = static_cast<std::uint64_t>(
      cell(node.state.p_W.x(), kCellSide_m) << 40 | cell(node.state.p_W.y(), kCellSide_m) << 28 |
      (cell(heading, kHeadingCell) & 0x3f) << 22 | (cell(node.state.speed + 1e-9, kSpeedCell) & 0xff) << 12 |
      (node.step & 0xfff));
  std::size_t at = (key * 0x9e3779b97f4a7c15u) >> 47;
  while (slots_[at].search == searches_ && slots_[at].key != key) at = (at + 1) % kSlots;
  if (slots_[at].search != searches_) slots_[at] = {key, searches_, -1};
  return slots_[at];
}

bool TrafficSearch::arc_is_free(const Node& from, const Node& to) const {
  const double piece_s = kStep_s / kPieces, start_s = from.step * kStep_s;
  const MotionSegment arc{0, kStep_s, from.state, to.curvature, to.acceleration};
  Eigen::Vector2d a = from.state.p_W;
  for (int k = 0; k < kPieces; ++k) {
    const Eigen::Vector2d b = k + 1 == kPieces ? to.state.p_W : arc.after((k + 1) * piece_s).p_W;
    if (!traffic_->is_free(from.step, start_s + k * piece_s, piece_s, a, b)) return false;
    a = b;
  }
  return true;
}

bool TrafficSearch::is_direct(const Node& from, const Node& to) const {
  const bool fastest = to.acceleration >= 0 && (to.acceleration > 0 || from.state.speed >= vehicle_.max_speed - 1e-9);
  const auto direct = fastest && to.curvature == 0 ? direct_to(from.state, from.corner) : std::optional<DirectMotion>();
  return direct && direct->arc_m < 1e-9;
}

double TrafficSearch::priority_of(const Node& node) const { return node.arrival_s - reward_ * node.step * kStep_s; }

void TrafficSearch::hurry() {
  reward_ *= kHurry;
  for (Open& open : open_) open.priority = priority_of(nodes_[open.node]);
  std::ranges::make_heap(open_, later);
}

void TrafficSearch::add(const Node& node) {
  nodes_.push_back(node);
  open_.push_back({priority_of(node), static_cast<int>(nodes_.size()) - 1});
  std::ranges::push_heap(open_, later);
}

double TrafficSearch::reachable_speed(double speed, double acceleration) const {
  // A vehicle that is slower or faster than its range comes back into it.
  return std::clamp(speed + acceleration * kStep_s, std::min(vehicle_.min_speed, speed),
                    std::max(vehicle_.max_speed, speed));
}

void TrafficSearch::expand(int index) {
  const Node from = nodes_[index];
  double last_speed = -1;
  for (const double wish : {vehicle_.acceleration, 0.0, -vehicle_.braking}) {
    const double speed = reachable_speed(from.state.speed, wish);
    if (std::abs(speed - last_speed) < 1e-9) continue;
    last_speed = speed;
    const double acceleration = (speed - from.state.speed) / kStep_s;
    const bool moves = from.state.speed + speed > 1e-9;
    for (const double share : {0.0, -0.5, 0.5, -1.0, 1.0}) {
      if (share != 0 && !moves) break;
      Node to{{}, 0, index, from.step + 1, share * vehicle_.max_curvature(), acceleration, false, 0};
      to.state = MotionSegment{0, kStep_s, from.state, to.curvature, acceleration}.after(kStep_s);
      to.corner = corner_from(to.state, from.corner);
      to.arrival_s = arrival_of(to.state, to.step, to.corner);
      Slot& slot = slot_of(to);
      if (slot.node >= 0 && nodes_[slot.node].arrival_s <= to.arrival_s) continue;
      if (!arc_is_free(from, to)) continue;
      to.direct_meets = from.direct_meets && to.corner == from.corner && is_direct(from, to);
      slot.node = static_cast<int>(nodes_.size());
      add(to);
    }
  }
}

int TrafficSearch::free_direct(const Node& node, DirectMotion& motion) const {
  const auto direct = direct_to(node.state, node.corner);
  if (!direct) return 0;
  motion = *direct;
  const int steps = static_cast<int>(std::ceil(direct->arrival_s / kStep_s));
  if (!goes_to_goal(node.corner) && node.step + steps <= horizon_) return 0;  // from the corner it must go on
  const int last = std::min(horizon_, node.step + std::max(1, steps));
  const double piece_s = kStep_s / kPieces;
  Eigen::Vector2d a = node.state.p_W;
  for (int step = node.step; step < last; ++step) {
    for (int k = 0; k < kPieces; ++k) {
      const double from_s = step * kStep_s + k * piece_s;
      const Eigen::Vector2d b = motion.at(from_s + piece_s - node.step * kStep_s).p_W;
      if (!traffic_->is_free(step, from_s, piece_s, a, b)) return 0;
      a = b;
    }
  }
  return last;
}

std::optional<double> TrafficSearch::escape(const MotionState& state, int step) const {
  const double piece_s = kStep_s / kPieces;
  const double braking_s = std::max(0.0, state.speed - vehicle_.min_speed) / vehicle_.braking;
  for (const double share : {0.0, -1.0, 1.0}) {
    if (share == 0 && vehicle_.min_speed > 0) continue;
    const MotionSegment brake{0, braking_s, state, share * vehicle_.max_curvature(), -vehicle_.braking};
    const MotionSegment after{0, 1e9, brake.after(braking_s), brake.curvature, 0};
    bool free = true;
    Eigen::Vector2d a = state.p_W;
    for (int k = 0; free && k * piece_s < braking_s + config_.clear_s; ++k) {
      const double to_s = (k + 1) * piece_s;
      const Eigen::Vector2d b = to_s <= braking_s ? brake.after(to_s).p_W : after.after(to_s - braking_s).p_W;
      const int in_step = step + k / kPieces;
      free = in_step < steps() && traffic_->is_free(in_step, step * kStep_s + k * piece_s, piece_s, a, b);
      a = b;
    }
    if (free) return brake.curvature;
  }
  return std::nullopt;
}

void TrafficSearch::append_escape(double curvature, Trajectory& motion) const {
  const MotionSegment& last = motion.segments.back();
  const double speed = last.after(last.duration_s).speed;
  const double braking_s = std::max(0.0, speed - vehicle_.min_speed) / vehicle_.braking;
  if (braking_s > 0) motion.append({}, curvature, -vehicle_.braking, braking_s);
  motion.append({}, curvature, 0, config_.clear_s);
}

void TrafficSearch::write(int node, Trajectory& motion) const {
  motion.segments.clear();
  for (int at = node; nodes_[at].parent >= 0; at = nodes_[at].parent) {
    const Node& to = nodes_[at];
    const Node& from = nodes_[to.parent];
    motion.segments.push_back({from.step * kStep_s, kStep_s, from.state, to.curvature, to.acceleration});
  }
  std::ranges::reverse(motion.segments);
  if (motion.segments.empty()) motion.segments.push_back({0, 0, nodes_[node].state, 0, 0});
}

bool TrafficSearch::try_finish(int index) {
  Node& node = nodes_[index];
  if (node.arrival_s >= best_.arrival_s || (node.direct_meets && node.step < horizon_)) return false;
  Finish finish{index, horizon_, node.arrival_s, 0, {}};
  if (node.step < horizon_) finish.last = free_direct(node, finish.direct);
  if (finish.last == 0) {
    node.direct_meets = true;
    return false;
  }
  const double direct_s = (finish.last - node.step) * kStep_s;
  const auto curvature = escape(direct_s > 0 ? finish.direct.at(direct_s) : node.state, finish.last);
  if (!curvature) return false;
  finish.escape_curvature = *curvature;
  best_ = finish;
  return true;
}

void TrafficSearch::write_best(TrafficSearchResult& result, Trajectory& motion) const {
  const Node& node = nodes_[best_.node];
  write(best_.node, motion);
  if (best_.last > node.step) best_.direct.append_to(motion, (best_.last - node.step) * kStep_s);
  append_escape(best_.escape_curvature, motion);
  result.end = SearchEnd::kHorizon;
  result.arrival_s = node.arrival_s;
  result.free_s = best_.last * kStep_s;
}

int TrafficSearch::roll(int index, double curvature, double wish) {
  const Node from = nodes_[index];
  if (from.step >= horizon_) return -1;
  const double speed = reachable_speed(from.state.speed, wish);
  Node to{{}, 0, index, from.step + 1, curvature, (speed - from.state.speed) / kStep_s, false, 0};
  to.state = MotionSegment{0, kStep_s, from.state, curvature, to.acceleration}.after(kStep_s);
  if (!arc_is_free(from, to)) return -1;
  to.corner = corner_from(to.state, from.corner);
  to.arrival_s = arrival_of(to.state, to.step, to.corner);
  add(to);
  const int added = static_cast<int>(nodes_.size()) - 1;
  try_finish(added);
  return added;
}

void TrafficSearch::add_turns() {
  const double speed = nodes_[0].state.speed;
  for (const double wish : {vehicle_.acceleration, 0.0, -vehicle_.braking}) {
    if (wish != 0 && reachable_speed(speed, wish) == speed) continue;  // the same as at constant speed
    for (const double side : {-1.0, 1.0}) {
      int turned = 0;
      for (int turn = 0; turn <= kMaxTurnSteps && turned >= 0; ++turn) {
        for (int ahead = side > 0 && turn == 0 ? -1 : turned; ahead >= 0;) ahead = roll(ahead, 0, wish);
        turned = roll(turned, side * vehicle_.max_curvature(), wish);
      }
    }
  }
}

void TrafficSearch::fall_back(TrafficSearchResult& result, Trajectory& motion) {
  order_.resize(nodes_.size());
  std::iota(order_.begin(), order_.end(), 0);
  std::ranges::sort(order_, [&](int a, int b) {
    if (nodes_[a].step != nodes_[b].step) return nodes_[a].step > nodes_[b].step;
    return nodes_[a].arrival_s != nodes_[b].arrival_s ? nodes_[a].arrival_s < nodes_[b].arrival_s : a < b;
  });
  // Neighbours in this order have much in common: of each step, nodes at even distances are tried.
  for (std::size_t first = 0, end = 0; first < order_.size(); first = end) {
    while (end < order_.size() && nodes_[order_[end]].step == nodes_[order_[first]].step) ++end;
    const std::size_t stride = (end - first) / kFallBacks + 1;
    for (std::size_t i = first; i < end; i += stride) {
      const Node& node = nodes_[order_[i]];
      const auto curvature = escape(node.state, node.step);
      if (!curvature) continue;
      write(order_[i], motion);
      append_escape(*curvature, motion);
      result.end = SearchEnd::kEscape;
      result.arrival_s = node.arrival_s;
      result.free_s = node.step * kStep_s;
      return;
    }
  }
}

TrafficSearchResult TrafficSearch::search(const PredictedTraffic& traffic, const MotionState& start,
                                          const Eigen::Vector2d& goal_W, double arrival_m, const TrafficGuide* guide,
                                          double before_s, Trajectory& motion) {
  traffic_ = &traffic;
  goal_W_ = goal_W;
  arrival_m_ = arrival_m;
  ++searches_;
  nodes_.clear();
  open_.clear();
  reward_ = config_.depth_reward;
  guide_ = guide;
  const int corner = corner_from(start, 0);
  add({start, arrival_of(start, 0, corner), -1, 0, 0, 0, false, corner});
  TrafficSearchResult result;
  // The table must never fill: each expansion adds at most 15 slots.
  const int bound = std::min(config_.max_expansions, static_cast<int>(kSlots / 16));
  best_ = {0, 0, before_s, 0, {}};
  const bool is_limited = before_s < std::numeric_limits<double>::infinity();
  const auto found = [this] { return best_.last > 0; };
  while (!open_.empty() && result.expansions < (found() || is_limited ? bound / 2 : bound)) {
    std::ranges::pop_heap(open_, later);
    const int node = open_.back().node;
    open_.pop_back();
    if (nodes_[node].arrival_s >= best_.arrival_s) continue;
    ++result.expansions;
    if (try_finish(node)) break;
    if (nodes_[node].step < horizon_) expand(node);
    if (result.expansions == bound / 8) add_turns();
    if (result.expansions == bound / 2 && !found()) hurry();
  }
  if (found()) {
    write_best(result, motion);
  } else if (!is_limited) {
    fall_back(result, motion);
  }
  return result;
}

}  // namespace isobath
