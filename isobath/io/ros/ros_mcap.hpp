// MCAP files with messages of ROS: bags of rosbag2 (encoding cdr, schemas ros2msg), and messages of ROS 1 (ros1,
// ros1msg). Channels whose schema is in another language (IDL) are read by the definitions of ros_known_types.cpp.
// The container and its damage are McapReader's.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <isobath/io/ros/ros_recording.hpp>

namespace isobath {

/// Whether an MCAP file holds messages of ROS and none of Isobath's own log.
bool holds_ros_messages(const std::filesystem::path& file);
/// Opens the same file again from its beginning.
using OpenLog = std::function<std::unique_ptr<std::istream>()>;
std::unique_ptr<RosRecording> open_ros_mcap_recording(const OpenLog& open, const std::string& name);
std::unique_ptr<Source> open_ros_mcap(const std::filesystem::path& file, const InputConfig& config);

}  // namespace isobath
