// ObstacleMemory: the obstacles that the body grid confirmed, kept in the world for when the vehicle comes back
// (ledger S6-66, S6-F04; Ganesan 2015, 7.2.4 asks for it and leaves it open).
//
// Each is a convex outline in W where navigation put it when it was last seen. Navigation drifts, so that place is
// uncertain relative to the vehicle NOW by what was added since:
//
//   margin = confidence sqrt(s2 + detection_sigma^2),
//   s2 = min(sum |change of var|, var_then + var_now) + (drift_share distance)^2
//
// var is the variance of the position in the plane as navigation states it: dead reckoning alone makes the sum var_now
// - var_then, a fix adds the jump that it made, and independent errors bound both. The distance is the part of the way
// since that navigation gave no variance for.
//
// A sweep is compared with what is remembered where both are now. What is found within their combined uncertainty is
// the same obstacle: it takes the new place and loses its margin, and becomes more certain. The shift that most of the
// sweep agrees on is taken off first: it is drift, and tells which stored obstacle belongs to which seen one; obstacles
// that were not seen do not move by it. Outlines grow to the hull of both, where that swallows no free water and is not
// much larger than both; they shrink to what is seen when all of them was in view several times, and the rest is free.
//
// What is not found where it could be seen loses existence: nine places, the middle and eight at 1.5 sigma around it,
// share the belief of where drift has put it; a sweep that sees a place free multiplies its share by `miss`. What lies
// in unseen water loses nothing. An obstacle is forgotten when its existence is below `least_existence`, it is older
// than `max_age`, or its margin is above `max_margin`: drift does not block free water for ever.
//
// Frames: W north and east; L the level body frame of the sweep; outlines in the positive sense, m. Bounded by `most`:
// what is out of view and least certain goes first. Ids rise and are never given twice. Deterministic. One thread at a
// time. Measured, one core, 300 obstacles: 0.12 ms a sweep that shows thirty of them, 0.08 ms where all are in view and
// none is seen. It does not promise to follow what moves by itself.
#pragma once

#include <array>
#include <cstdint>
#include <isobath/base/config.hpp>
#include <isobath/geometry/cartesian_grid.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/map/obstacle.hpp>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

struct ObstacleMemoryConfig {
  double confidence = 2;         ///< standard deviations of the margin
  double detection_sigma = 0.5;  ///< m, of an outline relative to the vehicle when it is seen
  double drift_share = 0.02;     ///< of the distance travelled, where navigation gives no variance
  double least_seen = 0.8;       ///< existence of an obstacle that is taken in
  int confirmations = 2;         ///< sweeps that must have seen it before it counts
  double unconfirmed_age = 60;   ///< s, after which one that was not seen so often is forgotten
  double miss = 0.35;            ///< chance that a sweep calls the place of an obstacle free
  double least_existence = 0.3;
  double max_age = 7200;   ///< s since it was last seen
  double max_margin = 15;  ///< m
  int clear_looks = 4;     ///< sweeps that must agree before an outline shrinks
  int most = 512;
};

std::vector<Field> fields(ObstacleMemoryConfig& config);

/// Which water a sweep has seen to be free: cells of a grid whose frame G holds L at a position and a heading, as
/// Detection has them. Empty `free`: nothing is known to be free.
struct FreeWater {
  CartesianGrid cells;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  Angle heading;
  std::span<const std::uint8_t> free;  ///< 1: free
};

struct MemorySweep {
  Time time;
  Pose X_WL;
  std::optional<double> sigma_m;  ///< standard deviation of the position in the plane, an axis; empty: not known
  std::span<const Obstacle> obstacles;
  FreeWater water;
};

struct RememberedObstacle {
  std::uint32_t id = 0;
  Polygon outline_W;    ///< north, east
  double margin_m = 0;  ///< how far beyond it the obstacle may reach, as things stand now
  double existence = 0;
  int sightings = 0;
  Time first_seen, last_seen;
  bool whole = false;  ///< the last sweep showed all of it
};

