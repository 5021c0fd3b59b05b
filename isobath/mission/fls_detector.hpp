// FlsDetector: at the end of each sweep, all that is in the way, as one list for the Navigator (Ganesan 2015, 5.1, 6.1;
// ledger S6-38, S6-58, S6-66).
//
// Hears Sweep, Navigation and MissionOrder; says ObstacleScan, with hazards in the level body frame of its pose:
//   seen        obstacles of the last sweep, with a margin of a share of the grid's cell
//   remembered  what earlier sweeps confirmed and this one did not show whole, with the margin of the drift since
//   injected    maps of the mission plan, from the time on for which they are given; the scan that first holds one has
//               exactly that time, and the next pose that is known then
// and all that is remembered around, seen again by this sweep or not, for whoever shows it.
// Obstacles hidden by others, and those that may be echoes of a nearer one, are kept: one too many costs a detour, one
// too few the vehicle. Only what is less probable than `least_existence` is left out.
#pragma once

#include <isobath/map/obstacle_memory.hpp>
#include <isobath/mission/agent.hpp>

namespace isobath {

struct FlsDetectorConfig {
  double least_existence = 0.95;
  double margin_cells = 0.5;
  double memory_radius_m = 200;
};

std::vector<Field> fields(FlsDetectorConfig& config);

class FlsDetector final : public Agent {
 public:
  FlsDetector(const FlsDetectorConfig& config, const ObstacleMemoryConfig& memory) : config_(config), memory_(memory) {}

  void hear(const Message& message, Time now, Outbox& out) override;
  void tick(Time now, Outbox& out) override;

 private:
  struct Due {
    Time at;
    std::vector<Polygon> outlines;  ///< in W
  };
  void take(const Sweep& sweep, Outbox& out);
  void start(const MissionPlan& plan, Time now);
  void remember(const Sweep& sweep);
  void say_scan(Time time, const Pose& X_WL, bool posed, Outbox& out);

  FlsDetectorConfig config_;
  ObstacleMemory memory_;
  std::optional<Navigation> here_;
  Pose X_WL_seen_;            ///< of the last sweep
  std::vector<Hazard> seen_;  ///< in that frame
  int taken_in_ = 0;          ///< the last sweep that is in the memory
  std::vector<Due> due_;      ///< in order of time
  std::vector<Polygon> injected_;
  int number_ = 0;
};

}  // namespace isobath
