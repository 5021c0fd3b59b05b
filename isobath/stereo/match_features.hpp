// MatchFeatures: what dense matching compares of a picture: for each channel four bytes of a centre-symmetric census of
// 9 x 7 pixels (Spangenberg et al. 2013: 31 pairs of pixels opposite to each other; bit: the first is darker), and its
// brightness. Brightness is multiplied by the channel's weight. Pixels beyond the edge repeat it.
//
// Planes of a row lie one after the other, `stride` apart. In a mirrored picture pixel x is at `front` + width - 1 - x;
// both ends are padded with the outermost pixels.
#pragma once

#include <isobath/stereo/disparity_kernel.hpp>
#include <isobath/stereo/optics/camera_image.hpp>

namespace isobath {

class MatchFeatures {
 public:
  static constexpr int kCensusBytes = 4, kPairs = 31;

  void compute(const DisparityKernel& kernel, const CameraImage& image, const double (&weights)[3], bool mirrored,
               int front, int back);
  [[nodiscard]] const std::uint8_t* row(int y) const { return data_.data() + static_cast<std::size_t>(y) * row_bytes_; }
  [[nodiscard]] std::size_t stride() const { return stride_; }

 private:
  void pad_channel(const CameraImage& image, int channel);
  void compute_row(const DisparityKernel& kernel, int width, int y, int weight, bool mirrored, int front,
                   std::uint8_t* planes);

  std::size_t stride_ = 0, row_bytes_ = 0;
  std::vector<std::uint8_t> data_;
  std::size_t padded_ = 0;             ///< bytes of a row of channel_
  std::vector<std::uint8_t> channel_;  ///< padded by half the census window on all sides
  std::vector<std::uint8_t> values_;   ///< of one row of a plane
};

}  // namespace isobath
