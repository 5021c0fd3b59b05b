// RosWriter: one ROS message, value after value in the order of its definition; RosMessage reads it back.
//
// The definition decides how each value is stored (integer, float32, float64), so that one sequence of calls gives the
// message in both encodings and of every version of a type. A call that does not fit the next field, or a message that
// is taken before its last field, is a mistake of the caller (ISOBATH_ASSERT). CDR is little-endian.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <isobath/base/time.hpp>
#include <isobath/io/bytes/bytes.hpp>
#include <isobath/io/ros/ros_definition.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace isobath {

class RosWriter {
 public:
  RosWriter(RosDefinition definition, RosEncoding encoding);

  [[nodiscard]] const RosDefinition& definition() const { return definition_; }
  /// Starts the next message.
  RosWriter& begin();
  /// std_msgs/Header, with the number of the message where it has one (ROS 1).
  RosWriter& header(Time time, std::string_view frame);
  RosWriter& number(double value);
  RosWriter& numbers(std::initializer_list<double> values);
  /// `time`: one that ros_can_hold.
  RosWriter& time(Time time);
  RosWriter& text(std::string_view value);
  /// A whole array of numbers, with its count where it is a sequence.
  RosWriter& array(std::span<const double> values);
  /// A whole array of numbers of `size` bytes each, as they lie in the memory of a little-endian machine.
  RosWriter& raw_array(std::span<const std::uint8_t> bytes);
  /// Starts a sequence of messages, whose fields follow.
  RosWriter& count(std::size_t elements);
  /// The message that all fields were written of; valid until the next `begin`.
  [[nodiscard]] std::span<const std::uint8_t> done();

 private:
  /// Fields of `left` values of a type, of which the first is at `field`.
  struct Level {
    std::size_t type = 0, field = 0, left = 1;
  };
  const RosField* next();
  void align(std::size_t size);
  void put(const void* from, std::size_t size);
  void put_number(RosPrimitive primitive, double value);

  RosDefinition definition_;
  RosEncoding encoding_;
  std::vector<std::uint8_t> out_;
  std::vector<Level> levels_;
  std::uint32_t messages_ = 0;
};

/// Whether a header of ROS can state a time: not before 1970, and before 2106 (ROS 1) or 2038 (ROS 2).
bool ros_can_hold(Time time, RosEncoding encoding);

/// A message in the other encoding, little-endian, number by number and bit by bit. Untrusted: empty if the bytes do
/// not hold a message of this definition, or are CDR of another byte order.
std::optional<std::vector<std::uint8_t>> recoded(const RosDefinition& definition, Bytes message, RosEncoding from);

}  // namespace isobath
