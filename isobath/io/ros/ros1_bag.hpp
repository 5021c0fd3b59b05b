// ROS 1 bags, format 2.0 (wiki.ros.org/Bags/Format/2.0): chunks without compression, bz2, or as an lz4 frame.
//
// The records are read from the first chunk to the last. The index at the end of the file only tells which topics there
// are and how many messages they have; without a valid one (a recording that was not closed) the chunks are read once
// for that. Damage costs the chunk that it is in: the reader goes on at the next one. Of a chunk that the end of the
// file cuts off, what stands before the cut is read, if it is not compressed or bz2.
// Refused with a reason: format 1.x and encrypted bags. Chunks over 256 MiB are skipped.
// Checked against bags that Debian's rosbag 1.15.15 wrote in the three compressions: the same topics, counts and times.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <isobath/io/bytes/bytes.hpp>
#include <isobath/io/ros/ros_recording.hpp>
#include <memory>
#include <span>
#include <string>

namespace isobath {

bool looks_like_ros1_bag(std::span<const std::uint8_t> head);
/// Throws Error for a bag that cannot be read at all.
std::unique_ptr<RosRecording> open_ros1_recording(std::unique_ptr<std::istream> input, const std::string& name);
std::unique_ptr<Source> open_ros1_bag(const std::filesystem::path& file, const InputConfig& config);

}  // namespace isobath
