// SearchArea: a rectangle that one vehicle or a group searches in parallel lanes (Herman 1988, 1, 6; ledger S2-48,
// S2-50), and the points of a mission that lead along them.
//
// Lane k lies along `heading`, (k + 1/2) lane breadths to starboard of the side that begins at `corner`. The lanes have
// equal breadths, at most `spacing_m`. A lane has stations at equal distances of at most `station_m`, so that a vehicle
// that went round an obstacle comes back to the lane. Station i of lane k is point k stations() + i of the mission.
// Every other lane begins at its far end, so that the points in their order lead back and forth.
// Frame W, m.
#pragma once

#include <Eigen/Core>
#include <isobath/base/angle.hpp>
#include <isobath/base/error.hpp>
#include <string>
#include <vector>

namespace isobath {

inline constexpr std::size_t kMaxLanes = 64, kMaxStations = 1000;

struct SearchArea {
  Place place = {};
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();  ///< north, east
  Angle heading = {};                                ///< of the lanes
  double length_m = 0;                               ///< along the lanes; 0: there is no area
  double breadth_m = 100;                            ///< to starboard of the corner
  double spacing_m = 10;                             ///< greatest distance between two lanes
  double station_m = 30;                             ///< greatest distance between two stations of a lane
  double depth_m = 1;
  double drop_distance_m = 4;  ///< an obstacle that is nearer to a station blocks it

  [[nodiscard]] bool on() const { return length_m > 0; }
  [[nodiscard]] std::size_t lanes() const;
  /// Number of stations of a lane, with its two ends.
  [[nodiscard]] std::size_t stations() const;
  [[nodiscard]] double lane_breadth_m() const { return breadth_m / static_cast<double>(lanes()); }
};

struct Lane {
  Eigen::Vector2d from_W, to_W;

  [[nodiscard]] Eigen::Vector2d at(double share) const { return from_W + share * (to_W - from_W); }
  [[nodiscard]] double length_m() const { return (to_W - from_W).norm(); }
};
std::vector<Lane> lanes_of(const SearchArea& area);

/// A vehicle of the group that a mission is for.
struct GroupMember {
  std::string name;
  Eigen::Vector2d start = Eigen::Vector2d::Zero();  ///< north, east, where it is expected to start
};

}  // namespace isobath
