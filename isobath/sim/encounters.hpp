// Encounters: one to three bodies that each meet a vehicle which goes straight, in the situations of the rules of the
// road at sea. They test whether a vehicle passes each kind of encounter, alone and together.
//
// Five kinds (EncounterKind), named after what the vehicle sees. The 55 situations are all sets of one, two or three
// kinds with repetition (5 + 15 + 35), in the order in which DNV's Ship Traffic Generator lists its baseline
// situations 1 to 40 (repository dnv-opensource/ship-traffic-generator, MIT); the order of the other 15 follows by the
// same rule.
//
// Each target keeps course and speed. At a time t, drawn uniformly from `meeting_s`, it is where the vehicle is that
// goes straight at speed v from its start. With the bearing b of the target from the bow at the start, positive to
// starboard, and r = speed of the target / v, the target starts at the distance
//
//   v t (cos b + sqrt(r^2 - sin^2 b)), or with a minus sign where the vehicle overtakes,
//
// and sees the vehicle at the angle a from its own bow, sin a = sin b / r. b and r are uniform within the bounds of the
// kind; these are the smallest and largest values of the baseline situations 1 to 40:
//
//   kind                                b, deg        r            a, deg
//   head-on                             -5 to 5       0.5 to 1.8   up to 5
//   crossing from starboard (give way)  9 to 102      0.6 to 1.8   5 to 112.5
//   crossing from port (stand on)       -110 to -30   0.6 to 1.7   5 to 112.5
//   overtaken (give way)                8 to 35       0.4 to 0.8   above 112.5: the vehicle comes from astern
//   overtaking (stand on)               150 to 210    1.5 to 1.9   up to 112.5
//
// A draw is repeated until a is within its bounds, the target starts at least `free_m` from the vehicle, and it is
// clear of the other targets. In the baseline situations a ship of 122 m at 10 knots meets the targets after 10 to 20
// minutes, which is 25 to 51 of its lengths; a REMUS 100 of 1.6 m needs 27 to 54 s for as many of its own at 1.5 m/s:
// the default of `meeting_s`.
//
// Frame W, m, m/s, s of the scene. Places are whole centimetres, so that the last digit of a sine does not matter and
// the bodies are the same on every machine. A target ends its path at the end of the run.
#pragma once

#include <array>
#include <cstdint>
#include <isobath/base/config.hpp>
#include <isobath/sim/scene.hpp>
#include <string>
#include <vector>

namespace isobath {

enum class EncounterKind : std::uint8_t { kHeadOn, kFromStarboard, kFromPort, kOvertaken, kOvertaking };
const char* to_text(EncounterKind kind);

/// How the targets of one kind are drawn.
struct EncounterBounds {
  std::array<double, 2> bearing_deg, speed_ratio, aspect_deg;
};
const EncounterBounds& encounter_bounds(EncounterKind kind);

using EncounterSituation = std::vector<EncounterKind>;
const std::vector<EncounterSituation>& encounter_situations();

struct EncounterConfig {
  bool on = false;
  Eigen::Vector2d meeting_s = {27, 54};
  double radius_m = 0.5;
  double free_m = 10;
  double top_m = 0, bottom_m = 30;
};
std::vector<Field> fields(EncounterConfig& config);

/// The vehicle that the targets meet.
struct EncounteredVehicle {
  Eigen::Vector2d start_W = Eigen::Vector2d::Zero();
  Angle course;
  double speed = 1.5;  ///< over ground
};

/// The targets of a situation: upright cylinders with a path, named "head-on 1", "crossing from port 2". The Error that
/// it throws names the setting that leaves a target no place.
std::vector<Body> encounter_bodies(const EncounterConfig& config, const EncounterSituation& situation,
                                   const EncounteredVehicle& vehicle, std::uint64_t seed, double duration_s);
/// "head-on, crossing from port".
std::string to_text(const EncounterSituation& situation);

}  // namespace isobath
