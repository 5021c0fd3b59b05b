// The whole configuration: the structs of all classes, under the names that they have in a file.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/io/open.hpp>
#include <isobath/map/body_grid.hpp>
#include <isobath/perception/grid_mapper.hpp>
#include <isobath/perception/obstacle_detector.hpp>
#include <isobath/runtime/event_gate.hpp>
#include <isobath/runtime/pose_buffer.hpp>
#include <isobath/sim/reservoir.hpp>
#include <isobath/sonar/echo_detector.hpp>
#include <vector>

namespace isobath {

struct Configuration {
  InputConfig input;
  EventGateConfig gate;
  PoseBufferConfig poses;
  EchoDetectorConfig echoes;
  BodyGridConfig grid;
  GridMapperConfig update;
  ObstacleDetectorConfig obstacles;
  ReservoirConfig reservoir;
};

/// Bound to `configuration`, which must outlive them.
std::vector<Section> sections(Configuration& configuration);

}  // namespace isobath
