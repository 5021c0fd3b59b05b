// CDR, the serialisation of ROS 2 messages (OMG XCDR1, little-endian).
//
// Numbers are aligned to their own size, counted from the end of a header of four bytes. Sequences start with a 32-bit
// count. A CdrReader never reads outside its bytes: after the first value that does not fit, `ok` is false and all
// further values are zero.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

class CdrWriter {
 public:
  /// Overwrites `out`.
  explicit CdrWriter(std::vector<std::uint8_t>& out) : out_(out) { out_.assign({0, 1, 0, 0}); }

  template <class Number>
  CdrWriter& number(Number value) {
    align(sizeof value);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
    out_.insert(out_.end(), bytes, bytes + sizeof value);
    return *this;
  }
  /// Writes the length, including the closing zero, and then the text.
  CdrWriter& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    out_.insert(out_.end(), value.begin(), value.end());
    out_.push_back(0);
    return *this;
  }
  /// Writes the count and zeroed elements. The caller must fill the elements before the next write.
  template <class Number>
  std::uint8_t* sequence(std::size_t count) {
    number(static_cast<std::uint32_t>(count));
    if (count > 0) align(sizeof(Number));
    const std::size_t at = out_.size();
    out_.resize(at + count * sizeof(Number));
    return out_.data() + at;
  }

 private:
  void align(std::size_t size) { out_.resize(4 + (out_.size() - 4 + size - 1) / size * size); }
  std::vector<std::uint8_t>& out_;
};

class CdrReader {
 public:
  explicit CdrReader(std::span<const std::uint8_t> data) : data_(data) {
    ok_ = data.size() >= 4 && data[0] == 0 && data[1] == 1;
  }

  template <class Number>
  Number number() {
    Number value{};
    const auto bytes = take(sizeof value, sizeof value);
    if (ok_) std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  /// The bytes of the elements, not aligned in memory.
  template <class Number>
  std::span<const std::uint8_t> sequence() {
    const std::uint64_t count = number<std::uint32_t>();
    return count == 0 ? std::span<const std::uint8_t>() : take(sizeof(Number), count * sizeof(Number));
  }

  std::string text() {
    const std::uint64_t size = number<std::uint32_t>();
    const auto bytes = size == 0 ? std::span<const std::uint8_t>() : take(1, size);
    return bytes.empty() ? std::string() : std::string(bytes.begin(), bytes.end() - 1);
  }

  [[nodiscard]] bool ok() const { return ok_; }
  /// Whether all bytes are read: an older record lacks the fields that were added later.
  [[nodiscard]] bool at_end() const { return ok_ && at_ == data_.size(); }

 private:
  std::span<const std::uint8_t> take(std::size_t alignment, std::uint64_t count) {
    if (!ok_) return {};
    const std::uint64_t at = 4 + (at_ - 4 + alignment - 1) / alignment * alignment;
    ok_ = at <= data_.size() && count <= data_.size() - at;
    if (!ok_) return {};
    at_ = at + count;
    return data_.subspan(at, count);
  }

  std::span<const std::uint8_t> data_;
  std::uint64_t at_ = 4;
  bool ok_ = false;
};

}  // namespace isobath
