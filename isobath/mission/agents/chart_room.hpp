// ChartRoom: sends the hazards that chart, depth map, voxels and spherical grid contain (Ganesan 2015, 5.1; ledger
// S6-32, S6-33, S1-03, S5-32; S1-41 defines what is too shallow).
//
// Receives WorldSnapshot, Navigation and MissionOrder. Sends ChartedHazards and Decision.
//
// The hazards are the water around the vehicle that is shallower than the vehicle's depth plus a clearance, as few
// convex outlines (shoal_outlines.hpp), and the rocks and lines of the chart that reach up that far. Water that a sonar
// has measured gives hazards of its own (HazardKind::kMapped). They are sent again when the vehicle has moved by a
// share of the reach or has changed its depth, and when the chart has a new version: once a second in a run whose depth
// map grows (`live_s`). Water of unknown depth is not blocked, unless the configuration asks for it: the sonar looks
// there. With `voxels`, what the voxels hold for occupied between the clearance above and below the vehicle's depth is
// a hazard (HazardKind::kVoxels), even where the depth map or the chart says deep water: the more dangerous map stands.
// With `sphere`, the occupied cells of the spherical grid near the vehicle's level are hazards, too (S4-51).
//
// When a mission starts, each leg from point to point is checked against the chart at the depth of its end. Each leg
// that is too shallow gives a Decision with leg, place and margin; if none is, one says on what share of the way the
// maps know the depth. The chart room does not decide whether to go. A leg to a point with an altitude is checked at
// the minimum depth of the mission, with that altitude as clearance.
//
// Frames: W; depths are below the surface, for which the datum of the map is taken. At most 2000 x 2000 pixels are
// read: the reach shrinks where pixels are small.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/mission/messages/agent.hpp>

namespace isobath {

struct ChartRoomConfig {
  double reach_m = 150;         ///< half the side of the square around the vehicle
  double recheck_share = 0.25;  ///< movement after which hazards are sent again, share of the reach
  double depth_step_m = 0.5;    ///< change of depth after which hazards are sent again
  double clearance_m = 1;       ///< water required below the vehicle
  double half_width_m = 2;      ///< of the corridor along a leg
  double margin_m = 0;          ///< how far hazards may reach beyond their outlines
  double overreach_m = 1;       ///< how far outlines may reach over deep water
  int max_outlines = 1000;      ///< maximum number, of shallow water
  bool unknown_blocks = false;  ///< whether water of unknown depth is blocked
  double live_s = 1;            ///< interval at which the growing depth map replaces the chart; 0: it never does
  bool voxels = false;          ///< whether occupied voxels near the vehicle's depth are hazards, too
  bool sphere = false;          ///< whether the occupied cells of the spherical grid are hazards, too
};
std::vector<Field> fields(ChartRoomConfig& config);

class ChartRoom final : public Agent {
 public:
  explicit ChartRoom(const ChartRoomConfig& config = {}) : config_(config) {}

  void on_message(const Message& message, Time now, Outbox& out) override;
  void tick(Time, Outbox&) override {}

 private:
  /// The chart and the position for which hazards were last sent.
  struct Said {
    Eigen::Vector3d p_WB;
    std::uint64_t version = 0;
    Time time;
    std::shared_ptr<const std::vector<ChartObstacle>> objects = {};
    std::shared_ptr<const OccupancySnapshot> voxels = {};
    std::uint64_t sphere = 0;  ///< version
    ChartedHazards hazards = {};
  };

  void say_hazards(Time now, Outbox& out);
  [[nodiscard]] bool outdated(Time now) const;
  [[nodiscard]] std::vector<Hazard> hazards() const;
  void add_shoals(std::vector<Hazard>& hazards) const;
  void add_voxels(std::vector<Hazard>& hazards) const;
  void add(std::vector<Polygon> outlines, HazardKind kind, std::vector<Hazard>& hazards) const;
  [[nodiscard]] PixelWindow window_around(const PixelGrid& grid, double reach_m) const;
  void add_objects(std::vector<Hazard>& hazards) const;
  void add_sphere(std::vector<Hazard>& hazards) const;
  void check_legs(const MissionPlan& plan, Time now, Outbox& out) const;
  [[nodiscard]] Result<Traversability, CorridorRefusal> check_leg(const MissionPlan& plan, const MissionPoint& to,
                                                                  const Eigen::Vector2d& from) const;
  [[nodiscard]] std::optional<Decision> objection(const MissionPoint& to, std::size_t point,
                                                  const Result<Traversability, CorridorRefusal>& verdict,
                                                  Time now) const;
  [[nodiscard]] std::uint64_t version() const { return world_.depths ? world_.depths->version() : 0; }
  [[nodiscard]] std::uint64_t sphere_version() const { return world_.sphere ? world_.sphere->version : 0; }

  ChartRoomConfig config_;
  WorldSnapshot world_;
  std::optional<Eigen::Vector3d> p_WB_;
  std::optional<Said> said_;
};

}  // namespace isobath
