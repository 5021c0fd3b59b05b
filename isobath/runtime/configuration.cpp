#include <isobath/runtime/configuration.hpp>

namespace isobath {

std::vector<Field> fields(SensorConfig& c) {
  return {Field::text("model", &c.model, "Sensor model made by isobath calibrate; empty: none.")};
}

std::vector<Field> fields(MapConfig& c) {
  return {
      Field::flag("fit", &c.fit, "Cell and size of the grid follow from the sonar's range; false: as [grid] says.")};
}

std::vector<Section> sections(Configuration& c) {
  return {{"input", "What logs do not say about the sonar and how it is mounted.", fields(c.input)},
          {"gate", "What the pipeline refuses: late events.", fields(c.gate)},
          {"poses", "How a ping gets the pose of its transmit time.", fields(c.poses)},
          {"sensor", "What is known of the sonar from a calibration.", fields(c.sensor)},
          {"echoes", "From intensities to decisions: which bins hold an echo.", fields(c.echoes)},
          {"map", "How the grid is chosen.", fields(c.map)},
          {"grid", "The body-fixed grid of occupancy.", fields(c.grid)},
          {"motion", "How sure the vehicle is of its own motion.", fields(c.update.motion)},
          {"update", "From decisions to occupancy.", fields(c.update)},
          {"table", "The table of overlaps of bins and cells.", fields(c.update.table)},
          {"obstacles", "From occupancy to outlines.", fields(c.obstacles)},
          {"calibration", "From marked recordings to a sensor model.", fields(c.calibration)},
          {"simulation", "What overrides a scene, where the input is one.", fields(c.simulation)}};
}

}  // namespace isobath
