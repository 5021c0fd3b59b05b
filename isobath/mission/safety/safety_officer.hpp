// SafetyOfficer: watches over all other agents, independently of planning, and can only make things safer (Ganesan
// 2015, 5.1; Herman 1988, 3.4; Oskard 1990, III-D; ledger S6-39, S2-28, S2-E10, S1-43, S1-44).
//
// It receives sensor input and the messages of all agents. Ten times a second it judges for each row of the fault table
// whether its cause holds, since when, and what action that requires. A row is raised in the first cycle in which its
// limit is exceeded, and is over `clear_after_s` after its cause is gone. The Safety Officer sends SafetyAction, the
// strongest action that the raised rows require, whenever that changes; SafetyReport to the Captain when a row is
// raised, when it requires the end of the mission, and when it is over (with `abort` still set where it required that);
// and a Decision with the reason for each. No action asks for more speed than the last order, but an escape of a
// vehicle that cannot stop, which is sailed at the speed at which it turns fastest; a slow-down is a limit.
//
// Collisions: from the ground speed v and the current turn, the hull's path is predicted over v t + v^2 / 2b and a
// margin. Raw echoes on which pings agree, raw ranges, and voxels that are occupied up to `height_margin_m` above or
// below the vehicle must not lie in it (near_echoes.hpp, imminent_collision.hpp; S5-37). The vehicle stops while it
// can; else it turns to the freer side; else it surfaces, and the Safety Officer reports that the collision could not
// be avoided. A vehicle that cannot stop must always have an escape manoeuvre: a turn, and then a straight line, that
// meets no known obstacle for `escape_s`. Before an order leads to
// where there is none, the Safety Officer takes the last one (safety_escape.cpp). A vehicle that has stopped turns on
// the spot to the ordered heading, and the stop is over when the path there is free at the ordered speed. Echoes are
// taken to be at the height of the sonar.
//
// While no route is found, the time until the mission ends counts anew for each further point that the Executive
// Officer tries: the levels of command try what they can first, each a bounded number of times (S2-17).
//
// Bodies that a tracker knows to move (Sweep) are taken to keep their velocity: echoes in the place that such a body
// had when they came move with it, so it leaves no trail; its outline counts where it will be. An echo that belongs to
// no such body stays where it is.
//
// Where a sonar that measures height (WorldSnapshot) has measured all water clear at the vehicle's depth and
// `height_margin_m` above and below it, the vehicle passes over or under: neither echoes nor obstacles count at that
// place (S5-35). Echoes that bottom or surface explain do not arrive here where depth and altitude are known
// (sonar/boundary_echoes.hpp); where the altitude is unknown, a bottom within the beam's reach stops the vehicle.
//
// Times in messages are compared with the logical clock and never used as a clock: a clock that jumps trips no watchdog
// but its own. All numbers are untrusted; a value that is not finite counts as not received. One thread at a time.
#pragma once

#include <array>
#include <functional>
#include <isobath/mission/messages/agent.hpp>
#include <isobath/mission/safety/fault_table.hpp>
#include <isobath/mission/safety/near_echoes.hpp>
#include <isobath/mission/safety/safety_config.hpp>
#include <isobath/mission/safety/sonar_health_monitor.hpp>
#include <isobath/perception/imminent_collision.hpp>
#include <isobath/planning/escape.hpp>
#include <isobath/sonar/sensor_table.hpp>
#include <isobath/vehicle/current_estimate.hpp>
#include <isobath/vehicle/guidance.hpp>
#include <isobath/vehicle/vehicle_parameters.hpp>
#include <map>
#include <optional>
#include <string>

namespace isobath {

class SafetyOfficer final : public Agent {
 public:
  SafetyOfficer(const SafetyConfig& config, const VehicleParameters& vehicle);

  void on_message(const Message& message, Time now, Outbox& out) override;
  void tick(Time now, Outbox& out) override;

  [[nodiscard]] bool raised(Fault fault) const { return rows_[static_cast<std::size_t>(fault)].raised; }
  /// In force.
  [[nodiscard]] const SafetyAction& action() const { return action_; }

