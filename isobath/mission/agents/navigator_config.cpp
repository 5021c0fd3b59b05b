#include <isobath/mission/agents/navigator_config.hpp>

namespace isobath {

std::vector<Field> fields(NavigatorConfig& c) {
  return {
      Field::real(
          "drop_distance_m", &c.drop_distance_m, {0, 1000}, "m",
          "A mission point with an obstacle nearer than this is refused; 0: 10 m, and the clearance for a vehicle that "
          "can hover."),
      Field::real(
          "slack_m", &c.slack_m, {0, 100}, "m",
          "A route that was planned with the clearance may come this much nearer to a hazard before it is changed."),
      Field::real("switch_m", &c.switch_m, {0, 1000}, "m",
                  "A new route is preferred to one with its corners moved aside if it is this much shorter."),
      Field::real("shortcut_m", &c.shortcut_m, {0, 1000}, "m",
                  "A clear route is replaced by one that is this much shorter."),
      Field::integer("sure_scans", &c.sure_scans, {1, 100}, "1",
                     "Scans in a row that must agree to refuse a mission point or to take a shortcut."),
      Field::real("decide_within_m", &c.decide_within_m, {0, 100000}, "m",
                  "Distance within which a mission point may be refused for an obstacle that was seen at it."),
      Field::real("sure_within_m", &c.sure_within_m, {0, 1000}, "m",
                  "An obstacle at the mission point that is this near to the vehicle is avoided at once."),
      Field::real("fence_clearance_m", &c.fence_clearance_m, {0, 1000}, "m",
                  "Clearance from the vehicle's hull to the fence."),
      Field::real("chart_sigmas", &c.chart_sigmas, {0, 10}, "1",
                  "Charted obstacles grow by this many standard deviations of the vehicle's position."),
      Field::real("jump_m", &c.jump_m, {0.01, 1000}, "m",
                  "A fix this far from the predicted position moves the last scan and the route with it."),
      Field::real("map_age_s", &c.map_age_s, {0, 3600}, "s",
                  "Without a scan for this long every route is refused; 0: no limit."),
      Field::real("tight_m", &c.tight_m, {0, 100}, "m",
                  "A route with less room than this beyond the clearance is followed slowly."),
      Field::real("tight_speed", &c.tight_speed, {0.1, 1}, "1",
                  "Share of its speed at which such a route is followed."),
      Field::integer("emergency_factor", &c.emergency_factor, {1, 1000}, "1",
                     "Factor on the number of cells that a search may expand in an emergency."),
      Field::real("off_leg_m", &c.off_leg_m, {1, 1000}, "m",
                  "Where moving bodies lead the vehicle this far off its leg, the route begins where it is."),
  };
}

}  // namespace isobath
