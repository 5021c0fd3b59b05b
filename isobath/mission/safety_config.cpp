#include <isobath/mission/safety_config.hpp>

namespace isobath {
namespace {

constexpr Range kSeconds{0.1, 3600};

Field wait(const char* name, double* value, const char* sentence) {
  return Field::real(name, value, kSeconds, "s", sentence);
}

std::vector<Field> sonar_fields(SafetyConfig& c) {
  return {
      wait("sonar_silent_s", &c.sonar_silent_s, "A sonar without a ping for so long is silent."),
      Field::integer("frozen_looks", &c.frozen_looks, {2, 1000}, "1", "So many pings in a row with equal samples."),
      Field::integer("bad_looks", &c.bad_looks, {1, 1000}, "1", "So many bad pings in a row are a fault."),
      Field::integer("good_looks", &c.good_looks, {1, 1000}, "1", "So many good ones in a row end it."),
      Field::real("saturated_share", &c.saturated_share, {0.05, 1}, "1", "Of a ping's samples at full scale: bad."),
      Field::real("garbled_roughness", &c.garbled_roughness, {0.05, 1}, "1",
                  "Mean step between neighbouring bins, of full scale: no water; uniform garbage has 0.33."),
      wait("deaf_s", &c.deaf_s, "A sonar that hears nothing at all, not even itself, for so long is deaf."),
      Field::real("blind_share", &c.blind_share, {0, 0.5}, "1", "A side below this share of the other's level: bad."),
      Field::integer("blind_looks", &c.blind_looks, {1, 1000}, "1", "So many such looks of a side: it is blind."),
      wait("sonar_abort_s", &c.sonar_abort_s, "A useless sonar ends the mission after so long."),
      wait("blind_abort_s", &c.blind_abort_s, "A blind side ends it after so long."),
  };
}

std::vector<Field> navigation_fields(SafetyConfig& c) {
  return {
      wait("navigation_silent_s", &c.navigation_silent_s, "Without a fix, or with a frozen one, for so long."),
      wait("navigation_surface_s", &c.navigation_surface_s, "Without navigation it surfaces after so long."),
      Field::real("jump_m", &c.jump_m, {0.1, 1000}, "m",
                  "A fix this far from where it should be, beyond four times its deviation, is a jump."),
      wait("jump_abort_s", &c.jump_abort_s, "Jumps that go on end the mission after so long."),
      wait("depth_sensor_abort_s", &c.depth_sensor_abort_s, "A lost depth sensor ends the mission after so long."),
      wait("altitude_silent_s", &c.altitude_silent_s, "An altimeter that says nothing for so long is lost."),
      wait("altitude_abort_s", &c.altitude_abort_s, "A lost altimeter ends the mission after so long."),
      wait("clock_jump_s", &c.clock_jump_s, "A clock that is this much off at once has jumped."),
  };
}

std::vector<Field> way_fields(SafetyConfig& c) {
  return {
      Field::real("cross_track_m", &c.cross_track_m, {1, 1000}, "m", "Farther from its way the vehicle is off it."),
      wait("off_way_s", &c.off_way_s, "For so long."),
      Field::real("progress_m", &c.progress_m, {0.1, 100}, "m", "It must come this much nearer to its way-point ..."),
      wait("progress_s", &c.progress_s, "... within so long, while it is to move."),
      wait("way_abort_s", &c.way_abort_s, "Way-points that are not followed end the mission after so long."),
      wait("blocked_abort_s", &c.blocked_abort_s, "So does a vehicle without a way out, or without a path."),
      wait("budget_stop_s", &c.budget_stop_s, "Without a plan in its budget the vehicle stops after so long."),
      wait("budget_abort_s", &c.budget_abort_s, "And the mission ends after so long."),
  };
}

std::vector<Field> collision_fields(SafetyConfig& c) {
  return {
      Field::real("echo_contrast", &c.echo_contrast, {1, 100}, "1",
                  "Deviations above its beam that an echo must have to be looked at without a map; of a fan more."),
      Field::real("confirm_m", &c.confirm_m, {0.05, 50}, "m", "Echoes of two pings that are no farther apart ..."),
      wait("confirm_s", &c.confirm_s, "... in place and in time confirm each other."),
      wait("memory_s", &c.memory_s, "How long a confirmed echo counts when nothing hears it again."),
      Field::real("reaction_s", &c.reaction_s, {0, 10}, "s", "From the decision to stop until the vehicle brakes."),
      Field::real("collision_margin_m", &c.collision_margin_m, {0, 100}, "m", "Water to be left before an obstacle."),
      Field::real("height_margin_m", &c.height_margin_m, {0, 100}, "m",
                  "An obstacle over or under which so much water above and below the vehicle was measured is none."),
      Field::real("side_margin_m", &c.side_margin_m, {0, 100}, "m", "Water to be left beside the hull."),
      Field::real("escape_s", &c.escape_s, {1, 120}, "s", "A vehicle that cannot stop keeps a way out free so long."),
      Field::real("unknown_current", &c.unknown_current, {0, 10}, "m/s",
                  "From astern, that a vehicle that steers by fins may not know of."),
      wait("collision_abort_s", &c.collision_abort_s, "An obstacle in the way ends the mission after so long."),
  };
}

std::vector<Field> vehicle_fields(SafetyConfig& c) {
  return {
      Field::real("depth_slack_m", &c.depth_slack_m, {0, 100}, "m", "So much deeper than its limit is too deep."),
      wait("depth_abort_s", &c.depth_abort_s, "Too deep for so long ends the mission."),
      wait("low_abort_s", &c.low_abort_s, "Too near to the bottom for so long ends the mission."),
      wait("agent_surface_s", &c.agent_surface_s, "A vehicle without one of its agents surfaces after so long."),
      wait("health_silent_s", &c.health_silent_s, "No report of the vehicle's health for so long."),
      wait("thruster_abort_s", &c.thruster_abort_s, "A weak thruster ends the mission after so long."),
      wait("link_silent_s", &c.link_silent_s, "An operator who was heard and is not for so long is lost."),
      wait("link_abort_s", &c.link_abort_s, "And the policy is followed after so long."),
      Field::choice(
          "link_policy", &c.link_policy,
          {{"continue", LinkPolicy::kContinue}, {"return", LinkPolicy::kReturn}, {"surface", LinkPolicy::kSurface}},
          "What is done without an operator."),
  };
}

}  // namespace

std::vector<Field> fields(SafetyConfig& c) {
  std::vector<Field> all = {
      wait("startup_s", &c.startup_s, "A sensor that has not spoken so long after the start is silent."),
      wait("leave_s", &c.leave_s, "A fault is over when its cause was gone for so long."),
      Field::real("leave_share", &c.leave_share, {0, 1}, "1", "And what is measured is below this share of its limit."),
      Field::real("slow_speed", &c.slow_speed, {0.01, 10}, "m/s", "Speed when slowed."),
      Field::choice("abort_end", &c.abort_end,
                    {{"hold", MissionEnd::kHold}, {"surface", MissionEnd::kSurface}, {"return", MissionEnd::kReturn}},
                    "How an aborted mission ends, where the fault does not say otherwise."),
  };
  for (const auto& group :
       {sonar_fields(c), navigation_fields(c), way_fields(c), collision_fields(c), vehicle_fields(c)}) {
    all.insert(all.end(), group.begin(), group.end());
  }
  return all;
}

}  // namespace isobath
