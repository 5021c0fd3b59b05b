// ObstacleMemory: the obstacles that the body grid confirmed, kept in the world until the vehicle comes back (ledger
// S6-66, S6-F04; Ganesan 2015, 7.2.4 asks for it and leaves it open).
//
// Each obstacle is a convex outline in W, at the place that navigation gave when it was last seen. Navigation drifts,
// so this place is uncertain relative to the vehicle's PRESENT position by the drift since then:
//
//   margin = confidence sqrt(s2 + detection_sigma^2),
//   s2 = min(sum |change of var|, var_then + var_now) + (drift_share distance)^2
//
// var is the variance of the position in the plane as navigation gives it. Under dead reckoning alone the sum is
// var_now - var_then; a fix adds its jump; independent errors bound both. The distance is the part of the path since
// then for which navigation gave no variance.
//
// When the position jumps, an obstacle moves along if what dead reckoning has drifted since it was last seen is less
// than what the fixes of then and now may be off (var_then + var_now, or the jump itself): it stays where it is
// relative to the vehicle. An obstacle that was last seen longer ago stays where it is in the world (S6-53).
//
// A sweep is compared with the stored obstacles at their present places. A sighting within the combined uncertainty of
// a stored obstacle is the same obstacle: the obstacle takes the new place, loses its margin, and becomes more certain.
// First the shift on which most of the sweep agrees is removed: it is drift, and it shows which stored obstacle belongs
// to which sighting. Obstacles that were not seen do not move with it. Outlines grow to the hull of both, where that
// hull contains no free water and is not much larger than both. An outline shrinks to what is seen when all of it was
// in view several times and the rest of it is free.
//
// An obstacle that is not found where it should be visible loses existence. Nine places, the middle and eight at 1.5
// sigma around it, share the belief of where drift has put it; a sweep that sees a place free multiplies the place's
// share by `miss`. An obstacle in unseen water loses nothing. An obstacle is forgotten when its existence is below
// `min_existence`, it is older than `max_age`, or its margin is above `max_margin`, so that drift does not block free
// water permanently.
//
// Another vehicle may tell of an obstacle. It counts at once, where the teller's navigation had it, with the errors of
// both vehicles as margin, until the own sonar sees it or sees that it is not there. What is stored already, from
// whomever, is not stored again.
//
// Frames: W north and east; L the level body frame of the sweep; outlines in the positive sense, m. At most
// `max_obstacles` obstacles are kept: those out of view and least certain are dropped first. Ids rise and are never
// reused. Deterministic. One thread at a time. Measured, one core, 300 obstacles: 0.12 ms for a sweep that shows thirty
// of them, 0.08 ms where all are in view and none is seen. The memory does not store an obstacle that moves or may
// move, and deletes what it stored of it before.
#pragma once

#include <array>
#include <cstdint>
#include <isobath/base/config.hpp>
#include <isobath/geometry/cartesian_grid.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/map/occupancy/obstacle.hpp>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

struct ObstacleMemoryConfig {
  double confidence = 2;               ///< standard deviations of the margin
  double detection_sigma = 0.5;        ///< m, of an outline relative to the vehicle when it is seen
  double drift_share = 0.02;           ///< of the distance travelled, where navigation gives no variance
  double min_initial_existence = 0.8;  ///< minimum existence of an obstacle that is stored
  int confirmations = 2;               ///< sightings before an obstacle counts
  double unconfirmed_age = 60;  ///< s since the last sighting before an obstacle with fewer sightings is forgotten
  double miss = 0.35;           ///< chance that a sweep sees an obstacle's place as free
  double min_existence = 0.3;
  double max_age = 7200;   ///< s since it was last seen
  double max_margin = 15;  ///< m
  int clear_looks = 4;     ///< sweeps that must agree before an outline shrinks
  int max_obstacles = 512;
};

std::vector<Field> fields(ObstacleMemoryConfig& config);

/// The water that a sweep has seen to be free: cells of a grid whose frame G holds L at a position and a heading, as in
/// Detection. Empty `free`: nothing is known to be free.
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
  Eigen::Vector2d jumped = Eigen::Vector2d::Zero();  ///< sum of all jumps of the position so far, in W, m
};

/// An obstacle as another vehicle tells of it.
struct ToldObstacle {
  int teller = 0;         ///< which vehicle
  std::uint32_t key = 0;  ///< the same each time that the teller tells of this obstacle; others may have it too
  Eigen::Vector2d centre_W = Eigen::Vector2d::Zero();
  double radius_m = 0;
  double sigma_m = 0;  ///< standard deviation of its place by the teller's navigation, an axis
  bool operator==(const ToldObstacle&) const = default;
};

