#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/report/group_outcome.hpp>
#include <nlohmann/json.hpp>

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

}  // namespace

void add_searched(GroupOutcome& outcome) {
  SearchedSquares squares(outcome.plan.search);
  for (std::size_t v = 0; v < outcome.vehicles.size(); ++v) {
    const auto& mission = outcome.vehicles[v].run.mission;
    if (!mission || !mission->truth) continue;
    for (const TrueMotion& motion : mission->truth->track) {
      squares.pass(motion.state.X_WB.translation.head<2>(), v);
    }
  }
  for (std::size_t v = 0; v < outcome.vehicles.size(); ++v) {
    outcome.vehicles[v].searched = squares.share([v](std::uint8_t by) { return (by >> v & 1) != 0; });
  }
  outcome.searched = squares.share([](std::uint8_t by) { return by != 0; });
  outcome.overlap = squares.share([](std::uint8_t by) { return (by & (by - 1)) != 0; });
}

std::string GroupOutcome::failure() const {
  if (least_separation_m <= 0) return fmt::format("two vehicles touched each other at {:.1f} s", least_separation_s);
  for (const GroupVehicleOutcome& vehicle : vehicles) {
    if (vehicle.lost_s || !vehicle.run.mission) continue;
    const std::string why = vehicle.run.mission->failure();
    if (!why.empty()) return vehicle.name + ": " + why;
  }
  return all_searched_s ? "" : "the area was not searched whole";
}

double GroupOutcome::bit_rate(std::size_t vehicle) const {
  const double under_way_s = vehicles[vehicle].lost_s.value_or(duration_s);
  return under_way_s > 0 ? 8 * static_cast<double>(vehicles[vehicle].link.bytes) / under_way_s : 0;
}

std::string group_text(const GroupOutcome& outcome) {
  nlohmann::ordered_json json;
  json["lanes"] = outcome.plan.search.lanes();
  json["searched"] = outcome.searched;
  json["overlap"] = outcome.overlap;
  json["all_searched_s"] = outcome.all_searched_s ? nlohmann::ordered_json(*outcome.all_searched_s) : nullptr;
  json["duration_s"] = outcome.duration_s;
  json["least_separation_m"] = std::isfinite(outcome.least_separation_m)
                                   ? nlohmann::ordered_json(outcome.least_separation_m)
                                   : nlohmann::ordered_json(nullptr);
  json["least_separation_s"] = outcome.least_separation_s;
  json["failure"] = outcome.failure();
  json["vehicles"] = nlohmann::ordered_json::array();
  for (std::size_t v = 0; v < outcome.vehicles.size(); ++v) {
    const GroupVehicleOutcome& vehicle = outcome.vehicles[v];
    const LinkCounts& n = vehicle.link;
    nlohmann::ordered_json one;
    one["name"] = vehicle.name;
    one["phase"] = vehicle.run.mission ? to_text(vehicle.run.mission->report.phase) : "";
    one["lost_s"] = vehicle.lost_s ? nlohmann::ordered_json(*vehicle.lost_s) : nullptr;
    one["lanes"] = vehicle.lanes;
    one["searched"] = vehicle.searched;
    one["link"] = {{"packets", n.packets}, {"bytes", n.bytes},       {"bit_rate", outcome.bit_rate(v)},
                   {"dropped", n.dropped}, {"received", n.received}, {"out_of_range", n.out_of_range},
                   {"deaf", n.deaf},       {"collided", n.collided}, {"lost", n.lost}};
    json["vehicles"].push_back(std::move(one));
  }
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::vector<std::string> group_summary(const GroupOutcome& outcome) {
  std::vector<std::string> lines;
  const auto percent = [](double share) { return fmt::format("{:.1f} %", 100 * share); };
  lines.push_back(fmt::format("{} vehicles searched {} of an area of {} lanes in {:.0f} s, and {} of it twice or more",
                              outcome.vehicles.size(), percent(outcome.searched), outcome.plan.search.lanes(),
                              outcome.duration_s, percent(outcome.overlap)));
  if (outcome.all_searched_s)
    lines.push_back(fmt::format("the last lane was done at {:.0f} s", *outcome.all_searched_s));
  if (std::isfinite(outcome.least_separation_m)) {
    lines.push_back(fmt::format("least separation of two hulls: {:.1f} m, at {:.0f} s", outcome.least_separation_m,
                                outcome.least_separation_s));
  }
  for (std::size_t v = 0; v < outcome.vehicles.size(); ++v) {
    const GroupVehicleOutcome& vehicle = outcome.vehicles[v];
    const LinkCounts& n = vehicle.link;
    std::string line = fmt::format("  {}: {}, {} lanes, {} of the area", vehicle.name,
                                   vehicle.lost_s        ? fmt::format("lost at {:.0f} s", *vehicle.lost_s)
                                   : vehicle.run.mission ? to_text(vehicle.run.mission->report.phase)
                                                         : "no mission",
                                   vehicle.lanes, percent(vehicle.searched));
    line += fmt::format("; sent {} packets, {:.1f} bit/s; {} received, {} lost, {} collided, {} unheard", n.packets,
                        outcome.bit_rate(v), n.received, n.lost, n.collided, n.deaf + n.out_of_range);
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace isobath
