// BodyGrid: the probability that each square cell of the water around the vehicle is occupied (Ganesan 2015, 3.2
// and 3.4; ledger S6-10, S6-19 to S6-27, S6-68, S6-71).
//
// Cells hold natural log-odds, clamped to [p_min, 1 - p_min]; they are independent. The grid has its own axes G: level,
// and parallel to the level body frame L at construction. L then moves within G. The vehicle stays in its home cell;
// when it leaves that cell, the contents scroll by whole cells. The rest of the displacement and the whole heading are
// carried exactly, so that nothing blurs the grid (S6-25) except the uncertainty of the motion: its covariance
// accumulates until its standard deviation reaches `diffuse_at` cells; then a kernel of exactly that covariance is
// applied. An uncertain heading spreads the contents along circles round the vehicle, by range times its standard
// deviation; up to 15 % of that variance goes outward, where the circle runs along neither a side nor a diagonal of
// the cells.
//
// The options `shifting` and `turning` provide the thesis's own motion for comparison (interpolation at every step; the
// grid turns by 1 degree as soon as the heading has changed by that much).
//
// Frames: L is x forward, y starboard; G is the same at the start, with its origin at the low corner of cell (0, 0).
// Lengths in metres. After construction nothing allocates in the default modes. Errors: the constructor throws Error,
// also where prior >= threshold / 9, which would make unseen water an obstacle (S6-24).
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/angle.hpp>
#include <isobath/base/config.hpp>
#include <isobath/base/time.hpp>
#include <isobath/geometry/cartesian_grid.hpp>
#include <isobath/map/occupancy/motion_kernel.hpp>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

struct BodyGridConfig {
  double cell_m = 1;
  int cells_x = 100;    ///< forward at the start
  int cells_y = 100;    ///< to starboard
  double home_x = 0.5;  ///< the vehicle's position; 1/6 is the centre of the rear third (S6-10)
  double home_y = 0.5;
  double prior = 0.01;
  double p_min = 1e-4;
  double threshold = 0.8;  ///< of the detector; used only to check the prior
  enum class Shifting : std::uint8_t { kWholeCells, kInterpolated, kPrinted } shifting = Shifting::kWholeCells;
  enum class Turning : std::uint8_t { kExact, kResampled } turning = Turning::kExact;
  enum class Moved : std::uint8_t { kSum, kAnyTarget } moved = Moved::kSum;  ///< S6-71
  double diffuse_at = 0.25;  ///< standard deviation of the accumulated motion, in cells, that triggers a diffusion
};

std::vector<Field> fields(BodyGridConfig& config);

/// The echoes behind the probability of a cell. `last_ms` counts from the first echo of the grid.
struct HitEvidence {
  std::uint32_t hits = 0;
  std::uint32_t last_ms = 0;
};

class BodyGrid {
 public:
  explicit BodyGrid(const BodyGridConfig& config);

  [[nodiscard]] const BodyGridConfig& config() const { return config_; }
  [[nodiscard]] const CartesianGrid& cells() const { return cells_; }

  /// Pose of L in G.
  [[nodiscard]] Eigen::Vector2d position() const { return cells_.centre(home_) + offset_; }
  [[nodiscard]] Angle heading() const { return heading_; }
  [[nodiscard]] Eigen::Vector2d to_level_body(const Eigen::Vector2d& p_G) const;
  [[nodiscard]] Eigen::Vector2d from_level_body(const Eigen::Vector2d& p_L) const;
  [[nodiscard]] std::optional<Cell> cell_at(const Eigen::Vector2d& p_L) const {
    return cells_.cell_at(from_level_body(p_L));
  }

  [[nodiscard]] double probability(Cell c) const;
  void set_probability(Cell c, double p);
  /// Free: evidence against an obstacle of at least ln 2 below the prior. Cells neither free nor detected are unknown.
  [[nodiscard]] bool is_free(Cell c) const { return is_free(cells_.index(c)); }
  [[nodiscard]] bool is_free(std::size_t index) const { return log_odds_[index] <= free_below_; }

  /// For the sensor update, which must keep within [log_odds_min, log_odds_max].
  [[nodiscard]] std::span<double> log_odds() { return log_odds_; }
  [[nodiscard]] std::span<const double> log_odds() const { return log_odds_; }
  /// Counts one echo for the cell that explains it best.
  void note_hit(std::size_t index, Time time);
  [[nodiscard]] std::uint32_t hits(std::size_t index) const { return evidence_[index].hits; }
  /// Meaningless where there are no hits.
  [[nodiscard]] Time last_hit(std::size_t index) const {
    return first_hit_ + std::chrono::milliseconds(evidence_[index].last_ms);
  }
  [[nodiscard]] double log_odds_min() const { return -log_odds_max_; }
  [[nodiscard]] double log_odds_max() const { return log_odds_max_; }
  [[nodiscard]] double log_odds_prior() const { return log_odds_prior_; }

  /// The vehicle has moved by `displacement` with the given covariance (both in L before the move, m and m2), then
  /// turned to starboard; `turn_variance` is that of the turn, rad2. The order does not matter for small steps (S6-26).
  void move(const Eigen::Vector2d& displacement, Angle turn, const Eigen::Matrix2d& covariance,
            double turn_variance = 0);

  /// Makes everything unknown again.
  void clear();

 private:
  void scroll();
  void scroll_cells(int dx, int dy);
  void interpolate(const Eigen::Vector2d& content_shift, const Eigen::Matrix2d& covariance);
  void diffuse(const Eigen::Matrix2d& covariance);
  void diffuse_turn(double variance);
  void spread_along_circles(double variance);
  void resample(Angle turn);
  void convolve(const MotionKernel& kernel);
  void read_probabilities();
  void write_probabilities();
  [[nodiscard]] double combined(double sum, double none) const {
    return config_.moved == BodyGridConfig::Moved::kSum ? sum : 1 - none;
  }

  BodyGridConfig config_;
  CartesianGrid cells_;
  Cell home_;
  double log_odds_max_;
  double log_odds_prior_;
  double free_below_;
  Eigen::Vector2d offset_ = Eigen::Vector2d::Zero();           ///< of L from the centre of the home cell
  Eigen::Vector2d evidence_offset_ = Eigen::Vector2d::Zero();  ///< of the evidence from the contents, in cells
  Angle heading_;
  Eigen::Matrix2d pending_ = Eigen::Matrix2d::Zero();  ///< covariance not yet applied, in G
  double pending_turn_ = 0;                            ///< variance of the heading not yet applied, rad2
  std::vector<double> log_odds_;
  std::vector<HitEvidence> evidence_;
  Time first_hit_ = Time::max();
  std::vector<double> old_;  ///< probabilities before and after a motion
  std::vector<double> new_;
};

double log_odds_of(double p);
double probability_of(double log_odds);

}  // namespace isobath
