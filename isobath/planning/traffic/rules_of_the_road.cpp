#include <algorithm>
#include <cmath>
#include <isobath/planning/traffic/rules_of_the_road.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kHeadOnBow = 10 * kDegree, kHeadOnAspect = 15 * kDegree;
constexpr double kAbaft = 112.5 * kDegree;  ///< from the bow: 22.5 degrees abaft the beam
constexpr double kStillHasCourse = 0.5;     ///< of the minimum speed, below which a body with a role is not seen as one
constexpr double kForget_s = 5, kJump_m = 5;
constexpr double kPast_s = 2, kNoRisk_s = 5;
constexpr double kHeadOnAhead_s = 10;   ///< of the way of a body that is met head-on, that its zone reaches ahead
constexpr double kBesideCourse_m = 10;  ///< width of the zone on the port side of a vehicle that acts
constexpr double kBesideSlack_m = 0.5;  ///< between what the vehicle keeps and that zone
constexpr double kActing_s = 8;         ///< of its way, that the zone reaches beyond the closest approach

Vector2d ahead_of(double heading) { return {std::cos(heading), std::sin(heading)}; }
Vector2d starboard_of(const Vector2d& ahead) { return {-ahead.y(), ahead.x()}; }

/// The rectangle from `back` to `front` along `ahead`, and from `port` to `starboard` across it, m from `p_W`.
MovingBody zone_box(const Vector2d& p_W, const Vector2d& ahead, double back, double front, double port,
                    double starboard) {
  const Vector2d aside = starboard_of(ahead);
  const Vector2d half_length = 0.5 * (front - back) * ahead, half_width = 0.5 * (starboard - port) * aside;
  MovingBody zone;
  zone.p_W = p_W + 0.5 * (front + back) * ahead + 0.5 * (starboard + port) * aside;
  zone.outline = {half_length + half_width, half_width - half_length, -half_length - half_width,
                  half_length - half_width};
  return zone;
}

PlaneMotion motion_now(const MovingBody& body, Time now) {
  return {body.p_W + to_seconds(now - body.time) * body.velocity_W, body.velocity_W};
}

}  // namespace

const char* to_text(SteeringRole role) {
  switch (role) {
    case SteeringRole::kHeadOn: return "head-on";
    case SteeringRole::kOvertaking: return "overtaking";
    case SteeringRole::kGiveWay: return "gives way";
    case SteeringRole::kOvertaken: return "overtaken";
    case SteeringRole::kStandOn: return "stands on";
    case SteeringRole::kNone: break;
  }
  return "none";
}

std::vector<Field> fields(SteeringRulesConfig& c) {
  return {
      Field::flag(
          "rules", &c.on,
          "Whether plans follow the steering rules of the sea (COLREGs 13 to 17): give way, stand on, head-on."),
      Field::real("rules_risk_m", &c.risk_m, {0, 1000}, "m",
                  "Gap at the closest approach below which there is risk of collision; a higher value gives roles to "
                  "bodies that pass farther off."),
      Field::real("rules_risk_s", &c.risk_s, {1, 3600}, "s",
                  "Time to the closest approach below which there is risk; a higher value lets roles begin earlier."),
      Field::real("rules_min_speed", &c.min_speed, {0.05, 20}, "m/s", "Minimum speed of a body that has a role."),
      Field::real("rules_act_s", &c.act_s, {0, 600}, "s",
                  "Time to the closest approach below which a vehicle that stands on acts; a higher value lets it act "
                  "earlier."),
      Field::real("rules_ahead_s", &c.ahead_s, {0, 600}, "s",
                  "Time of the way ahead of a body that a vehicle which gives way does not cross."),
      Field::real("rules_beam_m", &c.beam_m, {0, 1000}, "m",
                  "Width of the zone on the starboard side of a body that is met head-on."),
      Field::real("rules_clear_m", &c.clear_m, {0, 1000}, "m", "Gap from which on a body that is past is clear."),
  };
}

