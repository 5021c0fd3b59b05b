#include <algorithm>
#include <cairo/cairo.h>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <isobath/report/plot/picture.hpp>
#include <numbers>

namespace isobath {
namespace {

constexpr double kLeft = 58, kTop = 34, kRight = 246, kBottom = 46;  // margins of a plan view, px; right: the legend
constexpr int kMinLegendHeight = 190;

std::uint32_t argb(const Colour& c) {
  const auto byte = [](double v) { return static_cast<std::uint32_t>(std::lround(std::clamp(v, 0.0, 1.0) * 255)); };
  return byte(c.alpha) << 24 | byte(c.red * c.alpha) << 16 | byte(c.green * c.alpha) << 8 | byte(c.blue * c.alpha);
}

std::string tick_text(double value) { return fmt::format("{:.6g}", std::abs(value) < 1e-12 ? 0.0 : value); }

int plan_width(const PlanExtent& e, int plot_px) {
  const double scale = plot_px / std::max(e.x_max - e.x_min, e.y_max - e.y_min);
  return static_cast<int>(std::ceil((e.y_max - e.y_min) * scale + kLeft + kRight));
}

int plan_height(const PlanExtent& e, int plot_px) {
  const double scale = plot_px / std::max(e.x_max - e.x_min, e.y_max - e.y_min);
  return std::max(kMinLegendHeight, static_cast<int>(std::ceil((e.x_max - e.x_min) * scale + kTop + kBottom)));
}

}  // namespace

PlanExtent frame_around(const Eigen::AlignedBox2d& content) {
  constexpr double kMarginShare = 0.04, kNarrowest = 0.15;
  const double longer = std::max(content.sizes().maxCoeff(), 1.0);
  const Eigen::Vector2d half =
      (0.5 * content.sizes()).cwiseMax(0.5 * kNarrowest * longer).array() + kMarginShare * longer;
  const Eigen::Vector2d middle = content.center();
  return {middle.x() - half.x(), middle.x() + half.x(), middle.y() - half.y(), middle.y() + half.y()};
}

PlanPicture::PlanPicture(const PlanExtent& extent, int plot_px, Labels labels)
    : Canvas(plan_width(extent, plot_px), plan_height(extent, plot_px)),
      extent_(extent),
      labels_(std::move(labels)),
      scale_(plot_px / std::max(extent.x_max - extent.x_min, extent.y_max - extent.y_min)),
      left_(kLeft),
      top_(kTop),
      plot_width_((extent.y_max - extent.y_min) * scale_),
      plot_height_((extent.x_max - extent.x_min) * scale_) {}

Eigen::Vector2d PlanPicture::to_px(const Eigen::Vector2d& p) const {
  return {left_ + (p.y() - extent_.y_min) * scale_, top_ + (extent_.x_max - p.x()) * scale_};
}

void PlanPicture::clip_to_plot() const {
  cairo_save(cairo_.get());
  cairo_rectangle(cairo_.get(), left_, top_, plot_width_, plot_height_);
  cairo_clip(cairo_.get());
}
void PlanPicture::unclip() const { cairo_restore(cairo_.get()); }

void PlanPicture::raster(const std::function<Colour(double, double)>& colour) {
  const int width = static_cast<int>(plot_width_), height = static_cast<int>(plot_height_);
  cairo_surface_t* image = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height);
  unsigned char* data = cairo_image_surface_get_data(image);
  const int stride = cairo_image_surface_get_stride(image);
  for (int row = 0; row < height; ++row) {
    auto* pixels = reinterpret_cast<std::uint32_t*>(data + static_cast<std::ptrdiff_t>(row) * stride);
    for (int column = 0; column < width; ++column) {
      pixels[column] = argb(colour(extent_.x_max - (row + 0.5) / scale_, extent_.y_min + (column + 0.5) / scale_));
    }
  }
  cairo_surface_mark_dirty(image);
  cairo_set_source_surface(cairo_.get(), image, left_, top_);
  cairo_paint(cairo_.get());
  cairo_surface_destroy(image);
}

