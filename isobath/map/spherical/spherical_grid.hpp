// SphericalGrid: a first model of the water within sonar range, centred on the vehicle: the echoes by direction and
// range, from the present position and from earlier ones (Auran, Silven 1995; ledger S4-01, S4-03, S4-06, S4-11, S4-13
// to S4-15, S4-21 to S4-24, S4-E05, S4-E07, S4-E09, S4-E10).
//
// Directions are buckets of equal angles, ranges are geometric layers, and only touched cells exist
// (spherical_cells.hpp); clear_views.hpp records how far the water was seen to be clear.
// perception/spherical_mapper.hpp decides what a reading says about cells. Cells are independent; their state is a
// log-odds.
//
// Frames. G: origin at the vehicle, x', y', z' up, as of S4-02; callers use G. T: the axes that G had at the start;
// cells are fixed in T. `turn` changes only the angle between the two, of which the table takes whole buckets (S4-21):
// a bucket of G is accurate to half a bucket, points (`point_of`) are exact.
//
// Motion. The grid stays level: a vehicle that pitches or rolls tilts its beams, not the grid (S4-22). The contents of
// cells move exactly, by their mean and their spread; cells are re-binned when the vehicle has moved by `rebin_at` of
// the finest layer. A content that is wider than its new cell is split in two, repeatedly, so that an approached wall
// has no holes; contents that meet in one cell merge. Splitting and merging keep the number of echoes and the first two
// moments, so that moving to and fro spreads nothing. Cells that leave the range are handed over (`on_dropped`). Above
// 75 degrees of elevation cells are narrower than their contents; there may be holes there.
//
// Cost (bench/README.md): an emptiness test is two look-ups; 20,000 cells are re-binned within 2 ms. After warm-up
// nothing allocates. Errors: the constructor throws Error. One thread.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <isobath/base/config.hpp>
#include <isobath/map/spherical/clear_views.hpp>
#include <isobath/map/spherical/spherical_cells.hpp>
#include <isobath/map/spherical/spherical_layers.hpp>
#include <optional>

namespace isobath {

struct SphericalGridConfig {
  double min_layer_m = 0.15;           ///< D0
  Angle bucket = Angle::degrees(2.5);  ///< of azimuth and elevation
  double range_m = 50;
  double prior = 0.01;       ///< of an unseen cell
  double occupied = 0.3;     ///< a cell is an obstacle from this on: one echo gives its cells 0.3 to 0.5
  double max_log_odds = 10;  ///< magnitude
  enum class Merging : std::uint8_t { kLargest, kDensity } merging = Merging::kLargest;
  double rebin_at = 0.5;    ///< of the finest layer
  int lock_echoes = 5;      ///< a cell locks after so many echoes; 0: none does
  int lock_scans = 2;       ///< in so many scans
  double lock_state = 0.9;  ///< and with this probability (S4-14)
  int views = 32;           ///< of clear water that are remembered
  double view_apart_m = 1;
};
std::vector<Field> fields(SphericalGridConfig& config);

struct SphericalPlace {
  SphericalDirection direction;
  int layer = 0;
  auto operator<=>(const SphericalPlace&) const = default;
};

class SphericalGrid {
 public:
  explicit SphericalGrid(const SphericalGridConfig& config = {});
  SphericalGrid(const SphericalGrid&) = delete;
  SphericalGrid& operator=(const SphericalGrid&) = delete;

  [[nodiscard]] const SphericalGridConfig& config() const { return config_; }
  [[nodiscard]] const SphericalLayers& layers() const { return layers_; }
  [[nodiscard]] const DirectionBuckets& buckets() const { return buckets_; }
  [[nodiscard]] const SphericalCells& cells() const { return cells_; }
  [[nodiscard]] std::size_t bytes() const { return cells_.bytes() + views_.bytes(); }

  // Places.
  // ------------------------------------------------------------------------------------------------------------
  [[nodiscard]] Eigen::Vector3d to_table(const Eigen::Vector3d& p_G) const;
  [[nodiscard]] Eigen::Vector3d from_table(const Eigen::Vector3d& p_T) const;
  /// Mean of a cell's content, in G.
  [[nodiscard]] Eigen::Vector3d point_of(const SphericalCell& cell) const { return from_table(cell.point()); }
  /// Empty beyond the range.
  [[nodiscard]] std::optional<SphericalPlace> place_at(const Eigen::Vector3d& p_T) const;
  /// The middle of a cell, in T; the axis of a direction.
  [[nodiscard]] Eigen::Vector3d middle_in_table(const SphericalPlace& place) const {
    return layers_.middle(place.layer) * axis_in_table(place.direction);
  }
  [[nodiscard]] Eigen::Vector3d axis_in_table(const SphericalDirection& d) const {
    return buckets_.middle(unturned(d));
  }

  // What is known.
  // -----------------------------------------------------------------------------------------------------
  /// Whether there was no echo in this direction (S4-11); u_G of any length but 0.
  [[nodiscard]] bool is_empty(const Eigen::Vector3d& u_G) const { return !cells_.any(direction_of(u_G)); }
  /// Whether a point was seen to be in clear water.
  [[nodiscard]] bool was_clear(const Eigen::Vector3d& p_G) const { return views_.is_clear(to_table(p_G)); }
  [[nodiscard]] SphericalDirection direction_of(const Eigen::Vector3d& u_G) const;
  [[nodiscard]] double log_odds(const SphericalPlace& place) const;
  [[nodiscard]] double prior_log_odds() const { return prior_; }
  [[nodiscard]] double occupied_log_odds() const { return occupied_; }
  /// Whether an echo made the cell an obstacle.
  [[nodiscard]] bool is_obstacle(const SphericalCell& cell) const {
    return cell.holds_echo() && static_cast<double>(cell.log_odds) >= occupied_;
  }
  [[nodiscard]] static double probability(const SphericalCell& cell);

