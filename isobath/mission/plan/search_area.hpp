// SearchArea: a rectangle that one vehicle or a group searches in parallel lanes (Herman 1988, 1, 6; ledger S2-48,
// S2-50), and the points of a mission that lead along them.
//
// Lane k lies along `heading`, (k + 1/2) lane breadths to starboard of the side that begins at `corner`. The lanes have
// equal breadths, at most `spacing_m`. A lane goes on `run_out_m` beyond the area at both ends, where the vehicle
// turns, so that it is on the lane from side to side of the area. A lane has a station at each of its ends and, at
// equal distances of at most `station_m`, from side to side of the area, so that a vehicle that went round an obstacle
// comes back to the lane. Station i of lane k is point k stations() + i of the mission. Every other lane begins at its
// far end, so that the points in their order lead back and forth. The points behind the stations are the places where
// vehicles of a group wait (add_waiting_places): two a vehicle, one beyond each side to which lanes lead. Frame W, m.
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
  double run_out_m = 6;                              ///< of a lane beyond the area, at both ends; 0: none
  double together_s =
      0;  ///< how long the vehicles of a group wait for one another at their waiting places; 0: not at all
  double depth_m = 1;
  double drop_distance_m = 4;  ///< an obstacle that is nearer to a station blocks it

  [[nodiscard]] bool on() const { return length_m > 0; }
  [[nodiscard]] std::size_t lanes() const;
  /// Number of stations of a lane, with its two ends.
  [[nodiscard]] std::size_t stations() const;
  /// Where a station lies on its lane, as a share of the lane's length.
  [[nodiscard]] double share_of_station(std::size_t station) const;
  /// The stations of all lanes together.
  [[nodiscard]] std::size_t all_stations() const { return lanes() * stations(); }
  /// Whether a station of a lane lies beyond the area.
  [[nodiscard]] bool is_run_out(std::size_t station) const {
    return run_out_m > 0 && (station == 0 || station + 1 == stations());
  }
  [[nodiscard]] double lane_breadth_m() const { return breadth_m / static_cast<double>(lanes()); }
};

inline constexpr double kWaitingCircle_m = 12;  ///< radius of the water in which a vehicle circles while it waits
inline constexpr double kAtWaitingPlace_m =
    1.5 * kWaitingCircle_m;  ///< a vehicle that is nearer to its place waits there

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
