// Mission risk: the cost of a path through threats (Oskard 1990, III-D; ledger S1-37).
//
// A probability per pixel means nothing without the distance over which it was met. The grid therefore holds its rate:
// lambda = -ln(1 - p) / L for probability p over a reference length L, so that over a length l the probability is
// 1 - exp(-lambda l). Survival multiplies, so the cost is additive: sum lambda l over the pixels of the path, each with
// the exact length of the path within it; finer sampling of the path changes nothing. Rates of independent threats
// (detection, destruction) add.
//
// Points are (north, east) of W, m. The part of a path outside the grid is not judged; its length is reported. Pure
// functions.
#pragma once

#include <Eigen/Core>
#include <isobath/map/depth/mission_map.hpp>
#include <span>
#include <vector>

namespace isobath {

/// 1/m. p in [0, 1]; 1 gives an infinite rate.
double rate_of_probability(double probability, double reference_m);

/// One threat: rates by rows from the north-west of the window.
struct RiskGrid {
  PixelGrid grid;
  PixelWindow window;
  std::vector<double> rate_per_m;  ///< at least 0

  [[nodiscard]] double rate_of(Pixel cell) const {
    const auto row = static_cast<std::size_t>(cell.row - window.row);
    return rate_per_m[row * static_cast<std::size_t>(window.width) +
                      static_cast<std::size_t>(cell.column - window.column)];
  }
  /// 0 outside.
  [[nodiscard]] double rate_at(const Eigen::Vector2d& north_east) const {
    const Pixel cell = grid.at(north_east);
    return window.contains(cell) ? rate_of(cell) : 0;
  }
};

enum class Threat : std::uint8_t { kDetection, kDestruction, kAny };
/// The rates of a threat over the cells of the mission map.
RiskGrid risk_of(const MissionMap& map, Threat threat);

struct PathRisk {
  double cost = 0;      ///< -ln of the probability that nothing happens
  double judged_m = 0;  ///< length inside the grid
  double outside_m = 0;

  [[nodiscard]] double probability() const;
  PathRisk& operator+=(const PathRisk& other);
};

PathRisk path_risk(const RiskGrid& risk, std::span<const Eigen::Vector2d> path);

}  // namespace isobath
