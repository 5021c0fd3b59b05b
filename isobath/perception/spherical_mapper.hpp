// SphericalMapper: inserts range readings into a spherical grid (Auran, Silven 1995, 4.1, 5; ledger S4-01, S4-05,
// S4-19, S4-20, S4-27, S4-28, S4-30, S4-50, S4-E04, S4-E08).
//
// An echo is counted in the cell that contains it, and changes the state of the cells around it (ReadingGaussian). Two
// rules:
//   maximum_response  the paper's: state = max(state, density at the cell's middle over its peak). A repeated echo
//                     changes nothing, and no cell is ever cleared.
//   log_odds          Lambda = -ln(1 - P), the expected number of objects in a cell, is proportional to volume. A
//                     reading adds kappa x its mass in the cell, kappa = -ln(1 - hit), so merged cells have the state
//                     of a coarser grid. Cells before the echo keep Lambda (1 - pass x share), share the beam's power
//                     there. All cells fade to the prior with `tau_s`.
// The grid also stores the range to which the water was clear.
//
// Frames: readings come with X_WB. The grid is at the origin of B, its axes level: x' east, y' north (north_up), or
// x' starboard, y' ahead (course_up). Lever arms of the sonar move the echo, and the Gaussian is about the line from
// the grid's origin: exact if the arm is short against the range. Steps after warm-up allocate nothing. One thread.
#pragma once

#include <isobath/map/spherical/spherical_grid.hpp>
#include <isobath/perception/reading_gaussian.hpp>
#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/ping.hpp>
#include <isobath/sonar/range_reading.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

struct SphericalMapperConfig {
  enum class Rule : std::uint8_t { kLogOdds, kMaximumResponse } rule = Rule::kLogOdds;
  enum class Axes : std::uint8_t { kNorthUp, kCourseUp } axes = Axes::kNorthUp;
  double sigma_m = 0.15;
  double sigma_share = 0.003;
  double mask = 2;     ///< standard deviations about an echo in which cells change
  int max_cells = 75;  ///< maximum number of cells that one echo changes
  double hit = 0.9;
  double pass = 0.5;
  double tau_s = 600;  ///< 0: no fading
  /// Minimum contrast of an echo of a ping (nearest_clear_echo). An echo of nearest_dense_echo counts at any contrast.
  /// 0: every decision for an echo counts.
  double contrast = 0;
};
std::vector<Field> fields(SphericalMapperConfig& config);

/// One beam, in the axes G of the grid.
struct SphericalLook {
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitY();
  Angle width;                    ///< full, half power
  std::optional<double> range_m;  ///< empty: no echo
  double max_range_m = 0;
  Time time{};
  double sigma_m = 0;  ///< standard deviation of the range, where it is stated and greater than the configured one
  /// The ranges between which the beam tells whether the water is clear.
  ClearViews::Stretch told{.to_m = std::numeric_limits<double>::infinity()};
};

class SphericalMapper {
 public:
  static constexpr double kAboutVehicle_m = 3;  ///< blind zones of imaging sonars reach 1 to 2 m

  /// `grid` must outlive the mapper.
  SphericalMapper(const SphericalMapperConfig& config, SphericalGrid& grid);

  /// Moves the grid to the vehicle, turns it (course_up) and fades it.
  void move_to(const Pose& X_WB, Time time);
  void begin_scan() { grid_.begin_scan(); }
  void update(const RangeReading& reading, const Pose& X_WB);
  /// Inserts the nearest echo of each beam of the decisions; a beam of a fan is treated as a cone of its width. Beams
  /// within one bucket of directions are taken together. Water counts as clear only where the bins tell something, but
  /// for gaps that are no longer than a layer, and for a blind zone of up to kAboutVehicle_m: the vehicle itself is
  /// there. Beyond a longer gap nothing counts as clear.
  void update(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB);
  void add(const SphericalLook& look);

  /// Turns a vector of W components into the axes of the turned grid.
  [[nodiscard]] Eigen::Vector3d to_grid(const Eigen::Vector3d& v_W) const;
  [[nodiscard]] const SphericalGrid& grid() const { return grid_; }

 private:
  struct Heard {
    std::optional<double> range_m;  ///< of the nearest echo
    ClearViews::Stretch told;       ///< where the beam tells whether the water is clear
  };
  [[nodiscard]] Heard heard(const Ping& ping, const EchoDecisions& decisions, int beam) const;
  void hit(const ReadingGaussian& reading);
  void pass(const ReadingGaussian& reading, const ClearViews::Stretch& clear);
  void look_from(const Pose& X_WS, const Eigen::Vector3d& u_S, const SphericalLook& look);

  SphericalMapperConfig config_;
  SphericalGrid& grid_;
  double kappa_;
  std::optional<Pose> X_WB_;
  Time faded_{};
  std::vector<TouchedCell> touched_;
  std::vector<TouchedDirection> directions_;
  std::vector<Heard> beams_;
};

/// Resolution of a sonar, from its data sheet.
struct SonarResolution {
  std::string name;
  double range_m = 50;
  double resolution_m = 0.15;
  Angle beam_width = Angle::degrees(2.5), beam_spacing = Angle::degrees(2.5);
  int beams = 144;  ///< of a ping; 1: a head that turns all round
  /// That a ping of the sonar, or a turn of its head, covers.
  [[nodiscard]] Angle sector() const { return beams == 1 ? Angle::degrees(360) : beam_spacing * beams; }
};
/// em_1000_shallow (60 beams 2.5 degrees apart: 150 degrees, S4-E01), wesmar_ss150, simulated_2_5. Throws Error for
/// others (S4-36).
SonarResolution listed_resolution(const std::string& name);
/// A grid as fine as the sonar: the finest layer has the sonar's range resolution; buckets have at most the beams'
/// spacing and divide half a turn into equal parts (S4-05).
SphericalGridConfig grid_for(const SonarResolution& sonar);
/// A message if the grid is coarser than the sonar; empty if it is not.
std::string coarser_than_sonar(const SphericalGridConfig& grid, const SonarResolution& sonar);

}  // namespace isobath
