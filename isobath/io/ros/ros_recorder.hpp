// RosRecorder: writes a log of ROS message by message, in one of three kinds of file.
//
// - ROS 1 bag, format 2.0: chunks of 768 KiB as lz4 frames, an index of each, and the list of topics at the end.
//   The checksums of the types are those of ROS 1 (md5 of the definition), so that its programs accept the messages.
// - ROS 2 bag in SQLite, with the tables of rosbag2 since Iron (definitions of the types); metadata.yaml, which rosbag2
//   needs beside it, is `metadata_yaml`.
// - ROS 2 bag in MCAP: profile ros2, schemas ros2msg, messages in CDR.
// Types are those of known_ros_definition. Errors: Error if the disk refuses. Checked: @foxglove/rosbag, sql.js and
// @mcap/core read what is written (tests/io/ros_conformance); rosbag2 itself was not run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <isobath/base/time.hpp>
#include <isobath/io/ros/ros_definition.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace isobath {

struct RecordedTopic {
  std::string name, type;  ///< type without "/msg"
  bool latched = false;    ///< a later subscriber still gets its last message (transient local in ROS 2)
  std::uint64_t messages = 0;
};

/// First and last time of a log's messages.
struct RecordedSpan {
  std::optional<Time> first, last;
  void add(Time time);
};

class RosRecorder {
 public:
  virtual ~RosRecorder() = default;
  [[nodiscard]] virtual RosEncoding encoding() const = 0;
  /// Index of the topic in `topics`.
  std::size_t add_topic(RecordedTopic topic);
  /// `time`: of recording, one that ros_can_hold.
  void write(std::size_t topic, Time time, std::span<const std::uint8_t> message);
  /// Writes what ends the file.
  virtual void close() = 0;

  [[nodiscard]] const std::vector<RecordedTopic>& topics() const { return topics_; }
  [[nodiscard]] const RecordedSpan& span() const { return span_; }

 private:
  virtual void start(std::size_t topic) = 0;
  virtual void put(std::size_t topic, Time time, std::span<const std::uint8_t> message) = 0;

  std::vector<RecordedTopic> topics_;
  RecordedSpan span_;
};

std::unique_ptr<RosRecorder> record_ros1_bag(const std::filesystem::path& file);
std::unique_ptr<RosRecorder> record_ros2_database(const std::filesystem::path& file);
std::unique_ptr<RosRecorder> record_ros2_mcap(const std::filesystem::path& file);

/// The text of metadata.yaml (version 5, of Humble and later) for a closed ROS 2 bag in SQLite with this file name.
std::string metadata_yaml(const RosRecorder& bag, const std::string& file_name);

/// The checksum by which ROS 1 tells versions of a type apart, of a type that known_ros_definition knows.
std::string ros1_checksum(std::string_view type);

}  // namespace isobath
