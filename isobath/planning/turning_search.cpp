#include <algorithm>
#include <cmath>
#include <isobath/planning/turning.hpp>
#include <isobath/planning/turning_search.hpp>
#include <numbers>
#include <queue>
#include <unordered_map>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Way = std::vector<Vector2d>;
using std::numbers::pi;

constexpr int kHeadings = 16;
constexpr double kTurn = 2 * pi / kHeadings;
constexpr std::size_t kHalfCircle = 6;  // corners of turn_towards
constexpr int kMore = 300;              // states expanded after a first path that ends with more than half a circle
constexpr double kTurningCosts = 1.05;  // times straight on: of equally long paths the straighter one

struct State {
  Vector2d place;
  int heading = 0;  ///< in steps from the first
  double cost = 0;
  std::int32_t parent = -1;
  std::optional<Vector2d> corner = {};  ///< on the way here from the parent
};

struct Open {
  double bound;
  std::int32_t state;
};
struct Later {
  bool operator()(const Open& a, const Open& b) const {
    return a.bound != b.bound ? a.bound > b.bound : a.state < b.state;  // of equal ones the last found
  }
};

class TurningSearch {
 public:
  TurningSearch(const RouteGrid& grid, const TurningTask& task,
                const std::function<bool(const Vector2d&, const Vector2d&)>& clear)
      : grid_(grid),
        task_(task),
        clear_(clear),
        rest_(grid, grid.window().columns, grid.window().rows, grid.window().cell_m),
        tangent_(task.radius_m * std::tan(kTurn / 2)),
        straight_(std::max(task.radius_m * kTurn, grid.window().cell_m)) {}

  std::optional<Way> run() {
    const auto goal = grid_.window().at(task_.goal);
    if (!goal) return std::nullopt;
    // 1. the cost from every cell to the goal: all cells that can be reached from the goal; no cell ends that search
    rest_.run(*goal, grid_.window().size(), std::numeric_limits<std::int64_t>::max());
    // 2. the states
    for (int k = 0; k < (task_.heading ? 1 : kHeadings); ++k) offer({task_.start, k});
    std::optional<Way> circling;
    double least = INFINITY;
    int most = task_.max_expanded;
    for (int expanded = 0; !open_.empty() && expanded < most;) {
      const std::int32_t best = open_.top().state;
      open_.pop();
      const State here = states_[static_cast<std::size_t>(best)];
      if (here.cost > cheapest_.at(key_of(here).value())) continue;
      ++expanded;
      if (auto ending = finish(best)) {
        if (ending->corners <= kHalfCircle) return way_to(best, ending->way);
        if (!circling) most = std::min(most, expanded + kMore);
        if (here.cost + ending->length < least) {
          least = here.cost + ending->length;
          circling = way_to(best, ending->way);
        }
      }
      expand(here, best);
    }
    return circling;
  }

 private:
  [[nodiscard]] double heading_of(const State& s) const { return task_.heading.value_or(0) + s.heading * kTurn; }

  [[nodiscard]] std::optional<std::uint64_t> key_of(const State& s) const {
    const auto cell = grid_.window().at(s.place);
    if (!cell) return std::nullopt;
    return static_cast<std::uint64_t>(*cell) * kHeadings + static_cast<std::uint64_t>(s.heading);
  }

  void offer(const State& s) {
    const auto key = key_of(s);
    if (!key) return;
    const auto known = cheapest_.find(*key);
    if (known != cheapest_.end() && known->second <= s.cost) return;
    cheapest_[*key] = s.cost;
    const double cells = rest_.cost(static_cast<std::size_t>(*key / kHeadings));
    const double left = std::isfinite(cells) ? cells : (task_.goal - s.place).norm();
    open_.push({s.cost + left, static_cast<std::int32_t>(states_.size())});
    states_.push_back(s);
  }

  void expand(const State& here, std::int32_t number) {
    const double heading = heading_of(here);
    const Vector2d ahead(std::cos(heading), std::sin(heading));
    const Vector2d on = here.place + straight_ * ahead;
    if (clear_(here.place, on)) {
      offer({on, here.heading, here.cost + grid_.leg_cost(here.place, on), number, {}});
    }
    const Vector2d corner = here.place + tangent_ * ahead;
    if (!clear_(here.place, corner)) return;
    for (const int side : {1, -1}) {
      const double then = heading + side * kTurn;
      const Vector2d end = corner + tangent_ * Vector2d(std::cos(then), std::sin(then));
      if (!clear_(corner, end) || !clear_(here.place, end)) continue;
      const double longer = task_.radius_m * kTurn / (end - here.place).norm();
      const double cost = grid_.leg_cost(here.place, end) * longer * kTurningCosts;
      offer({end, (here.heading + side + kHeadings) % kHeadings, here.cost + cost, number, corner});
    }
  }

  struct Ending {
    Way way;  ///< from the state to the goal
    double length = 0;
    std::size_t corners = 0;
  };
  /// Goes by an arc and a straight leg to the goal, on the shorter side that is clear.
  [[nodiscard]] std::optional<Ending> finish(std::int32_t number) const {
    const State& here = states_[static_cast<std::size_t>(number)];
    std::optional<Ending> best;
    double least = INFINITY;
    for (const int side : {1, -1}) {
      const auto corners = turn_towards(here.place, heading_of(here), task_.radius_m, side, task_.goal, 0);
      if (!corners) continue;
      Way ending = {here.place};
      ending.insert(ending.end(), corners->begin(), corners->end());
      ending.push_back(task_.goal);
      double length = 0;
      bool clear = true;
      for (std::size_t i = 1; i < ending.size() && clear; ++i) {
        length += (ending[i] - ending[i - 1]).norm();
        const Vector2d chord_end = (ending[i] + ending[std::min(i + 1, ending.size() - 1)]) / 2;
        const Vector2d chord_start = i == 1 ? ending[0] : Vector2d((ending[i - 1] + ending[i]) / 2);
        clear = length < least && clear_(ending[i - 1], ending[i]) &&
                (i + 1 >= ending.size() - 1 || clear_(chord_start, chord_end));
      }
      if (!clear) continue;
      least = length;
      best = Ending{std::move(ending), length, corners->size()};
    }
    return best;
  }

  /// From the start to a state, and on by its ending.
  [[nodiscard]] Way way_to(std::int32_t number, const Way& ending) const {
    Way way;  // backwards
    for (std::int32_t i = number; i >= 0; i = states_[static_cast<std::size_t>(i)].parent) {
      const State& s = states_[static_cast<std::size_t>(i)];
      if (s.corner) way.push_back(*s.corner);
    }
    way.push_back(task_.start);
    std::reverse(way.begin(), way.end());
    way.insert(way.end(), ending.begin() + 1, ending.end());
    return way;
  }

  const RouteGrid& grid_;
  const TurningTask& task_;
  const std::function<bool(const Vector2d&, const Vector2d&)>& clear_;
  GridSearch<RouteGrid> rest_;
  double tangent_, straight_;
  std::vector<State> states_;
  std::unordered_map<std::uint64_t, double> cheapest_;
  std::priority_queue<Open, std::vector<Open>, Later> open_;
};

}  // namespace

std::optional<Way> search_turning(const RouteGrid& grid, const TurningTask& task,
                                  const std::function<bool(const Vector2d&, const Vector2d&)>& clear) {
  ISOBATH_ASSERT(task.radius_m > 0);
  return TurningSearch(grid, task, clear).run();
}

}  // namespace isobath
