#include <bit>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <isobath/base/pending_file.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/report/plot/number_picture.hpp>
#include <isobath/studies/stereo_study.hpp>
#include <limits>

namespace isobath {
namespace {

void append_float(std::string& bytes, double value) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
  for (int k = 0; k < 4; ++k) bytes += static_cast<char>(bits >> 8 * k & 0xFF);
}

/// Binary PLY, with the colours of the left picture and the standard deviation of z.
std::string points_ply(const std::vector<StereoPoint>& points, const CameraImage& left) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment x right, y down, z forward of the left camera, metres\n"
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty float sigma_z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
      points.size());
  for (const StereoPoint& point : points) {
    for (const double value : {point.p_V.x(), point.p_V.y(), point.p_V.z(), point.sigma_z_m})
      append_float(bytes, value);
    for (int c = 0; c < 3; ++c) {
      bytes += static_cast<char>(left(point.column, point.row, left.channels == 3 ? c : 0));
    }
  }
  return bytes;
}

}  // namespace

std::vector<std::filesystem::path> write_stereo(const StereoPair& pair, const StereoStudy& study,
                                                const std::filesystem::path& folder) {
  make_folder(folder);
  std::vector<std::filesystem::path> files;
  const auto write = [&](const char* name, const std::string& bytes) {
    write_whole_file(folder / name, bytes);
    files.emplace_back(name);
  };
  if (pair.simulated || pair.geometry.rectifies()) {
    write_camera_image(folder / "left.png", pair.left);
    write_camera_image(folder / "right.png", pair.right);
    files.insert(files.end(), {"left.png", "right.png"});
  }
  const MotionDepth* const motion = study.motion ? &*study.motion : nullptr;
  const int width = motion ? motion->width : study.map.width, height = motion ? motion->height : study.map.height;
  if (!motion) {
    write("disparity.png", number_picture(study.map.disparity, width, height, {"Disparity", "pixels"}));
    write("confidence.png", number_picture(study.map.confidence, width, height, {"Confidence", "0 to 1"}, {{0, 1}}));
    write_pfm(folder / "disparity.pfm", {width, height, study.map.disparity});
    files.emplace_back("disparity.pfm");
  }
  if (study.points.empty()) return files;
  const int every = motion ? motion->every : 1;
  std::vector<float> depth(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                           std::numeric_limits<float>::quiet_NaN());
  std::vector<float> sigma = depth;
  for (const StereoPoint& point : study.points) {
    const std::size_t at = static_cast<std::size_t>(point.row / every) * static_cast<std::size_t>(width) +
                           static_cast<std::size_t>(point.column / every);
    depth[at] = static_cast<float>(point.p_V.z());
    sigma[at] = static_cast<float>(point.sigma_z_m);
  }
  write("depth.png", number_picture(depth, width, height, {"Depth along the optical axis", "m"}));
  write("uncertainty.png", number_picture(sigma, width, height, {"Standard deviation of the depth", "m"}));
  write_pfm(folder / "depth.pfm", {width, height, depth});
  files.emplace_back("depth.pfm");
  write("points.ply", points_ply(study.points, pair.left));
  return files;
}

}  // namespace isobath
