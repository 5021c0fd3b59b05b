// RecordWriter: a record of a stated size whose fields are written at their offsets, little-endian; RecordView
// (bytes.hpp) reads such records. Fields that are not written are zero.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

namespace isobath {

class RecordWriter {
 public:
  explicit RecordWriter(std::size_t bytes) : bytes_(bytes) {}

  /// T: integer, float, double or an enumeration. The field must lie within the record.
  template <class T>
  RecordWriter& put(std::size_t offset, T value) {
    static_assert(std::endian::native == std::endian::little);
    return put_bytes(offset, &value, sizeof value);
  }
  RecordWriter& put_bytes(std::size_t offset, const void* from, std::size_t count) {
    if (count > 0) std::memcpy(bytes_.data() + offset, from, count);
    return *this;
  }
  /// At most `longest` characters, without a zero at the end.
  RecordWriter& put_text(std::size_t offset, std::size_t longest, std::string_view text) {
    return put_bytes(offset, text.data(), std::min(longest, text.size()));
  }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace isobath
