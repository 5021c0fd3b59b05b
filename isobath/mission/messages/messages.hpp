// Messages: everything that agents send to one another, as plain data (Ganesan 2015, 5.1; ledger S6-32, S6-33).
//
// Each message is one alternative of Message. Large content (maps, plans) goes by pointer to an object that never
// changes again, so that agents in different threads may read it. Positions are in W unless a name says otherwise; SI
// units.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/map/occupancy/obstacle_memory.hpp>
#include <isobath/mission/plan/command_level.hpp>
#include <isobath/mission/plan/mission_plan.hpp>
#include <isobath/perception/obstacle_detector.hpp>
#include <isobath/planning/hazard_map.hpp>
#include <isobath/planning/world_snapshot.hpp>
#include <isobath/sonar/ping.hpp>
#include <isobath/sonar/range_reading.hpp>
#include <isobath/sonar/scan_command.hpp>
#include <isobath/vehicle/guidance.hpp>
#include <isobath/vehicle/health.hpp>
#include <isobath/vehicle/navigation.hpp>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace isobath {

// Sensor input -------------------------------------------------------------------------------------------------------

/// The obstacles at the end of one sweep, as the pipeline reports them, in the vehicle's frame of that instant.
struct Sweep {
  int number = 0;  ///< from 1
  bool posed = true;
  double sigma_m = 0;                                ///< of the vehicle's horizontal position
  std::shared_ptr<const Detection> map;              ///< never null
  Eigen::Vector2d jumped = Eigen::Vector2d::Zero();  ///< sum of all jumps of the position so far, in W, m
};

/// The remembered obstacles around the vehicle, whether or not the last sweep showed them; in W.
struct KnownObstacles {
  int sweep = 0;  ///< the last sweep in the memory
  std::vector<RememberedObstacle> obstacles;
  std::vector<std::uint32_t> seen_as;  ///< for each obstacle of that sweep the id; 0: none
};

/// FLSDetector -> Navigator: all obstacles: those of the last sweep, remembered ones, and those that a person injected.
struct ObstacleScan {
  int number = 0;  ///< from 1
  Time time;
  Pose X_WL;  ///< at the instant of the sweep; the frame of `hazards`
  bool posed = true;
  std::vector<Hazard> hazards;                            ///< in L
  std::shared_ptr<const KnownObstacles> known = nullptr;  ///< null where there is no pose
};

/// Chart room -> Navigator: the hazards around the vehicle that chart and depth map contain; replaces those before.
/// In W.
struct ChartedHazards {
  std::shared_ptr<const std::vector<Hazard>> hazards;
  std::optional<Time> looked_ahead = {};  ///< as in WorldSnapshot
};

/// Commodore -> Navigator: the water in which other vehicles of the group circle while they wait, and passages that
/// count as blocked; replaces those before. In W.
struct GroupHazards {
  std::vector<Hazard> hazards;
};

/// Commodore -> FLS Detector: obstacles that other vehicles of the group have seen.
struct GroupObstacles {
  std::vector<ToldObstacle> obstacles;
};

// WorldSnapshot (planning/world_snapshot.hpp), maps -> all agents: all maps from now on; replaces the one before.

/// Quality of one ping, sent as soon as the ping arrives.
struct SonarHealthSample {
  Time time;
  std::string sonar;                ///< "sonar", "sonar.2" ...
  std::uint64_t digest = 0;         ///< of the samples: equal digests mean equal samples
  double mean = 0;                  ///< of the samples, share of full scale
  double full_scale = 0;            ///< share of samples at full scale
  double silent = 0;                ///< share of samples at zero
  double roughness = 0;             ///< mean step between neighbouring range bins, share of full scale
  std::optional<double> port;       ///< mean of the beams to that side; empty: no beam looks there
  std::optional<double> starboard;  ///< likewise
  Angle bearing;                    ///< of the middle of the fan, from forward
};

/// The nearest echoes of one ping before any map has accepted them, sent once the pose is known. For a ping whose
/// echoes could not be told from noise there is no such message.
struct SonarEchoes {
  Time time;
  Pose X_WL;                                          ///< at the instant of the ping; the frame of the echoes
  double blanking_m = 0;                              ///< blanking distance: the sonar receives no nearer echoes
  std::vector<Eigen::Vector2d> echoes_L;              ///< x forward, y starboard, m; at most one a beam, the nearest
  std::shared_ptr<const BeamFan> fan;                 ///< of `silent_m`; null: nothing is said of silence
  Eigen::Vector2d sonar_L = Eigen::Vector2d::Zero();  ///< where the sonar is
  Angle boresight_L;                                  ///< from which the azimuths of the fan count
  std::vector<float> silent_m;                        ///< by beam: the range up to which nothing stands out
};

