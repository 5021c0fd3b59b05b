#include <algorithm>
#include <isobath/mission/plan/lane_sharing.hpp>
#include <limits>
#include <numeric>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kNever = std::numeric_limits<double>::infinity();

/// The rows of the vehicles in this order: row i is [ends[i - 1], ends[i]) of the open lanes.
struct Division {
  std::vector<std::size_t> ends;
  double last_s = kNever;
};

/// `time_s` (vehicle, begin, end): how long a vehicle takes for a row.
template <class Time>
Division divide(std::size_t lanes, const std::vector<std::size_t>& order, const Time& time_s) {
  std::vector<std::vector<double>> best(order.size() + 1, std::vector<double>(lanes + 1, kNever));
  std::vector<std::vector<std::size_t>> from(order.size() + 1, std::vector<std::size_t>(lanes + 1, 0));
  best[0][0] = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t end = 0; end <= lanes; ++end) {
      for (std::size_t begin = 0; begin <= end; ++begin) {
        const double last_s = std::max(best[i][begin], time_s(order[i], begin, end));
        if (!(last_s < best[i + 1][end])) continue;
        best[i + 1][end] = last_s;
        from[i + 1][end] = begin;
      }
    }
  }
  Division division{std::vector<std::size_t>(order.size()), best[order.size()][lanes]};
  std::size_t end = lanes;
  for (std::size_t i = order.size(); i > 0; --i) {
    division.ends[i - 1] = end;
    end = from[i][end];
  }
  return division;
}

/// Orders of the vehicles along the area to compare.
std::vector<std::vector<std::size_t>> orders_of(std::span<const LaneSailor> sailors, const Vector2d& aside) {
  std::vector<std::size_t> order(sailors.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<std::vector<std::size_t>> all;
  if (sailors.size() <= kOrdered) {
    do {
      all.push_back(order);
    } while (std::next_permutation(order.begin(), order.end()));
    return all;
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return sailors[a].place_W.dot(aside) < sailors[b].place_W.dot(aside);
  });
  all.push_back(order);
  std::reverse(order.begin(), order.end());
  all.push_back(order);
  return all;
}

}  // namespace

std::vector<LaneVisit> visits_of(std::span<const Lane> lanes, std::span<const std::size_t> order,
                                 const Vector2d& place_W) {
  std::vector<LaneVisit> visits;
  Vector2d here = place_W;
  for (const std::size_t k : order) {
    const bool backwards = (lanes[k].to_W - here).norm() < (lanes[k].from_W - here).norm();
    visits.push_back({k, backwards});
    here = backwards ? lanes[k].from_W : lanes[k].to_W;
  }
  return visits;
}

std::vector<std::size_t> stations_of(std::span<const LaneVisit> visits, const SearchArea& area) {
  std::vector<std::size_t> points;
  const std::size_t stations = area.stations();
  for (const LaneVisit& visit : visits) {
    for (std::size_t i = area.is_run_out(0) ? 1 : 0; i < stations; ++i) {
      points.push_back(visit.lane * stations + (visit.backwards ? stations - 1 - i : i));
    }
  }
  return points;
}

double sailing_s(std::span<const Lane> lanes, std::span<const std::size_t> order, const LaneSailor& sailor,
                 const SailingRules& rules) {
  if (order.empty()) return 0;
  Vector2d here = sailor.place_W;
  double way_m = 0;
  for (const LaneVisit& visit : visits_of(lanes, order, sailor.place_W)) {
    const Lane& lane = lanes[visit.lane];
    way_m += ((visit.backwards ? lane.to_W : lane.from_W) - here).norm() + lane.length_m();
    here = visit.backwards ? lane.from_W : lane.to_W;
  }
  return sailor.ready_s + way_m / rules.speed + rules.turn_s * static_cast<double>(order.size() - 1);
}

LaneShares share_lanes(std::span<const Lane> lanes, std::span<const std::size_t> open,
                       std::span<const LaneSailor> sailors, const SailingRules& rules) {
  LaneShares shares;
  shares.lanes.resize(sailors.size());
  if (open.empty() || sailors.empty()) return shares;
  const Vector2d aside = lanes[open.back()].at(0.5) - lanes[open.front()].at(0.5);
  shares.last_s = kNever;
  for (const bool ascending : {true, false}) {
    std::vector<std::size_t> row(open.begin(), open.end());
    if (!ascending) std::reverse(row.begin(), row.end());
    std::vector<std::vector<std::vector<double>>> times(sailors.size());
    for (std::size_t v = 0; v < sailors.size(); ++v) {
      times[v].assign(row.size() + 1, std::vector<double>(row.size() + 1, 0));
      for (std::size_t begin = 0; begin < row.size(); ++begin) {
        for (std::size_t end = begin + 1; end <= row.size(); ++end) {
          times[v][begin][end] = sailing_s(lanes, std::span(row).subspan(begin, end - begin), sailors[v], rules);
        }
      }
    }
    for (const std::vector<std::size_t>& order : orders_of(sailors, aside)) {
      const Division division =
          divide(row.size(), order, [&](std::size_t v, std::size_t b, std::size_t e) { return times[v][b][e]; });
      if (!(division.last_s < shares.last_s)) continue;
      shares.last_s = division.last_s;
      shares.ascending = ascending;
      std::size_t begin = 0;
      for (std::size_t i = 0; i < order.size(); ++i) {
        shares.lanes[order[i]].assign(row.begin() + static_cast<std::ptrdiff_t>(begin),
                                      row.begin() + static_cast<std::ptrdiff_t>(division.ends[i]));
        begin = division.ends[i];
      }
    }
  }
  return shares;
}

}  // namespace isobath
