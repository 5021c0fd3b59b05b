// A scene from above: depths, bodies, the way of the vehicle and what its sonars look at. For the docs and for whoever
// writes a scene.
#pragma once

#include <Eigen/Core>
#include <isobath/sim/simulator.hpp>
#include <span>
#include <string>

namespace isobath {

/// PNG. `track`: north, east of the vehicle, where it was run; else its way-points are drawn alone.
std::string scene_picture(const Simulator& simulator, std::span<const Eigen::Vector2d> track);

}  // namespace isobath
