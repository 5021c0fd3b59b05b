#include <algorithm>
#include <array>
#include <cairo/cairo.h>
#include <cmath>
#include <cstdint>
#include <isobath/base/error.hpp>
#include <isobath/report/plot/chart_layout.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kRight = 40, kBottom_px = 64;  // px, around the plot
constexpr Colour kOnDark{0.88, 0.94, 1, 1};

int plot_pixels(double length_m, double longest_m, int plot_px) {
  return std::max(1, static_cast<int>(std::ceil(length_m / longest_m * plot_px - 1e-6)));
}
double longest(const PlanExtent& e) { return std::max(e.x_max - e.x_min, e.y_max - e.y_min); }

}  // namespace

ChartLayout::ChartLayout(const PlanExtent& e, int plot_px, const std::string& title, std::optional<GeoOrigin> origin,
                         int min_height_px)
    : Canvas(plot_pixels(e.y_max - e.y_min, longest(e), plot_px) + static_cast<int>(kLeft + kRight + kPanel),
             std::max(min_height_px, plot_pixels(e.x_max - e.x_min, longest(e), plot_px)) +
                 static_cast<int>(kTop + kBottom_px)),
      extent_(e),
      title_(title),
      origin_(origin),
      columns_(plot_pixels(e.y_max - e.y_min, longest(e), plot_px)),
      rows_(plot_pixels(e.x_max - e.x_min, longest(e), plot_px)),
      metres_per_px_(longest(e) / plot_px),
      panel_y_(kTop) {}

Vector2d ChartLayout::to_px(const Vector2d& p) const {
  return {kLeft + (p.y() - extent_.y_min) / metres_per_px_, kTop + (extent_.x_max - p.x()) / metres_per_px_};
}

void ChartLayout::begin_plot() const {
  cairo_save(cairo_.get());
  cairo_rectangle(cairo_.get(), kLeft, kTop, columns_, rows_);
  cairo_clip(cairo_.get());
  cairo_new_path(cairo_.get());
}
void ChartLayout::end_plot() const { cairo_restore(cairo_.get()); }

/// Whether dark ink would be hard to read there.
bool ChartLayout::is_dark(const Vector2d& at) const {
  cairo_surface_t* image = cairo_get_target(cairo_.get());
  cairo_surface_flush(image);
  const auto x = static_cast<std::ptrdiff_t>(std::clamp(at.x(), 0.0, width_ - 1.0));
  const auto y = static_cast<std::ptrdiff_t>(std::clamp(at.y(), 0.0, height_ - 1.0));
  const unsigned char* pixel = cairo_image_surface_get_data(image) + y * cairo_image_surface_get_stride(image) + 4 * x;
  return 0.0722 * pixel[0] + 0.7152 * pixel[1] + 0.2126 * pixel[2] < 90;  // blue, green, red
}

double ChartLayout::text_width(const std::string& words, double size) const {
  cairo_text_extents_t extents;
  cairo_set_font_size(cairo_.get(), size);
  cairo_text_extents(cairo_.get(), words.c_str(), &extents);
  return extents.x_advance;
}

bool ChartLayout::take_room(const Box& box) {
  if (box.x - box.half_width < kLeft || box.x + box.half_width > kLeft + columns_ || box.y - box.half_height < kTop ||
      box.y + box.half_height > kTop + rows_) {
    return false;
  }
  for (const Box& b : taken_) {
    if (std::abs(b.x - box.x) < b.half_width + box.half_width &&
        std::abs(b.y - box.y) < b.half_height + box.half_height)
      return false;
  }
  taken_.push_back(box);
  return true;
}

