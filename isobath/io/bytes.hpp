// Bytes that others wrote: views of them, and a cursor that cannot leave them.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace isobath {

using Bytes = std::span<const std::byte>;

inline Bytes bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }
inline std::string_view text_of(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

/// Reads numbers one after the other, of either byte order. A read beyond the end gives zero and makes ok() false for
/// good: read a group, then ask once.
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

}  // namespace isobath
