// DepthRules: how one reading changes the depth and confidence of one pixel (Oskard 1990, IV-A and IV-B; ledger S1-45
// to S1-51, S1-62, S1-63, S1-76, S1-E05, S1-E06, S1-E09).
//
// Each pixel holds a depth and a confidence 0..20. A reading affirms the depth (confidence rises by the step),
// conflicts with it (confidence falls by the step; below the threshold the depth is replaced and the confidence set to
// the sensor's base), or is irrelevant to it. A pixel of unknown depth takes the first depth that a reading gives it,
// because there is no old depth to defend. A reading that is too uncertain to count (step 0) leaves such a pixel
// unsure: its confidence lies below the threshold, no path may rely on its depth, and the first reading that counts
// replaces it. Of two such readings the shallower one stands.
//
// Depths from forward sonars alone are bounds: an object reaches at least up to them. A higher bound does not
// contradict a lower one, so with `tighten` it replaces it at once, with the confidence of a new depth (S1-67). By the
// published rule each echo of a lower beam would affirm the lower bound, and the map would never hold the higher one.
//
// A new depth replaces the old one after floor((c0 - threshold) / step) + 1 conflicting readings, where c0 is the
// confidence at the start; a fully confirmed depth is replaced after full - threshold + 1 readings at a step of one.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <isobath/base/config.hpp>
#include <isobath/map/depth/depth_pixel.hpp>

namespace isobath {

struct DepthRules {
  int base_prior = 5;   ///< confidence of a charted depth
  int base_sensor = 6;  ///< confidence of a depth that a sensor has just replaced
  int threshold = 2;    ///< a depth is replaced when its confidence falls below this
  bool refine = false;  ///< agreeing depth soundings move the depth by step / (confidence + step) of the difference
  bool tighten = true;  ///< a higher bound of a forward sonar replaces a lower one at once; false: as published

  /// Whether no reading that counts stands behind the depth of a known pixel.
  [[nodiscard]] bool unsure(const DepthPixel& pixel) const { return pixel.confidence() < threshold; }
  /// Throws Error unless 0 < threshold <= base_prior < base_sensor <= 20 (S1-46).
  void check() const;
};
std::vector<Field> fields(DepthRules& rules);

/// What a reading says about a pixel.
enum class Claim : std::uint8_t {
  kBottomAt,   ///< depth sonar: the bottom is at `depth`, give or take `margin`
  kAtLeast,    ///< clear water down to `depth`: a shallower pixel conflicts, a deeper one is irrelevant
  kAtMost,     ///< the bottom, or an object on it, reaches up to `depth`
  kSomewhere,  ///< an echo that the map already explains: affirms a pixel that reaches up to `depth`, never conflicts
};

enum class Verdict : std::uint8_t { kIrrelevant, kAffirmed, kConflicted, kReplaced };

struct PixelReading {
  Claim claim = Claim::kBottomAt;
  std::int32_t depth_cm = 0;
  std::int32_t margin_cm = 0;
  int step = 1;       ///< confidence units; 0: too uncertain to count
  unsigned flag = 0;  ///< PixelFlag of the sensor
  std::uint32_t minute = 0;
};

/// Whether `pixel` agrees, conflicts, or is irrelevant (S1-51). kBottomAt is never irrelevant.
inline Verdict judge(const DepthPixel& pixel, const PixelReading& reading) {
  if (!pixel.known()) return reading.claim == Claim::kSomewhere ? Verdict::kIrrelevant : Verdict::kConflicted;
  const std::int32_t depth = pixel.depth_cm();
  switch (reading.claim) {
    case Claim::kBottomAt:
      return std::abs(depth - reading.depth_cm) <= reading.margin_cm ? Verdict::kAffirmed : Verdict::kConflicted;
    case Claim::kAtLeast: return depth < reading.depth_cm ? Verdict::kConflicted : Verdict::kIrrelevant;
    case Claim::kAtMost: return depth <= reading.depth_cm ? Verdict::kAffirmed : Verdict::kConflicted;
    case Claim::kSomewhere: return depth <= reading.depth_cm ? Verdict::kAffirmed : Verdict::kIrrelevant;
  }
  return Verdict::kIrrelevant;
}

/// The rule, in place (S1-49).
inline Verdict apply(DepthPixel& pixel, const PixelReading& reading, const DepthRules& rules) {
  const Verdict verdict = judge(pixel, reading);
  if (verdict == Verdict::kIrrelevant) return verdict;
  const unsigned flags = pixel.flags() | reading.flag;
  const int confidence = pixel.confidence();
  const bool first_that_counts = pixel.known() && rules.unsure(pixel) && reading.step > 0;
  if (verdict == Verdict::kAffirmed && !(first_that_counts && reading.claim == Claim::kBottomAt)) {
    const int risen = std::min(confidence + reading.step, kFullConfidence);
    if (rules.refine && reading.claim == Claim::kBottomAt && (flags & kSensed) != 0) {
      const int difference = reading.depth_cm - pixel.depth_cm();
      pixel.depth_word += static_cast<std::uint32_t>(
          std::lround(static_cast<double>(difference) * reading.step / (confidence + reading.step)));
    }
    pixel.state_word = DepthPixel::word_of_state(risen, flags, reading.minute);
    return verdict;
  }
  const int fallen = std::max(confidence - reading.step, 0);
  const bool tightens = rules.tighten && reading.claim == Claim::kAtMost && pixel.has(kSensed) &&
                        pixel.has(kSeenByObstacle) && !pixel.has(kSeenByDepth);
  if (pixel.known() && fallen >= rules.threshold && !tightens) {
    pixel.state_word = DepthPixel::word_of_state(fallen, pixel.flags(), reading.minute);
    return verdict;
  }
  pixel.depth_word = static_cast<std::uint32_t>(reading.depth_cm + DepthPixel::kDepthOffset);
  // The flags say which sensors support this depth; those that supported the previous one do not.
  const unsigned kept = pixel.flags() & kTrack;
  const unsigned seen = reading.claim == Claim::kAtLeast ? 0 : reading.flag;
  const int base = reading.step > 0 ? rules.base_sensor : rules.threshold - 1;
  pixel.state_word = DepthPixel::word_of_state(base, kept | seen | kSensed, reading.minute);
  return Verdict::kReplaced;
}

}  // namespace isobath