NearestPass nearest_pass(const PlaneMotion& own, const PlaneMotion& body) {
  const Vector2d to = body.p_W - own.p_W, closing = own.velocity_W - body.velocity_W;
  const double speed2 = closing.squaredNorm();
  const double in_s = speed2 > 1e-12 ? to.dot(closing) / speed2 : 0;
  return {in_s, (to - in_s * closing).norm()};
}

double bearing_from_bow(const PlaneMotion& from, const Vector2d& p_W) {
  const Vector2d to = p_W - from.p_W;
  return std::atan2(from.velocity_W.x() * to.y() - from.velocity_W.y() * to.x(), from.velocity_W.dot(to));
}

SteeringRole role_toward(const PlaneMotion& own, const PlaneMotion& body, double min_speed) {
  if (!own.p_W.allFinite() || !own.velocity_W.allFinite() || !body.p_W.allFinite() || !body.velocity_W.allFinite()) {
    return SteeringRole::kNone;
  }
  if (own.velocity_W.norm() < min_speed || body.velocity_W.norm() < min_speed) return SteeringRole::kNone;
  const double bearing = bearing_from_bow(own, body.p_W), aspect = bearing_from_bow(body, own.p_W);
  if (std::abs(aspect) > kAbaft) return SteeringRole::kOvertaking;
  if (std::abs(bearing) > kAbaft) return SteeringRole::kOvertaken;
  if (std::abs(bearing) <= kHeadOnBow && std::abs(aspect) <= kHeadOnAspect) return SteeringRole::kHeadOn;
  return bearing >= 0 ? SteeringRole::kGiveWay : SteeringRole::kStandOn;
}

bool RulesOfTheRoad::is_risk(const PlaneMotion& own, const PlaneMotion& body, double radius_m, double within_m) const {
  const NearestPass nearest = nearest_pass(own, body);
  return nearest.in_s > 0 && nearest.in_s <= config_.risk_s && nearest.distance_m - radius_m - own_radius_m_ < within_m;
}

bool RulesOfTheRoad::is_over(const PlaneMotion& own, const PlaneMotion& intended, Encounter& e, Time now) const {
  const double gap_m = (own.p_W - e.last.p_W).norm() - e.radius_m - own_radius_m_;
  const bool opens = nearest_pass(own, e.last).in_s <= 0 && nearest_pass(intended, e.last).in_s <= 0;
  if (!opens || gap_m <= config_.clear_m) e.closing = now;
  const double wide_m = 2 * config_.risk_m;
  if (gap_m < wide_m || is_risk(own, e.last, e.radius_m, wide_m) || is_risk(intended, e.last, e.radius_m, wide_m)) {
    e.risky = now;
  }
  return to_seconds(now - e.closing) >= kPast_s || to_seconds(now - e.risky) >= kNoRisk_s;
}

void RulesOfTheRoad::begin_to_act(const MotionState& own, const PlaneMotion& moves, Encounter& e) const {
  if (e.acts || (e.role != SteeringRole::kStandOn && e.role != SteeringRole::kOvertaken)) return;
  const NearestPass nearest = nearest_pass(moves, e.last);
  const bool is_due = nearest.in_s <= config_.act_s && nearest.distance_m - e.radius_m - own_radius_m_ < config_.risk_m;
  if (nearest.in_s <= 0 || !is_due) return;
  e.acts = true;
  e.act_from = own;
}

