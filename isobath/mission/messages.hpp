// Messages: all that agents say to one another, as plain data (Ganesan 2015, 5.1; ledger S6-32, S6-33).
//
// Each is one alternative of Message. What is large (maps, plans) goes by pointer to something that never changes
// again, so that agents in different threads may look at it. Positions in W unless a name says otherwise, SI units.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/map/depth_field.hpp>
#include <isobath/map/obstacle_memory.hpp>
#include <isobath/map/space_grid.hpp>
#include <isobath/mission/mission_plan.hpp>
#include <isobath/perception/obstacle_detector.hpp>
#include <isobath/planning/hazard_map.hpp>
#include <isobath/planning/traversability.hpp>
#include <isobath/sonar/range_reading.hpp>
#include <isobath/vehicle/guidance.hpp>
#include <isobath/vehicle/health.hpp>
#include <isobath/vehicle/navigation.hpp>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace isobath {

// What is sensed --------------------------------------------------------------------------------------------------

/// The obstacles at the end of one sweep, as the pipeline has them, in the vehicle's frame of that instant.
struct Sweep {
  int number = 0;  ///< from 1
  bool posed = true;
  double sigma_m = 0;                    ///< of the vehicle's place in the plane
  std::shared_ptr<const Detection> map;  ///< never null
};

/// What is remembered around, whether or not the last sweep showed it; in W.
struct KnownObstacles {
  int sweep = 0;  ///< the last that was taken in
  std::vector<RememberedObstacle> obstacles;
  std::vector<std::uint32_t> seen_as;  ///< of each obstacle of that sweep, the id; 0: of none
};

/// FLSDetector -> Navigator: what is in the way: the last sweep, what is remembered, what a person injected.
struct ObstacleScan {
  int number = 0;  ///< from 1
  Time time;
  Pose X_WL;  ///< of the instant of the sweep; the frame of `hazards`
  bool posed = true;
  std::vector<Hazard> hazards;                            ///< in L
  std::shared_ptr<const KnownObstacles> known = nullptr;  ///< null: without a place
};

/// Map in three dimensions -> Navigator: the water around, where a sonar tells height; replaces what it said before.
struct SpaceSeen {
  Time time;
  std::shared_ptr<const SpaceGrid> grid;  ///< never null
};

/// Chart room -> Navigator: what the chart says of the water around; replaces what it said before. In W.
struct ChartedHazards {
  std::shared_ptr<const std::vector<Hazard>> hazards;
};

/// Maps -> Chart room: the chart as it is from now on. Either may be null: none.
struct ChartUpdate {
  std::shared_ptr<const DepthField> depths;
  std::shared_ptr<const std::vector<ChartObstacle>> objects;
};

/// What one ping says about the sonar itself, as soon as it is heard.
struct SonarLook {
  Time time;
  std::string sonar;                ///< "sonar", "sonar.2" ...
  std::uint64_t digest = 0;         ///< of the samples: equal ones mean equal samples
  double mean = 0;                  ///< of the samples, share of full scale
  double full_scale = 0;            ///< share of samples at full scale
  double silent = 0;                ///< share of samples at zero
  double roughness = 0;             ///< mean step between neighbouring range bins, share of full scale
  std::optional<double> port;       ///< mean of the beams to that side; empty: none looks there
  std::optional<double> starboard;  ///< likewise
  Angle bearing;                    ///< of the middle of the fan, from forward
};

/// The nearest echoes of one ping before any map has believed them, once its place is known; of a ping in which echoes
/// could not be told from noise, nothing is said.
struct SonarEchoes {
  Time time;
  Pose X_WL;                              ///< of the instant of the ping; the frame of the echoes
  double blind_m = 0;                     ///< nearer than this the sonar hears nothing
  std::vector<Eigen::Vector2d> echoes_L;  ///< x forward, y starboard, m; at most one a beam, the nearest
};

// From the operator --------------------------------------------------------------------------------------------------

struct OperatorCommand {
  enum class Kind : std::uint8_t { kStart, kAbort, kHold, kResume, kBeat } kind = Kind::kBeat;
  std::shared_ptr<const MissionPlan> plan = {};  ///< with kStart
};

// Captain, Executive Officer, Navigator, Pilot -----------------------------------------------------------------------

enum class MissionPhase : std::uint8_t { kWaiting, kUnderWay, kHolding, kFinished, kAborted };
const char* to_text(MissionPhase phase);

/// Captain -> Executive Officer.
struct MissionOrder {
  enum class Kind : std::uint8_t { kStart, kHold, kResume, kAbort } kind = Kind::kStart;
  std::shared_ptr<const MissionPlan> plan = {};
  MissionEnd end = MissionEnd::kHold;  ///< how it ends, with kAbort
  std::string why;
};

