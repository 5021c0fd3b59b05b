// SafetyOfficer: watches over everything else, apart from planning, and can only make things safer (Ganesan 2015, 5.1;
// Herman 1988, 3.4; Oskard 1990, III-D; ledger S6-39, S2-28, S2-E10, S1-43, S1-44).
//
// It hears what is sensed and what is said, and judges ten times a second: for each row of the fault table whether its
// cause holds, since when, and what that asks for. A row is raised with the first cycle in which its limit is exceeded
// and over `leave_s` after its cause is gone. What it says: SafetyAction, the strongest of what the raised rows ask
// for, whenever that changes; SafetyReport to the Captain when a row is raised, when it asks for the end of the
// mission, and when it is over (with `abort` still set where it asked for that); a Decision with the reason for each.
// No action asks for more speed than was ordered last, and a slow-down is a limit.
//
// Collisions: from the ground speed v and the turn of the moment the hull's way is predicted over v t + v^2 / 2b and a
// margin; raw echoes that two pings agree on, and raw ranges, must not lie in it (near_echoes.hpp,
// imminent_collision.hpp). It stops while it can; else it turns to the freer side; else it surfaces, and says that the
// collision could not be avoided. A vehicle that cannot stop must always have a way out: a turn, and then straight on,
// that meets nothing of what is known, for `escape_s`; before an order leads where there is none, the officer takes the
// last (safety_escape.cpp). Once it has stopped, it turns on the spot to where it was ordered to go, and the stop
// is over when the way lies free there for the ordered speed. Echoes are taken as at the height of the sonar.
// A place where all water at the vehicle's depth, and `height_margin_m` above and below it, was measured to be clear by
// a sonar that tells height (SpaceSeen) is passed over or under: it counts neither as echo nor as obstacle (S5-35).
// Those that bottom or surface explain do not come here where depth and altitude are known (sonar/boundary_echoes.hpp);
// where the altitude is not, a bottom within the beam's reach stops it.
//
// Times in messages are held against the logical clock and never used as one: a clock that jumps trips no watchdog but
// its own. All numbers are untrusted; what is not finite is as good as not said. One thread at a time.
#pragma once

#include <array>
#include <functional>
#include <isobath/mission/agent.hpp>
#include <isobath/mission/fault_table.hpp>
#include <isobath/mission/near_echoes.hpp>
#include <isobath/mission/safety_config.hpp>
#include <isobath/mission/sonar_watch.hpp>
#include <isobath/perception/imminent_collision.hpp>
#include <isobath/planning/escape.hpp>
#include <isobath/sonar/sensor_table.hpp>
#include <isobath/vehicle/guidance.hpp>
#include <isobath/vehicle/vehicle_sheet.hpp>
#include <map>
#include <optional>
#include <string>

namespace isobath {

class SafetyOfficer final : public Agent {
 public:
  SafetyOfficer(const SafetyConfig& config, const VehicleSheet& vehicle);

  void hear(const Message& message, Time now, Outbox& out) override;
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
    double since_s = 0;       ///< raised
    double last_cause_s = 0;  ///< in force
    bool aborted = false;
    std::optional<Eigen::Vector2d> place = {};  ///< N, E
    std::optional<double> margin_m = {};
  };
  /// Whose times are held against the logical clock.
  enum Speaker : std::uint8_t { kNavigator, kSonar, kRanger, kHost, kSpeakers };
  struct Offset {
    bool known = false;
    double s = 0;  ///< of the time in its messages, from the logical clock
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
    std::optional<Eigen::Vector2d> from;  ///< where it was ordered, or where the vehicle was found first
    std::vector<Eigen::Vector2d> points;  ///< `from` is the first
    std::size_t next = 1;
    double nearest_m = 0;  ///< to the next point, so far
    double progress_s = 0;
    std::optional<double> off_since_s;
    bool altitude = false;
  };
  struct Altitude {
    bool spoken = false;
    double heard_s = 0;
    double echo_s = 0;
    double last_m = 0;
    std::uint32_t low = 0;  ///< of the last three, the newest in bit 0
  };

