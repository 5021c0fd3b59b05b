// FlsDetector: sends all obstacles as one list to the Navigator at the end of each sweep (Ganesan 2015, 5.1, 6.1;
// ledger S6-38, S6-58, S6-66).
//
// Receives Sweep, Navigation, MissionOrder and GroupObstacles. Sends Decision and ObstacleScan, with hazards in the
// level body frame of its pose:
//   seen        obstacles of the last sweep, with a share of the grid's cell as margin
//   moving      the same of those that move, with the water that they cross in the next `moving_ahead_s`; in a sweep
//               that has such obstacles, also those that may move, at their present places
//   remembered  obstacles that earlier sweeps confirmed and this one did not show whole, with the drift since as
//               margin; also those that other vehicles of the group tell of
//   injected    maps of the mission plan, from the time given there on; the first scan that contains one has exactly
//               that time, and the last pose known at the next tick
// The scan also lists all remembered obstacles around the vehicle, seen again by this sweep or not, for display.
// Obstacles hidden by others, and those that may be echoes of a nearer one, are kept: a false obstacle costs a detour,
// a missed one the vehicle. Only obstacles less probable than `min_existence` are left out.
#pragma once

#include <isobath/map/occupancy/obstacle_memory.hpp>
#include <isobath/mission/messages/agent.hpp>

namespace isobath {

struct FlsDetectorConfig {
  double min_existence = 0.95;
  double margin_cells = 0.5;
  double memory_radius_m = 200;
  double moving_ahead_s = 5;
};

std::vector<Field> fields(FlsDetectorConfig& config);

class FlsDetector final : public Agent {
 public:
  FlsDetector(const FlsDetectorConfig& config, const ObstacleMemoryConfig& memory) : config_(config), memory_(memory) {}

  void on_message(const Message& message, Time now, Outbox& out) override;
  void tick(Time now, Outbox& out) override;

 private:
  struct Due {
    Time at;
    std::vector<Polygon> outlines;  ///< in W
  };
  void on(const Sweep& sweep, Outbox& out);
  void on(const GroupObstacles& told, Time now, Outbox& out);
  void start(const MissionPlan& plan, Time now);
  void remember(const Sweep& sweep);
  void say_scan(Time time, const Pose& X_WL, bool posed, Outbox& out);

  FlsDetectorConfig config_;
  ObstacleMemory memory_;
  std::vector<std::string> group_;  ///< names of its vehicles
  std::optional<Navigation> here_;
  Pose X_WL_seen_;            ///< at the last sweep
  std::vector<Hazard> seen_;  ///< in that frame
  int taken_in_ = 0;          ///< number of the last sweep in the memory
  std::vector<Due> due_;      ///< in order of time
  std::vector<Polygon> injected_;
  int number_ = 0;
};

}  // namespace isobath
