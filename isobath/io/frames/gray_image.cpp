#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/io/bytes/whole_file.hpp>
#include <isobath/io/frames/gray_image.hpp>
#include <memory>
#include <png.h>

namespace isobath {
namespace {

constexpr std::uint64_t kMaxFileBytes = 1u << 30;
constexpr std::uint64_t kMaxInflation = 1032;  // deflate's maximum ratio; bounds the image size by the file size

// libpng reports errors by longjmp. These structs hold everything that must survive a jump, outside the functions that
// call setjmp.
struct Reading {
  std::span<const std::uint8_t> left;
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::string problem;
  std::vector<std::uint8_t> rows;  // as libpng delivers them
  std::vector<png_bytep> row_at;
  std::size_t row_bytes = 0;
  int channels = 0;

  ~Reading() { png_destroy_read_struct(&png, &info, nullptr); }
};

struct Writing {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::string problem;
  std::vector<std::uint8_t> bytes;

  ~Writing() { png_destroy_write_struct(&png, &info); }
};

template <class Work>
void keep_problem(png_structp png, png_const_charp message) {
  static_cast<Work*>(png_get_error_ptr(png))->problem = message;
  png_longjmp(png, 1);
}
void ignore_warning(png_structp, png_const_charp) {}

void feed(png_structp png, png_bytep out, std::size_t count) {
  auto& left = static_cast<Reading*>(png_get_io_ptr(png))->left;
  if (count > left.size()) png_error(png, "the file is cut off");
  std::memcpy(out, left.data(), count);
  left = left.subspan(count);
}

void take(png_structp png, png_bytep data, std::size_t count) {
  auto& bytes = static_cast<Writing*>(png_get_io_ptr(png))->bytes;
  bytes.insert(bytes.end(), data, data + count);
}
void flush_nothing(png_structp) {}

void read_header(Reading& r, std::size_t file_bytes) {
  png_set_user_limits(r.png, GrayImage::kMaxSide, GrayImage::kMaxSide);
  png_set_chunk_malloc_max(r.png, 8u << 20);
  png_set_read_fn(r.png, &r, feed);
  png_read_info(r.png, r.info);
  png_set_expand(r.png);  // palettes to colour, few bits to 8, transparent colour to alpha
  png_set_swap(r.png);    // PNG is big-endian
  png_set_interlace_handling(r.png);
  png_read_update_info(r.png, r.info);
  r.row_bytes = png_get_rowbytes(r.png, r.info);
  r.channels = png_get_channels(r.png, r.info);
  const std::uint64_t total = std::uint64_t(r.row_bytes) * png_get_image_height(r.png, r.info);
  // expanding a 1-bit palette to 8-bit colour with alpha turns one byte into 32
  if (total / 32 / kMaxInflation > file_bytes)
    png_error(r.png, "the stated image size is impossible for so short a file");
}

bool read_rows(Reading& r, std::size_t file_bytes) {
  if (setjmp(png_jmpbuf(r.png))) return false;
  read_header(r, file_bytes);
  const std::size_t height = png_get_image_height(r.png, r.info);
  r.rows.resize(r.row_bytes * height);
  r.row_at.resize(height);
  for (std::size_t y = 0; y < height; ++y) r.row_at[y] = r.rows.data() + y * r.row_bytes;
  png_read_image(r.png, r.row_at.data());
  png_read_end(r.png, nullptr);
  return true;
}

struct RowsToWrite {
  int width, height, channels, sample_bytes;
  const std::uint8_t* samples;
};

bool write_rows(Writing& w, const RowsToWrite& image) {
  if (setjmp(png_jmpbuf(w.png))) return false;
  png_set_write_fn(w.png, &w, take, flush_nothing);
  png_set_IHDR(w.png, w.info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height),
               8 * image.sample_bytes, image.channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(w.png, w.info);
  if (image.sample_bytes == 2) png_set_swap(w.png);
  const std::size_t row_bytes = static_cast<std::size_t>(image.width) * image.channels * image.sample_bytes;
  for (int y = 0; y < image.height; ++y) png_write_row(w.png, image.samples + y * row_bytes);
  png_write_end(w.png, nullptr);
  return true;
}

}  // namespace

PngRows parse_png(std::span<const std::uint8_t> bytes, const std::string& file) {
  if (bytes.size() < 8 || png_sig_cmp(bytes.data(), 0, 8) != 0)
    throw Error("not a PNG picture", {file, {}, {}, {}, {}});
  Reading r;
  r.left = bytes;
  r.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &r, keep_problem<Reading>, ignore_warning);
  r.info = r.png ? png_create_info_struct(r.png) : nullptr;
  ISOBATH_ASSERT(r.info);
  if (!read_rows(r, bytes.size())) {
    throw Error("damaged PNG: " + r.problem, {file, bytes.size() - r.left.size(), {}, {}, {}});
  }
  return {static_cast<int>(png_get_image_width(r.png, r.info)), static_cast<int>(png_get_image_height(r.png, r.info)),
          r.channels, png_get_bit_depth(r.png, r.info) / 8, std::move(r.rows)};
}

GrayImage parse_gray_png(std::span<const std::uint8_t> bytes, const std::string& file) {
  PngRows rows = parse_png(bytes, file);
  GrayImage image;
  image.width = rows.width;
  image.height = rows.height;
  image.sample_bytes = rows.sample_bytes;
  const std::size_t pixel = static_cast<std::size_t>(rows.channels) * image.sample_bytes;
  if (rows.channels == 1) {
    image.samples = std::move(rows.samples);
    return image;
  }
  image.samples.reserve(rows.samples.size() / rows.channels);
  for (std::size_t at = 0; at < rows.samples.size(); at += pixel) {
    image.samples.insert(image.samples.end(), rows.samples.begin() + at,
                         rows.samples.begin() + at + image.sample_bytes);
  }
  return image;
}

GrayImage read_gray_png(const std::filesystem::path& file) {
  return parse_gray_png(read_whole_file(file, kMaxFileBytes), file.string());
}

std::vector<std::uint8_t> png_bytes(int width, int height, int channels, int sample_bytes,
                                    std::span<const std::uint8_t> samples) {
  ISOBATH_ASSERT(width > 0 && height > 0 && (sample_bytes == 1 || sample_bytes == 2) &&
                 (channels == 1 || channels == 3));
  ISOBATH_ASSERT(samples.size() == static_cast<std::size_t>(width) * height * channels * sample_bytes);
  Writing w;
  w.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &w, keep_problem<Writing>, ignore_warning);
  w.info = w.png ? png_create_info_struct(w.png) : nullptr;
  ISOBATH_ASSERT(w.info);
  if (!write_rows(w, {width, height, channels, sample_bytes, samples.data()}))
    throw Error("cannot be written as PNG: " + w.problem);
  return std::move(w.bytes);
}

std::vector<std::uint8_t> gray_png_bytes(const GrayImage& image) {
  return png_bytes(image.width, image.height, 1, image.sample_bytes, image.samples);
}

void write_gray_png(const std::filesystem::path& file, const GrayImage& image) {
  write_whole_file(file, gray_png_bytes(image));
}

}  // namespace isobath
