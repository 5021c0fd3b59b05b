// A depth field that is a plain array: the obvious map to test planners with.
#pragma once

#include <isobath/map/depth/depth_field.hpp>
#include <string>
#include <vector>

namespace isobath::test {

class ArrayField final : public DepthField {
 public:
  ArrayField(PixelGrid grid, PixelWindow window, double depth_m, int confidence = kFullConfidence)
      : grid_(grid),
        window_(window),
        pixels_(static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height),
                of(depth_m, confidence)) {}

  static DepthPixel of(double depth_m, int confidence = kFullConfidence) {
    return {DepthPixel::word_of_depth(depth_m), DepthPixel::word_of_state(confidence, 0, 0)};
  }
  void set(Pixel p, const DepthPixel& value) {
    pixels_[index(p)] = value;
    ++version_;
  }
  void set(Pixel p, double depth_m) { set(p, of(depth_m)); }

  [[nodiscard]] PixelGrid grid() const override { return grid_; }
  [[nodiscard]] std::uint64_t version() const override { return version_; }
  void read(PixelWindow w, std::span<DepthPixel> out) const override {
    std::size_t i = 0;
    for (std::int32_t row = w.row; row < w.row + w.height; ++row) {
      for (std::int32_t column = w.column; column < w.column + w.width; ++column) {
        const Pixel p{column, row};
        out[i++] = window_.contains(p) ? pixels_[index(p)] : DepthPixel{};
      }
    }
  }
  [[nodiscard]] const PixelWindow& window() const { return window_; }

 private:
  [[nodiscard]] std::size_t index(Pixel p) const {
    return static_cast<std::size_t>(p.row - window_.row) * static_cast<std::size_t>(window_.width) +
           static_cast<std::size_t>(p.column - window_.column);
  }
  PixelGrid grid_;
  PixelWindow window_;
  std::vector<DepthPixel> pixels_;
  std::uint64_t version_ = 1;
};

}  // namespace isobath::test
