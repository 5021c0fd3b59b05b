// RosDefinition: the fields of a ROS message type, as the text says that a log carries with each topic (.msg files of
// ROS 1 and ROS 2: the root type, then each type that it needs after a line of = and "MSG: package/Name").
//
// Messages are decoded by the definition that was recorded with them, since the fields of a type change over the years.
// Names lose the "/msg" of ROS 2: sensor_msgs/msg/Range is sensor_msgs/Range. `time` of ROS 1 and
// builtin_interfaces/Time of ROS 2 are one primitive: seconds and nanoseconds of 32 bits. Constants take no space.
// Untrusted: parse gives nothing for a text that is not a definition, lacks a type, or contains itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

/// The serialisation of ROS 1, with definitions as ROS 1 writes them; CDR, with those of ROS 2.
enum class RosEncoding : std::uint8_t { kRos1, kCdr };

enum class RosPrimitive : std::uint8_t {
  kMessage,  ///< not primitive: RosField::type is its type
  kBool,
  kI8,
  kU8,
  kI16,
  kU16,
  kI32,
  kU32,
  kI64,
  kU64,
  kF32,
  kF64,
  kText,
  kTime
};
/// Bytes of a number; 0: not a number.
std::size_t bytes_of(RosPrimitive primitive);

struct RosField {
  enum class Array : std::uint8_t { kNone, kFixed, kSequence };
  std::string name;
  RosPrimitive primitive = RosPrimitive::kMessage;
  std::size_t type = 0;  ///< index of the type of a message
  Array array = Array::kNone;
  std::size_t count = 1;  ///< of a fixed array
};

struct RosType {
  std::string name;
  std::vector<RosField> fields;
  std::size_t min_bytes = 0;  ///< a value takes at least as much, so that counts can be checked
};

class RosDefinition {
 public:
  static constexpr std::size_t kMaxTypes = 200, kMaxFields = 5000, kMaxCount = 1 << 24;

  /// `root`: name of the type that the text begins with.
  static std::optional<RosDefinition> parse(std::string_view root, std::string_view text);

  /// Types by index; the root is the first.
  [[nodiscard]] const std::vector<RosType>& types() const { return types_; }

 private:
  std::vector<RosType> types_;
};

/// "sensor_msgs/msg/Range" -> "sensor_msgs/Range".
std::string ros_type_name(std::string_view name);

/// Package of the types that hold the records of Isobath's native log, exactly: isobath_msgs/Ping, ...
constexpr std::string_view kRecordPackage = "isobath_msgs/";

/// The definition of a type of the packages that Isobath reads and writes, with the types that it needs, as bags carry
/// it; empty: not known here. Logs may lack their definitions (rosbag2 before Iron): then these are used.
std::string known_ros_definition(std::string_view type, RosEncoding encoding);

}  // namespace isobath
