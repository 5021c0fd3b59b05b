#include <algorithm>
#include <isobath/mission/safety/fault_table.hpp>

namespace isobath {
namespace {

using Act = SafetyActionKind;
constexpr After kAtOnce{After::When::kAtOnce, nullptr};
Deadline within(double seconds) { return {Deadline::From::kInjection, seconds}; }
After later(double SafetyConfig::*wait) { return {After::When::kLater, wait}; }

std::vector<FaultRow> sonar_rows() {
  return {
      {.fault = Fault::kSonarSilent,
       .name = "sonar silent",
       .noticed = "no ping, none since the start, late pings, or a report of the host",
       .limits = {"sonar_silent_s", "startup_s"},
       .action = Act::kStop,
       .abort = later(&SafetyConfig::sonar_abort_s),
       .injected = "sonar: off",
       .deadline = within(2),
       .test = "FaultsOfASonar.Silent"},
      {.fault = Fault::kSonarFrozen,
       .name = "sonar frozen",
       .noticed = "identical samples, ping after ping",
       .limits = {"frozen_looks"},
       .action = Act::kStop,
       .abort = later(&SafetyConfig::sonar_abort_s),
       .injected = "sonar: stuck",
       .deadline = within(0.75),
       .test = "FaultsOfASonar.Frozen"},
      {.fault = Fault::kSonarSaturated,
       .name = "sonar saturated",
       .noticed = "share of samples at full scale",
       .limits = {"saturated_share", "bad_looks"},
       .action = Act::kStop,
       .abort = later(&SafetyConfig::sonar_abort_s),
       .injected = "sonar: saturated",
       .deadline = within(0.75),
       .test = "FaultsOfASonar.Saturated"},
      {.fault = Fault::kSonarDeaf,
       .name = "sonar deaf",
       .noticed = "all samples 0",
       .limits = {"deaf_s"},
       .action = Act::kStop,
       .abort = later(&SafetyConfig::sonar_abort_s),
       .injected = "sonar: wrong_gain",
       .deadline = within(5.5),
       .test = "FaultsOfASonar.Deaf"},
      {.fault = Fault::kSonarBlindSide,
       .name = "sonar blind on one side",
       .noticed = "level of one side, compared with the other",
       .limits = {"blind_share", "blind_looks"},
       .action = Act::kSlow,
       .abort = later(&SafetyConfig::blind_abort_s),
       .injected = "sonar: blind_side",
       .deadline = within(7),
       .test = "FaultsOfASonar.BlindOnOneSide"},
      {.fault = Fault::kSonarGarbled,
       .name = "sonar garbled",
       .noticed = "neighbouring bins that are not correlated",
       .limits = {"garbled_roughness", "bad_looks"},
       .action = Act::kStop,
       .abort = later(&SafetyConfig::sonar_abort_s),
       .injected = "sonar: garbage",
       .deadline = within(1),
       .test = "FaultsOfASonar.Garbled"},
  };
}

std::vector<FaultRow> navigation_rows() {
  return {
      {.fault = Fault::kNavigationSilent,
       .name = "navigation silent",
       .noticed = "no fix, none since the start, late fixes, or identical fixes while the vehicle is ordered to move",
       .limits = {"navigation_silent_s", "startup_s"},
       .action = Act::kStop,
       .later = Act::kSurface,
       .later_after = later(&SafetyConfig::navigation_surface_s),
       .abort = later(&SafetyConfig::navigation_surface_s),
       .injected = "navigation: off",
       .deadline = within(1.25),
       .test = "FaultsOfNavigation.Silent"},
      {.fault = Fault::kNavigationJump,
       .name = "navigation jumps",
       .noticed = "a fix that is not finite, or farther from the predicted position than a limit plus 4 standard "
                  "deviations",
       .limits = {"jump_m"},
       .action = Act::kStop,
       .abort = later(&SafetyConfig::jump_abort_s),
       .injected = "navigation: jump",
       .deadline = within(0.25),
       .test = "FaultsOfNavigation.Jump"},
      {.fault = Fault::kNavigationDrift,
       .name = "navigation drifts",
       .noticed = "standard deviation of the position",
       .limits = {"max_position_sigma_m"},
       .action = Act::kSlow,
       .abort = kAtOnce,
       .injected = "dvl: off",
       .deadline = within(15),
       .test = "FaultsOfNavigation.Drift"},
      {.fault = Fault::kDepthLost,
       .name = "depth sensor lost",
       .noticed = "a report of the host",
       .action = Act::kStop,
       .abort = later(&SafetyConfig::depth_sensor_abort_s),
       .injected = "depth: off",
       .deadline = within(1.25),
       .test = "FaultsOfNavigation.DepthLost"},
      {.fault = Fault::kAltitudeLost,
       .name = "altitude sensor lost",
       .noticed = "no reading of a downward sensor, no echo while an altitude is to be held, or a report of the host",
       .limits = {"altitude_silent_s", "startup_s"},
       .action = Act::kSlow,
       .abort = later(&SafetyConfig::altitude_abort_s),
       .injected = "altimeter: off",
       .deadline = within(2.5),
       .test = "FaultsOfNavigation.AltitudeLost"},
  };
}

std::vector<FaultRow> route_rows() {
  return {
      {.fault = Fault::kWayNotFollowed,
       .name = "way-points not followed",
       .noticed = "too far off the route, or no progress towards its next way-point",
       .limits = {"cross_track_m", "off_route_s", "progress_m", "progress_s"},
       .action = Act::kSlow,
       .abort = later(&SafetyConfig::route_abort_s),
       .injected = "a current faster than the vehicle",
       .deadline = {Deadline::From::kStart, 25},
       .test = "FaultsOfTheWay.NotFollowed"},
      {.fault = Fault::kInsideObstacle,
       .name = "inside an obstacle",
       .noticed = "a route is refused for this reason, until one is found; before the first route, a hazard over "
                  "the vehicle",
       .action = Act::kStop,
       .abort = later(&SafetyConfig::blocked_abort_s),
       .over = Over::kAtOnce,
       .injected = "an obstacle over the start",
       .deadline = {Deadline::From::kStart, 0.5},
       .test = "FaultsOfTheWay.InsideAnObstacle"},
      {.fault = Fault::kNoPath,
       .name = "no path",
       .noticed = "no route leads to the point, or there was no scan for too long, until a route is found; the time "
                  "counts anew for each further point that is tried",
       .action = Act::kStop,
       .abort = later(&SafetyConfig::blocked_abort_s),
       .over = Over::kAtOnce,
       .injected = "a wall from side to side",
       .deadline = {Deadline::From::kRefusal, 0.25},
       .test = "FaultsOfTheWay.NoPath"},
      {.fault = Fault::kPlannerOverBudget,
       .name = "planner over budget",
       .noticed = "a route is refused for this reason, until one is found",
       .action = Act::kSlow,
       .later = Act::kStop,
       .later_after = later(&SafetyConfig::budget_stop_s),
       .abort = later(&SafetyConfig::budget_abort_s),
       .over = Over::kAtOnce,
       .injected = "planner: wrong_scale",
       .deadline = {Deadline::From::kRefusal, 0.25},
       .test = "FaultsOfTheWay.PlannerOverBudget"},
  };
}

std::vector<FaultRow> collision_rows() {
  return {
      {.fault = Fault::kCollisionAhead,
       .name = "collision ahead",
       .noticed = "raw echoes of 2 pings or more that noise does not explain, raw ranges in 2 of 3, or an occupied "
                  "voxel, in the path of the hull within its stopping distance",
       .limits = {"reaction_s", "collision_margin_m", "side_margin_m", "confirm_m", "confirm_s"},
       .action = Act::kStop,
       .abort = later(&SafetyConfig::collision_abort_s),
       .injected = "a body on the path that is on no map",
       .deadline = {Deadline::From::kNearness, 1},
       .test = "LastDitch.StopsInTime"},
      {.fault = Fault::kCollisionUnavoidable,
       .name = "collision unavoidable",
       .noticed = "the same, nearer than the vehicle can stop; for a vehicle that cannot stop, an order that leaves "
                  "no escape "
                  "manoeuvre",
       .limits = {"reaction_s", "side_margin_m", "collision_margin_m", "escape_s", "unknown_current"},
       .action = Act::kTurn,
       .abort = later(&SafetyConfig::collision_abort_s),
       .injected = "a body that appears ahead of the bow",
       .deadline = {Deadline::From::kNearness, 1},
       .test = "LastDitch.TurnsToTheFreerSide"},
  };
}

std::vector<FaultRow> limit_rows() {
  return {
      {.fault = Fault::kFenceAhead,
       .name = "fence ahead",
       .noticed = "the stopping distance reaches over the fence; for a vehicle that cannot stop: the order leaves no "
                  "turn before the fence",
       .limits = {"reaction_s", "collision_margin_m", "escape_s"},
       .action = Act::kSlow,
       .unstoppable = Act::kTurn,
       .injected = "a route along the fence, with a current that sets towards it",
       .deadline = {Deadline::From::kCrossing, 0},
       .test = "Limits.FenceAhead"},
      {.fault = Fault::kFenceBreach,
       .name = "fence breached",
       .noticed = "outside the fence",
       .action = Act::kStop,
       .abort = kAtOnce,
       .injected = "a current over the fence",
       .deadline = {Deadline::From::kCrossing, 1},
       .test = "Limits.FenceBreached"},
      {.fault = Fault::kTooDeep,
       .name = "too deep",
       .noticed = "deeper than the mission or the vehicle allows",
       .limits = {"depth_slack_m", "max_depth_m"},
       .action = Act::kSurface,
       .abort = later(&SafetyConfig::depth_abort_s),
       .injected = "depth: drifting",
       .deadline = within(6.5),
       .test = "Limits.TooDeep"},
      {.fault = Fault::kTooLow,
       .name = "too near to the bottom",
       .noticed = "2 of 3 readings of a downward sensor",
       .limits = {"min_altitude_m"},
       .action = Act::kTurn,
       .abort = later(&SafetyConfig::low_altitude_abort_s),
       .injected = "a rising bottom",
       .deadline = {Deadline::From::kNearness, 1},
       .test = "Limits.TooLow"},
  };
}

std::vector<FaultRow> vehicle_rows() {
  return {
      {.fault = Fault::kAgentDead,
       .name = "agent dead",
       .noticed = "a report of the supervisor that it died or hangs",
       .action = Act::kStop,
       .later = Act::kSurface,
       .later_after = later(&SafetyConfig::agent_surface_s),
       .abort = kAtOnce,
       .over = Over::kNever,
       .injected = "agent.navigator: off",
       .deadline = within(0.5),
       .test = "FaultsOfTheVehicle.AgentDead"},
      {.fault = Fault::kLeak,
       .name = "leak",
       .noticed = "a report of the host",
       .action = Act::kSurface,
       .abort = kAtOnce,
       .end = "surface",
       .over = Over::kNever,
       .injected = "vehicle: leak",
       .deadline = within(1.25),
       .test = "FaultsOfTheVehicle.Leak"},
      {.fault = Fault::kBatteryLow,
       .name = "battery low",
       .noticed = "remaining charge",
       .limits = {"low_battery_share"},
       .abort = kAtOnce,
       .end = "by at_end of the mission, but surface instead of hold",
       .over = Over::kNever,
       .injected = "vehicle: battery",
       .deadline = within(1.25),
       .test = "FaultsOfTheVehicle.BatteryLow"},
      {.fault = Fault::kThrusterLost,
       .name = "thruster lost",
       .noticed = "a report of the host",
       .action = Act::kSlow,
       .abort = later(&SafetyConfig::thruster_abort_s),
       .injected = "thruster: thruster_loss",
       .deadline = within(0.25),
       .test = "FaultsOfTheVehicle.ThrusterLost"},
      {.fault = Fault::kHealthSilent,
       .name = "health silent",
       .noticed = "no health report of the vehicle, or a report that it is lost",
       .limits = {"health_silent_s", "startup_s"},
       .action = Act::kSlow,
       .injected = "health: off",
       .deadline = within(5.5),
       .test = "FaultsOfTheVehicle.HealthSilent"},
  };
}

std::vector<FaultRow> run_rows() {
  return {
      {.fault = Fault::kLinkLost,
       .name = "operator link lost",
       .noticed = "no heartbeat of an operator who was connected",
       .limits = {"link_silent_s"},
       .abort = later(&SafetyConfig::link_abort_s),
       .end = "by link_policy: continue, return or surface",
       .injected = "link: off",
       .deadline = within(31),
       .test = "FaultsOfTheVehicle.LinkLost"},
      {.fault = Fault::kClockJump,
       .name = "clock jump",
       .noticed = "a jump of the logical clock, or of a sensor's times against it",
       .limits = {"clock_jump_s"},
       .action = Act::kSlow,
       .injected = "vehicle: clock_jump",
       .deadline = within(1),
       .test = "FaultsOfTheVehicle.ClockJump"},
      {.fault = Fault::kDiskFull,
       .name = "disk full",
       .noticed = "a report of the host",
       .injected = "disk: off",
       .deadline = within(0.25),
       .test = "FaultsOfTheVehicle.DiskFull"},
      {.fault = Fault::kMissionTooLong,
       .name = "mission too long",
       .noticed = "time since the start of the mission",
       .limits = {"max_duration_s"},
       .abort = kAtOnce,
       .end = "by at_end of the mission",
       .over = Over::kNever,
       .injected = "a mission that is longer than its limit",
       .deadline = {Deadline::From::kOvertime, 0.25},
       .test = "Limits.MissionTooLong"},
  };
}

std::vector<FaultRow> all_rows() {
  std::vector<FaultRow> rows;
  for (auto& group :
       {sonar_rows(), navigation_rows(), route_rows(), collision_rows(), limit_rows(), vehicle_rows(), run_rows()})
    rows.insert(rows.end(), group.begin(), group.end());
  return rows;
}

}  // namespace

std::span<const FaultRow> fault_table() {
  static const std::vector<FaultRow> kRows = all_rows();
  return kRows;
}

const FaultRow& row_of(Fault fault) { return fault_table()[static_cast<std::size_t>(fault)]; }

std::string file_name_of(const FaultRow& row) {
  std::string name = row.name;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ' ' || c == '-'; }, '_');
  return name;
}

}  // namespace isobath
