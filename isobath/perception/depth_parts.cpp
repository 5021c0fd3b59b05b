#include <isobath/perception/depth_parts.hpp>

namespace isobath {

std::vector<Field> fields(DepthMapperConfig& c) {
  return {
      Field::flag("prefilter", &c.prefilter, "Whether similar readings of one sensor merge into one of more weight."),
      Field::flag("quarantine", &c.quarantine, "Whether depths without support around them are held back."),
      Field::flag("range_weighting", &c.range_weighting,
                  "Whether steps of confidence fall with range and position uncertainty; false: as published.")
          .was("honest"),
      Field::flag("affirm_predicted", &c.affirm_predicted,
                  "Whether an echo that the map predicts affirms the map and contradicts nothing.")
          .was("explain"),
      Field::real("spread_sigmas", &c.spread_sigmas, {0, 5}, "1",
                  "Widening of a sounding's footprint, in standard deviations of the vehicle's position."),
      Field::flag("queue_all", &c.queue_all,
                  "Whether all readings during a window shift are kept for the new window; false: only those that "
                  "changed something."),
      Field::flag("background", &c.background,
                  "Whether the window shifts in a thread of its own; the map is the same."),
  };
}

}  // namespace isobath
