#include <algorithm>
#include <isobath/configuration/configuration.hpp>
#include <iterator>

namespace isobath {

std::vector<Section> sections(Configuration& c) {
  std::vector<Section> all{
      {"input", "The sonar and its mounting, where logs do not say.", fields(c.input)},
      {"cameras", "How pairs of pictures become ranges, and carry the position.", fields(c.cameras)},
      {"gate", "Which events the pipeline rejects.", fields(c.gate)},
      {"poses", "How the pose of a ping's transmit time is found.", fields(c.poses)},
      {"sensor", "Calibration files of the sonar.", fields(c.sensor)},
      {"echoes", "Echo detection: which bins hold an echo.", fields(c.echoes)},
      {"map", "How cell and size of the grid are chosen.", fields(c.map)},
      {"grid", "The body-fixed occupancy grid.", fields(c.grid)},
      {"motion", "Uncertainty of the vehicle's own motion.", fields(c.update.motion)},
      {"update", "How echo decisions change the occupancy grid.", fields(c.update)},
      {"table", "The table of overlaps between bins and cells.", fields(c.update.table)},
      {"obstacles", "How obstacle outlines are extracted from the grid.", fields(c.obstacles)},
      {"bodies", "Which bodies move, and how the echoes of a ping become readings of bodies.", fields(c.bodies)},
      {"tracker", "Existence of bodies, and which reading is of which.", fields(c.bodies.tracker)},
      {"body_motion", "How bodies move.", fields(c.bodies.motion)},
      {"voxels", "The voxel map, of sonars with a fan of beams.", fields(c.voxels)},
      {"sphere", "The spherical grid: echoes by direction and range around the vehicle.", fields(c.sphere)},
      {"scan", "How a scanning sonar is steered, where the program commands it.", fields(c.scan)},
      {"corner_fix", "Whether corners of charted walls correct the position.", fields(c.corner_fix)},
      {"contacts", "Which obstacle a sound comes from that a passive array hears.", fields(c.contacts)},
      {"fans", "How echo decisions change the voxel map.", fields(c.voxels.fans)},
      {"depth_map", "The depth map that ranges and soundings make.", fields(c.depth_map)},
      {"prior", "What a new depth map starts from.", fields(c.prior)},
      {"depth", "How ranges and soundings change the depth map.", fields(c.depth.mapper)},
      {"confidence", "How readings change the confidence of a pixel.", fields(c.depth.rules)},
      {"evidence", "Which pixels a reading changes, and how.", fields(c.depth.evidence)},
      {"deviation", "Standard deviations of ranges and positions.", fields(c.depth.evidence.deviation)},
      {"prefilter", "Which similar readings of one sensor are merged.", fields(c.depth.prefilter)},
      {"quarantine", "Which depths must be confirmed before the map accepts them.", fields(c.depth.gate)},
      {"collision", "When raw ranges raise the collision alarm, independent of the maps.", fields(c.collision)},
      {"state", "When health reports raise an alarm.", fields(c.state)},
      {"safety", "What the Safety Officer treats as a fault.", fields(c.safety)},
      {"executor",
       "How agents are run and watched, and which command takes precedence.",
       fields(c.executor),
       {},
       "crew"},
      {"calibration", "How marked recordings become a sensor model.", fields(c.calibration)},
      {"histogram", "How marked recordings become a histogram model.", fields(c.histogram)},
      {"simulation", "Settings that override a scene, if the input is one.", fields(c.simulation)},
      {"recorder", "What a recording holds, how often, and how it is written.", fields(c.recorder)},
      {"report", "What the report of a run holds besides its text and pictures.", fields(c.report)}};
  std::vector<Section> mission = sections(c.mission);
  const auto executor = std::find_if(all.begin(), all.end(), [](const Section& s) { return s.name == "safety"; });
  all.insert(executor, std::make_move_iterator(mission.begin()), std::make_move_iterator(mission.end()));
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
