// scene_picture: a scene from above: depths, bodies, the track of the vehicle and the fields of view of its sonars. For
// the documentation and for authors of scenes.
#pragma once

#include <Eigen/Core>
#include <isobath/sim/simulator.hpp>
#include <span>
#include <string>

namespace isobath {

/// PNG. `track`: north and east of the vehicle if the scene was run; if it is empty, only the way-points are drawn.
std::string scene_picture(const Simulator& simulator, std::span<const Eigen::Vector2d> track);

}  // namespace isobath
