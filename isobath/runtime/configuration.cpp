#include <algorithm>
#include <isobath/runtime/configuration.hpp>
#include <iterator>

namespace isobath {

std::vector<Field> fields(SensorConfig& c) {
  return {Field::text("model", &c.model, "Sensor model or fan model made by isobath calibrate; empty: none."),
          Field::text("histogram", &c.histogram, "Histogram model made by isobath calibrate; empty: none.")};
}

std::vector<Field> fields(MapConfig& c) {
  return {Field::flag("fit", &c.fit, "Cell and size of the grid follow from the sonar's range; false: as [grid] says."),
          Field::real("fan_scan_s", &c.fan_scan_s, {0, 60}, "s",
                      "Obstacles are taken from the grid this often for a fan of beams; 0: with each ping.")};
}

std::vector<Section> sections(Configuration& c) {
  std::vector<Section> all{
      {"input", "What logs do not say about the sonar and how it is mounted.", fields(c.input)},
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
      {"voxels", "The map in three dimensions, of sonars with fans of beams.", fields(c.voxels)},
      {"fans", "From decisions to voxels.", fields(c.voxels.fans)},
      {"depth_map", "The chart of the bottom that ranges and soundings make.", fields(c.depth_map)},
      {"prior", "What a new depth map begins with.", fields(c.prior)},
      {"depth", "From ranges and soundings to the depth map.", fields(c.depth.mapper)},
      {"confidence", "How readings change what is believed of a pixel.", fields(c.depth.rules)},
      {"evidence", "What one reading says of which pixels.", fields(c.depth.evidence)},
      {"deviation", "How far ranges and places may be off: standard deviations.", fields(c.depth.evidence.deviation)},
      {"prefilter", "Which readings of one sensor are alike and become one.", fields(c.depth.prefilter)},
      {"quarantine", "Which depths must be confirmed before they are believed.", fields(c.depth.gate)},
      {"collision", "When raw ranges raise the alarm, whatever the maps say.", fields(c.collision)},
      {"state", "When health reports raise an alarm.", fields(c.state)},
      {"safety", "What the Safety Officer takes for a fault.", fields(c.safety)},
      {"crew", "How agents are run and watched, and who has the last word.", fields(c.crew)},
      {"calibration", "From marked recordings to a sensor model.", fields(c.calibration)},
      {"histogram", "From marked recordings to a histogram model.", fields(c.histogram)},
      {"simulation", "What overrides a scene, where the input is one.", fields(c.simulation)},
      {"recorder", "What a recording holds, how often, and how it is written.", fields(c.recorder)},
      {"report", "What the report of a run carries beside what is written in it.", fields(c.report)}};
  std::vector<Section> mission = sections(c.mission);
  const auto crew = std::find_if(all.begin(), all.end(), [](const Section& s) { return s.name == "safety"; });
  all.insert(crew, std::make_move_iterator(mission.begin()), std::make_move_iterator(mission.end()));
  return all;
}

Schema schema(Configuration& c) { return {sections(c), {agent_list(c.agents)}}; }

std::string to_toml(const Configuration& configuration, bool annotated) {
  Configuration c = configuration;
  std::string text = write_toml(sections(c), annotated);
  for (AgentFile& agent : c.agents) text += "\n" + write_toml({{"[agent]", "", fields(agent)}}, annotated);
  return text;
}

}  // namespace isobath
