#include <isobath/stereo/optics/camera_image.hpp>

namespace isobath {

CameraImage grey_of(const CameraImage& image) {
  if (image.channels == 1) return image;
  CameraImage grey(image.width, image.height, 1);
  const std::uint8_t* from = image.samples.data();
  for (std::uint8_t& sample : grey.samples) {
    sample = static_cast<std::uint8_t>((77 * from[0] + 150 * from[1] + 29 * from[2] + 128) >> 8);
    from += 3;
  }
  return grey;
}

CameraImage halved(const CameraImage& image) {
  CameraImage half(image.width / 2, image.height / 2, image.channels);
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      for (int c = 0; c < image.channels; ++c) {
        const int sum = image(2 * x, 2 * y, c) + image(2 * x + 1, 2 * y, c) + image(2 * x, 2 * y + 1, c) +
                        image(2 * x + 1, 2 * y + 1, c);
        half(x, y, c) = static_cast<std::uint8_t>((sum + 2) / 4);
      }
    }
  }
  return half;
}

}  // namespace isobath
