// A folder of fan detections, made by ray casting: a vehicle circles in a rectangular basin, and a fan of 121 beams
// sees its walls. It shares no code with the reader and the maps.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

namespace isobath::test {

struct FanRecording {
  static constexpr double kNorth_m = 30, kEast_m = 40;  ///< the basin, from the origin
  double compass_error_deg = 0;                         ///< of the compass, clockwise
  double reckoned_share = 1.1;                          ///< of each step, in the dead reckoning
  double reckoned_turn_deg = 25;                        ///< of the frame of the dead reckoning, counter-clockwise

  struct Place {
    double t_s, north, east, heading;  ///< s, m, rad
  };
  /// Half a metre a second, two places a second, once around. The heading is that of the last step.
  static std::vector<Place> track() {
    std::vector<Place> places;
    constexpr double kCorners[][2] = {{10, 8}, {10, 32}, {20, 32}, {20, 8}, {10, 8}};
    for (int leg = 0; leg < 4; ++leg) {
      const double north = kCorners[leg + 1][0] - kCorners[leg][0], east = kCorners[leg + 1][1] - kCorners[leg][1];
      const int steps = static_cast<int>(std::lround(4 * std::hypot(north, east)));
      for (int i = places.empty() ? 0 : 1; i <= steps; ++i) {
        places.push_back({0.5 * static_cast<double>(places.size()), kCorners[leg][0] + north * i / steps,
                          kCorners[leg][1] + east * i / steps, std::atan2(east, north)});
      }
    }
    return places;
  }

  /// The distance from a place to the walls along a bearing.
  static double range_to_wall(const Place& from, double bearing) {
    const double n = std::cos(bearing), e = std::sin(bearing);
    const double to_n = n > 0 ? (kNorth_m - from.north) / n : n < 0 ? -from.north / n : 1e9;
    const double to_e = e > 0 ? (kEast_m - from.east) / e : e < 0 ? -from.east / e : 1e9;
    return std::min(to_n, to_e);
  }
  /// The distance from a place in the basin to the nearest wall, m.
  static double off_wall(double north, double east) {
    return std::min({std::abs(north), std::abs(kNorth_m - north), std::abs(east), std::abs(kEast_m - east)});
  }

  /// Detections at every fourth place, in `seen.csv`; `where.csv` is the satellite track, `reckoned.csv` the other one.
  void write(const std::filesystem::path& folder) const {
    constexpr double kRadian = std::numbers::pi / 180;
    std::filesystem::create_directories(folder);
    std::ofstream seen(folder / "seen.csv"), where(folder / "where.csv"), reckoned(folder / "reckoned.csv");
    seen << "scan,time_s,range_m,bearing_deg\n";
    where << "time,x,y,theta\n";
    reckoned << "time,x,y\n";
    const std::vector<Place> places = track();
    double x = 5, y = -3;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Place& p = places[i];
      where << fmt::format("{:.3f},{:.4f},{:.4f},{:.6f}\n", p.t_s, p.east, p.north,
                           p.heading + compass_error_deg * kRadian);
      if (i > 0) {
        const double step = reckoned_share * std::hypot(p.north - places[i - 1].north, p.east - places[i - 1].east);
        const double course = p.heading + (compass_error_deg - reckoned_turn_deg) * kRadian;
        x += step * std::sin(course);
        y += step * std::cos(course);
      }
      reckoned << fmt::format("{:.3f},{:.4f},{:.4f}\n", p.t_s, x, y);
      for (int beam = -60; i % 4 == 0 && beam <= 60; ++beam) {
        seen << fmt::format("{},{:.3f},{:.3f},{}\n", i, p.t_s, range_to_wall(p, p.heading + beam * kRadian), beam);
      }
    }
  }
};

}  // namespace isobath::test
