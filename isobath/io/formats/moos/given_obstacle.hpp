// GivenObstacle: an obstacle as the obstacle manager of a MOOS community takes it, the text of the variable
// GIVEN_OBSTACLE: "pts={x,y:x,y:...},label=ID,duration=10". x is east and y north of the local grid, m; the outline is
// convex. The helm forgets the obstacle `duration` seconds after it was last given.
#pragma once

#include <isobath/geometry/polygon.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace isobath {

struct GivenObstacle {
  Polygon outline_W;  ///< north, east
  std::string label;
  double duration_s = 0;
};

/// Rounded to centimetres, and convex after that. Empty: the outline then has no area.
std::optional<std::string> given_obstacle_text(const GivenObstacle& obstacle);
/// Empty: not of this form, no label, no duration over 0, an outline that is not convex or has over kMaxCorners.
std::optional<GivenObstacle> given_obstacle_of(std::string_view text);

}  // namespace isobath
