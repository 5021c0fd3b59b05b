// The bytes of a quadtree file as its format says (isobath/map/depth/tree_file.hpp), for tests that damage them with
// care. Words are little-endian, as the machines that run the tests are.
#pragma once

#include <cstdint>
#include <vector>

namespace isobath::test {

struct TreeFileBytes {
  // Offsets in the header.
  static constexpr std::size_t kOrder = 8;
  static constexpr std::size_t kVersion = 12;
  static constexpr std::size_t kLevels = 24;
  static constexpr std::size_t kRoot = 32;
  static constexpr std::size_t kPages = 36;
  static constexpr std::size_t kBlocks = 40;
  static constexpr std::size_t kFreeHead = 44;
  static constexpr std::size_t kFreeCount = 48;
  static constexpr std::size_t kMetadataBytes = 52;
  static constexpr std::size_t kCrownBlocks = 56;
  static constexpr std::size_t kCrownCrc = 60;
  static constexpr std::size_t kCrc = 68;
  static constexpr std::size_t kHeader = 72;
  static constexpr std::size_t kPage = 16384;

  std::vector<std::uint8_t> bytes;

  [[nodiscard]] std::uint32_t word(std::size_t at) const {
    std::uint32_t w = 0;
    for (std::size_t i = 0; i < sizeof w && at + i < bytes.size(); ++i) w |= std::uint32_t{bytes[at + i]} << 8 * i;
    return w;
  }
  void put(std::size_t at, std::uint32_t w) {
    for (std::size_t i = 0; i < sizeof w && at + i < bytes.size(); ++i)
      bytes[at + i] = static_cast<std::uint8_t>(w >> 8 * i);
  }
  [[nodiscard]] std::size_t table() const { return kHeader + (std::size_t{word(kMetadataBytes)} + 3) / 4 * 4; }
  [[nodiscard]] std::size_t crown() const { return table() + std::size_t{4} * word(kPages); }
  [[nodiscard]] std::size_t page(std::size_t number) const {
    return (crown() + std::size_t{20} * word(kCrownBlocks) + 4095) / 4096 * 4096 + kPage * number;
  }
  [[nodiscard]] std::size_t block(std::size_t index) const { return page(0) + 16 * index; }

  /// Every checksum that the file has room for: as if it had been written so.
  void seal() {
    if (bytes.size() < kHeader) return;
    for (std::size_t i = 0; i < word(kPages) && page(i) + kPage <= bytes.size(); ++i)
      put(table() + 4 * i, crc(page(i), kPage));
    put(kCrownCrc, crc(crown(), std::size_t{20} * word(kCrownBlocks)));
    put(kCrc, crc(kHeader, word(kMetadataBytes), crc(0, kCrc)));
  }
  /// CRC-32 of ISO 3309, a bit at a time.
  [[nodiscard]] std::uint32_t crc(std::size_t from, std::size_t size, std::uint32_t before = 0) const {
    std::uint32_t crc = ~before;
    for (std::size_t i = from; i < from + size && i < bytes.size(); ++i) {
      crc ^= bytes[i];
      for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (0xedb88320U & -(crc & 1U));
    }
    return ~crc;
  }
};

}  // namespace isobath::test