// From the operator --------------------------------------------------------------------------------------------------

struct OperatorCommand {
  enum class Kind : std::uint8_t {
    kStart,
    kAbort,
    kHold,
    kResume,
    kBeat,
    kAcknowledge,
    kNewMission,  ///< `plan` replaces the mission, under way too
    kReturn,      ///< back to where the mission started
    kHandOver     ///< `by` is a sentence that says who has command from now on
  } kind = Kind::kBeat;
  std::shared_ptr<const MissionPlan> plan = {};  ///< with kStart and kNewMission
  std::string by = {};                           ///< who gave it: "the page at 192.168.2.7"; empty: not known
};

// Captain, Executive Officer, Navigator, Pilot -----------------------------------------------------------------------

enum class MissionPhase : std::uint8_t { kWaiting, kUnderWay, kHolding, kFinished, kAborted };
const char* to_text(MissionPhase phase);

/// Captain -> Executive Officer.
struct MissionOrder {
  enum class Kind : std::uint8_t { kStart, kHold, kResume, kAbort } kind = Kind::kStart;
  std::shared_ptr<const MissionPlan> plan = {};
  MissionEnd end = MissionEnd::kHold;  ///< how the mission ends, with kAbort
  std::string why;
  bool replaces = false;  ///< with kStart: instead of the mission before, whose start stays the place to return to
};
const char* to_text(MissionOrder::Kind kind);

/// Captain -> Executive Officer: a point has moved (S6-65).
struct PointMoved {
  std::size_t point = 0;
  Eigen::Vector2d north_east = Eigen::Vector2d::Zero();
};

/// Commodore -> Executive Officer, Captain: the points of the mission to visit from now on, in this order, instead of
/// those that are still to come. If the vehicle is on its way to the first of them, it goes on.
struct VisitOrder {
  std::uint32_t version = 0;
  std::vector<std::size_t> points;
  bool last = false;  ///< the mission ends after them; else the vehicle waits for the next order
  std::string why;
  bool given_up = false;  ///< no vehicle of the group finds a way to what is left: for the Captain (S2-17)
};

/// Commodore -> Executive Officer: the vehicle waits where it is until it is its turn in a passage, or goes on (S2-17).
struct PassageWait {
  bool waits = false;
  std::string why;
};

/// Executive Officer -> Navigator: asks for a route to this point; replaces the request before.
struct RouteRequest {
  std::uint32_t id = 0;
  std::size_t point = 0;  ///< index in the plan
  MissionPoint target;
  bool last = false;                           ///< no other point follows
  std::optional<Eigen::Vector2d> then_W = {};  ///< the next point, if the vehicle goes on to it without a stop
};

/// Navigator -> Executive Officer. Replaces the rest of the route before.
struct RoutePlanned {
  std::uint32_t request = 0;
  std::uint32_t version = 0;
  std::vector<Waypoint> waypoints;
  bool avoiding = false;                       ///< the route goes round an obstacle
  std::string why;                             ///< names obstacle, leg and margin
  std::optional<Eigen::Vector2d> then_W = {};  ///< where the route to the next point will first lead
};

/// Navigator -> Executive Officer, Captain: there is no route to this point.
struct RouteRefused {
  enum class Reason : std::uint8_t {
    kStartBlocked,  ///< the vehicle is inside an obstacle
    kGoalBlocked,   ///< an obstacle on the point, or nearer than the drop distance
    kNoPath,
    kOutOfBudget,
    kOutsideFence,
    kNoMap,  ///< there was no scan for too long
  } reason = Reason::kNoPath;
  std::uint32_t request = 0;
  std::size_t point = 0;
  std::optional<Eigen::Vector2d> safe_nearby;  ///< nearest clear place to the point, if one was searched for
  std::string why;
};
const char* to_text(RouteRefused::Reason reason);

