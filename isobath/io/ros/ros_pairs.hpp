// Pairs of pictures from a log of ROS: two image topics (PairRig::left_topic, right_topic), sensor_msgs/Image (mono8,
// rgb8, bgr8, rgba8, bgra8, 8UC1, 8UC3; mono16 by its upper byte) or sensor_msgs/CompressedImage (PNG, JPEG). Two
// pictures are a pair if the times of their headers differ by at most kTogether.
#pragma once

#include <isobath/io/frames/pair_reader.hpp>
#include <isobath/io/ros/ros_recording.hpp>
#include <memory>

namespace isobath {

/// A bag, a ROS 2 database or an MCAP file with messages of ROS. Throws Error for other files.
std::unique_ptr<RosRecording> open_ros_recording(const std::filesystem::path& file);

/// Throws Error if the recording lacks a topic, or if it holds no pictures.
std::unique_ptr<PairReader> open_ros_pairs(std::unique_ptr<RosRecording> recording, const PairRig& rig,
                                           const std::string& name);

}  // namespace isobath