 private:
  /// One row of the table: whether its cause holds, and since when.
  struct Row {
    bool cause = false;  ///< found in this cycle
    std::string why;
    bool raised = false;
    double since_s = 0;       ///< when it was raised
    double last_cause_s = 0;  ///< when its cause last held
    bool aborted = false;
    std::optional<Eigen::Vector2d> place = {};  ///< N, E
    std::optional<double> margin_m = {};
  };
  /// The sources whose times are compared with the logical clock.
  enum Speaker : std::uint8_t { kNavigator, kSonar, kRanger, kHost, kSpeakers };
  struct Offset {
    bool known = false;
    double s = 0;  ///< of the time in its messages from the logical clock
    double heard_s = 0;
  };
  struct Fix {
    Navigation navigation;
    double heard_s = 0;
    Eigen::Vector2d v_W = Eigen::Vector2d::Zero();  ///< over ground
    double yaw_rate = 0;                            ///< rad/s, smoothed
    double sigma_m = 0;
  };
  struct Refusal {
    RouteRefused::Reason reason = RouteRefused::Reason::kNoPath;
    std::string why;
  };
  struct Way {
    std::uint32_t version = 0;
    std::optional<Eigen::Vector2d> from;  ///< where the vehicle was at the order, or at the first fix after it
    std::vector<Eigen::Vector2d> points;  ///< `from` is the first
    std::size_t next = 1;
    double nearest_m = 0;  ///< minimum distance to the next point so far
    double progress_s = 0;
    double steered_s = 0;     ///< last order of the Goal Selector
    double in_traffic_s = 0;  ///< for which it has steered since the last progress, and the watch waited
    std::optional<double> off_since_s;
    bool altitude = false;
  };
  struct Altitude {
    bool spoken = false;
    double heard_s = 0;
    double echo_s = 0;
    double last_m = 0;
    std::uint32_t low = 0;  ///< whether each of the last three readings was low, the newest in bit 0
  };

  // Input (safety_input.cpp)
  void set_clock(Time now);
  bool in_time(Speaker speaker, Time said, Time now);
  void on_fix(const Navigation& fix, Time now);
  void on_sonar_health(const SonarHealthSample& look, Time now);
  void on_echoes(const SonarEchoes& echoes, Time now);
  void on_range(const RangeReading& reading, Time now);
  void on_altitude(const RangeReading& reading, double down);
  void on_health(const Health& health, Time now);
  void on_command(const OperatorCommand& command);
  void on_scan(const ObstacleScan& scan);
  void on_sweep(const Sweep& sweep);
  void on_chart(const ChartedHazards& chart);
  void on_world(const WorldSnapshot& world);
  void on_lost(const AgentLost& lost);
  void on_point(const PointReport& report);
  void start(const std::shared_ptr<const MissionPlan>& plan);
  void follow(const FollowOrder& order);
  void wait_for_traffic();

  // Judging (safety_checks.cpp)
  void find(Fault fault, std::string why);
  [[nodiscard]] Row& row(Fault fault) { return rows_[static_cast<std::size_t>(fault)]; }
  [[nodiscard]] bool watching() const;   ///< from the first start on
  [[nodiscard]] bool under_way() const;  ///< or holding
  void check_sonars();
  void check_navigation();
  void check_altitude();
  void check_way();
  void check_route();
  void check_limits();
  [[nodiscard]] bool fenced() const;  ///< the plan has a fence that can be judged
  void check_host();

  // Collisions (safety_collision.cpp)
  struct Travel {
    double speed = 0;
    double drift = 0;  ///< direction of travel from the heading, rad
    double curvature = 0;
    double half_width_m = 0;
  };
  [[nodiscard]] Travel travel() const;
  [[nodiscard]] double stop_way(double speed, double delay_s) const;
  void check_collision();
  void choose_turn(std::span<const Eigen::Vector2d> points, const Travel& travel);

  // Escape manoeuvres of a vehicle that cannot stop (safety_escape.cpp)
  [[nodiscard]] bool passes_by(const Eigen::Vector3d& p_W) const;
  [[nodiscard]] std::vector<ObstaclePoint> confirmed_echoes(const Pose& X_WL);
  [[nodiscard]] ObstaclePoint where_now(const NearEcho& echo, const Pose& X_WL) const;
  [[nodiscard]] std::vector<ObstaclePoint> solid_points(const Pose& X_WL) const;
  [[nodiscard]] std::vector<ObstaclePoint> known_points(const Pose& X_WL,
                                                        std::span<const ObstaclePoint> echoes_L) const;
  /// `wary`: reckons with a current from astern that the headings so far have not shown.
  [[nodiscard]] EscapeTask escape_task(bool wary) const;
  [[nodiscard]] double ordered_turn() const;
  [[nodiscard]] std::vector<ObstaclePoint> fence_points(const Pose& X_WL) const;
  void check_fence(const Pose& X_WL, std::span<const ObstaclePoint> fence_L, std::span<const ObstaclePoint> all_L);
  void choose_circle(const Pose& X_WL, std::span<const ObstaclePoint> all_L);
  void check_escape(const Pose& X_WL, std::span<const ObstaclePoint> known_L);

