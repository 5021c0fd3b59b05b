// echo_picture: the newest echoes around a vehicle as lines of characters, seen from above, the bow up.
#pragma once

#include <isobath/links/mounting_check.hpp>
#include <string>
#include <vector>

namespace isobath::app {

/// `rows` lines; a character is as strong as its strongest echo, "+" is the vehicle.
std::vector<std::string> echo_picture(const EchoPanorama& echoes, int rows);

}  // namespace isobath::app
