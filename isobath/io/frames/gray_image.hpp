// GrayImage: 8-bit and 16-bit grey images as PNG, the format in which polar sonar frames and masks are stored.
//
// Reading accepts grey, grey with alpha, and colour (its first channel). Samples of 1, 2 and 4 bits are scaled up to 8;
// palettes are expanded to colour. Values are used as stored, without gamma or alpha blending. Writing the same image
// gives the same bytes. Errors: throws Error if the file is not a complete PNG or has a side longer than kMaxSide.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace isobath {

struct GrayImage {
  static constexpr int kMaxSide = 32768;

  int width = 0;
  int height = 0;
  int sample_bytes = 1;               ///< 1 or 2
  std::vector<std::uint8_t> samples;  ///< rows from the top; little-endian if sample_bytes is 2

  [[nodiscard]] int operator()(int column, int row) const {
    const std::size_t at = (static_cast<std::size_t>(row) * width + column) * sample_bytes;
    return sample_bytes == 1 ? samples[at] : samples[at] | samples[at + 1] << 8;
  }
  bool operator==(const GrayImage&) const = default;
};

/// All channels of a PNG file as stored.
struct PngRows {
  int width = 0, height = 0;
  int channels = 1;                   ///< 1: grey, 2: grey and alpha, 3: colour, 4: colour and alpha
  int sample_bytes = 1;               ///< 1 or 2
  std::vector<std::uint8_t> samples;  ///< rows from the top; little-endian if sample_bytes is 2
};
PngRows parse_png(std::span<const std::uint8_t> bytes, const std::string& file);
/// Grey (1 channel) or colour (3 channels).
std::vector<std::uint8_t> png_bytes(int width, int height, int channels, int sample_bytes,
                                    std::span<const std::uint8_t> samples);

GrayImage parse_gray_png(std::span<const std::uint8_t> bytes, const std::string& file);
GrayImage read_gray_png(const std::filesystem::path& file);

std::vector<std::uint8_t> gray_png_bytes(const GrayImage& image);
void write_gray_png(const std::filesystem::path& file, const GrayImage& image);

}  // namespace isobath
