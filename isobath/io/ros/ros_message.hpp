// RosMessage: one ROS message, read field by field where its definition says that each field lies.
//
// One reader for two encodings: the serialisation of ROS 1 (little-endian, packed) and CDR of ROS 2 (OMG XCDR1, either
// byte order: numbers are aligned to their size, counted after a head of four bytes, and a text counts its closing
// zero). XCDR2 is refused.
// Untrusted: nothing is read outside the bytes, and counts are checked before use. After the first value that does not
// fit, `ok` is false and all further values are zero or empty; likewise after a field that the type lacks, which
// `missing` names. So one check after all reads is enough. Values are views: they must not outlive the message.
#pragma once

#include <algorithm>
#include <bit>
#include <isobath/base/time.hpp>
#include <isobath/io/bytes/bytes.hpp>
#include <isobath/io/ros/ros_definition.hpp>

namespace isobath {

class RosMessage;

class RosValue {
 public:
  /// The field of a message; a field that the type lacks makes the message bad.
  RosValue operator[](std::string_view field) const;
  [[nodiscard]] bool has(std::string_view field) const;
  /// A number of any kind, or a truth value.
  [[nodiscard]] double number() const;
  [[nodiscard]] std::uint64_t whole() const {
    return static_cast<std::uint64_t>(std::max(0.0, std::min(number(), 1e15)));
  }
  [[nodiscard]] std::string_view text() const;
  [[nodiscard]] std::optional<Time> time() const;
  /// Three views of an array: its elements, its numbers, and the bytes of its numbers as they lie in the message.
  [[nodiscard]] std::vector<RosValue> elements() const;
  [[nodiscard]] std::vector<double> numbers() const;
  [[nodiscard]] Bytes bytes() const;

 private:
  friend class RosMessage;
  RosValue(const RosMessage* message, RosField field, std::size_t at)
      : message_(message), field_(std::move(field)), at_(at) {}

  const RosMessage* message_;
  RosField field_;
  std::size_t at_;
};

class RosMessage {
 public:
  /// `definition` and `bytes` must outlive the message.
  RosMessage(const RosDefinition& definition, Bytes bytes, RosEncoding encoding);

  RosValue operator[](std::string_view field) const { return root()[field]; }
  [[nodiscard]] RosValue root() const;
  [[nodiscard]] bool ok() const { return ok_ && missing_.empty(); }
  [[nodiscard]] const std::string& missing() const { return missing_; }
  [[nodiscard]] std::endian order() const { return order_; }
  [[nodiscard]] const RosDefinition& definition() const { return definition_; }
  [[nodiscard]] Bytes bytes() const { return bytes_; }
  [[nodiscard]] RosEncoding encoding() const { return encoding_; }

 private:
  friend class RosValue;
  /// Position from which a value of this size is read.
  [[nodiscard]] std::size_t aligned(std::size_t at, std::size_t size) const;
  /// Bytes at a position, which moves behind them; empty and not ok if they do not fit.
  Bytes take(std::size_t& at, std::size_t count) const;
  [[nodiscard]] double number_at(std::size_t& at, RosPrimitive primitive) const;
  [[nodiscard]] std::uint32_t count_at(std::size_t& at) const;
  [[nodiscard]] std::string_view text_at(std::size_t& at) const;
  /// Number of elements of a field, 1 if it is no array; `at` moves behind the count.
  [[nodiscard]] std::size_t length_at(std::size_t& at, const RosField& field) const;
  void skip(std::size_t& at, const RosField& field) const;
  void skip_one(std::size_t& at, const RosField& field) const;

  const RosDefinition& definition_;
  Bytes bytes_;
  RosEncoding encoding_;
  std::endian order_ = std::endian::little;
  mutable bool ok_ = true;
  mutable std::string missing_;
};

}  // namespace isobath