class ObstacleMemory {
 public:
  explicit ObstacleMemory(const ObstacleMemoryConfig& config = {});

  /// Takes in a sweep. False, and nothing happens, where pose, sigma or time are not finite or time runs backwards.
  bool add(const MemorySweep& sweep);

  /// Confirmed obstacles within `radius_m` of a place (north, east), margin included. In order of id.
  [[nodiscard]] std::vector<RememberedObstacle> known(const Eigen::Vector2d& north_east, double radius_m) const;
  /// Those of them that the last sweep did not show whole: for planning.
  [[nodiscard]] std::vector<RememberedObstacle> remembered(const Eigen::Vector2d& north_east, double radius_m) const;
  /// All, in order of id, unconfirmed ones too.
  [[nodiscard]] std::vector<RememberedObstacle> all() const;
  /// As which obstacle each of the last sweep was taken, by id; 0: as none.
  [[nodiscard]] std::span<const std::uint32_t> seen_as() const { return seen_as_; }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  /// The drift that the last sweep has shown since what it saw was stored, in W, m; zero where it showed none.
  [[nodiscard]] const Eigen::Vector2d& shift() const { return shift_; }
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

 private:
  static constexpr std::size_t kPlaces = 9;
  struct Entry {
    RememberedObstacle seen;
    Eigen::Vector2d centre;  ///< of the outline's box
    double radius = 0;       ///< of the circle about it that holds the outline
    double area = 0;
    std::vector<Eigen::Vector2d> samples;  ///< spread over the outline, in W
    std::array<double, kPlaces> belief;    ///< of the places that drift may have put it; sum 1
    double variance = 0;                   ///< of the vehicle when it was last seen, m2
    double wander = 0, unmeasured = 0;     ///< of the memory then
    int clear_looks = 0;
    std::uint64_t sweep = 0;  ///< that last saw it
  };
  struct Sighting {
    Polygon outline_W;
    Eigen::Vector2d centre;
    double radius = 0, area = 0, existence = 0;
    bool doubtful = false;   ///< too weak to be taken in on its own
    std::size_t number = 0;  ///< in its sweep
    std::vector<Eigen::Vector2d> samples;
  };
  struct View;

  void measure_drift(const MemorySweep& sweep);
  [[nodiscard]] double variance_since(const Entry& entry) const;
  [[nodiscard]] std::vector<Sighting> sightings_of(const MemorySweep& sweep) const;
  [[nodiscard]] bool is_stale(const Entry& entry) const;
  [[nodiscard]] Eigen::Vector2d shift_of(const std::vector<Sighting>& sightings) const;
  [[nodiscard]] Entry* match(const Sighting& sighting);
  /// Returns the id of the obstacle that it is a sighting of; 0: of none.
  std::uint32_t take(const Sighting& sighting, const View& view, Time time);
  void see_again(Entry& entry, const Sighting& sighting, Time time);
  [[nodiscard]] bool grow(Entry& entry, const Sighting& sighting, const View& view) const;
  void look_again(Entry& entry, const std::vector<Sighting>& sightings, const View& view) const;
  void look_for_missing(Entry& entry, const View& view) const;
  void drop_contained();
  void forget(Time now);
  void stamp(Entry& entry, Time time) const;
  static void set_outline(Entry& entry, Polygon outline);

  ObstacleMemoryConfig config_;
  std::vector<Entry> entries_;  ///< in order of id
  std::vector<std::uint32_t> seen_as_;
  std::uint32_t next_id_ = 1;
  std::uint64_t sweeps_ = 0;
  std::uint64_t refused_ = 0;
  std::optional<Time> last_time_;
  std::optional<Eigen::Vector2d> last_place_;
  std::optional<double> variance_;  ///< now, m2
  double wander_ = 0;               ///< sum of |change of variance|, m2
  double unmeasured_ = 0;           ///< way without variance, m
  Eigen::Vector2d shift_ = Eigen::Vector2d::Zero();
};

}  // namespace isobath