void PlanPicture::trace(std::span<const Eigen::Vector2d> points) const {
  for (const auto& p : points) {
    const Eigen::Vector2d at = to_px(p);
    cairo_line_to(cairo_.get(), at.x(), at.y());
  }
}

void PlanPicture::polygon(std::span<const Eigen::Vector2d> points, const Stroke& stroke, Colour filling) {
  clip_to_plot();
  cairo_new_path(cairo_.get());
  trace(points);
  cairo_close_path(cairo_.get());
  if (filling.alpha > 0) fill(filling);
  set(stroke);
  cairo_stroke(cairo_.get());
  unclip();
}

void PlanPicture::polyline(std::span<const Eigen::Vector2d> points, const Stroke& stroke) {
  clip_to_plot();
  cairo_new_path(cairo_.get());
  trace(points);
  set(stroke);
  cairo_stroke(cairo_.get());
  unclip();
}

void PlanPicture::label(const Eigen::Vector2d& at, const std::string& words, Colour colour) {
  const Eigen::Vector2d p = to_px(at);
  clip_to_plot();
  text(p.x() + 5, p.y() - 5, words, 11, colour, 0, true);
  unclip();
}

void PlanPicture::dot(const Eigen::Vector2d& at, double radius_px, Colour colour) {
  const Eigen::Vector2d p = to_px(at);
  clip_to_plot();
  cairo_new_path(cairo_.get());
  cairo_arc(cairo_.get(), p.x(), p.y(), radius_px, 0, 2 * std::numbers::pi);
  fill(colour);
  cairo_new_path(cairo_.get());
  unclip();
}

void PlanPicture::vehicle(const Eigen::Vector2d& at, double heading_rad) {
  const Eigen::Vector2d p = to_px(at);
  cairo_save(cairo_.get());
  cairo_translate(cairo_.get(), p.x(), p.y());
  cairo_rotate(cairo_.get(), heading_rad);
  cairo_new_path(cairo_.get());
  for (const auto& [x, y] : {std::pair(0.0, -11.0), {6.0, 7.0}, {0.0, 4.0}, {-6.0, 7.0}})
    cairo_line_to(cairo_.get(), x, y);
  cairo_close_path(cairo_.get());
  fill(palette::kVehicle);
  set({{1, 1, 1, 1}, 1, false});
  cairo_stroke(cairo_.get());
  cairo_restore(cairo_.get());
}

void PlanPicture::range_rings(const Eigen::Vector2d& centre, double step_m) {
  const Eigen::Vector2d p = to_px(centre);
  const double reach = std::max({extent_.x_max, -extent_.x_min, extent_.y_max, -extent_.y_min}) * 1.5;
  clip_to_plot();
  for (double r = step_m; r < reach; r += step_m) {
    cairo_new_path(cairo_.get());
    cairo_arc(cairo_.get(), p.x(), p.y(), r * scale_, 0, 2 * std::numbers::pi);
    set({palette::kFaint, 0.7, true});
    cairo_stroke(cairo_.get());
    text(p.x() + 3, p.y() - r * scale_ - 3, tick_text(r) + " m", 10, palette::kInk, 0, true);
  }
  unclip();
}

