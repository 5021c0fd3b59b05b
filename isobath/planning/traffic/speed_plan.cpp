#include <algorithm>
#include <bit>
#include <cmath>
#include <isobath/planning/traffic/speed_plan.hpp>

namespace isobath {
namespace {

constexpr int kMoments = 4;           // of a step
constexpr double kSpeedStep_s = 0.5;  // longer where the vehicle changes its speed slowly
constexpr int kMinLevels = 8, kMaxLevels = 64;
constexpr int kGoalsOfLevel = 6;  // the farthest places of each speed whose braking is tried
constexpr int kWordBits = 64;

double speed_step_s(const TrafficVehicle& v) {
  return std::max(kSpeedStep_s, v.max_speed / (kMaxLevels * std::min(v.acceleration, v.braking)));
}

int speed_levels(const TrafficVehicle& v) {
  const double rise = std::min(v.acceleration, v.braking) * speed_step_s(v);
  return std::max(kMinLevels, static_cast<int>(std::ceil(v.max_speed / rise - 1e-9))) + 1;
}

/// Time to a distance ahead when the vehicle speeds up.
double time_over(double way_m, double speed, const TrafficVehicle& v) {
  if (way_m <= 0) return 0;
  const double rising_s = std::max(0.0, v.max_speed - speed) / v.acceleration;
  const double risen_m = rising_s * (speed + 0.5 * rising_s * v.acceleration);
  if (way_m < risen_m) return (std::sqrt(speed * speed + 2 * v.acceleration * way_m) - speed) / v.acceleration;
  return rising_s + (way_m - risen_m) / v.max_speed;
}

/// Places and the speed along a path while it is being written as segments.
struct AlongPath {
  const SmoothPath& path;
  Trajectory& motion;
  double along_m = 0, speed;
  std::size_t piece = 0;

