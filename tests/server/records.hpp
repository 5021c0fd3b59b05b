// The records of a frame, read as docs/live-page.md has them.
#pragma once

#include <cstdint>
#include <cstring>
#include <isobath/runtime/display_items.hpp>
#include <isobath/server/web_session.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace isobath::test {

struct Record {
  DisplayKind kind;
  bool gone, forget;
  std::uint64_t number;
  std::string payload;
};

/// Throws where they are not whole.
inline std::vector<Record> records_of(std::string_view bytes) {
  std::vector<Record> records;
  while (!bytes.empty()) {
    if (bytes.size() < 24) throw std::runtime_error("cut in a head");
    std::uint32_t size = 0;
    std::uint64_t number = 0;
    std::memcpy(&size, bytes.data() + 4, 4);
    std::memcpy(&number, bytes.data() + 8, 8);
    if (bytes.size() < 24 + (size + 7) / 8 * 8) throw std::runtime_error("cut in a payload");
    records.push_back({static_cast<DisplayKind>(bytes[0]), (bytes[1] & 1) != 0, (bytes[1] & 2) != 0, number,
                       std::string(bytes.substr(24, size))});
    bytes.remove_prefix(24 + (size + 7) / 8 * 8);
  }
  return records;
}

inline std::vector<Record> records_of(const WebFrame& frame) {
  return records_of((frame.shared ? *frame.shared : std::string()) + frame.own);
}

inline std::vector<Record> of_kind(const std::vector<Record>& records, DisplayKind kind) {
  std::vector<Record> found;
  for (const Record& r : records) {
    if (r.kind == kind) found.push_back(r);
  }
  return found;
}

}  // namespace isobath::test
