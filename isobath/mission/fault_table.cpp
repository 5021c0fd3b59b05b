#include <algorithm>
#include <fmt/format.h>
#include <isobath/mission/fault_table.hpp>

namespace isobath {
namespace {

using Act = SafetyActionKind;
constexpr After kNever{};
constexpr After kAtOnce{After::When::kAtOnce, nullptr};
After later(double SafetyConfig::*wait) { return {After::When::kLater, wait}; }

std::vector<FaultRow> sensor_rows() {
  using C = SafetyConfig;
  const After useless = later(&C::sonar_abort_s);
  return {
      {Fault::kSonarSilent,
       "sonar silent",
       "no ping, none since the start, pings that come late, or the host says so",
       {"sonar_silent_s", "startup_s"},
       Act::kStop,
       Act::kNone,
       kNever,
       useless,
       "",
       Over::kLater,
       "sonar: off",
       "FaultsOfASonar.Silent"},
      {Fault::kSonarFrozen,
       "sonar frozen",
       "samples equal to the last bit, ping after ping",
       {"frozen_looks"},
       Act::kStop,
       Act::kNone,
       kNever,
       useless,
       "",
       Over::kLater,
       "sonar: stuck",
       "FaultsOfASonar.Frozen"},
      {Fault::kSonarSaturated,
       "sonar saturated",
       "share of samples at full scale",
       {"saturated_share", "bad_looks"},
       Act::kStop,
       Act::kNone,
       kNever,
       useless,
       "",
       Over::kLater,
       "sonar: saturated",
       "FaultsOfASonar.Saturated"},
      {Fault::kSonarDeaf,
       "sonar deaf",
       "all samples 0",
       {"deaf_s"},
       Act::kStop,
       Act::kNone,
       kNever,
       useless,
       "",
       Over::kLater,
       "sonar: wrong_gain",
       "FaultsOfASonar.Deaf"},
      {Fault::kSonarBlindSide,
       "sonar blind on one side",
       "one side's level, beside the other's",
       {"blind_share", "blind_looks"},
       Act::kSlow,
       Act::kNone,
       kNever,
       later(&C::blind_abort_s),
       "",
       Over::kLater,
       "sonar: blind_side",
       "FaultsOfASonar.BlindOnOneSide"},
      {Fault::kSonarGarbled,
       "sonar garbled",
       "neighbouring bins that have nothing to do with one another",
       {"garbled_roughness", "bad_looks"},
       Act::kStop,
       Act::kNone,
       kNever,
       useless,
       "",
       Over::kLater,
       "sonar: garbage",
       "FaultsOfASonar.Garbled"},
      {Fault::kNavigationSilent,
       "navigation silent",
       "no fix, none since the start, fixes that come late or repeat to the last bit while it is to move",
       {"navigation_silent_s", "startup_s"},
       Act::kStop,
       Act::kSurface,
       later(&C::navigation_surface_s),
       later(&C::navigation_surface_s),
       "",
       Over::kLater,
       "navigation: off",
       "FaultsOfNavigation.Silent"},
      {Fault::kNavigationJump,
       "navigation jumps",
       "a fix that is not finite, or farther from where speed leads than 4 deviations and a limit",
       {"jump_m"},
       Act::kStop,
       Act::kNone,
       kNever,
       later(&C::jump_abort_s),
       "",
       Over::kLater,
       "navigation: jump",
       "FaultsOfNavigation.Jump"},
      {Fault::kNavigationDrift,
       "navigation drifts",
       "standard deviation of the position",
       {"max_position_sigma_m"},
       Act::kSlow,
       Act::kNone,
       kNever,
       kAtOnce,
       "",
       Over::kLater,
       "dvl: off",
       "FaultsOfNavigation.Drift"},
      {Fault::kDepthLost,
       "depth sensor lost",
       "the host says so",
       {},
       Act::kStop,
       Act::kNone,
       kNever,
       later(&C::depth_sensor_abort_s),
       "",
       Over::kLater,
       "depth: off",
       "FaultsOfNavigation.DepthLost"},
      {Fault::kAltitudeLost,
       "altitude sensor lost",
       "no reading of a sensor that looks down, no echo where an altitude is to be held, or the host says so",
       {"altitude_silent_s", "startup_s"},
       Act::kSlow,
       Act::kNone,
       kNever,
       later(&C::altitude_abort_s),
       "",
       Over::kLater,
       "altimeter: off",
       "FaultsOfNavigation.AltitudeLost"},
  };
}

std::vector<FaultRow> way_rows() {
  using C = SafetyConfig;
  return {
      {Fault::kWayNotFollowed,
       "way-points not followed",
       "too far beside the way, or not coming nearer to its next point",
       {"cross_track_m", "off_way_s", "progress_m", "progress_s"},
       Act::kSlow,
       Act::kNone,
       kNever,
       later(&C::way_abort_s),
       "",
       Over::kLater,
       "a current faster than the vehicle",
       "FaultsOfTheWay.NotFollowed"},
      {Fault::kInsideObstacle,
       "inside an obstacle",
       "a route is refused for it, until one is found; before any way, a hazard over the vehicle",
       {},
       Act::kStop,
       Act::kNone,
       kNever,
       later(&C::blocked_abort_s),
       "",
       Over::kAtOnce,
       "a body over the start",
       "FaultsOfTheWay.InsideAnObstacle"},
      {Fault::kNoPath,
       "no path",
       "no route leads to the point, or nothing was seen for too long, until a route is found",
       {},
       Act::kStop,
       Act::kNone,
       kNever,
       later(&C::blocked_abort_s),
       "",
       Over::kAtOnce,
       "a wall from side to side",
       "FaultsOfTheWay.NoPath"},
      {Fault::kPlannerOverBudget,
       "planner over budget",
       "a route is refused for it, until one is found",
       {},
       Act::kSlow,
       Act::kStop,
       later(&C::budget_stop_s),
       later(&C::budget_abort_s),
       "",
       Over::kAtOnce,
       "planner: wrong_scale",
       "FaultsOfTheWay.PlannerOverBudget"},
      {Fault::kCollisionAhead,
       "collision ahead",
       "raw echoes in 2 pings, or raw ranges in 2 of 3, inside what the hull sweeps in the water that it needs to stop",
       {"reaction_s", "collision_margin_m", "side_margin_m", "confirm_m", "confirm_s"},
       Act::kStop,
       Act::kNone,
       kNever,
       later(&C::collision_abort_s),
       "",
       Over::kLater,
       "a body in the way that no map has",
       "LastDitch.StopsInTime"},
      {Fault::kCollisionUnavoidable,
       "collision unavoidable",
       "the same, nearer than it can stop, or with a vehicle that cannot",
       {"reaction_s", "side_margin_m"},
       Act::kTurn,
       Act::kNone,
       kNever,
       later(&C::collision_abort_s),
       "",
       Over::kLater,
       "a body that appears before the bow",
       "LastDitch.TurnsToTheFreerSide"},
      {Fault::kFenceAhead,
       "fence ahead",
       "the water that it needs to stop reaches over the fence",
       {"reaction_s", "collision_margin_m"},
       Act::kSlow,
       Act::kNone,
       kNever,
       kNever,
       "",
       Over::kLater,
       "a way along the fence",
       "Limits.FenceAhead"},
      {Fault::kFenceBreach,
       "fence breached",
       "outside the fence",
       {},
       Act::kStop,
       Act::kNone,
       kNever,
       kAtOnce,
       "",
       Over::kLater,
       "a current over the fence",
       "Limits.FenceBreached"},
      {Fault::kTooDeep,
       "too deep",
       "deeper than the mission or the vehicle allows",
       {"depth_slack_m", "max_depth_m"},
       Act::kSurface,
       Act::kNone,
       kNever,
       later(&C::depth_abort_s),
       "",
       Over::kLater,
       "depth: drifting",
       "Limits.TooDeep"},
      {Fault::kTooLow,
       "too near to the bottom",
       "2 of 3 readings of a sensor that looks down",
       {"min_altitude_m"},
       Act::kTurn,
       Act::kNone,
       kNever,
       later(&C::low_abort_s),
       "",
       Over::kLater,
       "a bottom that rises",
       "Limits.TooLow"},
  };
}

std::vector<FaultRow> host_rows() {
  using C = SafetyConfig;
  return {
      {Fault::kAgentDead,
       "agent dead",
       "its supervisor says that it died or hangs",
       {},
       Act::kStop,
       Act::kSurface,
       later(&C::agent_surface_s),
       kAtOnce,
       "",
       Over::kNever,
       "agent.navigator: off",
       "FaultsOfTheVehicle.AgentDead"},
      {Fault::kLeak,
       "leak",
       "the host says so",
       {},
       Act::kSurface,
       Act::kNone,
       kNever,
       kAtOnce,
       "surface",
       Over::kNever,
       "vehicle: leak",
       "FaultsOfTheVehicle.Leak"},
      {Fault::kBatteryLow,
       "battery low",
       "charge",
       {"low_battery_share"},
       Act::kNone,
       Act::kNone,
       kNever,
       kAtOnce,
       "as the mission ends, or at the surface where that is to hold",
       Over::kNever,
       "vehicle: battery",
       "FaultsOfTheVehicle.BatteryLow"},
      {Fault::kThrusterLost,
       "thruster lost",
       "the host says so",
       {},
       Act::kSlow,
       Act::kNone,
       kNever,
       later(&C::thruster_abort_s),
       "",
       Over::kLater,
       "thruster: thruster_loss",
       "FaultsOfTheVehicle.ThrusterLost"},
      {Fault::kHealthSilent,
       "health silent",
       "no report of the vehicle, or it says that it is lost",
       {"health_silent_s", "startup_s"},
       Act::kSlow,
       Act::kNone,
       kNever,
       kNever,
       "",
       Over::kLater,
       "no report is passed on",
       "FaultsOfTheVehicle.HealthSilent"},
      {Fault::kLinkLost,
       "operator link lost",
       "no beat of an operator who was heard",
       {"link_silent_s"},
       Act::kNone,
       Act::kNone,
       kNever,
       later(&C::link_abort_s),
       "by link_policy: goes on, returns or surfaces",
       Over::kLater,
       "link: off",
       "FaultsOfTheVehicle.LinkLost"},
      {Fault::kClockJump,
       "clock jump",
       "the logical clock, or the times of a sensor beside it, off at once",
       {"clock_jump_s"},
       Act::kSlow,
       Act::kNone,
       kNever,
       kNever,
       "",
       Over::kLater,
       "vehicle: clock_jump",
       "FaultsOfTheVehicle.ClockJump"},
      {Fault::kDiskFull,
       "disk full",
       "the host says so",
       {},
       Act::kNone,
       Act::kNone,
       kNever,
       kNever,
       "",
       Over::kLater,
       "disk: off",
       "FaultsOfTheVehicle.DiskFull"},
      {Fault::kMissionTooLong,
       "mission too long",
       "time since its start",
       {"max_duration_s"},
       Act::kNone,
       Act::kNone,
       kNever,
       kAtOnce,
       "as the mission ends",
       Over::kNever,
       "a mission that is longer than its limit",
       "Limits.MissionTooLong"},
  };
}

std::vector<FaultRow> all_rows() {
  std::vector<FaultRow> rows;
  for (auto& group : {sensor_rows(), way_rows(), host_rows()}) rows.insert(rows.end(), group.begin(), group.end());
  return rows;
}

/// "1.5 s" of a field; empty for a name that the configuration does not have.
std::string value_of(std::vector<Field>& all, const std::string& name) {
  const auto field = std::find_if(all.begin(), all.end(), [&](const Field& f) { return f.name() == name; });
  if (field == all.end()) return {};
  return field->value() + (field->unit().empty() || field->unit() == "1" ? "" : " " + field->unit());
}

std::string wait_text(const After& after, const SafetyConfig& config) {
  return after.when == After::When::kLater ? fmt::format(" after {:g} s", config.*after.wait) : " at once";
}

std::string action_text(const FaultRow& row, const SafetyConfig& config) {
  std::string text = row.action == Act::kNone ? "report" : to_text(row.action);
  if (row.fault == Fault::kCollisionUnavoidable) text = "turn to the freer side; surface where neither is free";
  if (row.fault == Fault::kCollisionAhead) text = "stop, then turn on the spot to where the way leads";
  if (row.fault == Fault::kTooLow) text = "slow and rise";
  if (row.later != Act::kNone) text += fmt::format("; {}{}", to_text(row.later), wait_text(row.later_after, config));
  if (row.abort.when != After::When::kNever) text += "; abort" + wait_text(row.abort, config);
  if (*row.end != 0) text += fmt::format(" ({})", row.end);
  return text;
}

std::string limits_text(const FaultRow& row, std::vector<Field>& all) {
  std::string text;
  for (const char* name : row.limits) {
    const std::string value = value_of(all, name);
    text += fmt::format("{}`{}`{}", text.empty() ? "" : ", ", name, value.empty() ? " of the mission" : " " + value);
  }
  return text.empty() ? "at once" : text;
}

constexpr const char* kHead = R"(# Faults

What can go wrong, how the Safety Officer notices it, what it does and what shows it. The table is the one that the
program acts by; limits are those of `[safety]` in [configuration.md](configuration.md) with their defaults, or of the
mission file.

- The Safety Officer looks ten times a second, stands above planning and steering, and can only slow, stop, turn away or
  surface: never does it ask for more speed than was ordered. Of several actions the strongest holds.
- *stop* of a vehicle that needs way on to hold its depth, or that was ordered to surface, is *surface*.
- A fault is over when its cause was gone for `leave_s` ({} s); those of routes with the next route, and those with
  a dagger stay.
- *abort* ends the mission as `abort_end` says ({}), unless the row says otherwise. Each fault, its end and each action
  is a decision with its reason in the log.
- Sensors that have not spoken `startup_s` after the start of a mission are silent.
- A fault of a scene is injected by `[[fault]]` ([scene-format.md](scene-format.md)).

| fault | noticed by | limit | action | injected by | test |
| --- | --- | --- | --- | --- | --- |
)";

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

std::string fault_page(SafetyConfig config) {
  std::vector<Field> all = fields(config);
  std::string page = fmt::format(kHead, config.leave_s, value_of(all, "abort_end"));
  for (const FaultRow& row : fault_table()) {
    page += fmt::format("| {}{} | {} | {} | {} | {} | {} |\n", row.name, row.over == Over::kNever ? " †" : "",
                        row.noticed, limits_text(row, all), action_text(row, config), row.injected, row.test);
  }
  return page;
}

}  // namespace isobath