void ChartLayout::raster(const std::vector<Colour>& colours) {
  ISOBATH_ASSERT(colours.size() == static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  cairo_surface_t* image = cairo_image_surface_create(CAIRO_FORMAT_RGB24, columns_, rows_);
  unsigned char* data = cairo_image_surface_get_data(image);
  const int stride = cairo_image_surface_get_stride(image);
  const auto byte = [](double v) { return static_cast<std::uint32_t>(std::lround(std::clamp(v, 0.0, 1.0) * 255)); };
  for (int row = 0; row < rows_; ++row) {
    auto* pixels = reinterpret_cast<std::uint32_t*>(data + static_cast<std::ptrdiff_t>(row) * stride);
    const Colour* from = colours.data() + static_cast<std::ptrdiff_t>(row) * columns_;
    for (int c = 0; c < columns_; ++c)
      pixels[c] = byte(from[c].red) << 16 | byte(from[c].green) << 8 | byte(from[c].blue);
  }
  cairo_surface_mark_dirty(image);
  cairo_set_source_surface(cairo_.get(), image, kLeft, kTop);
  cairo_paint(cairo_.get());
  cairo_surface_destroy(image);
}

void ChartLayout::polyline(std::span<const Vector2d> points, bool closed, const Stroke& stroke) {
  begin_plot();
  for (const Vector2d& p : points) {
    const Vector2d at = to_px(p);
    cairo_line_to(cairo_.get(), at.x(), at.y());
  }
  if (closed) cairo_close_path(cairo_.get());
  set(stroke);
  cairo_stroke(cairo_.get());
  end_plot();
}

void ChartLayout::contour(std::span<const Vector2d> points, bool closed, const Stroke& stroke, const std::string& label,
                          const std::function<bool(const Vector2d&)>& approximate) {
  std::vector<Vector2d> px;
  std::vector<double> at = {0};
  std::vector<std::pair<bool, bool>> look;  // dashed, on dark water
  for (std::size_t i = 0; i < points.size() + (closed ? 1 : 0); ++i) {
    px.push_back(to_px(points[i % points.size()]));
    look.emplace_back(approximate && approximate(points[i % points.size()]), is_dark(px.back()));
    if (i > 0) at.push_back(at.back() + (px[i] - px[i - 1]).norm());
  }
  // 1. Place the labels on straight stretches, far enough apart, where there is no other text.
  const double width = text_width(label, kSmallPx) + 8;
  constexpr double kApart = 420, kMinLine = 110, kStraight = 0.985;
  std::vector<std::pair<std::size_t, std::size_t>> gaps;
  double last = -kApart * 0.6;
  for (std::size_t i = 0, j = 0; at.back() >= kMinLine && i < px.size(); ++i) {
    while (j + 1 < px.size() && at[j] - at[i] < width) ++j;
    if (at[j] - at[i] < width) break;
    if (at[i] - last < kApart * (gaps.empty() ? 0.7 : 1)) continue;
    const Vector2d chord = px[j] - px[i], middle = (px[i] + px[j]) / 2;
    if (chord.norm() < kStraight * (at[j] - at[i])) continue;
    const double c = std::abs(chord.x()) / chord.norm(), s = std::abs(chord.y()) / chord.norm();
    if (!take_room({middle.x(), middle.y(), c * width / 2 + s * 8, s * width / 2 + c * 8})) continue;
    double angle = std::atan2(chord.y(), chord.x());
    if (std::abs(angle) > std::numbers::pi / 2) angle -= std::copysign(std::numbers::pi, angle);
    text_at_angle(middle, angle, label, kSmallPx, {stroke.colour.red, stroke.colour.green, stroke.colour.blue, 1});
    gaps.emplace_back(i, j);
    last = at[j];
  }
  // 2. Draw the line in solid and dashed runs, without the gaps.
  begin_plot();
  std::size_t gap = 0;
  for (std::size_t i = 1; i < px.size(); ++i) {
    while (gap < gaps.size() && gaps[gap].second < i) ++gap;
    if (gap < gaps.size() && i > gaps[gap].first) continue;
    cairo_new_path(cairo_.get());
    const auto [dashed, dark] = look[i];
    cairo_move_to(cairo_.get(), px[i - 1].x(), px[i - 1].y());
    for (; i < px.size() && look[i] == std::pair(dashed, dark) && (gap == gaps.size() || i <= gaps[gap].first); ++i) {
      cairo_line_to(cairo_.get(), px[i].x(), px[i].y());
    }
    --i;
    set({dark ? kOnDark : stroke.colour, stroke.width_px, dashed});
    cairo_stroke(cairo_.get());
  }
  end_plot();
}

void ChartLayout::text_at_angle(const Vector2d& centre, double angle, const std::string& words, double size,
                                Colour colour) const {
  const bool dark = is_dark(centre);
  begin_plot();
  cairo_translate(cairo_.get(), centre.x(), centre.y());
  cairo_rotate(cairo_.get(), angle);
  text(0, 0.36 * size, words, size, dark ? kOnDark : colour, 0.5, !dark);
  end_plot();
}

bool ChartLayout::sounding(const Vector2d& at, double depth_m) {
  const double magnitude = std::abs(depth_m);
  // Round to the shoaler value: less deep, or drying higher.
  const double tenths = depth_m >= 0 ? std::floor(10 * magnitude + 1e-6) : std::ceil(10 * magnitude - 1e-6);
  const auto whole = static_cast<int>(std::floor(tenths / 10));
  const int tenth = static_cast<int>(tenths) - 10 * whole;
  const std::string metres = std::to_string(whole), decimetres = whole < 31 ? std::to_string(tenth) : std::string();
  const double w = text_width(metres, kTextPx), v = text_width(decimetres, 11);
  const Vector2d p = to_px(at);
  if (!take_room({p.x(), p.y(), (w + v) / 2 + 5, 12})) return false;
  const bool dark = is_dark(p);
  const Colour ink = dark ? palette::kPaper : Colour{0.08, 0.10, 0.16, 1};
  const double x = p.x() - (w + v) / 2, y = p.y() + 5;
  begin_plot();
  text(x, y, metres, kTextPx, ink, 0, !dark);
  text(x + w + 1, y + 4, decimetres, 11, ink, 0, !dark);
  if (depth_m < 0) line(x, y + 2, x + w, y + 2, {ink, 1.2, false});  // a drying height is underlined
  end_plot();
  return true;
}

void ChartLayout::danger_symbol(const Vector2d& p) const {
  cairo_t* c = cairo_.get();
  cairo_new_path(c);
  cairo_arc(c, p.x(), p.y(), 9, 0, 2 * std::numbers::pi);
  fill({0.75, 0.88, 0.98, 0.9});
  set({palette::kInk, 2, false});
  const std::array<double, 2> dots{0.1, 3.67};
  cairo_set_dash(c, dots.data(), 2, 0);
  cairo_set_line_cap(c, CAIRO_LINE_CAP_ROUND);
  cairo_stroke(c);
  cairo_set_line_cap(c, CAIRO_LINE_CAP_BUTT);
  line(p.x() - 4, p.y(), p.x() + 4, p.y(), {palette::kInk, 1.6, false});
  line(p.x(), p.y() - 4, p.x(), p.y() + 4, {palette::kInk, 1.6, false});
}

void ChartLayout::danger(const Vector2d& at, const std::string& label) {
  const Vector2d p = to_px(at);
  begin_plot();
  danger_symbol(p);
  const double w = text_width(label, kSmallPx);
  const bool left = p.x() + 14 + w > kLeft + columns_;
  text(left ? p.x() - 13 : p.x() + 13, p.y() + 5, label, kSmallPx, palette::kInk, left ? 1 : 0, true);
  end_plot();
  taken_.push_back({p.x() + (left ? -1 : 1) * w / 2, p.y(), w / 2 + 14, 13});
}

}  // namespace isobath