/// Executive Officer -> Captain, Commodore.
struct PointReport {
  enum class Kind : std::uint8_t {
    kReached,
    kDropped,
    kTaken,     ///< the vehicle is on its way there
    kAvoiding,  ///< the route there goes round an obstacle (S6-56)
    kTask,      ///< a back-seat driver is wanted there for the task that `why` names
    kTold       ///< a step of a task tells the operator `why`
  } kind = Kind::kReached;
  std::size_t point = 0;
  std::string why;
  bool no_way = false;  ///< kDropped: for want of a route, not because of what stands on the point
};
struct MissionReport {
  MissionPhase phase = MissionPhase::kWaiting;
  std::size_t reached = 0, dropped = 0;
  std::string why;

  /// Counts a point that was reached or dropped since the report.
  void update(const PointReport& point) {
    reached += point.kind == PointReport::Kind::kReached ? 1 : 0;
    dropped += point.kind == PointReport::Kind::kDropped ? 1 : 0;
  }
};

/// Executive Officer -> Pilot: follow these way-points; an empty list: hold the position.
struct FollowOrder {
  std::uint32_t version = 0;
  std::vector<Waypoint> waypoints;
  std::optional<double> altitude_m;
  bool surface = false;
  std::optional<Eigen::Vector2d> then_W = {};  ///< where it will go on after the last way-point; empty: it stops there
};

/// Navigator -> Goal Selector: all hazards that lie still, in W, at each cycle in which one moves, or the vehicle holds
/// its position. Not while the route leads over or under a hazard of the plane.
struct StillHazards {
  Time time;
  std::shared_ptr<const std::vector<Hazard>> hazards;
};

/// Goal Selector -> Pilot, Navigator: the motion past bodies that move. The Pilot follows it instead of the legs
/// between the way-points of its FollowOrder, or of holding its position; the Navigator leaves these bodies to the Goal
/// Selector; both while the last order is younger than kLasts.
struct MotionOrder {
  static constexpr Duration kLasts = std::chrono::milliseconds(500);
  std::uint32_t version = 0;                             ///< of the FollowOrder
  std::size_t waypoint = 0;                              ///< that the motion leads to; those before it count as passed
  Time time;                                             ///< of the order
  Eigen::Vector2d place_W = Eigen::Vector2d::Zero();     ///< where it should be at that time
  Eigen::Vector2d velocity_W = Eigen::Vector2d::Zero();  ///< over ground, that it should have at `at`
  Time at;                                               ///< later than `time` by the lag of the vehicle's heading
};

/// Executive Officer -> vehicle: how the scanning sonar looks from now on (S2-16); empty: as configured.
struct SonarOrder {
  std::optional<ScanCommand> scan;
};
/// How the sonar looks during a step of a task; empty: as configured.
std::optional<ScanCommand> scan_of(const TaskStep& step);

/// Pilot -> Executive Officer.
struct WaypointPassed {
  std::uint32_t version = 0;
  std::size_t index = 0;
  bool reached = false;  ///< within the radius; false: passed abeam
  bool last = false;
};

/// Pilot -> vehicle, unless the Safety Officer's action overrides it.
struct HelmOrder {
  Setpoint setpoint;
};

/// Captain, Commodore, Executive Officer, Navigator, Pilot -> recording and page: this level of command has planned.
struct LevelPlan {
  CommandLevel level = CommandLevel::kMission;
  double horizon_s = 0;  ///< how far ahead the plan reaches; 0: there is nothing to plan
  bool changed = false;  ///< it differs from the plan before
};

/// Executive Officer -> recording and page: where the vehicle is in its plan graph. Sent at each node that it reaches,
/// and with each other graph.
struct PlanStep {
  std::shared_ptr<const PlanGraph> graph;  ///< never null; the same object while the graph is the same
  std::size_t node = 0;
  bool other_graph = false;  ///< than that of the message before
};
/// Where it is and what may follow: "point 1: circle" (node 4 of 9); next "point 2" on task done.
std::string text_of_step(const PlanStep& step);

// Safety Officer -----------------------------------------------------------------------------------------------------

enum class SafetyActionKind : std::uint8_t { kNone, kSlow, kStop, kTurn, kSurface };
const char* to_text(SafetyActionKind kind);

/// Overrides every HelmOrder until an action of kind kNone revokes it.
struct SafetyAction {
  SafetyActionKind kind = SafetyActionKind::kNone;
  Setpoint setpoint;  ///< for kTurn; speed limit for kSlow; heading for kSurface
  std::string fault;  ///< row of docs/faults.md: "sonar silent"
  std::string why;
};

