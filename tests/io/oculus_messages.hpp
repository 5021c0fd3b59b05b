// Writer of Oculus messages and containers, made from the published layouts alone.
#pragma once

#include <bit>
#include <tests/io/bytes_by_hand.hpp>
#include <zlib.h>

namespace isobath::test {

inline std::string real(double value) { return little(std::bit_cast<std::uint64_t>(value)); }

struct OculusMessage {
  int version = 1;
  int beams = 3;
  int ranges = 2;
  int bytes_per_sample = 1;
  bool gain_per_row = false;
  std::uint32_t ping_id = 7;
  double start_time = 0;
  double frequency = 1.2e6;
  std::vector<int> bearings{-3000, 0, 3000};  ///< hundredths of a degree
  std::string image = std::string("\x01\x02\x03\x04\x05\x06", 6);

  [[nodiscard]] std::string bytes() const {
    const bool v2 = version == 2;
    const std::size_t head = v2 ? 202 : 122;
    const std::size_t offset = head + 2 * bearings.size();
    std::string body = std::string("\x01\x00\xff\x7f", 4) + static_cast<char>(gain_per_row ? 0x0d : 0x09);
    body += real(10) + real(50) + real(1500) + real(35);
    if (v2) body += std::string(36, '\0');
    body += little(ping_id) + little(std::uint32_t{0}) + real(frequency) + real(15) + real(1.5);
    if (v2) body += real(10) + real(2) + real(-3);
    body += real(1500) + (v2 ? real(start_time) : little(std::uint32_t{1000}));
    body += static_cast<char>(bytes_per_sample - 1);
    body += real(0.02) + little(static_cast<std::uint16_t>(ranges)) + little(static_cast<std::uint16_t>(beams));
    if (v2) body += std::string(16, '\0');
    const std::size_t total = offset + image.size();
    for (const std::size_t v : {offset, image.size(), total}) body += little(static_cast<std::uint32_t>(v));
    for (const int b : bearings) body += little(static_cast<std::uint16_t>(b));
    std::string message = "SO" + hex("D4 1E 00 00 23 00") + little(static_cast<std::uint16_t>(version)) +
                          little(static_cast<std::uint32_t>(total - 16)) + std::string(2, '\0');
    return message + body + image;
  }
};

inline std::string oculus_file_header(int encryption = 0) {
  return hex("44 33 22 11 30 00 00 00 4F 63 75 6C 75 73 00x10 01 00") + little(static_cast<std::uint16_t>(encryption)) +
         hex("00x4 00x8 00 00 20 40 FC 54 D9 41");
}

inline std::string oculus_item(double time, const std::string& payload, int type = 10, int compression = 0) {
  const auto size = little(static_cast<std::uint32_t>(payload.size()));
  return hex("DD CC BB AA 28 00 00 00") + little(static_cast<std::uint16_t>(type)) + std::string(6, '\0') + real(time) +
         little(static_cast<std::uint16_t>(compression)) + std::string(2, '\0') + size + size + std::string(4, '\0') +
         payload;
}

inline std::string qt_compressed(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(size, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
           static_cast<uLong>(bytes.size()));
  packed.resize(size);
  return big(static_cast<std::uint32_t>(bytes.size())) + packed;
}

}  // namespace isobath::test
