#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/io/bytes/whole_file.hpp>
#include <isobath/io/frames/camera_pictures.hpp>
#include <isobath/io/frames/gray_image.hpp>
// After <cstdio>, which it needs.
#include <jpeglib.h>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

namespace isobath {
namespace {

constexpr std::uint64_t kMaxPictureBytes = 1u << 28;
constexpr float kUnknownNumber = std::numeric_limits<float>::quiet_NaN();

/// libjpeg reports errors by a call that must not return; this one jumps.
struct JpegProblem {
  jpeg_error_mgr manager{};
  std::jmp_buf jump{};
  char text[JMSG_LENGTH_MAX]{};
};
[[noreturn]] void leave_jpeg(j_common_ptr common) {
  auto* problem = reinterpret_cast<JpegProblem*>(common->err);
  common->err->format_message(common, problem->text);
  std::longjmp(problem->jump, 1);
}
void ignore_jpeg_message(j_common_ptr) {}

struct JpegReading {
  jpeg_decompress_struct jpeg{};
  JpegProblem problem;
  CameraImage image;
  bool cut_off = false;
  ~JpegReading() { jpeg_destroy_decompress(&jpeg); }
};

bool read_jpeg_rows(JpegReading& r, std::span<const std::uint8_t> bytes) {
  r.jpeg.err = jpeg_std_error(&r.problem.manager);
  r.problem.manager.error_exit = leave_jpeg;
  r.problem.manager.output_message = ignore_jpeg_message;
  if (setjmp(r.problem.jump)) return false;
  jpeg_create_decompress(&r.jpeg);
  jpeg_mem_src(&r.jpeg, bytes.data(), bytes.size());
  jpeg_read_header(&r.jpeg, TRUE);
  r.jpeg.out_color_space = r.jpeg.num_components == 1 ? JCS_GRAYSCALE : JCS_RGB;
  r.jpeg.dct_method = JDCT_ISLOW;
  if (r.jpeg.image_width > GrayImage::kMaxSide || r.jpeg.image_height > GrayImage::kMaxSide ||
      std::uint64_t(r.jpeg.image_width) * r.jpeg.image_height > 2000 * std::uint64_t(bytes.size())) {
    std::strcpy(r.problem.text, "the stated image size is impossible for so short a file");
    return false;
  }
  jpeg_start_decompress(&r.jpeg);
  r.image = CameraImage(static_cast<int>(r.jpeg.output_width), static_cast<int>(r.jpeg.output_height),
                        r.jpeg.output_components);
  const std::size_t row_bytes = std::size_t{r.jpeg.output_width} * static_cast<std::size_t>(r.jpeg.output_components);
  while (r.jpeg.output_scanline < r.jpeg.output_height) {
    JSAMPROW row = r.image.samples.data() + r.jpeg.output_scanline * row_bytes;
    jpeg_read_scanlines(&r.jpeg, &row, 1);
  }
  jpeg_finish_decompress(&r.jpeg);
  r.cut_off = r.problem.manager.num_warnings > 0;
  return true;
}

CameraImage parse_jpeg(std::span<const std::uint8_t> bytes, const std::string& file) {
  JpegReading r;
  if (!read_jpeg_rows(r, bytes)) throw Error(std::string("damaged JPEG: ") + r.problem.text, {file});
  if (r.cut_off) throw Error("damaged JPEG: part of the picture is missing or garbled", {file});
  return std::move(r.image);
}

CameraImage parse_png_picture(std::span<const std::uint8_t> bytes, const std::string& file) {
  const PngRows rows = parse_png(bytes, file);
  CameraImage image(rows.width, rows.height, rows.channels < 3 ? 1 : 3);
  const auto stored = static_cast<std::size_t>(rows.channels) * static_cast<std::size_t>(rows.sample_bytes);
  const auto kept = static_cast<std::size_t>(image.channels);
  for (std::size_t i = 0, n = image.samples.size() / kept; i < n; ++i) {
    for (std::size_t c = 0; c < kept; ++c) {  // of 16 bits the upper byte
      const auto sample = static_cast<std::size_t>(rows.sample_bytes) * (c + 1) - 1;
      image.samples[i * kept + c] = rows.samples[i * stored + sample];
    }
  }
  return image;
}

/// The next word of a PFM header; empty: none.
std::string_view pfm_word(std::string_view text, std::size_t& at) {
  while (at < text.size() && std::isspace(static_cast<unsigned char>(text[at]))) ++at;
  const std::size_t begin = at;
  while (at < text.size() && !std::isspace(static_cast<unsigned char>(text[at]))) ++at;
  return text.substr(begin, at - begin);
}

template <class Number>
std::optional<Number> pfm_number(std::string_view word) {
  Number value{};
  const auto read = std::from_chars(word.data(), word.data() + word.size(), value);
  if (read.ec != std::errc() || read.ptr != word.data() + word.size()) return {};
  return value;
}

NumberMap parse_pfm(std::span<const std::uint8_t> bytes, const std::string& file) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::size_t at = 2;
  const auto width = pfm_number<int>(pfm_word(text, at)), height = pfm_number<int>(pfm_word(text, at));
  const auto scale = pfm_number<double>(pfm_word(text, at));
  if (!width || !height || !scale || *scale == 0 || *width < 1 || *height < 1 || *width > GrayImage::kMaxSide ||
      *height > GrayImage::kMaxSide)
    throw Error("damaged PFM: its header has no width, height and scale", {file});
  ++at;
  NumberMap map{*width, *height, {}};
  const auto row = static_cast<std::size_t>(*width), rows = static_cast<std::size_t>(*height);
  if (bytes.size() < at + 4 * row * rows) throw Error("damaged PFM: it is cut off", {file});
  map.values.resize(row * rows);
  for (std::size_t y = 0; y < rows; ++y) {
    for (std::size_t x = 0; x < row; ++x) {
      const std::uint8_t* const b = bytes.data() + at + 4 * ((rows - 1 - y) * row + x);  // rows from the bottom
      const std::uint32_t little = b[0] | b[1] << 8 | b[2] << 16 | static_cast<std::uint32_t>(b[3]) << 24;
      const std::uint32_t big = b[3] | b[2] << 8 | b[1] << 16 | static_cast<std::uint32_t>(b[0]) << 24;
      const float value = std::bit_cast<float>(*scale < 0 ? little : big);
      map.values[y * row + x] = std::isfinite(value) ? value : kUnknownNumber;
    }
  }
  return map;
}

}  // namespace

