#include <isobath/perception/depth_parts.hpp>

namespace isobath {

std::vector<Field> fields(DepthMapperConfig& c) {
  return {
      Field::flag("prefilter", &c.prefilter, "Alike readings of one sensor become one of more weight."),
      Field::flag("quarantine", &c.quarantine, "Depths that nothing around them supports are held back."),
      Field::flag("honest", &c.honest, "Steps of confidence fall with range and doubt of place; false: as published."),
      Field::flag("explain", &c.explain, "An echo that the map predicts affirms it and denies nothing."),
      Field::real("spread_sigmas", &c.spread_sigmas, {0, 5}, "1",
                  "A sounding speaks of its footprint widened by so many standard deviations of the vehicle's place."),
      Field::flag(
          "queue_all", &c.queue_all,
          "While the window shifts all readings are kept for the new one; false: those that changed something."),
      Field::flag("background", &c.background, "The window shifts in a thread of its own; the map is the same."),
  };
}

}  // namespace isobath
