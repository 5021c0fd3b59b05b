#include <isobath/planning/route_smoothing.hpp>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Way = std::vector<Vector2d>;

constexpr int kRounds = 8;            // of moving corners, for each distance
constexpr double kWorthwhile = 1e-4;  // share of cost

}  // namespace

void pull_straight(Way& way, const HazardMap& map, const RouteGrid& grid, double clearance_m) {
  std::vector<double> cost(way.size(), 0);  // from the start to each point
  const auto measure = [&] {
    for (std::size_t i = 1; i < way.size(); ++i) cost[i] = cost[i - 1] + grid.leg_cost(way[i - 1], way[i]);
  };
  const auto better = [&](std::size_t i, std::size_t j) {
    return grid.leg_cost(way[i], way[j]) <= (cost[j] - cost[i]) * (1 + 1e-9) &&
           map.leg_is_clear(way[i], way[j], clearance_m);
  };
  // 1. along the path, each leg as long as possible
  measure();
  Way pulled = {way.front()};
  for (std::size_t from = 0; from + 1 < way.size();) {
    std::size_t to = from + 1;
    while (to + 1 < way.size() && better(from, to + 1)) ++to;
    pulled.push_back(way[to]);
    from = to;
  }
  // 2. between the corners that are left, the farthest first, until nothing changes
  for (way = std::move(pulled);;) {
    measure();
    pulled = {way.front()};
    for (std::size_t from = 0; from + 1 < way.size();) {
      std::size_t to = way.size() - 1;
      while (to > from + 1 && !better(from, to)) --to;
      pulled.push_back(way[to]);
      from = to;
    }
    if (pulled.size() == way.size()) return;
    way = std::move(pulled);
  }
}

void settle_corners(Way& way, const HazardMap& map, const RouteGrid& grid, double clearance_m) {
  for (double by = 2 * grid.window().cell_m; by > grid.window().cell_m / 8; by /= 2) {
    for (int round = 0; round < kRounds; ++round) {
      bool moved = false;
      for (std::size_t i = 1; i + 1 < way.size(); ++i) {
        const Vector2d &before = way[i - 1], &after = way[i + 1];
        double least = (grid.leg_cost(before, way[i]) + grid.leg_cost(way[i], after)) * (1 - kWorthwhile);
        Vector2d best = way[i];
        for (const GridStep& s : kGridSteps) {
          const Vector2d p = way[i] + by * Vector2d(s.column, s.row);
          const double cost = grid.leg_cost(before, p) + grid.leg_cost(p, after);
          if (cost >= least || !map.leg_is_clear(before, p, clearance_m) || !map.leg_is_clear(p, after, clearance_m))
            continue;
          least = cost;
          best = p;
        }
        moved = moved || best != way[i];
        way[i] = best;
      }
      if (!moved) break;
    }
  }
  pull_straight(way, map, grid, clearance_m);
}

}  // namespace isobath
