// RulesScore: how a vehicle passed the targets of a suite of encounters (sim/encounters.hpp), by the steering rules of
// the sea (COLREGs, rules 13 to 17), from the true tracks. Which rule applies comes from how the target was drawn, so
// that the score shares nothing with a planner that follows the rules.
//
// - Crossing from starboard (rules 15, 16): the vehicle first crosses the line of the target's course astern of it.
// Where
//   it never crosses that line, it is abaft the target's beam at the closest approach.
// - Head-on (rule 14): at the closest approach the vehicle is on the target's port side.
// - Crossing from port and overtaking (rule 17): from when the target is within 60 m and the vehicle has run for 10 s,
//   until 12 s before the first closest approach to any target, if all keep their velocities, the course over ground,
//   as a mean of 2 s, stays within 10 degrees and the speed within 0.2 m/s of that at the beginning. Only where all
//   targets of the situation are of these two kinds, as the vehicle must manoeuvre for others; and where that time is 3
//   s or more.
//
// A target of the first two kinds whose closest approach is the end of the track was not passed, and does not count.
// Frame W, m, m/s, s.
#pragma once

#include <isobath/sim/encounters.hpp>
#include <isobath/vehicle/vehicle_state.hpp>
#include <span>

namespace isobath {

struct RulesScore {
  int give_way = 0, passed_astern = 0;       ///< crossing from starboard
  int head_on = 0, passed_port_to_port = 0;  ///< head-on
  int stand_on = 0, stood_on = 0;            ///< crossing from port, overtaking
};

/// `track`: of the vehicle, times from the start of the run, which rise by 1 s at most. `targets`: the bodies of the
/// situation, in its order; each moves on a straight path.
RulesScore rules_score(std::span<const TrueMotion> track, std::span<const Body> targets,
                       const EncounterSituation& situation);

}  // namespace isobath
