// PairSource: a folder of camera pairs, or a log of ROS with two image topics, as a source of events: a Swath a pair,
// between the fixes and the other events (ledger S8-07 S8-09 S1-79).
//
// A pair of cameras is read as a Swath and not as range readings, because a swath is what the maps take from a sensor
// that resolves elevation: voxels, body grid, spherical grid and depth map, each sounding with the standard deviation
// of its range. Range readings would not do: voxels and obstacles take none, and the run would count each direction as
// one more sensor.
//
// The first pair that shows something is matched when the source is opened: a calibration of another size or of other
// cameras, and exchanged eyes, are Errors then. Later pairs without ranges are counted by reason.
#pragma once

#include <isobath/cameras/camera_rig.hpp>
#include <isobath/event/event.hpp>
#include <isobath/io/frames/pair_reader.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>

namespace isobath {

/// Opens any input that the program can read: those of open_source, folders of camera pairs, and logs of ROS with the
/// pair that input.cameras describes. Throws Error.
std::unique_ptr<Source> open_input(const std::filesystem::path& input, const InputConfig& config,
                                   const CamerasConfig& cameras);

}  // namespace isobath
