// PNG frames: any bytes.
#include <cstdint>
#include <isobath/base/error.hpp>
#include <isobath/io/frames/gray_image.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  try {
    const GrayImage image = parse_gray_png({data, size}, "fuzz");
    (void)image(image.width - 1, image.height - 1);
  } catch (const Error&) {
  }
  return 0;
}
