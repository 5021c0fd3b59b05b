// Pictures of cameras, and maps of disparities, as files.
//
// Pictures: PNG (8 or 16 bits, grey, colour, palettes; alpha is ignored) and JPEG, recognised by content. Maps of
// numbers: PFM (one channel, either byte order; infinite or not a number: unknown), and grey PNG, 8 or 16 bits times a
// scale (0: unknown). Files are untrusted. Errors: throws Error with the file and what is wrong.
#pragma once

#include <filesystem>
#include <isobath/stereo/optics/camera_image.hpp>
#include <span>
#include <string>

namespace isobath {

/// `file`: for messages.
CameraImage parse_camera_image(std::span<const std::uint8_t> bytes, const std::string& file);
CameraImage read_camera_image(const std::filesystem::path& file);
void write_camera_image(const std::filesystem::path& file, const CameraImage& image);

struct NumberMap {
  int width = 0, height = 0;
  std::vector<float> values;  ///< rows from the top; NaN: unknown
};
NumberMap read_number_map(const std::filesystem::path& file, double scale);
void write_pfm(const std::filesystem::path& file, const NumberMap& map);

}  // namespace isobath