CameraImage parse_camera_image(std::span<const std::uint8_t> bytes, const std::string& file) {
  if (bytes.size() > 3 && bytes[0] == 0xFF && bytes[1] == 0xD8) return parse_jpeg(bytes, file);
  if (bytes.size() > 3 && bytes[0] == 0x89 && bytes[1] == 'P') return parse_png_picture(bytes, file);
  throw Error("is no picture that can be read", {file}, "PNG, JPEG");
}

CameraImage read_camera_image(const std::filesystem::path& file) {
  return parse_camera_image(read_whole_file(file, kMaxPictureBytes), file.string());
}

void write_camera_image(const std::filesystem::path& file, const CameraImage& image) {
  write_whole_file(file, png_bytes(image.width, image.height, image.channels, 1, image.samples));
}

NumberMap read_number_map(const std::filesystem::path& file, double scale) {
  const std::vector<std::uint8_t> bytes = read_whole_file(file, kMaxPictureBytes);
  if (bytes.size() > 2 && bytes[0] == 'P' && bytes[1] == 'f') return parse_pfm(bytes, file.string());
  const GrayImage image = parse_gray_png(bytes, file.string());
  NumberMap map{image.width, image.height, {}};
  map.values.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const int level = image(x, y);
      map.values.push_back(level > 0 ? static_cast<float>(level * scale) : kUnknownNumber);
    }
  }
  return map;
}

void write_pfm(const std::filesystem::path& file, const NumberMap& map) {
  std::string bytes = fmt::format("Pf\n{} {}\n-1\n", map.width, map.height);
  for (int y = map.height - 1; y >= 0; --y) {
    for (int x = 0; x < map.width; ++x) {
      const auto bits = std::bit_cast<std::uint32_t>(
          map.values[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(x)]);
      for (int k = 0; k < 4; ++k) bytes += static_cast<char>(bits >> 8 * k & 0xFF);
    }
  }
  write_whole_file(file, bytes);
}

}  // namespace isobath