/// Safety Officer -> Captain.
struct SafetyReport {
  std::string fault;
  bool active = true;  ///< false: the fault is over
  bool abort = false;  ///< the mission must end
  MissionEnd end = MissionEnd::kSurface;
  std::string why;
};

// Supervision, link, back-seat drivers -------------------------------------------------------------------------------

/// Supervisor -> all: an agent died (threw) or hangs (did not answer).
struct AgentLost {
  std::string agent;
  bool hung = false;
  std::string why;
};

/// For the operator; the Signaling Officer sends it.
struct StatusReport {
  MissionPhase phase = MissionPhase::kWaiting;
  std::size_t point = 0, points = 0;
  std::string text;
};

/// One frame on the link to the operator, or to the other vehicles of the group, as it is transmitted or was received
/// (S6-40, S2-51).
struct LinkFrame {
  enum class Way : std::uint8_t { kToOperator, kFromOperator, kToGroup, kFromGroup } way = Way::kToOperator;
  std::vector<std::uint8_t> bytes;
};

struct TaskCall {
  std::uint32_t id = 0;
  std::string task;
  MissionPoint at;
};
struct TaskBid {
  std::uint32_t id = 0;
  std::string driver;
  double suitability = 0;  ///< above 0; the highest wins
};
struct TaskAward {
  std::uint32_t id = 0;
  std::string driver;
};
struct TaskPlan {
  std::uint32_t id = 0;
  std::string driver;
  std::vector<Waypoint> waypoints;
  double drop_distance_m = 0;  ///< an obstacle that is nearer blocks a way-point; 0: the Navigator's
};

/// An opening on the route, as the vehicle knows it (mission/agents/opening_watch.hpp).
struct OpeningSighting {
  double distance_m = 0;  ///< to its plane
  double width_m = 0;
  double height_m = 0;    ///< 0: unknown
  double free_share = 0;  ///< of its face
};

/// How near the vehicle will come to a body that moves, by its plan (mission/agents/goal_selector.hpp).
struct ClosestApproach {
  double in_s = 0;   ///< from the decision on
  double gap_m = 0;  ///< between the hull and the body's outline, which is grown by its uncertainty
};

/// A decision, with its agent and its reason: for the recorder, the page and the report.
///
/// `number` counts the decisions of all agents of a run from 1, in the order in which the bus carried them, which is
/// the order of time. The terminal, decisions.json, the report, the live page, its player and the recording all show
/// this number. It is 0 until the decision has passed the bus, which sets it.
struct Decision {
  Time time;
  std::string agent;
  std::string what;                              ///< "replan", "drop point", "stop" ...
  std::string reason;                            ///< whole sentence; names obstacle, leg and margin where there are any
  std::optional<Eigen::Vector2d> obstacle = {};  ///< N, E of the obstacle's nearest point
  std::optional<int> leg = {};                   ///< from 1
  std::optional<double> margin_m = {};           ///< clearance of the old route; negative: it led through the obstacle
  std::vector<Eigen::Vector2d> way = {};         ///< N, E of the new route
  int obstacle_number = 0;                       ///< Obstacle::number of that obstacle; 0: it has none
  std::optional<OpeningSighting> opening = {};   ///< that it is about
  std::optional<ClosestApproach> approach = {};  ///< to that obstacle, which moves
  std::uint64_t number = 0;                      ///< from 1; set by the bus
};
/// One line: "27.200 s navigator: replan: leg 1 would run into an obstacle at north 44.7, east 2.4 m ...".
std::string to_text(const Decision& decision);

using Message =
    std::variant<Navigation, RangeReading, Health, SonarHealthSample, SonarEchoes, Sweep, ObstacleScan, ChartedHazards,
                 GroupHazards, GroupObstacles, OperatorCommand, MissionOrder, VisitOrder, PointMoved, RouteRequest,
                 RoutePlanned, RouteRefused, PointReport, MissionReport, FollowOrder, StillHazards, MotionOrder,
                 WaypointPassed, HelmOrder, SafetyAction, SafetyReport, AgentLost, StatusReport, TaskCall, TaskBid,
                 TaskAward, TaskPlan, Decision, WorldSnapshot, LinkFrame, LevelPlan, SonarOrder, PassageWait, PlanStep>;

}  // namespace isobath
