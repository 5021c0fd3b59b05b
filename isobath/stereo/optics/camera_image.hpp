// CameraImage: an 8-bit picture of a camera, grey or colour (red, green, blue), rows from the top.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace isobath {

struct CameraImage {
  int width = 0, height = 0;
  int channels = 1;                   ///< 1: grey; 3: red, green, blue
  std::vector<std::uint8_t> samples;  ///< channels side by side, row by row

  CameraImage() = default;
  CameraImage(int columns, int rows, int channel_count)
      : width(columns),
        height(rows),
        channels(channel_count),
        samples(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows) *
                static_cast<std::size_t>(channel_count)) {}

  [[nodiscard]] std::size_t index(int column, int row) const {
    return (static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)) *
           static_cast<std::size_t>(channels);
  }
  [[nodiscard]] std::uint8_t operator()(int column, int row, int channel = 0) const {
    return samples[index(column, row) + static_cast<std::size_t>(channel)];
  }
  std::uint8_t& operator()(int column, int row, int channel = 0) {
    return samples[index(column, row) + static_cast<std::size_t>(channel)];
  }
  bool operator==(const CameraImage&) const = default;
};

/// Brightness of a colour picture: (77 R + 150 G + 29 B) / 256, rounded; a grey one as it is.
CameraImage grey_of(const CameraImage& image);
/// Half the width and height: means of four pixels.
CameraImage halved(const CameraImage& image);

}  // namespace isobath