  // Acting (safety_officer.cpp)
  void settle(const FaultRow& about, Time now, Outbox& out);
  void report(const FaultRow& about, bool active, bool abort, Time now, Outbox& out);
  [[nodiscard]] SafetyActionKind asked(const FaultRow& about) const;
  [[nodiscard]] MissionEnd end_of(Fault fault) const;
  [[nodiscard]] SafetyAction strongest() const;
  [[nodiscard]] std::optional<Angle> way_out() const;
  [[nodiscard]] double escape_speed(double ordered) const;
  [[nodiscard]] Setpoint turned(const SafetyAction& action) const;
  void act(Time now, Outbox& out);

  SafetyConfig config_;
  VehicleParameters vehicle_;
  std::array<Row, kFaults> rows_;
  SafetyAction action_;
  bool told_ = false;  ///< a row changed in this cycle; its decision covers the change of action

  std::optional<Time> now_;
  double clock_s_ = 0;  ///< logical time since the first call, less its jumps
  std::array<Offset, kSpeakers> offsets_;
  std::string jumped_;

  MissionPhase phase_ = MissionPhase::kWaiting;
  std::shared_ptr<const MissionPlan> plan_;
  double started_s_ = 0;

  std::map<std::string, SonarHealthMonitor> sonars_;
  std::map<std::string, HealthState> states_;
  NearEchoes echoes_;
  std::vector<Eigen::Vector2d> mapped_W_;   ///< points on the outlines of the last scan's obstacles
  std::vector<Eigen::Vector2d> charted_W_;  ///< the same for the hazards of chart and depth map
  std::vector<Eigen::Vector2d> solid_W_;    ///< columns of voxels that are occupied at the vehicle's depth
  /// A body that moves, at the last sweep.
  struct Mover {
    Polygon outline_W;
    Eigen::Vector2d velocity_W;
    double seen_s;
  };
  std::vector<Mover> movers_;
  std::optional<double> ahead_s_;                   ///< last range of a sonar that looks ahead
  std::shared_ptr<const OccupancySnapshot> space_;  ///< null where no sonar measures height
  double blanking_m_ = 0;                           ///< blanking distance of the sonar
  SensorTable rangers_;
  ImminentCollision imminent_;
  std::optional<Fix> fix_;
  std::optional<double> moved_s_;          ///< when a fix last differed from the one before
  std::optional<double> to_move_since_s_;  ///< since when it has been ordered to move, and not held back
  std::string jump_;
  Altitude altitude_;
  std::optional<Setpoint> order_;
  std::optional<Way> way_;
  bool ever_planned_ = false;
  bool surfacing_ = false;  ///< the last order is to surface: a stop becomes surfacing
  std::optional<Refusal> refusal_;
  std::string inside_;
  bool waits_for_turn_ = false;             ///< before a passage: it needs no route
  bool wants_route_ = true;                 ///< false: the point was dropped, and no other one is asked for
  std::optional<std::size_t> tried_point_;  ///< the last to which the Executive Officer set out

  std::string lost_agent_;
  std::string leak_;
  std::optional<double> battery_share_;
  double health_s_ = 0;
  std::optional<double> beat_s_;
  bool stopped_ = false;         ///< the vehicle has stopped since a collision lay ahead
  std::optional<Angle> turn_;    ///< heading away from a collision, to the freer side
  std::optional<Angle> inward_;  ///< heading away from the fence, of a vehicle that cannot stop
  int circle_ = 0;               ///< side of the circle on which it surfaces, 1 starboard; 0: it holds its heading
  bool hemmed_in_ = false;       ///< neither side was free when the turn was chosen
  CurrentEstimate current_;
  Escape way_out_;      ///< rest of the current escape manoeuvre of a vehicle that cannot stop
  Angle way_out_from_;  ///< heading at that time
};

}  // namespace isobath
