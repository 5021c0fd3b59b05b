// RosRecording: the topics and messages of a log of ROS, in whatever file they stand (ROS 1 bag, SQLite, MCAP).
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/input/input_config.hpp>
#include <isobath/io/ros/ros_message.hpp>
#include <memory>
#include <string>
#include <vector>

namespace isobath {

struct RosTopic {
  std::string name;
  std::string type;  ///< without "/msg"
  RosEncoding encoding = RosEncoding::kRos1;
  std::optional<RosDefinition> definition;  ///< empty: the log has none that can be read
  std::uint64_t messages = 0;               ///< as its index states; 0 where there is none
};

struct RosRecord {
  std::size_t topic = 0;  ///< index of topics()
  Time time;              ///< at which it was recorded
  Bytes data;             ///< valid as long as `owner` lives
  std::shared_ptr<const void> owner;
};

class RosRecording {
 public:
  virtual ~RosRecording() = default;
  /// Those known so far; more may appear while messages are read.
  [[nodiscard]] virtual const std::vector<RosTopic>& topics() const = 0;
  /// The next message in the order of the file; empty at the end.
  virtual std::optional<RosRecord> next() = 0;
  [[nodiscard]] virtual SourceReport& report() = 0;
};

/// The events of a recording: see ros_source.cpp.
std::unique_ptr<Source> ros_events(std::unique_ptr<RosRecording> recording, const InputConfig& config);

}  // namespace isobath