void PlanPicture::finish(const std::vector<LegendEntry>& legend) {
  cairo_new_path(cairo_.get());
  cairo_rectangle(cairo_.get(), left_, top_, plot_width_, plot_height_);
  set({palette::kInk, 1, false});
  cairo_stroke(cairo_.get());
  const double bottom = top_ + plot_height_;
  for (const double v : ticks(extent_.y_min, extent_.y_max, 6)) {
    const double x = to_px({0, v}).x();
    line(x, bottom, x, bottom + 5, {});
    text(x, bottom + 17, tick_text(v), 10, palette::kInk, 0.5);
  }
  for (const double v : ticks(extent_.x_min, extent_.x_max, 6)) {
    const double y = to_px({v, 0}).y();
    line(left_ - 5, y, left_, y, {});
    text(left_ - 8, y + 4, tick_text(v), 10, palette::kInk, 1);
  }
  text(left_, top_ - 12, labels_.title, 14, palette::kInk);
  text(left_ + plot_width_ / 2, bottom + 34, labels_.right, 11, palette::kInk, 0.5);
  cairo_save(cairo_.get());
  cairo_translate(cairo_.get(), 14, top_ + plot_height_ / 2);
  cairo_rotate(cairo_.get(), -std::numbers::pi / 2);
  text(0, 0, labels_.up, 11, palette::kInk, 0.5);
  cairo_restore(cairo_.get());
  const double x = left_ + plot_width_ + 16;
  double y = top_ + 4;
  for (const LegendEntry& entry : legend) {
    cairo_new_path(cairo_.get());
    cairo_rectangle(cairo_.get(), x, y, 14, 11);
    fill(entry.colour);
    set({palette::kFaint, 0.7, false});
    cairo_stroke(cairo_.get());
    text(x + 20, y + 10, entry.text, 11, palette::kInk);
    y += 19;
  }
}

ChartPicture::ChartPicture(int width_px, int height_px, std::string title, Axis x, Axis y)
    : Canvas(width_px, height_px),
      title_(std::move(title)),
      x_(std::move(x)),
      y_(std::move(y)),
      plot_width_(width_px - left_ - 20),
      plot_height_(height_px - top_ - 50) {}

namespace {
double share_of(const ChartPicture::Axis& axis, double v) {
  if (axis.logarithmic) {
    return (std::log10(std::max(v, 1e-300)) - std::log10(axis.low)) / (std::log10(axis.high) - std::log10(axis.low));
  }
  return (v - axis.low) / (axis.high - axis.low);
}
}  // namespace

double ChartPicture::px_x(double x) const { return left_ + std::clamp(share_of(x_, x), -0.02, 1.02) * plot_width_; }
double ChartPicture::px_y(double y) const {
  return top_ + (1 - std::clamp(share_of(y_, y), -0.02, 1.02)) * plot_height_;
}

void ChartPicture::curve(std::span<const double> x, std::span<const double> y, const Stroke& stroke,
                         const std::string& name) {
  cairo_new_path(cairo_.get());
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
    if (std::isfinite(x[i]) && std::isfinite(y[i])) {
      cairo_line_to(cairo_.get(), px_x(x[i]), px_y(y[i]));
    } else {
      cairo_new_sub_path(cairo_.get());
    }
  }
  set(stroke);
  cairo_stroke(cairo_.get());
  name_line(x, y, stroke.colour, name);
}

void ChartPicture::name_line(std::span<const double> x, std::span<const double> y, Colour colour,
                             const std::string& name) {
  for (std::size_t i = std::min(x.size(), y.size()); i-- > 0 && !name.empty();) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) continue;
    names_.push_back({colour, name, px_x(x[i]), px_y(y[i])});
    return;
  }
}

/// Each name above the end of its line, inside the plot, with a sample of the line; names that would lie on one another
/// move apart.
void ChartPicture::draw_names() {
  constexpr double kApart = 15, kSample = 16;
  std::stable_sort(names_.begin(), names_.end(), [](const Name& a, const Name& b) { return a.y < b.y; });
  const double lowest = top_ + plot_height_ - 5;
  double y = top_ + 26 - kApart;  // below the labels of marks
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const double left_over = kApart * static_cast<double>(names_.size() - 1 - i);
    y = std::max(y + kApart, std::min(names_[i].y - 6, lowest - left_over));
    cairo_text_extents_t extents;
    cairo_set_font_size(cairo_.get(), 11);
    cairo_text_extents(cairo_.get(), names_[i].text.c_str(), &extents);
    const double right = std::min(names_[i].x + extents.x_advance + kSample + 14, left_ + plot_width_ - 6);
    text(right - kSample - 6, y, names_[i].text, 11, palette::kInk, 1, true);
    line(right - kSample, y - 4, right, y - 4, {names_[i].colour, 3, false});
  }
}