  // Echoes.
  // ------------------------------------------------------------------------------------------------------------
  /// Starts a new scan; later echoes belong to it.
  void begin_scan() { ++scan_; }
  /// Counts an echo at a point in the cell that contains it; `sigma_m` is that of its range. Empty beyond the range.
  std::optional<SphericalPlace> add_echo(const Eigen::Vector3d& p_G, double sigma_m, Time time);
  /// Makes the cell if there is none; a locked one keeps its state (S4-14). The value is clamped.
  void set_log_odds(const SphericalPlace& place, double log_odds);
  /// A known surface passes through this point, about `edge_m` across: locks and flags the cell (S4-15).
  void add_known(const Eigen::Vector3d& p_G, double edge_m);
  /// Adds the content of a cell of another grid, without its state and its lock (S4-17).
  void add_content(const Eigen::Vector3d& p_G, const SphericalCell& other);
  /// There was no echo along u_G, within half_width of it, on this stretch.
  void add_clear(const Eigen::Vector3d& from_G, const Eigen::Vector3d& u_G, Angle half_width,
                 const ClearViews::Stretch& clear, Time time);
  /// Applies l = l_0 + (l - l_0) exp(-elapsed / tau) to every cell that is not locked, and forgets those that are
  /// hardly above the prior, or below it. Also forgets views of clear water without a look for tau (S4-50).
  void decay(Duration elapsed, Duration tau, Time now);
  /// Copies another grid of the same configuration, for readers in other threads (grid_snapshots.hpp).
  void copy_from(const SphericalGrid& other);

  // Motion.
  // ------------------------------------------------------------------------------------------------------------
  /// The vehicle has moved by a displacement, in G (S4-23).
  void translate(const Eigen::Vector3d& displacement_G);
  /// Adds a turn about z' to all azimuths (S4-21): a turn of the vehicle to starboard.
  void turn(Angle turn);
  [[nodiscard]] Angle turned() const { return turned_; }
  /// The part of the turn that the table has not taken: at most half a bucket.
  [[nodiscard]] Angle remainder() const;
  /// Gets each cell that leaves the range, once, and its content's mean in G at the vehicle's present pose (S4-24).
  using Dropped = std::function<void(const SphericalCell& cell, const Eigen::Vector3d& p_G)>;
  void on_dropped(Dropped dropped) { dropped_ = std::move(dropped); }

 private:
  [[nodiscard]] SphericalDirection turned(SphericalDirection d) const {
    d.azimuth += cells_.directions().turned();
    if (d.azimuth >= buckets_.azimuths()) d.azimuth -= buckets_.azimuths();
    return d;
  }
  [[nodiscard]] SphericalDirection unturned(SphericalDirection d) const {
    d.azimuth -= cells_.directions().turned();
    if (d.azimuth < 0) d.azimuth += buckets_.azimuths();
    return d;
  }
  void fill(SphericalCell& cell, const SphericalPlace& place) const;
  void maybe_lock(SphericalCell& cell) const;
  [[nodiscard]] double clamped(double log_odds) const;
  // spherical_motion.cpp
  void rebin(const Eigen::Vector3d& t);
  struct Fit {
    enum Axis : std::uint8_t { kRange, kAzimuth, kElevation, kFits, kBeyond };
    std::uint32_t direction;  ///< of T, elevation within azimuth
    std::uint16_t layer;
    Axis widest;     ///< the cell axis along which the content is widest, if too wide
    float variance;  ///< along that axis
  };
  [[nodiscard]] Fit fit(const SphericalCell& content) const;
  SphericalCell halve(SphericalCell& content, const Fit& f) const;
  void split_wide();
  void gather();
  void merge(SphericalCell& into, const SphericalCell& other) const;

  SphericalGridConfig config_;
  SphericalLayers layers_;
  DirectionBuckets buckets_;
  double prior_, occupied_;  ///< log-odds
  SphericalCells cells_;
  ClearViews views_;
  std::uint32_t scan_ = 0;
  Angle turned_;
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();  ///< p_TG: of the vehicle since the last re-binning
  Dropped dropped_;
  std::vector<float> room_of_layer_;  ///< thickness squared
  // Buffers of a motion: contents in any order, their targets, and their order by direction.
  std::vector<SphericalCell> contents_;
  std::vector<Fit> fits_;
  std::vector<std::uint32_t> halved_, starts_, order_;
};

/// Grid axes for vectors in W relative to the vehicle: x' east, y' north, z' up (S4-19).
inline Eigen::Vector3d grid_axes_from_world(const Eigen::Vector3d& v_W) { return {v_W.y(), v_W.x(), -v_W.z()}; }
inline Eigen::Vector3d world_from_grid_axes(const Eigen::Vector3d& v_G) { return {v_G.y(), v_G.x(), -v_G.z()}; }

}  // namespace isobath
