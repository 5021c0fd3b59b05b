// Clutter: a seeded random field of poles, boxes and walls across the way from a start to a goal, for runs that must
// show what a vehicle does in water that nobody laid out for it (ledger S6-67).
//
// The field lies north of a start in W's origin and south of a goal `length_m` further north; all bodies stand upright
// from `top_m` to `bottom_m`. Their number follows from the density: bodies a hectare of the field, whose breadth they
// fill with the middle twice as dense as the edges are on average, so that the straight way is seldom free. No body
// comes nearer to start and goal than `free_m`. With a passage there is a way from start to goal, a polyline that
// wanders, from which every body stands at least half its width away: a way that a vehicle of that room can follow,
// not always the shortest one. Without, the field may be closed. `basin` puts sheer walls round it.
//
// Walls are slabs: a sheet without thickness that is met end on would return no sound, and no sonar could find it.
//
// A function of configuration and seed; all lengths are whole centimetres and all headings whole degrees, so that the
// last digit of a sine cannot matter: the same field on every machine. Bodies may overlap. A body that finds no free
// place in 200 tries is left out: full fields hold fewer than asked for.
#pragma once

#include <cstdint>
#include <isobath/base/config.hpp>
#include <isobath/sim/scene.hpp>
#include <vector>

namespace isobath {

struct ClutterConfig {
  double density = 0;     ///< bodies a hectare; 0: no field
  double length_m = 120;  ///< from start to goal
  double breadth_m = 80;  ///< of the field, middle on the straight way
  double free_m = 20;     ///< around start and goal
  double passage_m = 16;  ///< width of the way that is left free; 0: none
  double wander_m = 20;   ///< how far that way leaves the straight one at most
  double pole_share = 0.5;
  double box_share = 0.3;  ///< the rest are walls
  double top_m = 0, bottom_m = 30;
  bool basin = false;
};
std::vector<Field> fields(ClutterConfig& config);

struct ClutterField {
  std::vector<Body> bodies;
  std::vector<Eigen::Vector2d> passage;  ///< its middle, from start to goal; empty without one
};

/// Throws Error where the field has no room: 2 free_m must be below length_m, the passage within the breadth.
ClutterField clutter_field(const ClutterConfig& config, std::uint64_t seed);

}  // namespace isobath
