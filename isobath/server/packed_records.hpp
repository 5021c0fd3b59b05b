// Records as a slow link needs them: packed, and in slices, so that what an operator acts on goes between the slices of
// what is bulky (docs/live-page.md, kind 21). Errors: none; bytes that zlib cannot pack are empty.
#pragma once

#include <cstdint>
#include <isobath/base/time.hpp>
#include <string>
#include <string_view>

namespace isobath {

enum class Packing : std::uint8_t { kZlib, kGzip };
std::string packed(std::string_view bytes, Packing packing, int level);

/// Packed records on one of the two channels of a page, sent slice after slice.
struct PackedRecords {
  enum class Channel : std::uint64_t { kUrgent, kBulky };

  Channel channel = Channel::kUrgent;
  std::string bytes;
  std::size_t sent = 0;

  [[nodiscard]] std::size_t left() const { return bytes.size() - sent; }
  /// Appends a record with the next slice, of at most `max_bytes`.
  void append_slice(std::string& out, std::size_t max_bytes, Time time);
};

}  // namespace isobath
