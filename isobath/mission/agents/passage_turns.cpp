#include <algorithm>
#include <isobath/mission/agents/passage_turns.hpp>
#include <utility>

namespace isobath {

using Eigen::Vector2d;

PassageTurns::PassageTurns(std::span<const GroupPassage> passages, double longest_wait_s)
    : blocked_(passages.size(), 0), longest_wait_s_(longest_wait_s) {
  for (const GroupPassage& passage : passages) passages_.push_back(passage.outline);
}

void PassageTurns::set_way(std::vector<Vector2d> way_W, Time now) {
  way_W_ = std::move(way_W);
  if (!way_W_.empty()) {
    idle_since_.reset();
  } else if (!idle_since_) {
    idle_since_ = now;
  }
}

void PassageTurns::offer_way(std::span<const Vector2d> way_W) {
  if (held_ && !way_W.empty() && !along_m(way_W, ask_->passage)) end();
}

void PassageTurns::pass(std::size_t waypoints) {
  way_W_.erase(way_W_.begin(), way_W_.begin() + static_cast<std::ptrdiff_t>(std::min(waypoints, way_W_.size())));
}

double PassageTurns::distance_m(std::size_t passage) const { return distance_from(passages_[passage], here_W_); }

std::optional<double> PassageTurns::along_m(std::span<const Vector2d> way_W, std::size_t passage) const {
  double along_m = 0;
  Vector2d from = here_W_;
  for (const Vector2d& to : way_W) {
    const double leg_m = (to - from).norm();
    if (contains(passages_[passage], from)) return along_m;
    const auto hit_m = leg_m > 0 ? ray_hit(passages_[passage], from, (to - from) / leg_m) : std::nullopt;
    if (hit_m && *hit_m <= leg_m) return along_m + *hit_m;
    along_m += leg_m;
    from = to;
  }
  return std::nullopt;
}

void PassageTurns::move(const Vector2d& here_W, double ahead_m, Time now) {
  here_W_ = here_W;
  if (ask_) return go_on(now);
  std::optional<std::pair<double, std::size_t>> next;
  for (std::size_t k = 0; k < passages_.size(); ++k) {
    const auto at_m = blocked_[k] == 0 ? along_m(way_W_, k) : std::nullopt;
    if (at_m && *at_m <= ahead_m && (!next || *at_m < next->first)) next = {*at_m, k};
  }
  if (!next) return;
  ask_ = PassageAsk{static_cast<std::uint8_t>(next->second), ++asks_, false};
  since_ = now;
  go_on(now);
}

void PassageTurns::go_on(Time now) {
  const std::size_t k = ask_->passage;
  const bool inside = distance_m(k) <= kThrough_m;
  if (!ask_->passing) {
    if (inside) return take_turn(now);  // it is there already, and the others have to know
    held_ = held_ || distance_m(k) <= kWait_m;
    if (to_seconds(now - since_) <= longest_wait_s_) return;
    blocked_[k] = 1;
    return end();
  }
  if (inside) return;
  const bool leads_elsewhere = !way_W_.empty() && !along_m(way_W_, k);
  const bool idle =
      idle_since_ && distance_m(k) > kWait_m && to_seconds(now - std::max(since_, *idle_since_)) > kIdle_s;
  if (leads_elsewhere || idle) end();
}

void PassageTurns::end() {
  ask_.reset();
  held_ = false;
}

void PassageTurns::take_turn(Time now) {
  ask_->passing = true;
  held_ = false;
  since_ = now;
}

bool PassageTurns::is_blocked(std::size_t passage) const {
  return blocked_[passage] != 0 && distance_m(passage) > kThrough_m;
}

}  // namespace isobath