/// Captain -> Executive Officer: a point stands somewhere else now (S6-65).
struct PointMoved {
  std::size_t point = 0;
  Eigen::Vector2d north_east = Eigen::Vector2d::Zero();
};

/// Executive Officer -> Navigator: a way to this point, please; replaces the request before.
struct RouteRequest {
  std::uint32_t id = 0;
  std::size_t point = 0;  ///< index in the plan
  MissionPoint target;
  bool last = false;  ///< whether no other point follows
};

/// Navigator -> Executive Officer. Replaces what is left of the way before.
struct RoutePlanned {
  std::uint32_t request = 0;
  std::uint32_t version = 0;
  std::vector<Waypoint> waypoints;
  bool avoiding = false;  ///< it goes round something
  std::string why;        ///< names obstacle, leg and margin
};

/// Navigator -> Executive Officer, Captain: there is no way to this point.
struct RouteRefused {
  enum class Reason : std::uint8_t {
    kStartBlocked,  ///< inside an obstacle
    kGoalBlocked,   ///< an obstacle on the point, or nearer than the drop distance
    kNoPath,
    kOutOfBudget,
    kOutsideFence,
    kNoMap,  ///< nothing was seen for too long
  } reason = Reason::kNoPath;
  std::uint32_t request = 0;
  std::size_t point = 0;
  std::optional<Eigen::Vector2d> safe_nearby;  ///< nearest place to the point that is clear, if one was looked for
  std::string why;
};
const char* to_text(RouteRefused::Reason reason);

/// Executive Officer -> Captain.
struct PointReport {
  enum class Kind : std::uint8_t {
    kReached,
    kDropped,
    kTaken,    ///< it is on its way there
    kAvoiding  ///< the way there goes round something (S6-56)
  } kind = Kind::kReached;
  std::size_t point = 0;
  std::string why;
};
struct MissionReport {
  MissionPhase phase = MissionPhase::kWaiting;
  std::size_t reached = 0, dropped = 0;
  std::string why;
};

/// Executive Officer -> Pilot: follow these; an empty list: hold the place.
struct FollowOrder {
  std::uint32_t version = 0;
  std::vector<Waypoint> waypoints;
  std::optional<double> altitude_m;
  bool surface = false;
};

/// Pilot -> Executive Officer.
struct WaypointPassed {
  std::uint32_t version = 0;
  std::size_t index = 0;
  bool reached = false;  ///< within the radius; else passed abeam
  bool last = false;
};

/// Pilot -> vehicle, by way of the Safety Officer's word.
struct HelmOrder {
  Setpoint setpoint;
};

// Safety Officer -----------------------------------------------------------------------------------------------------

enum class SafetyActionKind : std::uint8_t { kNone, kSlow, kStop, kTurn, kSurface };
const char* to_text(SafetyActionKind kind);

/// Stands above every HelmOrder until it is taken back by one of kind kNone.
struct SafetyAction {
  SafetyActionKind kind = SafetyActionKind::kNone;
  Setpoint setpoint;  ///< of kTurn; speed limit of kSlow; heading of kSurface
  std::string fault;  ///< row of docs/faults.md: "sonar silent"
  std::string why;
};

/// Safety Officer -> Captain.
struct SafetyReport {
  std::string fault;
  bool active = true;  ///< false: it is over
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

/// For the operator: what the Signaling Officer sends.
struct StatusReport {
  MissionPhase phase = MissionPhase::kWaiting;
  std::size_t point = 0, points = 0;
  std::string text;
};

/// One frame on the link to the operator, as it goes over the air or came from there (S6-40).
struct LinkFrame {
  enum class Way : std::uint8_t { kToOperator, kFromOperator } way = Way::kToOperator;
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
};

/// Something was decided, by whom and why: for the recorder, the page and the report.
struct Decision {
  Time time;
  std::string agent;
  std::string what;    ///< "replan", "drop point", "stop" ...
  std::string reason;  ///< whole sentence; names obstacle, leg and margin where there are such
  std::optional<Eigen::Vector2d> obstacle = {};  ///< N, E of its nearest point
  std::optional<int> leg = {};                   ///< from 1
  std::optional<double> margin_m = {};           ///< clearance that the old way had left; negative: through it
  std::vector<Eigen::Vector2d> way = {};         ///< N, E of the new one
};

using Message =
    std::variant<Navigation, RangeReading, Health, SonarLook, SonarEchoes, Sweep, ObstacleScan, ChartedHazards,
                 OperatorCommand, MissionOrder, PointMoved, RouteRequest, RoutePlanned, RouteRefused, PointReport,
                 MissionReport, FollowOrder, WaypointPassed, HelmOrder, SafetyAction, SafetyReport, AgentLost,
                 StatusReport, TaskCall, TaskBid, TaskAward, TaskPlan, Decision, ChartUpdate, LinkFrame, SpaceSeen>;

}  // namespace isobath
