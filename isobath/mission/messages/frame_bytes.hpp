// The bytes of frames on a link: little-endian numbers, and the checksum.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace isobath {

using FrameBytes = std::vector<std::uint8_t>;

inline void put(FrameBytes& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

/// Of `count` bytes from `at` on, which must be there.
inline std::uint64_t number_at(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value |= std::uint64_t{bytes[at + i]} << (8 * i);
  return value;
}

/// CRC-32 of Ethernet: reflected, polynomial 0x04c11db7.
inline std::uint32_t crc32(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xffffffffU;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1U) != 0 ? 0xedb88320U : 0U);
  }
  return ~crc;
}

}  // namespace isobath
