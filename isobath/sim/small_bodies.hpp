// Echoes of bodies that are small against the cells of a field of view: each gets finer cells of its own, direct and
// over the surface and the bottom. Internal to the sources of the simulated echoes.
#pragma once

#include <isobath/sim/echo_paths.hpp>
#include <isobath/sonar/echo_truth.hpp>
#include <vector>

namespace isobath {

/// An echo of one column of cells of a body.
struct BodyEcho {
  double azimuth;  ///< of the column in S, rad
  PathEcho echo;
};

/// Marks the small bodies in `paths.small` and lists their echoes, body by body and path by path.
void trace_small_bodies(EchoPaths& paths, std::vector<BodyEcho>& echoes);

}  // namespace isobath
