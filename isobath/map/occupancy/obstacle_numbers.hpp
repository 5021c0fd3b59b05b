// ObstacleNumbers: gives each obstacle a number that it keeps from scan to scan, so that tables, pages and the reasons
// of decisions speak of the same obstacle by the same number.
//
// A detector numbers the obstacles of one scan afresh, each with all its convex pieces (Obstacle::number). `keep`
// replaces these numbers: an obstacle of the scan gets the number of the known obstacle whose outlines, where it was
// last seen, it overlaps most; without overlap, that of the nearest one within kSame_m; else the next number. Numbers
// count from 1, nearest first among those that are new in a scan, and are never reused.
//
// A number goes to one obstacle of a scan. Where an obstacle falls apart, the part with the largest overlap keeps the
// number. Where two grow together, the whole takes the number of the one that it overlaps more; the other number stays
// at its place and returns when they separate.
//
// An obstacle that is known to move is looked for where its velocity has brought it. Not promised: an obstacle of
// unknown velocity that moves more than its size and kSame_m from one scan to the next, and one that was away while the
// position drifted farther than that, get a new number. At most kMax obstacles are known; the one unseen for longest is
// dropped first.
//
// Outlines in L at the scan; known ones in W, m. Deterministic. One thread.
#pragma once

#include <cstdint>
#include <isobath/geometry/pose.hpp>
#include <isobath/map/occupancy/obstacle.hpp>
#include <span>
#include <vector>

namespace isobath {

class ObstacleNumbers {
 public:
  static constexpr double kSame_m = 2;
  static constexpr std::size_t kMax = 512;

  /// Renumbers the pieces of one scan, which come nearest first.
  void keep(std::span<Obstacle> pieces, const Pose& X_WL, Time time = {});
  /// The estimated position jumped: the known obstacles move along, as the water around the vehicle does.
  void move(const Eigen::Vector2d& by_W);
  /// Forgets the obstacles but not how far numbers have been given: the time starts anew.
  void forget() { known_.clear(); }

 private:
  /// The outlines of one obstacle, with the box around them.
  struct Place {
    std::vector<Polygon> outlines_W;
    Eigen::AlignedBox2d box;
    Eigen::Vector2d velocity_W = Eigen::Vector2d::Zero();

    void move(const Eigen::Vector2d& by_W);
  };
  struct Known {
    int number = 0;
    Place place;
    std::uint64_t scan = 0;  ///< that saw it last
    Time time = {};          ///< for which its place holds
  };
  struct Region {
    int number_in_scan = 0;
    Place place;
    int number = 0;  ///< 0: none yet
  };
  [[nodiscard]] static std::vector<Region> regions_of(std::span<const Obstacle> pieces, const Pose& X_WL);
  void match(std::vector<Region>& regions);
  void remember(Region& region, Time time);
  void drop_the_oldest();

  std::vector<Known> known_;  ///< in the order of their numbers
  int last_ = 0;              ///< the last number that was given
  std::uint64_t scan_ = 0;
};

}  // namespace isobath
