// ObstacleDisplay: turns the obstacles of the last scan and those that the agents remember into one item (kObstacles,
// docs/live-page.md): first the obstacles as people count them, each with its number, kind and extent
// (whole_obstacle.hpp), then their pieces, which carry the outlines.
//
// An obstacle that the last scan shows is described by its pieces in that scan, as the report and the terminal describe
// it; one that it does not show by its remembered pieces. Items: W, m; times since the start of the run. One thread.
#pragma once

#include <isobath/display/display_state.hpp>
#include <isobath/display/obstacle_trails.hpp>
#include <isobath/world/result_sinks.hpp>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

namespace isobath {

class ObstacleDisplay {
 public:
  explicit ObstacleDisplay(DisplayState& items) : items_(items) {}

  void update(const ScanResult& scan, Time start);
  /// What the agents remember, from now on; null: nothing.
  void update(std::shared_ptr<const KnownObstacles> known, Time now, Time start);
  /// The middle of an obstacle that moves or may move, in W, if it keeps its velocity of the last scan until `time`.
  [[nodiscard]] std::optional<Eigen::Vector2d> predicted(int number, Time time) const;

 private:
  void show(Time now, Time start);
  [[nodiscard]] nlohmann::ordered_json whole_json(Time start) const;
  [[nodiscard]] nlohmann::ordered_json seen_json(std::size_t index) const;
  [[nodiscard]] nlohmann::ordered_json remembered_json(const RememberedObstacle& obstacle, Time start) const;
  [[nodiscard]] std::optional<std::uint32_t> taken_for(std::size_t seen) const;

  DisplayState& items_;
  std::vector<Obstacle> seen_;  ///< of the last scan, outlines and nearest points in W
  int scan_ = 0;                ///< its number
  Time scanned_{};              ///< its time
  std::shared_ptr<const KnownObstacles> known_;
  ObstacleTrails trails_;
};

}  // namespace isobath
