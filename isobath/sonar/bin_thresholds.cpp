#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <isobath/sonar/bin_thresholds.hpp>

namespace isobath {
namespace {

static_assert(std::endian::native == std::endian::little, "eight bins are compared in one little-endian word");

constexpr std::uint64_t kTops = 0x8080808080808080u;

/// Sets the top bit of each byte with x >= y, both unsigned.
std::uint64_t at_or_above(std::uint64_t x, std::uint64_t y) {
  const std::uint64_t low = (x | kTops) - (y & ~kTops);
  return ((x & ~y) | (~(x ^ y) & low)) & kTops;
}

/// The top bits of eight bytes as one byte, the first byte lowest.
std::uint64_t gather_tops(std::uint64_t tops) { return ((tops >> 7) * 0x0102040810204080u) >> 56; }

/// Eight bytes as rows of eight bits, transposed (Warren, Hacker's Delight, 7-3).
std::uint64_t transpose(std::uint64_t x) {
  x = (x & 0xAA55AA55AA55AA55u) | ((x & 0x00AA00AA00AA00AAu) << 7) | ((x >> 7) & 0x00AA00AA00AA00AAu);
  x = (x & 0xCCCC3333CCCC3333u) | ((x & 0x0000CCCC0000CCCCu) << 14) | ((x >> 14) & 0x0000CCCC0000CCCCu);
  return (x & 0xF0F0F0F00F0F0F0Fu) | ((x & 0x00000000F0F0F0F0u) << 28) | ((x >> 28) & 0x00000000F0F0F0F0u);
}

std::uint64_t load8(const void* at) {
  std::uint64_t value = 0;
  std::memcpy(&value, at, 8);
  return value;
}

/// Compares one beam of adjacent 8-bit samples with the thresholds.
void compare_bins(const std::byte* samples, const std::uint8_t* thresholds, int bins, std::uint64_t* hits) {
  int k = 0;
  for (; k + 8 <= bins; k += 8) {
    hits[k / 64] |= gather_tops(at_or_above(load8(samples + k), load8(thresholds + k))) << (k % 64);
  }
  for (; k < bins; ++k) hits[k / 64] |= std::uint64_t{std::uint8_t(samples[k]) >= thresholds[k]} << (k % 64);
}

/// Compares eight interleaved beams, one row per bin: eight by eight decisions at a time, transposed to beams by bins.
void compare_beams(const std::byte* samples, std::ptrdiff_t bin_stride, const std::uint8_t* thresholds, int bins,
                   int beam, EchoDecisions& out) {
  for (int k = 0; k < bins; k += 8) {
    std::uint64_t rows = 0;
    for (int i = 0; i < std::min(8, bins - k); ++i) {
      const std::uint64_t wanted = thresholds[k + i] * 0x0101010101010101u;
      rows |= gather_tops(at_or_above(load8(samples + (k + i) * bin_stride), wanted)) << (8 * i);
    }
    if (rows == 0) continue;
    const std::uint64_t columns = transpose(rows);
    for (int b = 0; b < 8; ++b) out.hits(beam + b)[k / 64] |= (columns >> (8 * b) & 0xff) << (k % 64);
  }
}

template <class Sample>
void compare_strided(const std::byte* at, std::ptrdiff_t stride, const float* thresholds, int bins,
                     std::uint64_t* hits) {
  for (int k = 0; k < bins; ++k, at += stride) {
    Sample value;
    std::memcpy(&value, at, sizeof value);
    hits[k / 64] |= std::uint64_t{static_cast<float>(value) >= thresholds[k]} << (k % 64);
  }
}

void compare_any(const Intensities& z, int beam, const float* thresholds, std::uint64_t* hits) {
  const std::byte* at = z.data() + beam * z.beam_stride();
  switch (z.type()) {
    case SampleType::kU8: return compare_strided<std::uint8_t>(at, z.bin_stride(), thresholds, z.bins(), hits);
    case SampleType::kU16: return compare_strided<std::uint16_t>(at, z.bin_stride(), thresholds, z.bins(), hits);
    case SampleType::kF32: return compare_strided<float>(at, z.bin_stride(), thresholds, z.bins(), hits);
  }
}

}  // namespace

void BinThresholds::set(const std::vector<float>& thresholds) {
  whole_.assign(thresholds.size(), 255);
  reachable_.assign((thresholds.size() + 63) / 64, 0);
  for (std::size_t k = 0; k < thresholds.size(); ++k) {
    if (!(thresholds[k] <= 255)) continue;
    whole_[k] = static_cast<std::uint8_t>(std::ceil(std::max(thresholds[k], 0.0f)));
    reachable_[k / 64] |= std::uint64_t{1} << (k % 64);
  }
}

void BinThresholds::decide(const Intensities& samples, const std::vector<float>& thresholds, EchoDecisions& out) const {
  const bool bytes = samples.type() == SampleType::kU8;
  int beam = 0;
  if (bytes && samples.bin_stride() == 1) {
    for (; beam < samples.beams(); ++beam) {
      compare_bins(samples.data() + beam * samples.beam_stride(), whole_.data(), samples.bins(), out.hits(beam));
    }
  } else if (bytes && samples.beam_stride() == 1) {
    for (; beam + 8 <= samples.beams(); beam += 8) {
      compare_beams(samples.data() + beam, samples.bin_stride(), whole_.data(), samples.bins(), beam, out);
    }
  }
  for (int b = beam; b < samples.beams(); ++b) compare_any(samples, b, thresholds.data(), out.hits(b));
  for (int b = 0; b < samples.beams(); ++b) {
    for (int w = 0; w < out.words(); ++w) {
      out.hits(b)[w] &= out.usable()[w] & (bytes ? reachable_[w] : ~std::uint64_t{0});
    }
  }
}

}  // namespace isobath