void RulesOfTheRoad::update(const MotionState& own, const Vector2d& intended_W, Time now,
                            std::span<const MovingBody> bodies) {
  const PlaneMotion moves{own.p_W, own.speed * ahead_of(own.heading)}, intended{own.p_W, intended_W};
  for (const MovingBody& body : bodies) {
    // What lies still may have the number of a body that moves, from which it was split.
    if (!is_valid(body) || body.velocity_W.norm() < kStillHasCourse * config_.min_speed) continue;
    const PlaneMotion there = motion_now(body, now);
    auto found = encounters_.find(body.number);
    if (found != encounters_.end()) {
      const PlaneMotion& last = found->second.last;
      const Vector2d expected = last.p_W + to_seconds(now - found->second.seen) * last.velocity_W;
      if ((there.p_W - expected).norm() > kJump_m) {
        encounters_.erase(found);
        found = encounters_.end();
      }
    }
    const double radius_m = circumscribed_radius(body);
    if (found == encounters_.end()) {
      if (!is_risk(moves, there, radius_m, config_.risk_m)) continue;
      const SteeringRole role = role_toward(moves, there, config_.min_speed);
      if (role == SteeringRole::kNone) continue;
      found = encounters_.emplace(body.number, Encounter{role, false, there, radius_m, now, now, now, own}).first;
    }
    Encounter& encounter = found->second;
    encounter.last = there;
    encounter.radius_m = radius_m;
    encounter.seen = now;
    if (is_over(moves, intended, encounter, now)) {
      encounters_.erase(found);
    } else {
      begin_to_act(own, moves, encounter);
    }
  }
  std::erase_if(encounters_, [&](const auto& one) { return to_seconds(now - one.second.seen) > kForget_s; });
}

std::vector<SteeringDuty> RulesOfTheRoad::duties() const {
  std::vector<SteeringDuty> all;
  for (const auto& [number, encounter] : encounters_) all.push_back({number, encounter.role, encounter.acts});
  return all;
}

bool RulesOfTheRoad::stands_on_for(int number) const {
  const auto found = encounters_.find(number);
  if (found == encounters_.end() || found->second.acts) return false;
  return found->second.role == SteeringRole::kStandOn || found->second.role == SteeringRole::kOvertaken;
}

bool RulesOfTheRoad::acts_for(int number) const {
  const auto found = encounters_.find(number);
  return found != encounters_.end() && found->second.acts;
}

MovingBody RulesOfTheRoad::zone_of(const Encounter& e, double share, double kept_m) const {
  const double speed = e.last.velocity_W.norm();
  const Vector2d ahead = e.last.velocity_W / speed;
  MovingBody zone;
  if (e.role == SteeringRole::kGiveWay) {
    zone = zone_box(e.last.p_W, ahead, 0, share * config_.ahead_s * speed, -e.radius_m, e.radius_m);
    zone.velocity_W = e.last.velocity_W;
  }
  if (e.role == SteeringRole::kHeadOn) {
    zone = zone_box(e.last.p_W, ahead, 0, share * kHeadOnAhead_s * speed, 0, share * config_.beam_m);
    zone.velocity_W = e.last.velocity_W;
  }
  if (e.role == SteeringRole::kStandOn && e.acts) {
    // It lies still, beside the course that the vehicle had: were it to turn with the vehicle, the vehicle could not
    // come back to its course after a turn to starboard.
    const double front_m = share * (config_.act_s + kActing_s) * e.act_from.speed;
    const double port_m = -kept_m - kBesideSlack_m;
    zone = zone_box(e.act_from.p_W, ahead_of(e.act_from.heading), 0, front_m, port_m - kBesideCourse_m, port_m);
  }
  return zone;
}

RulesOfTheRoad::Zones RulesOfTheRoad::zones(const MotionState& own, Time now, double kept_m) const {
  Zones all;
  for (const auto& [number, encounter] : encounters_) {
    if (encounter.seen != now) continue;
    for (const double share : {1.0, 0.75, 0.5, 0.25, 0.0}) {
      MovingBody zone = zone_of(encounter, share, kept_m);
      if (zone.outline.empty()) break;
      if (share == 0) {
        ++all.left_out;
        break;
      }
      if (distance_to(zone, own.p_W, 0) < kept_m) continue;
      zone.number = number;
      zone.time = now;
      all.zones.push_back(std::move(zone));
      break;
    }
  }
  return all;
}

}  // namespace isobath
