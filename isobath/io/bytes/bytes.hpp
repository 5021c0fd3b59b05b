// Untrusted bytes: views of them, and a cursor that cannot leave them.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>

namespace isobath {

using Bytes = std::span<const std::byte>;

inline Bytes bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }
inline std::string_view text_of(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

/// Reads numbers of either byte order one after the other. A read beyond the end gives zero and makes ok() false
/// permanently, so one check after a group of reads is enough.
class ByteCursor {
 public:
  explicit ByteCursor(Bytes bytes, std::size_t at = 0) : bytes_(bytes), at_(0) { skip(at); }

  /// T: integer, float or double.
  template <class T>
  T little() {
    return read<T, std::endian::little>();
  }
  template <class T>
  T big() {
    return read<T, std::endian::big>();
  }
  Bytes take(std::size_t count) {
    if (count > left()) {
      ok_ = false;
      at_ = bytes_.size();
      return {};
    }
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }
  void skip(std::size_t count) { take(count); }

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::size_t position() const { return at_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }

 private:
  template <class T, std::endian order>
  T read() {
    const Bytes from = take(sizeof(T));
    std::array<std::byte, sizeof(T)> raw{};
    for (std::size_t i = 0; i < from.size(); ++i) raw[order == std::endian::native ? i : sizeof(T) - 1 - i] = from[i];
    return std::bit_cast<T>(raw);
  }

  Bytes bytes_;
  std::size_t at_;
  bool ok_ = true;
};

/// The fields of a record by their offsets, for formats whose records state their own size and have grown over the
/// years. A field beyond the end is absent and reads as zero.
class RecordView {
 public:
  explicit RecordView(Bytes bytes, std::endian order = std::endian::little) : bytes_(bytes), order_(order) {}

  /// T: integer, float or double.
  template <class T>
  [[nodiscard]] T at(std::size_t offset) const {
    if (!holds(offset, sizeof(T))) return T{};
    std::array<std::byte, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes_.data() + offset, sizeof(T));
    if (order_ != std::endian::native) {
      for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(raw[i], raw[sizeof(T) - 1 - i]);
    }
    return std::bit_cast<T>(raw);
  }
  [[nodiscard]] bool holds(std::size_t offset, std::size_t count) const {
    return offset <= bytes_.size() && count <= bytes_.size() - offset;
  }
  /// The available part of `count` bytes.
  [[nodiscard]] Bytes part(std::size_t offset, std::size_t count) const {
    if (offset >= bytes_.size()) return {};
    return bytes_.subspan(offset, count < bytes_.size() - offset ? count : bytes_.size() - offset);
  }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  [[nodiscard]] std::endian order() const { return order_; }

 private:
  Bytes bytes_;
  std::endian order_;
};

}  // namespace isobath
