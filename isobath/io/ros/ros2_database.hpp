// ROS 2 bags in SQLite (rosbag2, .db3): the tables topics and messages, and message_definitions since Iron. Messages
// are CDR. They are read in the order of their times.
//
// Bags before Iron carry no definitions of their types: those of ROS 2 are used for the types that ros_known_types.cpp
// lists. The file is opened for reading only, and no code that a schema could hold is trusted. A page that SQLite
// cannot read ends the log, and the report says so. Checked: written and read back by SQLite itself; not run against
// rosbag2, which is not to be had here.
#pragma once

#include <filesystem>
#include <isobath/io/bytes/bytes.hpp>
#include <isobath/io/ros/ros_recording.hpp>
#include <span>

namespace isobath {

/// Whether an SQLite file has the tables of a bag, as far as its first bytes state them.
bool looks_like_ros2_database(Bytes head);
/// The tables of an SQLite file, as far as its head states them, by name. SQLite stores each with the words that made
/// it.
std::vector<std::string> sqlite_tables(std::string_view head);

std::unique_ptr<RosRecording> open_ros2_recording(const std::filesystem::path& file);
std::unique_ptr<Source> open_ros2_database(const std::filesystem::path& file, const InputConfig& config);

}  // namespace isobath