void ChartPicture::band(std::span<const double> x, std::span<const double> low, std::span<const double> high,
                        Colour colour) {
  const std::size_t n = std::min({x.size(), low.size(), high.size()});
  cairo_new_path(cairo_.get());
  for (std::size_t i = 0; i < n; ++i) cairo_line_to(cairo_.get(), px_x(x[i]), px_y(low[i]));
  for (std::size_t i = n; i-- > 0;) cairo_line_to(cairo_.get(), px_x(x[i]), px_y(high[i]));
  cairo_close_path(cairo_.get());
  fill(colour);
  cairo_new_path(cairo_.get());
}

void ChartPicture::points(std::span<const double> x, std::span<const double> y, Colour colour,
                          const std::string& name) {
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
    cairo_new_path(cairo_.get());
    cairo_arc(cairo_.get(), px_x(x[i]), px_y(y[i]), 3, 0, 2 * std::numbers::pi);
    fill(colour);
  }
  cairo_new_path(cairo_.get());
  name_line(x, y, colour, name);
}

void ChartPicture::mark(double x, const std::string& label, Colour colour) {
  constexpr double kLabelWidth = 20, kLabelHeight = 12;
  constexpr int kLabelRows = 6;
  mark_row_ = px_x(x) - last_mark_ < kLabelWidth ? (mark_row_ + 1) % kLabelRows
                                                 : 0;  // labels of near marks stand below one another
  last_mark_ = px_x(x);
  line(px_x(x), top_, px_x(x), top_ + plot_height_, {colour, 1, true});
  text(px_x(x), top_ + 12 + kLabelHeight * mark_row_, label, 11, colour, 0.5, true);
}

void ChartPicture::draw_ticks(const Axis& axis, bool horizontal) const {
  std::vector<double> values;
  if (axis.logarithmic) {
    for (double e = std::ceil(std::log10(axis.low) - 1e-9); e <= std::log10(axis.high) + 1e-9; ++e) {
      values.push_back(std::pow(10, e));
    }
  } else {
    values = ticks(std::min(axis.low, axis.high), std::max(axis.low, axis.high), 6);
  }
  const double bottom = top_ + plot_height_;
  for (const double v : values) {
    if (horizontal) {
      line(px_x(v), top_, px_x(v), bottom + 4, {palette::kFaint, 0.5, false});
      text(px_x(v), bottom + 16, tick_text(v), 10, palette::kInk, 0.5);
    } else {
      line(left_ - 4, px_y(v), left_ + plot_width_, px_y(v), {palette::kFaint, 0.5, false});
      text(left_ - 8, px_y(v) + 4, tick_text(v), 10, palette::kInk, 1);
    }
  }
}

void ChartPicture::finish() {
  draw_ticks(x_, true);
  draw_ticks(y_, false);
  cairo_new_path(cairo_.get());
  cairo_rectangle(cairo_.get(), left_, top_, plot_width_, plot_height_);
  set({palette::kInk, 1, false});
  cairo_stroke(cairo_.get());
  text(left_, top_ - 12, title_, 14, palette::kInk);
  text(left_ + plot_width_ / 2, top_ + plot_height_ + 34, x_.label, 11, palette::kInk, 0.5);
  cairo_save(cairo_.get());
  cairo_translate(cairo_.get(), 14, top_ + plot_height_ / 2);
  cairo_rotate(cairo_.get(), -std::numbers::pi / 2);
  text(0, 0, y_.label, 11, palette::kInk, 0.5);
  cairo_restore(cairo_.get());
  draw_names();
}

}  // namespace isobath