  void advance(double acceleration, double duration_s) {
    while (duration_s > 1e-9) {
      while (piece + 1 < path.pieces.size() && path.pieces[piece + 1].start_m <= along_m + 1e-6) ++piece;
      const bool is_last = piece + 1 >= path.pieces.size();
      const double curvature = path.pieces.empty() ? 0 : path.pieces[piece].curvature;
      const double left_m = is_last ? INFINITY : path.pieces[piece + 1].start_m - along_m;
      const double part_s = std::min(duration_s, time_to(left_m, acceleration));
      append(curvature, acceleration, part_s);
      const double moving_s = acceleration < 0 ? std::min(part_s, speed / -acceleration) : part_s;
      along_m += moving_s * (speed + 0.5 * acceleration * moving_s);
      speed = std::max(0.0, speed + acceleration * part_s);
      duration_s -= part_s;
    }
  }
  [[nodiscard]] double time_to(double way_m, double acceleration) const {
    const double last2 = speed * speed + 2 * acceleration * way_m;
    if (!std::isfinite(way_m) || last2 < 0 || speed + std::sqrt(last2) <= 0) return INFINITY;
    return 2 * way_m / (speed + std::sqrt(last2));
  }
  void append(double curvature, double acceleration, double duration_s) const {
    auto& all = motion.segments;
    if (!all.empty() && all.back().curvature == curvature && all.back().acceleration == acceleration) {
      all.back().duration_s += duration_s;
      return;
    }
    MotionState start = path.at(0);
    start.speed = speed;
    motion.append(start, curvature, acceleration, duration_s);
  }
};

}  // namespace

Trajectory SpeedPlan::motion_along(const SmoothPath& path, double speed, const TrafficVehicle& vehicle,
                                   double clear_s) const {
  Trajectory motion;
  AlongPath at{path, motion, 0, speed};
  double before = speed;
  for (const double after : speeds) {
    at.advance((after - before) / step_s, step_s);
    before = after;
  }
  at.advance(-vehicle.braking, before / vehicle.braking);
  at.advance(0, clear_s);
  return motion;
}

SpeedPlanner::SpeedPlanner(const TrafficVehicle& vehicle)
    : vehicle_(vehicle),
      levels_(speed_levels(vehicle)),
      rise_(vehicle.max_speed / (levels_ - 1)),
      place_m_(0.5 * rise_ * speed_step_s(vehicle)),
      faster_(static_cast<int>(std::floor(vehicle.acceleration * speed_step_s(vehicle) / rise_ + 1e-6))),
      slower_(static_cast<int>(std::floor(vehicle.braking * speed_step_s(vehicle) / rise_ + 1e-6))) {}

double SpeedPlanner::kept_from(const MovingBody& body, double ahead_s, const SpeedRules& rules) const {
  const double half_s = 0.5 * speed_step_s(vehicle_) / kMoments;
  const double kept = rules.distance_m + predicted_growth(body, ahead_s + half_s, rules.sigmas) + body.radius_m;
  const double corner_speed = std::abs(body.turn_rate) * (circumscribed_radius(body) - body.radius_m);
  return std::hypot(kept, half_s * (vehicle_.max_speed + body.velocity_W.norm())) - body.radius_m +
         half_s * corner_speed + 1.5 * place_m_;
}

void SpeedPlanner::mark(const MovingBody& body, Time now, const SpeedRules& rules) {
  const double moment_s = speed_step_s(vehicle_) / kMoments, age_s = to_seconds(now - body.time);
  const std::size_t moments = clear_.size() / words_;
  for (std::size_t moment = 0; moment < moments; ++moment) {
    const double t = static_cast<double>(moment) * moment_s, ahead_s = age_s + t;
    const double kept = kept_from(body, ahead_s, rules);
    const Eigen::Vector2d centre = body.p_W + ahead_s * body.velocity_W;
    const int end = std::min(places_, static_cast<int>(vehicle_.max_speed * t / place_m_) + 2);
    Word* clear = clear_.data() + moment * words_;
    for (int place = 0; place < end;) {
      const Eigen::Vector2d& p = at_[static_cast<std::size_t>(place)];
      const double gap =
          (body.outline.empty() ? (p - centre).norm() - body.radius_m : distance_to(body, p, ahead_s)) - kept;
      const int next = place + 1 + static_cast<int>(std::min(1e6, std::abs(gap) / place_m_));
      if (gap < 0) {
        for (int k = place; k < std::min(next, places_); ++k) clear[k / kWordBits] &= ~(Word{1} << (k % kWordBits));
      }
      place = next;
    }
  }
}

bool SpeedPlanner::is_clear(int moment, int place) const {
  if (place < 0 || place >= places_ || static_cast<std::size_t>(moment) >= clear_.size() / words_) return false;
  return (clear_[static_cast<std::size_t>(moment) * words_ + place / kWordBits] >> (place % kWordBits) & 1) != 0;
}

/// Places passed after `part` quarters of a step from one level to another.
int SpeedPlanner::offset(int level, int next, int part) const {
  return static_cast<int>(std::lround(0.5 * level * part + (next - level) * part * part / 16.0));
}

void SpeedPlanner::reach_first(double speed) {
  const double step_s = speed_step_s(vehicle_);
  for (int next = 0; next < levels_; ++next) {
    const double change = next * rise_ - speed;
    if (change > vehicle_.acceleration * step_s + 1e-6 || -change > vehicle_.braking * step_s + 1e-6) continue;
    int place = 0;
    bool clear = true;
    for (int part = 1; part <= kMoments && clear; ++part) {
      const double t = step_s * part / kMoments;
      place = static_cast<int>(std::lround((speed * t + change / step_s * t * t / 2) / place_m_));
      clear = is_clear(part, place);
    }
    if (clear) row(1, next)[place / kWordBits] |= Word{1} << (place % kWordBits);
  }
}

void SpeedPlanner::reach_next(int step) {
  const auto shifted = [&](const Word* from, std::size_t word, int by) {
    const std::size_t i = word + static_cast<std::size_t>(by / kWordBits);
    const int rest = by % kWordBits;
    const Word low = i < words_ ? from[i] >> rest : 0;
    return rest > 0 && i + 1 < words_ ? low | from[i + 1] << (kWordBits - rest) : low;
  };
  for (int level = 0; level < levels_; ++level) {
    const Word* from = row(step, level);
    std::size_t first = 0, end = words_;
    while (first < end && from[first] == 0) ++first;
    while (end > first && from[end - 1] == 0) --end;
    if (first == end) continue;
    for (int next = std::max(0, level - slower_); next <= std::min(levels_ - 1, level + faster_); ++next) {
      Word* to = row(step + 1, next);
      const int all = offset(level, next, kMoments), rest = all % kWordBits;
      for (std::size_t word = first; word < end; ++word) {
        Word moved = from[word];
        for (int part = 1; part <= kMoments && moved != 0; ++part) {
          const Word* clear = clear_.data() + static_cast<std::size_t>(kMoments * step + part) * words_;
          moved &= shifted(clear, word, offset(level, next, part));
        }
        if (moved == 0) continue;
        const std::size_t i = word + static_cast<std::size_t>(all / kWordBits);
        if (i < words_) to[i] |= moved << rest;
        if (rest > 0 && i + 1 < words_) to[i + 1] |= moved >> (kWordBits - rest);
      }
    }
  }
}

/// Adds the farthest places of each speed at a step: those at the arrival, and at the last step all.
void SpeedPlanner::collect(int step, int steps, int arrival_place) {
  for (int level = 0; level < levels_; ++level) {
    const Word* from = row(step, level);
    const int least = step < steps ? arrival_place : 0;
    int taken = 0;
    for (int word = static_cast<int>(words_) - 1; word >= least / kWordBits && taken < kGoalsOfLevel; --word) {
      for (Word left = from[word]; left != 0 && taken < kGoalsOfLevel; ++taken) {
        const int bit = kWordBits - 1 - std::countl_zero(left), place = word * kWordBits + bit;
        left &= ~(Word{1} << bit);
        if (place < least) break;
        const double ahead_m = (arrival_place - place) * place_m_, speed = level * rise_;
        const double rest_s = ahead_m > 0 ? time_over(ahead_m, speed, vehicle_) : ahead_m / std::max(speed, rise_);
        goals_.push_back({step * speed_step_s(vehicle_) + rest_s, step, level, place});
      }
    }
  }
}

bool SpeedPlanner::brakes(const Goal& goal, double clear_s) const {
  const double moment_s = speed_step_s(vehicle_) / kMoments, speed = goal.level * rise_;
  const double braking_s = speed / vehicle_.braking;
  for (int part = 1; (part - 1) * moment_s < braking_s + clear_s; ++part) {
    const double t = std::min(part * moment_s, braking_s);
    const int place = goal.place + static_cast<int>(std::lround(t * (speed - 0.5 * vehicle_.braking * t) / place_m_));
    if (!is_clear(kMoments * goal.step + part, place)) return false;
  }
  return true;
}

/// Whether a reached place leads to the next level.
bool SpeedPlanner::leads(int step, int level, int next, int place) const {
  if (place < 0 || (row(step, level)[place / kWordBits] >> (place % kWordBits) & 1) == 0) return false;
  for (int part = 1; part <= kMoments; ++part) {
    if (!is_clear(kMoments * step + part, place + offset(level, next, part))) return false;
  }
  return true;
}

SpeedPlan SpeedPlanner::written(const Goal& goal) const {
  SpeedPlan plan;
  plan.step_s = speed_step_s(vehicle_);
  plan.arrival_s = goal.arrival_s;
  plan.free_s = goal.step * plan.step_s;
  plan.speeds.assign(static_cast<std::size_t>(goal.step), 0);
  int level = goal.level, place = goal.place;
  for (int step = goal.step; step > 0; --step) {
    plan.speeds[static_cast<std::size_t>(step - 1)] = level * rise_;
    if (step == 1) break;
    // A constant speed first, then the smallest changes.
    for (int k = 0; k <= 2 * std::max(faster_, slower_); ++k) {
      const int before = level + (k % 2 == 0 ? -k / 2 : (k + 1) / 2);
      const bool within = before >= 0 && before < levels_ && level - before <= faster_ && before - level <= slower_;
      if (!within || !leads(step - 1, before, level, place - before - level)) continue;
      place -= before + level;
      level = before;
      break;
    }
  }
  return plan;
}

SpeedRefusal SpeedPlanner::refusal(std::span<const MovingBody> bodies, Time now, const SpeedRules& rules) const {
  const int steps = static_cast<int>(reached_.size() / (static_cast<std::size_t>(levels_) * words_)) - 1;
  SpeedRefusal result;
  int last = 0, place = 0;
  for (int step = 1; step <= steps; ++step) {
    for (int level = 0; level < levels_; ++level) {
      for (int word = static_cast<int>(words_) - 1; word >= 0; --word) {
        if (row(step, level)[word] == 0) continue;
        if (step > last) place = 0;
        last = step;
        place = std::max(place, word * kWordBits + kWordBits - 1 - std::countl_zero(row(step, level)[word]));
        break;
      }
    }
  }
  result.time_s = last * speed_step_s(vehicle_);
  result.place_m = place * place_m_;
  if (last == steps) return result;
  double least = INFINITY;
  for (const MovingBody& body : bodies) {
    for (int part = 1; part <= kMoments; ++part) {
      const double ahead_s = to_seconds(now - body.time) + result.time_s + part * speed_step_s(vehicle_) / kMoments;
      const double gap =
          distance_to(body, at_[static_cast<std::size_t>(place)], ahead_s) - kept_from(body, ahead_s, rules);
      if (gap >= least) continue;
      least = gap;
      result.body = body.number;
    }
  }
  return result;
}

Result<SpeedPlan, SpeedRefusal> SpeedPlanner::plan(const SmoothPath& path, double speed,
                                                   std::span<const MovingBody> bodies, Time now,
                                                   const SpeedRules& rules) {
  const double step_s = speed_step_s(vehicle_), braking_s = vehicle_.max_speed / vehicle_.braking;
  const double from = std::clamp(speed, 0.0, vehicle_.max_speed);
  const int steps = std::max(1, static_cast<int>(std::ceil(rules.horizon_s / step_s - 1e-9)));
  const int moments =
      kMoments * steps + static_cast<int>(std::ceil((braking_s + rules.clear_s) * kMoments / step_s)) + 2;
  const double farthest_m = std::min(path.length_m(), vehicle_.max_speed * moments * step_s / kMoments);
  places_ = static_cast<int>(std::floor(farthest_m / place_m_)) + 1;
  words_ = static_cast<std::size_t>(places_) / kWordBits + 1;
  at_.resize(static_cast<std::size_t>(places_));
  for (int place = 0; place < places_; ++place) at_[static_cast<std::size_t>(place)] = path.at(place * place_m_).p_W;
  clear_.assign(static_cast<std::size_t>(moments) * words_, ~Word{0});
  reached_.assign(static_cast<std::size_t>(steps + 1) * static_cast<std::size_t>(levels_) * words_, 0);
  for (std::size_t moment = 0; moment < static_cast<std::size_t>(moments); ++moment) {
    clear_[moment * words_ + words_ - 1] = (Word{1} << (places_ % kWordBits)) - 1;
  }
  for (const MovingBody& body : bodies) mark(body, now, rules);

  goals_.clear();
  const double arrival_m = std::max(0.0, path.length_m() - rules.arrival_m);
  const int arrival_place = static_cast<int>(std::ceil(arrival_m / place_m_ - 1e-9));
  reach_first(from);
  for (int step = 1; step <= steps; ++step) {
    if (step > 1) reach_next(step - 1);
    goals_.clear();
    collect(step, steps, arrival_place);
    std::ranges::sort(goals_, {}, &Goal::arrival_s);
    for (const Goal& goal : goals_) {
      if (brakes(goal, rules.clear_s)) return written(goal);
    }
  }
  return tl::unexpected(refusal(bodies, now, rules));
}

}  // namespace isobath
