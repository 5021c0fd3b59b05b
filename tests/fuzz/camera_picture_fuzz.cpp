// Pictures of cameras, PNG or JPEG: any bytes.
#include <cstdint>
#include <isobath/base/error.hpp>
#include <isobath/io/frames/camera_pictures.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  try {
    const CameraImage image = parse_camera_image({data, size}, "fuzz");
    ISOBATH_ASSERT(image.channels == 1 || image.channels == 3);
    (void)grey_of(image)(image.width - 1, image.height - 1);
  } catch (const Error&) {
  }
  return 0;
}