struct RememberedObstacle {
  std::uint32_t id = 0;
  Polygon outline_W;    ///< north, east
  double margin_m = 0;  ///< how far the obstacle may now extend beyond the outline
  double existence = 0;
  int sightings = 0;
  Time first_seen, last_seen;
  bool whole = false;  ///< the last sweep showed all of it
  int number = 0;      ///< Obstacle::number of the obstacle that it was last seen as, or as a piece of
  bool told = false;   ///< another vehicle has told of it, and the own sonar has not seen it yet
};

class ObstacleMemory {
 public:
  explicit ObstacleMemory(const ObstacleMemoryConfig& config = {});

  /// Adds a sweep. Returns false and changes nothing if pose, sigma or time are not finite or time runs backwards.
  bool add(const MemorySweep& sweep);

  /// Adds an obstacle that another vehicle tells of, or moves it to where that vehicle now has it. Returns whether it
  /// is new here. Refuses numbers that are not finite, and a radius that is not above 0.
  bool tell(const ToldObstacle& told, Time now);

  /// Confirmed obstacles within `radius_m` of a place (north, east), margin included. In order of id.
  [[nodiscard]] std::vector<RememberedObstacle> known(const Eigen::Vector2d& north_east, double radius_m) const;
  /// For each obstacle of the last sweep, the id of the stored obstacle that it belongs to; 0: none.
  [[nodiscard]] std::span<const std::uint32_t> seen_as() const { return seen_as_; }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  /// The drift between stored places and the last sweep, in W, m; zero where the sweep showed none.
  [[nodiscard]] const Eigen::Vector2d& shift() const { return shift_; }
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

 private:
  static constexpr std::size_t kPlaces = 9;
  static constexpr double kSurest = 0.99;  ///< maximum existence, so that evidence to the contrary still counts
  struct Entry {
    RememberedObstacle seen;
    Eigen::Vector2d centre;  ///< of the outline's box
    double radius = 0;       ///< of the circle about the centre that contains the outline
    double area = 0;
    std::vector<Eigen::Vector2d> samples;  ///< spread over the outline, in W
    std::array<double, kPlaces> belief;    ///< over the places where drift may have put it; sum 1
    double variance = 0;                   ///< of the vehicle's position when it was last seen, m2
    double wander = 0, unmeasured = 0;     ///< of the memory at that time
    int clear_looks = 0;
    std::uint64_t sweep = 0;  ///< the last one that saw it
    int teller = 0;           ///< who told of it, while `seen.told`
    std::uint32_t key = 0;
  };
  struct Sighting {
    Polygon outline_W;
    Eigen::Vector2d centre;
    double radius = 0, area = 0, existence = 0;
    bool doubtful = false;  ///< too weak to be stored as a new obstacle
    std::size_t index = 0;  ///< in its sweep
    int number = 0;         ///< Obstacle::number
    std::vector<Eigen::Vector2d> samples;
  };
  struct View;

  static void believe_middle(Entry& entry);
  [[nodiscard]] double margin_of(const Entry& entry) const;
  void take_told(Entry& entry, const ToldObstacle& told, Time now);
  void measure_drift(const MemorySweep& sweep);
  void move_along(const Eigen::Vector2d& by_W, const std::optional<double>& variance, double changed);
  [[nodiscard]] double modelled_since(const Entry& entry) const;
  [[nodiscard]] double variance_since(const Entry& entry) const;
  [[nodiscard]] std::vector<Sighting> sightings_of(const MemorySweep& sweep) const;
  [[nodiscard]] bool is_stale(const Entry& entry) const;
  [[nodiscard]] static bool similar(double area_a, double area_b) {
    return area_a < 2.5 * area_b && area_b < 2.5 * area_a;
  }
  [[nodiscard]] Eigen::Vector2d shift_of(const std::vector<Sighting>& sightings) const;
  [[nodiscard]] Entry* match(const Sighting& sighting);
  /// Returns the id of the obstacle that the sighting belongs to; 0: none.
  std::uint32_t take(const Sighting& sighting, const View& view, Time time);
  void see_again(Entry& entry, const Sighting& sighting, Time time);
  [[nodiscard]] bool grow(Entry& entry, const Sighting& sighting, const View& view) const;
  void look_again(Entry& entry, const std::vector<Sighting>& sightings, const View& view) const;
  void look_for_missing(Entry& entry, const View& view) const;
  void drop_contained();
  void drop_moving(const MemorySweep& sweep);
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
  std::optional<double> variance_;                    ///< now, m2
  double wander_ = 0;                                 ///< sum of |change of variance|, m2
  double unmeasured_ = 0;                             ///< distance travelled without variance, m
  Eigen::Vector2d jumped_ = Eigen::Vector2d::Zero();  ///< MemorySweep::jumped of the last sweep
  Eigen::Vector2d shift_ = Eigen::Vector2d::Zero();
};

}  // namespace isobath
