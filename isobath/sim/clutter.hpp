// Clutter: a seeded random field of poles, boxes and walls between a start and a goal. It tests how a vehicle behaves
// in water that was not laid out by hand (ledger S6-67).
//
// The start is at W's origin, the goal `length_m` north of it. All bodies stand upright from `top_m` to `bottom_m`. The
// density (bodies per hectare of the field) sets their number. The middle of the field is twice as dense as it is on
// average over its breadth, so the straight line is seldom free. All bodies keep `free_m` away from start and goal.
// With a passage, there is a winding polyline from start to goal that all bodies clear by half the passage's width. A
// vehicle that fits into this width can follow it; it is not always the shortest path. Without a passage, the field may
// be closed. `basin` adds vertical walls around the field.
//
// Walls are slabs: an infinitely thin sheet seen edge-on would return no echo.
//
// Traffic: `moving` upright discs of radius `moving_radius_m`, each with a constant speed of up to `moving_speed` in
// any direction. They go through each other and through the still bodies, turn back at the sides of the field, and do
// not react to the vehicle. At the start all keep `free_m` away from it. Times are those of the scene.
//
// The field is a function of configuration and seed. All lengths are whole centimetres and all headings whole degrees,
// so the last digit of a sine does not matter and the field is the same on every machine. Bodies may overlap. A body
// that finds no free place in 200 tries is left out, so dense fields hold fewer bodies than requested.
#pragma once

#include <cstdint>
#include <isobath/base/config.hpp>
#include <isobath/sim/scene.hpp>
#include <vector>

namespace isobath {

/// To a whole centimetre.
double whole_cm(double metres);

struct ClutterConfig {
  double density = 0;     ///< bodies per hectare; 0: no field
  double length_m = 120;  ///< from start to goal
  double breadth_m = 80;  ///< width of the field, centred on the line from start to goal
  double free_m = 20;     ///< free radius around start and goal
  double passage_m = 16;  ///< width of the path that is left free; 0: none
  double wander_m = 20;   ///< largest distance of that path from the straight line
  double pole_share = 0.5;
  double box_share = 0.3;  ///< the rest are walls
  double top_m = 0, bottom_m = 30;
  bool basin = false;
  int moving = 0;
  double moving_speed = 0.5;
  double moving_radius_m = 0.5;
};
std::vector<Field> fields(ClutterConfig& config);

struct ClutterField {
  std::vector<Body> bodies;
  std::vector<Eigen::Vector2d> passage;  ///< its centre line, from start to goal; empty without one
};

/// Throws Error if the field has no room: 2 free_m must be below length_m, and passage_m at most breadth_m.
/// `duration_s`: time for which the moving bodies have a path.
ClutterField clutter_field(const ClutterConfig& config, std::uint64_t seed, double duration_s = 0);

}  // namespace isobath
