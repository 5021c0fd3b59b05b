// Records of display items taken apart (docs/live-page.md), by a reading of that page that shares no code with what
// writes them.
#pragma once

#include <cstdint>
#include <cstring>
#include <isobath/display/display_state.hpp>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace isobath::test {

struct Record {
  DisplayKind kind;
  bool gone, forget, forget_kind;
  std::uint64_t number;
  Time time;
  std::string payload;
};

template <class Number>
Number number_at(const std::string& bytes, std::size_t at) {
  Number value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// Throws where they are not whole.
inline std::vector<Record> records_of(const std::string& bytes) {
  std::vector<Record> records;
  for (std::size_t at = 0; at < bytes.size();) {
    if (bytes.size() - at < 24) throw std::runtime_error("cut in a head");
    const auto size = number_at<std::uint32_t>(bytes, at + 4);
    const std::size_t whole = 24 + (std::size_t{size} + 7) / 8 * 8;
    if (bytes.size() - at < whole) throw std::runtime_error("cut in a payload");
    const int flags = bytes[at + 1];
    records.push_back({static_cast<DisplayKind>(bytes[at]), (flags & 1) != 0, (flags & 2) != 0, (flags & 4) != 0,
                       number_at<std::uint64_t>(bytes, at + 8), Time(Duration(number_at<std::int64_t>(bytes, at + 16))),
                       bytes.substr(at + 24, size)});
    at += whole;
  }
  return records;
}

inline std::vector<Record> of_kind(const std::vector<Record>& records, DisplayKind kind) {
  std::vector<Record> found;
  for (const Record& r : records) {
    if (r.kind == kind) found.push_back(r);
  }
  return found;
}

inline std::map<std::pair<DisplayKind, std::uint64_t>, std::string> as_map(const std::string& bytes) {
  std::map<std::pair<DisplayKind, std::uint64_t>, std::string> items;
  for (const Record& r : records_of(bytes)) {
    if (!r.gone) items[{r.kind, r.number}] = r.payload;
  }
  return items;
}

/// PackBits.
inline std::vector<std::uint8_t> unpacked(const std::string& packed) {
  std::vector<std::uint8_t> out;
  for (std::size_t at = 0; at < packed.size();) {
    const auto head = static_cast<std::uint8_t>(packed[at++]);
    if (head < 128) {
      for (int i = 0; i <= head; ++i) out.push_back(static_cast<std::uint8_t>(packed[at++]));
    } else if (head > 128) {
      out.insert(out.end(), 257 - head, static_cast<std::uint8_t>(packed[at++]));
    }
  }
  return out;
}

}  // namespace isobath::test
