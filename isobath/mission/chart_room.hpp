// Chart room: keeps the chart, and says what it holds against the vehicle (Ganesan 2015, 5.1; ledger S6-32, S6-33; what
// is too shallow is that of S1-41).
//
// Hears ChartUpdate, Navigation and MissionOrder; says ChartedHazards and Decision.
//
// The hazards are the water around the vehicle that the chart knows to be shallower than the vehicle's depth and a
// clearance, as few convex outlines (shoal_outlines.hpp), and the rocks and lines of the chart that reach up so far.
// They are said again when the vehicle has moved by a share of the reach or changed its depth, and when the chart has
// another version. Water that nobody knows is not blocked, unless it is asked for: the sonar is there to look.
//
// When a mission starts, each leg from point to point is held against the chart at the depth of its end, and each that
// is too shallow is a Decision with leg, place and margin; whether to go is not the chart room's to say. Points that go
// by altitude are held against the least depth of the mission and their altitude.
//
// Frames: W; depths below the surface, the datum of the map taken for it. Looks at no more than 2000 x 2000 pixels: the
// reach shrinks where pixels are small.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/mission/agent.hpp>

namespace isobath {

struct ChartRoomConfig {
  double reach_m = 150;         ///< half the side of the square around the vehicle
  double again_share = 0.25;    ///< of the reach
  double depth_step_m = 0.5;    ///< change of depth after which hazards are said again
  double clearance_m = 1;       ///< water wanted below the vehicle
  double half_width_m = 2;      ///< of the corridor along a leg
  double margin_m = 0;          ///< how far hazards may reach beyond their outlines
  double overreach_m = 1;       ///< how far outlines may reach over water to be few
  int most_outlines = 1000;     ///< of shallow water
  bool unknown_blocks = false;  ///< whether water that nobody knows is blocked
};
std::vector<Field> fields(ChartRoomConfig& config);

class ChartRoom final : public Agent {
 public:
  explicit ChartRoom(const ChartRoomConfig& config = {}) : config_(config) {}

  void hear(const Message& message, Time now, Outbox& out) override;
  void tick(Time, Outbox&) override {}

 private:
  /// The chart and the place that hazards were last said for.
  struct Said {
    Eigen::Vector3d p_WB;
    std::uint64_t version = 0;
    const void* objects = nullptr;
  };

  void say_hazards(Outbox& out);
  [[nodiscard]] bool outdated() const;
  [[nodiscard]] std::vector<Hazard> hazards() const;
  void add_shoals(std::vector<Hazard>& hazards) const;
  void add_objects(std::vector<Hazard>& hazards) const;
  void check_legs(const MissionPlan& plan, Time now, Outbox& out) const;
  [[nodiscard]] std::optional<Decision> check_leg(const MissionPlan& plan, std::size_t point,
                                                  const Eigen::Vector2d& from, Time now) const;
  [[nodiscard]] std::uint64_t version() const { return chart_.depths ? chart_.depths->version() : 0; }

  ChartRoomConfig config_;
  ChartUpdate chart_;
  std::optional<Eigen::Vector3d> p_WB_;
  std::optional<Said> said_;
};

}  // namespace isobath
