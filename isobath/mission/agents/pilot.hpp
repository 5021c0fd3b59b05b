// Pilot: turns way-points, or a position to hold, into set-points for heading, speed and depth (Ganesan 2015, 5.1,
// 6.1.1; ledger S6-37).
//
// Receives FollowOrder, MotionOrder, Navigation, RangeReading (of downward sensors), MissionOrder (limits) and
// AgentLost. Sends WaypointPassed when a way-point comes to lie behind, a HelmOrder at each tick, and LevelPlan.
//
// The last way-point is the mission point: it is reached within its own radius, or `point_radius`. Those before it are
// corners round obstacles. The vehicle turns at them within the acceptance radius of the guidance, which is smaller,
// because an early turn cuts the corner. A way-point that is passed abeam counts as passed, not as reached. After the
// last way-point the Pilot holds it; on an empty order it holds the place where the vehicle can come to rest. Without
// navigation for `silent_s` the vehicle stops; without an Executive Officer it surfaces.
//
// Where the vehicle goes on after the last way-point, it takes that corner at the speed of a corner; else, if it can
// hover, it brakes for the point.
//
// While the Goal Selector orders a motion, the Pilot keeps to its place and velocity instead of the line to the
// way-point or the place that it holds, and makes good an error of place in `motion_s`. The last way-point is then
// passed only within its radius; afterwards the line starts where it is.
//
// The Navigator avoids obstacles, and the Safety Officer decides whether an order is safe; the Pilot does neither.
#pragma once

#include <isobath/mission/messages/agent.hpp>
#include <isobath/mission/messages/plan_clock.hpp>
#include <isobath/mission/plan/timing_table.hpp>
#include <isobath/vehicle/depth_keeper.hpp>
#include <isobath/vehicle/guidance.hpp>

namespace isobath {

struct PilotConfig {
  double point_radius = 5;
  double hold_speed = 0.5;
  double silent_s = 3;
  double motion_s = 2.5;
};

std::vector<Field> fields(PilotConfig& config);

class Pilot final : public Agent {
 public:
  Pilot(const PilotConfig& config, const GuidanceConfig& guidance, const StationConfig& station,
        const DepthKeeperConfig& depth, const VehicleParameters& vehicle, const TimingTable& timing = {});

  void on_message(const Message& message, Time now, Outbox& out) override;
  void tick(Time now, Outbox& out) override;

 private:
  enum class Task : std::uint8_t { kNone, kFollow, kHold, kSurface };
  void on(const FollowOrder& order);
  void on(const RangeReading& reading);
  void take_limits(const MissionLimits& limits);
  void hold_where_it_stops();
  Setpoint follow(double dt, Time now, Outbox& out);
  Setpoint follow_motion(Time now, Outbox& out);
  [[nodiscard]] Setpoint along_motion(double depth, double max_speed, Time now) const;
  [[nodiscard]] bool is_steered(Time now) const;  ///< by the Goal Selector
  Setpoint hold(double dt, Time now);
  void report(Outbox& out);
  void pass(bool reached, Outbox& out);
  [[nodiscard]] double radius_of(const Waypoint& last) const;
  [[nodiscard]] double distance_to(const Waypoint& place) const;
  [[nodiscard]] double hold_speed() const;
  [[nodiscard]] double horizon_s() const;
  [[nodiscard]] Setpoint at_rest();
  [[nodiscard]] Setpoint at_its_depth(Setpoint wanted, Time now);

  PilotConfig config_;
  GuidanceConfig guidance_;
  DepthKeeperConfig depth_config_;
  VehicleParameters vehicle_;
  StationKeeper station_;
  DepthKeeper depth_;
  std::optional<LineOfSight> line_of_sight_;  ///< kept from order to order, with its estimate of the current

  PlanClock plans_;
  Task task_ = Task::kNone;
  FollowOrder order_;
  double went_ = 0;                    ///< speed of the last route, m/s
  std::size_t told_ = 0;               ///< way-points that were reported as passed
  std::size_t first_ = 0;              ///< way-point of the order that is the first of `line_of_sight_`
  std::optional<MotionOrder> motion_;  ///< that it follows
  Drift drift_;
  std::optional<Navigation> here_;
  std::optional<Time> last_tick_;
  std::optional<Setpoint> rest_;  ///< while there is no task
};

}  // namespace isobath
