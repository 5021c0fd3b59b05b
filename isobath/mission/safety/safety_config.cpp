#include <isobath/mission/safety/safety_config.hpp>

namespace isobath {
namespace {

constexpr Range kSeconds{0.1, 3600};

Field wait(const char* name, double* value, const char* sentence) {
  return Field::real(name, value, kSeconds, "s", sentence);
}

std::vector<Field> sonar_fields(SafetyConfig& c) {
  return {
      wait("sonar_silent_s", &c.sonar_silent_s, "A sonar without a ping for this long is silent."),
      Field::integer("frozen_looks", &c.frozen_looks, {2, 1000}, "1",
                     "A sonar that sends this many identical pings in a row is frozen."),
      Field::integer("bad_looks", &c.bad_looks, {1, 1000}, "1", "This many bad pings in a row are a fault."),
      Field::integer("good_looks", &c.good_looks, {1, 1000}, "1", "This many good pings in a row end the fault."),
      Field::real("saturated_share", &c.saturated_share, {0.05, 1}, "1",
                  "A ping with this share of its samples at full scale is bad."),
      Field::real(
          "garbled_roughness", &c.garbled_roughness, {0.05, 1}, "1",
          "A ping with this mean step between neighbouring bins, share of full scale, is bad; uniform noise has 0.33."),
      wait("deaf_s", &c.deaf_s, "A sonar that delivers only zeros for this long is deaf."),
      Field::real("blind_share", &c.blind_share, {0, 0.5}, "1",
                  "A side whose level is below this share of the other side's is bad."),
      Field::integer("blind_looks", &c.blind_looks, {1, 1000}, "1",
                     "A side that is bad in this many of its pings in a row is blind."),
      wait("sonar_abort_s", &c.sonar_abort_s,
           "A sonar fault other than a blind side ends the mission after this time."),
      wait("blind_abort_s", &c.blind_abort_s, "A blind side ends the mission after this time."),
  };
}

std::vector<Field> navigation_fields(SafetyConfig& c) {
  return {
      wait("navigation_silent_s", &c.navigation_silent_s,
           "Navigation without a fix, or with identical fixes, for this long is silent."),
      wait("navigation_surface_s", &c.navigation_surface_s,
           "Without navigation the vehicle surfaces, and the mission ends, after this time."),
      Field::real("jump_m", &c.jump_m, {0.1, 1000}, "m",
                  "A fix this far from the predicted position, beyond four standard deviations, is a jump."),
      wait("jump_abort_s", &c.jump_abort_s, "Jumps that go on end the mission after this time."),
      wait("depth_sensor_abort_s", &c.depth_sensor_abort_s, "A lost depth sensor ends the mission after this time."),
      wait("altitude_silent_s", &c.altitude_silent_s, "An altimeter without a reading for this long is lost."),
      wait("altitude_abort_s", &c.altitude_abort_s, "A lost altimeter ends the mission after this time."),
      wait("clock_jump_s", &c.clock_jump_s, "A clock that suddenly differs by this much has jumped."),
  };
}

std::vector<Field> way_fields(SafetyConfig& c) {
  return {
      Field::real("cross_track_m", &c.cross_track_m, {1, 1000}, "m",
                  "A vehicle farther than this, plus two turning radii, from its route is off the route."),
      wait("off_route_s", &c.off_route_s, "A vehicle that is off its route for this long does not follow it.")
          .was("off_way_s"),
      Field::real("progress_m", &c.progress_m, {0.1, 100}, "m",
                  "The vehicle must come this much nearer to its way-point within progress_s."),
      wait("progress_s", &c.progress_s,
           "Time within which the vehicle must come progress_m nearer, while it is ordered to move."),
      wait("route_abort_s", &c.route_abort_s, "The mission ends when way-points have not been followed for this long.")
          .was("way_abort_s"),
      wait("blocked_abort_s", &c.blocked_abort_s,
           "The mission ends when the vehicle has been inside an obstacle or without a path for this long."),
      wait("budget_stop_s", &c.budget_stop_s, "Without a plan within the budget the vehicle stops after this time."),
      wait("budget_abort_s", &c.budget_abort_s, "Without a plan within the budget the mission ends after this time."),
  };
}

std::vector<Field> collision_fields(SafetyConfig& c) {
  return {
      Field::real("echo_contrast", &c.echo_contrast, {1, 100}, "1",
                  "Standard deviations above its beam from which an echo counts without a map; more in a fan."),
      Field::real("confirm_m", &c.confirm_m, {0.05, 50}, "m",
                  "Maximum distance between echoes of different pings that confirm each other."),
      wait("confirm_s", &c.confirm_s,
           "Maximum time between echoes of two pings that confirm each other; how many it takes follows from the "
           "measured rate of false echoes."),
      wait("memory_s", &c.memory_s, "How long a confirmed echo counts after it was last received."),
      Field::real("reaction_s", &c.reaction_s, {0, 10}, "s",
                  "Time from the decision to stop until the vehicle brakes."),
      Field::real("collision_margin_m", &c.collision_margin_m, {0, 100}, "m",
                  "Distance to be left to an obstacle ahead."),
      Field::real("height_margin_m", &c.height_margin_m, {0, 100}, "m",
                  "An obstacle is ignored where this much water above and below the vehicle was measured to be clear."),
      Field::real("side_margin_m", &c.side_margin_m, {0, 100}, "m", "Distance to be left beside the hull."),
      Field::real("escape_s", &c.escape_s, {1, 120}, "s",
                  "An escape manoeuvre of a vehicle that cannot stop must be free for this long."),
      Field::real("escape_moving_s", &c.escape_moving_s, {0, 120}, "s",
                  "The same of bodies that move: later, their place is not known."),
      Field::real("unknown_current", &c.unknown_current, {0, 10}, "m/s",
                  "Current that may be unknown to a vehicle that cannot stop, until its headings have shown it."),
      wait("collision_abort_s", &c.collision_abort_s, "An obstacle on the path ends the mission after this time."),
  };
}

std::vector<Field> vehicle_fields(SafetyConfig& c) {
  return {
      Field::real("depth_slack_m", &c.depth_slack_m, {0, 100}, "m",
                  "A vehicle this much below its maximum depth is too deep."),
      wait("depth_abort_s", &c.depth_abort_s, "The mission ends when the vehicle has been too deep for this long."),
      wait("low_altitude_abort_s", &c.low_altitude_abort_s,
           "The mission ends when the vehicle has been too near to the bottom for this long.")
          .was("low_abort_s"),
      wait("agent_surface_s", &c.agent_surface_s,
           "A vehicle that has lost one of its agents surfaces after this time."),
      wait("health_silent_s", &c.health_silent_s,
           "Without a health report of the vehicle for this long its health is silent."),
      wait("thruster_abort_s", &c.thruster_abort_s, "A weak thruster ends the mission after this time."),
      wait("link_silent_s", &c.link_silent_s,
           "The link to an operator who was connected is lost after this time without a message."),
      wait("link_abort_s", &c.link_abort_s, "link_policy applies when the link has been lost for this long."),
      Field::choice(
          "link_policy", &c.link_policy,
          {{"continue", LinkPolicy::kContinue}, {"return", LinkPolicy::kReturn}, {"surface", LinkPolicy::kSurface}},
          "What the vehicle does when the link to the operator is lost."),
  };
}

}  // namespace

std::vector<Field> fields(SafetyConfig& c) {
  std::vector<Field> all = {
      wait("startup_s", &c.startup_s, "A sensor that has not reported this long after the start is silent."),
      wait("clear_after_s", &c.clear_after_s, "A fault is over when its cause has been gone for this long.")
          .was("leave_s"),
      Field::real("clear_share", &c.clear_share, {0, 1}, "1",
                  "A fault of a measured value is over only below this share of its limit.")
          .was("leave_share"),
      Field::real("slow_speed", &c.slow_speed, {0.01, 10}, "m/s", "Speed limit of a slowed vehicle."),
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
