#include <algorithm>
#include <cmath>
#include <isobath/scenario/group_record.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kSquare_m = 1;

/// The squares of the area, and which vehicles have searched them.
class SearchedSquares {
 public:
  explicit SearchedSquares(const SearchArea& area)
      : area_(area),
        along_(std::max(1, static_cast<int>(std::lround(area.length_m / kSquare_m)))),
        across_(std::max(1, static_cast<int>(std::lround(area.breadth_m / kSquare_m)))),
        by_(static_cast<std::size_t>(along_) * static_cast<std::size_t>(across_)) {}

  void pass(const Vector2d& p_W, std::size_t vehicle) {
    const double reach_m = kReach * area_.lane_breadth_m();
    const Vector2d ahead(cos(area_.heading), sin(area_.heading)), aside(-ahead.y(), ahead.x());
    const Vector2d from = p_W - area_.corner;
    const double x = from.dot(ahead), y = from.dot(aside);
    const auto range = [&](double at, int count) {
      return std::pair(std::clamp(static_cast<int>(std::floor((at - reach_m) / kSquare_m)), 0, count),
                       std::clamp(static_cast<int>(std::ceil((at + reach_m) / kSquare_m)), 0, count));
    };
    const auto [first_row, last_row] = range(x, along_);
    const auto [first, last] = range(y, across_);
    for (int i = first_row; i < last_row; ++i) {
      for (int j = first; j < last; ++j) {
        const Vector2d middle((i + 0.5) * kSquare_m, (j + 0.5) * kSquare_m);
        if ((middle - Vector2d(x, y)).squaredNorm() <= reach_m * reach_m) {
          by_[static_cast<std::size_t>(i) * static_cast<std::size_t>(across_) + static_cast<std::size_t>(j)] |=
              static_cast<std::uint8_t>(1U << vehicle);
        }
      }
    }
  }
  /// Share of the squares for which this is so of the vehicles, one bit each.
  template <class Counts>
  [[nodiscard]] double share(const Counts& counts) const {
    return static_cast<double>(std::ranges::count_if(by_, counts)) / static_cast<double>(by_.size());
  }

 private:
  const SearchArea& area_;
  int along_, across_;
  std::vector<std::uint8_t> by_;
};
static_assert(kMaxGroup <= 8);

/// When another vehicle shared the lanes anew because it had lost this one.
std::optional<double> reassigned_s(const GroupRecord& record, const GroupVehicleRecord& lost) {
  std::optional<double> first_s;
  for (const GroupVehicleRecord& vehicle : record.vehicles) {
    bool knows = false;
    for (const Decision& decision : vehicle.decisions) {
      const double at_s = to_seconds(decision.time.time_since_epoch());
      if (decision.agent != "commodore" || at_s < *lost.lost_s) continue;
      knows = knows || (decision.what == "vehicle lost" && decision.reason.starts_with(lost.name + " "));
      if (!knows || decision.what != "share lanes") continue;
      first_s = std::min(first_s.value_or(at_s), at_s);
      break;
    }
  }
  if (!first_s) return std::nullopt;
  return *first_s - *lost.lost_s;
}

}  // namespace

double GroupRecord::bit_rate(std::size_t vehicle) const {
  const double under_way_s = vehicles[vehicle].lost_s.value_or(duration_s);
  return under_way_s > 0 ? 8 * static_cast<double>(vehicles[vehicle].link.bytes) / under_way_s : 0;
}

std::size_t GroupRecord::lanes(std::size_t vehicle) const {
  const MissionReport& report = vehicles[vehicle].report;
  const std::size_t visited_of_lane = plan.search.stations() - (plan.search.is_run_out(0) ? 1 : 0);
  return (report.reached + report.dropped) / visited_of_lane;
}

GroupScore score_of(const GroupRecord& record) {
  GroupScore score;
  SearchedSquares squares(record.plan.search);
  for (std::size_t v = 0; v < record.vehicles.size(); ++v) {
    const GroupVehicleRecord& vehicle = record.vehicles[v];
    for (const TrueMotion& motion : vehicle.track) squares.pass(motion.state.X_WB.translation.head<2>(), v);
    for (const Decision& decision : vehicle.decisions) {
      if (decision.what != "area searched") continue;
      const double done_s = to_seconds(decision.time.time_since_epoch());
      score.all_searched_s = std::min(score.all_searched_s.value_or(done_s), done_s);
    }
    if (!score.reassigned_s && vehicle.lost_s) score.reassigned_s = reassigned_s(record, vehicle);
  }
  for (std::size_t v = 0; v < record.vehicles.size(); ++v) {
    score.searched_by.push_back(squares.share([v](std::uint8_t by) { return (by >> v & 1) != 0; }));
  }
  score.searched = squares.share([](std::uint8_t by) { return by != 0; });
  score.overlap = squares.share([](std::uint8_t by) { return (by & (by - 1)) != 0; });
  return score;
}

}  // namespace isobath
