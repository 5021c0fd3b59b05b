// Configuration: the structs of all classes, under the names that they have in a configuration file.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/io/open.hpp>
#include <isobath/map/body_grid.hpp>
#include <isobath/map/depth_map.hpp>
#include <isobath/mission/agent_library.hpp>
#include <isobath/mission/executor.hpp>
#include <isobath/mission/safety_config.hpp>
#include <isobath/mission/standard_agents.hpp>
#include <isobath/perception/depth_mapper.hpp>
#include <isobath/perception/grid_mapper.hpp>
#include <isobath/perception/imminent_collision.hpp>
#include <isobath/perception/obstacle_detector.hpp>
#include <isobath/runtime/depth_prior.hpp>
#include <isobath/runtime/event_gate.hpp>
#include <isobath/runtime/pose_buffer.hpp>
#include <isobath/runtime/recorder_config.hpp>
#include <isobath/runtime/report_config.hpp>
#include <isobath/runtime/voxel_config.hpp>
#include <isobath/sim/simulator.hpp>
#include <isobath/sonar/calibration.hpp>
#include <isobath/sonar/echo_detector.hpp>
#include <isobath/sonar/histogram_model.hpp>
#include <isobath/vehicle/state_evaluator.hpp>
#include <vector>

namespace isobath {

struct SensorConfig {
  std::string model;      ///< file made by calibration; empty: none
  std::string histogram;  ///< likewise
};
std::vector<Field> fields(SensorConfig& config);

struct MapConfig {
  bool fit = true;  ///< set cell and size of the grid by the sonar's range: about 100 cells each way, 1-2-5 steps
  double fan_scan_s = 0.5;
};
std::vector<Field> fields(MapConfig& config);

struct Configuration {
  InputConfig input;
  EventGateConfig gate;
  PoseBufferConfig poses;
  SensorConfig sensor;
  EchoDetectorConfig echoes;
  MapConfig map;
  BodyGridConfig grid;
  GridMapperConfig update;
  ObstacleDetectorConfig obstacles;
  VoxelModelConfig voxels;
  DepthMapConfig depth_map;
  DepthMapperParts depth;
  DepthPriorConfig prior;
  ImminentCollisionConfig collision;
  StateEvaluatorConfig state;
  MissionConfig mission;
  SafetyConfig safety;
  ExecutorConfig executor;
  std::vector<AgentFile> agents;  ///< [[agent]]: added to the standard agents
  CalibrationConfig calibration;
  HistogramConfig histogram;
  SimulationConfig simulation;
  RecorderConfig recorder;
  ReportConfig report;
};

/// Bound to `configuration`, which must outlive them.
std::vector<Section> sections(Configuration& configuration);
/// The same with the lists: everything that a file may hold.
Schema schema(Configuration& configuration);
/// The values in force, as `schema` reads them.
std::string to_toml(const Configuration& configuration, bool annotated);

}  // namespace isobath
