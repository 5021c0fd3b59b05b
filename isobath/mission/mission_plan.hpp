// MissionPlan: what the vehicle is asked to do: mission points in order, and the limits that hold all along (Ganesan
// 2015, 5.1; ledger S6-43, S6-58, S6-65). Way-points between the points are the Navigator's.
//
// Frames: W, north and east in m, depth below the surface. Plain data; mission_file.hpp reads and checks it.
#pragma once

#include <Eigen/Core>
#include <isobath/base/error.hpp>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/geometry/polygon.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

struct MissionPoint {
  Place place;  ///< in the file it comes from
  std::string name;
  Eigen::Vector2d north_east = Eigen::Vector2d::Zero();
  double depth_m = 1;                ///< where no altitude is asked for
  std::optional<double> altitude_m;  ///< above the bottom, instead of a depth
  double speed = 0;                  ///< on the way to it, m/s; 0: the mission's
  double hold_s = 0;                 ///< stay there so long
  double move_m = 0;                 ///< how far the Captain may move it off an obstacle; 0: it is dropped (S6-65)
  std::string task;                  ///< what a back-seat driver does there; empty: nothing
};

/// What is done when there is no further point.
enum class MissionEnd : std::uint8_t { kHold, kSurface, kReturn };

/// A map that a person made, given to the Navigator as if it had been seen (S6-58).
struct InjectedMap {
  Place place;
  double at_s = 10;               ///< after the start of the mission
  std::vector<Polygon> outlines;  ///< convex, in W
};

struct MissionLimits {
  double min_depth_m = 0;
  double max_depth_m = 100;
  double min_altitude_m = 1;
  double max_position_sigma_m = 30;  ///< of the vehicle's own estimate; beyond it the mission is aborted
  double max_duration_s = 0;         ///< 0: none
  double low_battery_share = 0.15;
};

struct MissionPlan {
  std::string title;
  double speed = 1.5;  ///< m/s
  std::vector<MissionPoint> points;
  Polygon fence;  ///< simple, any sense; empty: none
  MissionLimits limits;
  MissionEnd at_end = MissionEnd::kHold;
  MissionEnd if_dropped = MissionEnd::kHold;  ///< what is done when the last point was dropped (S6-E21)
  std::vector<InjectedMap> injected;
  std::optional<GeoOrigin> origin;
};

}  // namespace isobath
