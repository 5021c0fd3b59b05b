// DepthPixel: what a depth map knows about one pixel, and the two 31-bit words in which quadtrees keep it (Oskard 1990,
// III-A; ledger S1-12, S1-16 to S1-18, S1-45).
//
// Depth word: 0 is unknown; else the depth of the bottom below the map's datum in centimetres, offset by 2^30 (negative
// depths dry out). State word: 5 bits of confidence 0..20, the flags, and the time of the last reading of the pixel in
// minutes since the map's epoch (22 bits: 8 years, then it saturates).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

namespace isobath {

inline constexpr int kFullConfidence = 20;

enum PixelFlag : std::uint8_t {
  kTrack = 1,           ///< the vehicle passed here
  kSeenByDepth = 2,     ///< a downward sonar measured or affirmed its depth
  kSeenByObstacle = 4,  ///< a forward sonar did; alone, the depth is a bound: something reaches up to it or higher
  kSensed = 8,          ///< its depth comes from a sensor, not from the prior (S1-E05); alone: see clear_only()
};

struct DepthPixel {
  static constexpr std::uint32_t kUnknownDepth = 0;
  static constexpr std::int32_t kDepthOffset = 1 << 30;
  static constexpr std::uint32_t kLastMinute = (1U << 22) - 1;
  static constexpr std::uint32_t kLargestDepthCm = 1'000'000'000;  ///< 1e4 km

  std::uint32_t depth_word = kUnknownDepth;
  std::uint32_t state_word = 0;  ///< confidence, flags << 5, minutes << 9
  bool operator==(const DepthPixel&) const = default;

  [[nodiscard]] bool known() const { return depth_word != kUnknownDepth; }
  /// m, positive down; only where known.
  [[nodiscard]] double depth_m() const { return 0.01 * depth_cm(); }
  [[nodiscard]] std::int32_t depth_cm() const { return static_cast<std::int32_t>(depth_word) - kDepthOffset; }
  [[nodiscard]] int confidence() const { return static_cast<int>(state_word & 31U); }
  [[nodiscard]] unsigned flags() const { return (state_word >> 5) & 15U; }
  [[nodiscard]] bool has(PixelFlag flag) const { return (flags() & flag) != 0; }
  /// A forward beam without an echo here: the water is clear down to this depth, and nothing is known below it.
  [[nodiscard]] bool clear_only() const { return (flags() & (kSensed | kSeenByDepth | kSeenByObstacle)) == kSensed; }
  /// Since the map's epoch.
  [[nodiscard]] std::uint32_t minute() const { return state_word >> 9; }

  /// Whether words from a file are words of this map: every depth is in range, every confidence is at most 20.
  static bool depth_valid(std::uint32_t word) {
    return word == kUnknownDepth || word - (kDepthOffset - kLargestDepthCm) <= 2 * kLargestDepthCm;
  }
  static bool state_valid(std::uint32_t word) {
    return word >> 31 == 0 && (word & 31U) <= static_cast<std::uint32_t>(kFullConfidence);
  }

  /// Nearest centimetre; |depth| < 1e4 km.
  static std::uint32_t word_of_depth(double depth_m) {
    return static_cast<std::uint32_t>(std::lround(100 * depth_m) + kDepthOffset);
  }
  static std::uint32_t word_of_state(int confidence, unsigned flags, std::uint32_t minute) {
    return static_cast<std::uint32_t>(confidence) | (flags << 5) | (std::min(minute, kLastMinute) << 9);
  }
};

}  // namespace isobath
