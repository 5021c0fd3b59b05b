// OnboardConfiguration: the settings of all that runs on a vehicle.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/map/occupancy/body_grid.hpp>
#include <isobath/mission/agents/standard_agents.hpp>
#include <isobath/mission/command/agent_library.hpp>
#include <isobath/mission/command/executor.hpp>
#include <isobath/mission/safety/safety_config.hpp>
#include <isobath/onboard/corner_navigation.hpp>
#include <isobath/onboard/event_gate.hpp>
#include <isobath/onboard/moving_bodies.hpp>
#include <isobath/onboard/pose_buffer.hpp>
#include <isobath/onboard/scan_steering.hpp>
#include <isobath/perception/contact_tracker.hpp>
#include <isobath/perception/grid_mapper.hpp>
#include <isobath/perception/imminent_collision.hpp>
#include <isobath/perception/obstacle_detector.hpp>
#include <isobath/sonar/echo_detector.hpp>
#include <isobath/world/world_configuration.hpp>
#include <string>
#include <vector>

namespace isobath {

struct SensorConfig {
  std::string model;               ///< file made by calibration; empty: none
  std::string histogram;           ///< likewise
  std::string histogram_vertical;  ///< of the fans that lie in a vertical plane; empty: `histogram` is for all
};
std::vector<Field> fields(SensorConfig& config);

struct MapConfig {
  bool fit = true;  ///< set cell and size of the grid by the sonar's range: about 100 cells each way, 1-2-5 steps
  double fan_scan_s = 0.5;
  double sounding_band_m = 1.5;  ///< soundings in the water this far above or below the vehicle are obstacles
};
std::vector<Field> fields(MapConfig& config);

struct OnboardConfiguration : WorldConfiguration {
  EventGateConfig gate;
  PoseBufferConfig poses;
  SensorConfig sensor;
  EchoDetectorConfig echoes;
  MapConfig map;
  BodyGridConfig grid;
  GridMapperConfig update;
  ObstacleDetectorConfig obstacles;
  ImminentCollisionConfig collision;
  ScanSteeringConfig scan;
  CornerNavigationConfig corner_fix;
  ContactConfig contacts;
  MovingBodiesConfig bodies;
  MissionConfig mission;
  SafetyConfig safety;
  ExecutorConfig executor;
  std::vector<AgentFile> agents;  ///< [[agent]]: added to the standard agents
};

}  // namespace isobath
