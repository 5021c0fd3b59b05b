// Writer of Tritech frames, made from the published layout alone.
#pragma once

#include <cstdio>
#include <tests/io/bytes_by_hand.hpp>

namespace isobath::test {

inline std::string tritech_packet(int id, int sequence, const std::string& payload, int source = 2) {
  const auto length = static_cast<std::uint16_t>(payload.size() + 8);
  char digits[8];
  std::snprintf(digits, sizeof digits, "%04X", length);
  std::string frame = "@" + std::string(digits) + little(length);
  for (const int b : {source, 255, 0, id, sequence, source}) frame += static_cast<char>(b);
  return frame + payload + '\n';
}

struct TritechMessage {
  int bearing = 3200;
  int bin_time = 30;
  int head_control = 0x2305;
  int status = 0x10;
  int sweep = 0;
  int range_scale = 100;
  std::string samples = std::string("\x00\x40\xc8\xff", 4);

  [[nodiscard]] std::string payload() const {
    const auto u16 = [](int v) { return little(static_cast<std::uint16_t>(v)); };
    const std::string body = std::string(1, '\x11') + static_cast<char>(status) + static_cast<char>(sweep) +
                             u16(head_control) + u16(range_scale) + std::string(4, '\0') + '\x69' + u16(0) +
                             "\x51\x08" + u16(0) + u16(bin_time) + u16(2400) + u16(4000) + '\x10' + u16(bearing) +
                             u16(static_cast<int>(samples.size())) + samples;
    return u16(static_cast<int>(body.size()) + 2) + body;
  }
  [[nodiscard]] std::string frame() const { return tritech_packet(2, 0x80, payload()); }
};

}  // namespace isobath::test