  // Hearing (safety_hearing.cpp)
  void set_clock(Time now);
  bool in_time(Speaker speaker, Time said, Time now);
  void hear_fix(const Navigation& fix, Time now);
  void hear_look(const SonarLook& look, Time now);
  void hear_echoes(const SonarEchoes& echoes, Time now);
  void hear_range(const RangeReading& reading, Time now);
  void hear_altitude(const RangeReading& reading, double down);
  void hear_health(const Health& health, Time now);
  void hear_command(const OperatorCommand& command);
  void hear_scan(const ObstacleScan& scan);
  void hear_lost(const AgentLost& lost);
  void start(const std::shared_ptr<const MissionPlan>& plan);
  void follow(const FollowOrder& order);

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

  // Ways out, of a vehicle that cannot stop (safety_escape.cpp)
  [[nodiscard]] bool passes_by(const Eigen::Vector3d& p_W) const;
  [[nodiscard]] std::vector<Eigen::Vector2d> at_its_depth(const Pose& X_WL,
                                                          std::span<const Eigen::Vector2d> echoes_L) const;
  [[nodiscard]] std::vector<Eigen::Vector2d> known_points(const Pose& X_WL,
                                                          std::span<const Eigen::Vector2d> echoes_L) const;
  [[nodiscard]] EscapeTask escape_task() const;
  [[nodiscard]] double ordered_turn() const;
  void check_escape(const Pose& X_WL, std::span<const Eigen::Vector2d> echoes_L);

  // Acting (safety_officer.cpp)
  void settle(const FaultRow& about, Time now, Outbox& out);
  void report(const FaultRow& about, bool active, bool abort, Time now, Outbox& out);
  [[nodiscard]] SafetyActionKind asked(const FaultRow& about) const;
  [[nodiscard]] MissionEnd end_of(Fault fault) const;
  [[nodiscard]] SafetyAction strongest() const;
  [[nodiscard]] Setpoint turned(const SafetyAction& action) const;
  void act(Time now, Outbox& out);

  SafetyConfig config_;
  VehicleSheet vehicle_;
  std::array<Row, kFaults> rows_;
  SafetyAction action_;
  bool told_ = false;  ///< a row changed in this cycle: its decision covers the change of action

  std::optional<Time> now_;
  double clock_s_ = 0;  ///< logical time since the first call, less what it jumped
  std::array<Offset, kSpeakers> offsets_;
  std::string jumped_;

  MissionPhase phase_ = MissionPhase::kWaiting;
  std::shared_ptr<const MissionPlan> plan_;
  double started_s_ = 0;

  std::map<std::string, SonarWatch> sonars_;
  std::map<std::string, HealthState> states_;
  NearEchoes echoes_;
  std::vector<Eigen::Vector2d> mapped_W_;   ///< what the last scan's obstacles are made of
  std::shared_ptr<const SpaceGrid> space_;  ///< null where no sonar tells height
  double blind_m_ = 0;                      ///< nearer than this the sonar hears nothing
  SensorTable rangers_;
  ImminentCollision imminent_;
  std::optional<Fix> fix_;
  std::optional<double> moved_s_;          ///< when a fix last differed from the one before
  std::optional<double> to_move_since_s_;  ///< ordered to, and not held back
  std::string jump_;
  Altitude altitude_;
  std::optional<Setpoint> order_;
  std::optional<Way> way_;
  bool ever_planned_ = false;
  bool surfacing_ = false;  ///< the last order is to surface: what would stop the vehicle lets it
  std::optional<Refusal> refusal_;
  std::string inside_;

  std::string lost_agent_;
  std::string leak_;
  std::optional<double> battery_share_;
  double health_s_ = 0;
  std::optional<double> beat_s_;
  bool stopped_ = false;       ///< since a collision lay ahead
  std::optional<Angle> turn_;  ///< away from a collision: where it gets farther
  bool hemmed_in_ = false;     ///< neither side was free when the turn was chosen
  Drift drift_;                ///< of the vehicle, as far as it was crossed
  Escape way_out_;             ///< what is left of the one that a vehicle that cannot stop takes
  Angle way_out_from_;         ///< heading when that was so
};

}  // namespace isobath
