#include <algorithm>
#include <cairo/cairo.h>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <isobath/report/plot/canvas.hpp>
#include <isobath/report/plot/number_picture.hpp>

namespace isobath {
namespace {

constexpr int kLeftEdge = 12, kTopEdge = 34, kScaleRoom = 130, kScaleWidth = 18, kBelow = 34;
constexpr Colour kNoNumber{0.62, 0.62, 0.62, 1};

std::uint32_t packed(const Colour& c) {
  const auto byte = [](double v) { return static_cast<std::uint32_t>(std::lround(255 * v)); };
  return 0xFF000000u | byte(c.red) << 16 | byte(c.green) << 8 | byte(c.blue);
}

std::pair<double, double> limits_of(std::span<const float> values) {
  std::vector<float> known;
  std::copy_if(values.begin(), values.end(), std::back_inserter(known), [](float v) { return std::isfinite(v); });
  if (known.empty()) return {0, 1};
  const auto at = [&](double share) {
    const auto place = known.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(known.size() - 1));
    std::nth_element(known.begin(), place, known.end());
    return static_cast<double>(*place);
  };
  const double low = at(0.01), high = at(0.99);
  return {low, high > low ? high : low + 1};
}

class NumberCanvas : public Canvas {
 public:
  NumberCanvas(int plot_width, int plot_height)
      : Canvas(kLeftEdge + plot_width + kScaleRoom, kTopEdge + plot_height + kBelow),
        plot_width_(plot_width),
        plot_height_(plot_height) {}

  /// Draws `colour(column, row)` of each picture pixel of the rectangle.
  template <class At>
  void raster(int left, int top, int width, int height, const At& colour) {
    cairo_surface_t* image = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height);
    unsigned char* data = cairo_image_surface_get_data(image);
    const int stride = cairo_image_surface_get_stride(image);
    for (int row = 0; row < height; ++row) {
      auto* pixels = reinterpret_cast<std::uint32_t*>(data + static_cast<std::ptrdiff_t>(row) * stride);
      for (int column = 0; column < width; ++column) pixels[column] = packed(colour(column, row));
    }
    cairo_surface_mark_dirty(image);
    cairo_set_source_surface(cairo_.get(), image, left, top);
    cairo_paint(cairo_.get());
    cairo_surface_destroy(image);
  }
  void labels(const NumberPictureLabels& labels, double low, double high) {
    text(kLeftEdge, 22, labels.title, 14, palette::kInk);
    const int left = kLeftEdge + plot_width_ + 16;
    const int height = plot_height_;
    raster(left, kTopEdge, kScaleWidth, height,
           [&](int, int row) { return intensity_colour(1 - (row + 0.5) / height); });
    for (const double tick : ticks(low, high, 6)) {
      const double y = kTopEdge + height * (1 - (tick - low) / (high - low));
      line(left + kScaleWidth, y, left + kScaleWidth + 5, y, {palette::kInk, 1, false});
      text(left + kScaleWidth + 9, y + 4, fmt::format("{:g}", std::abs(tick) < 1e-9 ? 0 : tick), 11, palette::kInk);
    }
    const int below = kTopEdge + height + 22;
    text(left + kScaleWidth, below, labels.unit, 11, palette::kInk, 0.3);
    raster(kLeftEdge, below - 10, 12, 12, [](int, int) { return kNoNumber; });
    text(kLeftEdge + 18, below, "no valid value", 11, palette::kInk);
  }

 private:
  int plot_width_, plot_height_;
};

}  // namespace

std::string number_picture(std::span<const float> values, int width, int height, const NumberPictureLabels& labels,
                           std::optional<std::pair<double, double>> limits) {
  const std::pair<double, double> range = limits ? *limits : limits_of(values);
  const double low = range.first, high = range.second;
  const int zoom = std::clamp(640 / width, 1, 4), skip = std::max(1, width / 640);
  const int plot_width = width * zoom / skip, plot_height = height * zoom / skip;
  NumberCanvas canvas(plot_width, plot_height);
  canvas.raster(kLeftEdge, kTopEdge, plot_width, plot_height, [&](int column, int row) {
    const auto x = static_cast<std::size_t>(column * skip / zoom), y = static_cast<std::size_t>(row * skip / zoom);
    const float value = values[y * static_cast<std::size_t>(width) + x];
    return std::isfinite(value) ? intensity_colour((value - low) / (high - low)) : kNoNumber;
  });
  canvas.labels(labels, low, high);
  return canvas.png();
}

}  // namespace isobath
