// RecorderConfig: what a recording holds, how often, and how it is written (RunRecorder).
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/io/mcap/mcap.hpp>

namespace isobath {

/// Minimum time between two messages of a kind, s, in the channels for other viewers.
struct FoxgloveConfig {
  bool on = true;
  double pose_s = 0.1;
  double points_s = 0.5;
  double grid_s = 2;  ///< for obstacles, too
  double image_s = 2;
  double voxels_s = 5;  ///< for the track, too
};

struct RecorderConfig {
  double display_s = 0.25;  ///< between two samples of the display
  double keyframe_s = 10;   ///< between two complete samples, at least
  McapWriterConfig log;
  FoxgloveConfig foxglove;
};
std::vector<Field> fields(RecorderConfig& config);

}  // namespace isobath
