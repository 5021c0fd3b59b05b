// PilotSearch: the safest, most efficient path over the pixels of a depth map, by A* (Oskard 1990, III-D; ledger
// S1-42).
//
// The search leads from pixel centre to pixel centre over eight neighbours. A step is possible where the corridor of
// the vehicle's half-width between both centres is clear (traversability S1-41, strict: unknown is not clear, no corner
// is cut), so that the whole path is clear. Its cost is
//   length - w integral ln T ds + t integral lambda ds
// T is the fraction of clear pixels within `risk_reach_m` (a square), lambda the rate of the threats of the mission map
// (mission_risk, S1-37, S1-78), both by the trapezoid rule a step. w is the detour in metres that one e-fold of
// traversability is worth per metre of path, t the detour that one e-fold less chance of passing unharmed is worth;
// w = t = 0 gives the shortest path. The straight line over eight directions never overestimates the cost, since T <= 1
// and lambda >= 0: the path is the cheapest of the grid. Corners are then left out where a straight leg is clear and
// costs no more.
//
// To search the blocks of a coarser map, pass a field whose pixels are the blocks' minimum depths. To replan, call it
// again; `traversability` of the returned path says when.
//
// The search has one depth, that of the deeper end; points (north, east, depth) in W, m, of the vehicle's lowest part.
// Pure: same input, same path. Cost on one core: 0.05 us per pixel of the area to prepare, 1 us per expanded pixel.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/planning/mission_risk.hpp>
#include <isobath/planning/traversability.hpp>
#include <span>
#include <vector>

namespace isobath {

struct PilotSearchConfig {
  PassageConfig passage;
  double risk_weight = 1;         ///< w
  double risk_reach_m = 5;        ///< must be at least the half-width to see more than the search does
  double threat_weight_m = 1000;  ///< t
  double margin_m = 50;           ///< searched around the box of start and goal
  int max_expanded = 1'000'000;   ///< pixels, the budget
};

std::vector<Field> fields(PilotSearchConfig& config);

enum class PilotRefusal : std::uint8_t {
  kNotFinite,
  kAreaTooLarge,  ///< above kMaxSearchedPixels
  kStartBlocked,
  kGoalBlocked,
  kNoPath,
  kOutOfBudget,
};
const char* to_text(PilotRefusal refusal);

inline constexpr std::int64_t kMaxSearchedPixels = 1 << 24;

struct PilotPath {
  std::vector<Eigen::Vector3d> points;  ///< start, corners, goal
  double cost = 0;                      ///< of the grid's path, from the start's pixel to the goal's
  double length_m = 0;                  ///< likewise
  std::int64_t queries = 0;             ///< steps whose corridor was checked
  std::int64_t expanded = 0;
  std::uint64_t map_version = 0;
};

Result<PilotPath, PilotRefusal> search_path(const DepthField& map, const Eigen::Vector3d& start,
                                            const Eigen::Vector3d& goal, const PilotSearchConfig& config,
                                            std::span<const ChartObstacle> chart = {},
                                            const RiskGrid* threats = nullptr);

}  // namespace isobath
