// RulesOfTheRoad: the steering rules of the sea (International Regulations for Preventing Collisions at Sea, 1972,
// rules 8 and 13 to 17) for a vehicle in the plane: its role toward each body, and what the role asks of its plan
// (ledger S3-01, S3-03).
//
// There is risk of collision if vehicle and body, both keeping their velocities, come closer than `risk_m` within
// `risk_s`. The role follows then from two bearings, each positive to starboard: that of the body from the vehicle's
// bow, and that of the vehicle from the body's bow, which is the direction of its velocity (no heading is known).
//
//   rule    role         body from the bow    vehicle from the body's bow
//   14      head-on      up to 10 deg         up to 15 deg
//   13      overtaking   any                  more than 112.5 deg
//   13, 17  overtaken    more than 112.5 deg  any
//   15, 16  gives way    to starboard         up to 112.5 deg, and not head-on
//   15, 17  stands on    to port              up to 112.5 deg, and not head-on
//
// A role lasts until the body is past and clear (rule 13 d): later changes of bearing do not change it. Toward the
// place where the vehicle wants to go, and as it moves now, the distance grows, and the gap is more than `clear_m`, for
// 2 s; or for 5 s neither motion comes closer than twice `risk_m` within `risk_s`. Then a new risk makes a new role.
// Bodies slower than `min_speed` have no meaningful course and get no role; one that has a role and becomes slower than
// half of that counts as not seen. A body that is not seen for 5 s is forgotten; one that jumps farther than 5 m from
// where its velocity led is taken as a new one.
//
// What a role asks of the plan:
//
//   gives way   a zone ahead of the body, as long as its way in `ahead_s`: the vehicle passes astern of it
//   head-on     a zone of `beam_m` on the body's starboard side: both pass port to port
//   overtaking  nothing but the margin
//   overtaken,  the body is left out of the plan, so that the vehicle keeps course and speed, until the time to the
//   stands on   closest approach is below `act_s` (rule 17 a ii); then it counts. The vehicle that stands on does not
//               turn to port then (rule 17 c): a zone lies along its course on its port side. It may slow down.
//
// A zone is a MovingBody without uncertainty, with the body's number, that turns with the body's velocity. A zone that
// would hold the vehicle is shortened, or left out where a quarter of it would. Lights, sails, narrow channels and
// ranks of vessels (rules 9, 10, 12, 18) are not considered; the other vessel need not know the rules.
//
// Frame W, x north, y east, m, m/s, s. A function of its inputs. One thread at a time.
#pragma once

#include <isobath/base/field.hpp>
#include <isobath/planning/traffic/moving_body.hpp>
#include <isobath/planning/traffic/vehicle_motion.hpp>
#include <map>
#include <optional>
#include <vector>

namespace isobath {

enum class SteeringRole : std::uint8_t { kNone, kHeadOn, kOvertaking, kGiveWay, kOvertaken, kStandOn };
/// "none", "head-on", "overtaking", "gives way", "overtaken", "stands on".
const char* to_text(SteeringRole role);

struct SteeringRulesConfig {
  bool on = false;
  double risk_m = 4;       ///< between the hulls
  double risk_s = 45;      ///< until the closest approach
  double min_speed = 0.3;  ///< m/s, of a body that has a role
  double act_s = 12;       ///< until the closest approach, from which on a vehicle that stands on acts
  double ahead_s = 20;     ///< of the body's way, that a vehicle which gives way does not cross
  double beam_m = 12;  ///< width of the zone that keeps the vehicle on the port side of a body that it meets head-on
  double clear_m = 4;  ///< between the hulls, from which on a body that is past is clear
};

/// Each with the prefix "rules": "rules", "rules_risk_m", ...
std::vector<Field> fields(SteeringRulesConfig& config);

/// Place and velocity in W, m and m/s.
struct PlaneMotion {
  Eigen::Vector2d p_W = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity_W = Eigen::Vector2d::Zero();
};

/// Both keeping their velocities. Without relative motion: now.
struct NearestPass {
  double in_s = 0;        ///< below 0: it is past
  double distance_m = 0;  ///< between the places
};
NearestPass nearest_pass(const PlaneMotion& own, const PlaneMotion& body);

/// The bearing of a place from the bow of something that moves, rad in -pi .. pi, positive to starboard.
double bearing_from_bow(const PlaneMotion& from, const Eigen::Vector2d& p_W);

/// The role by the table above, whether there is risk or not; none where one of them is slower than `min_speed`.
SteeringRole role_toward(const PlaneMotion& own, const PlaneMotion& body, double min_speed);

/// The role toward one body.
struct SteeringDuty {
  int number = 0;  ///< of the body
  SteeringRole role = SteeringRole::kNone;
  bool acts = false;  ///< a vehicle that stands on or is overtaken acts, for the body does not
  friend bool operator==(const SteeringDuty&, const SteeringDuty&) = default;
};

class RulesOfTheRoad {
 public:
  RulesOfTheRoad() = default;
  RulesOfTheRoad(const SteeringRulesConfig& config, double own_radius_m)
      : config_(config), own_radius_m_(own_radius_m) {}

  /// Goes on with the roles of another one, which may have other settings.
  void take_roles(const RulesOfTheRoad& other) { encounters_ = other.encounters_; }

  /// The vehicle now, its velocity on the straight way to its goal, and the valid bodies that it sees.
  void update(const MotionState& own, const Eigen::Vector2d& intended_W, Time now, std::span<const MovingBody> bodies);

  /// The roles of the last update, sorted by the body's number.
  [[nodiscard]] std::vector<SteeringDuty> duties() const;
  /// Whether the vehicle keeps course and speed toward this body, which the plan leaves out.
  [[nodiscard]] bool stands_on_for(int number) const;
  /// Whether the vehicle has stood on for this body and acts now.
  [[nodiscard]] bool acts_for(int number) const;

  struct Zones {
    std::vector<MovingBody> zones;
    int left_out = 0;  ///< as they would hold the vehicle
  };
  /// What the plan keeps out of now. `kept_m`: distance that it keeps from a zone, from the vehicle's place on.
  [[nodiscard]] Zones zones(const MotionState& own, Time now, double kept_m) const;

 private:
  struct Encounter {
    SteeringRole role = SteeringRole::kNone;
    bool acts = false;
    PlaneMotion last;      ///< of the body
    double radius_m = 0;   ///< of the body
    Time seen, risky;      ///< last
    Time closing;          ///< last time that it was not past and clear
    MotionState act_from;  ///< the vehicle when it began to act
  };
  [[nodiscard]] bool is_risk(const PlaneMotion& own, const PlaneMotion& body, double radius_m, double within_m) const;
  [[nodiscard]] bool is_over(const PlaneMotion& own, const PlaneMotion& intended, Encounter& encounter, Time now) const;
  void begin_to_act(const MotionState& own, const PlaneMotion& moves, Encounter& encounter) const;
  /// The zone of one encounter, `share` of its full size; empty outline: the role has none.
  [[nodiscard]] MovingBody zone_of(const Encounter& encounter, double share, double kept_m) const;

  SteeringRulesConfig config_;
  double own_radius_m_ = 0;
  std::map<int, Encounter> encounters_;
};

}  // namespace isobath
