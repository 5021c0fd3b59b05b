#include <algorithm>
#include <array>
#include <cairo/cairo.h>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/report/plot/canvas.hpp>
#include <numbers>

namespace isobath {
namespace {

Colour mix(const Colour& a, const Colour& b, double share) {
  const auto between = [share](double u, double v) { return u + share * (v - u); };
  return {between(a.red, b.red), between(a.green, b.green), between(a.blue, b.blue), between(a.alpha, b.alpha)};
}

}  // namespace

Colour intensity_colour(double share) {
  static constexpr std::array<Colour, 6> kStops{Colour{0.00, 0.07, 0.18}, Colour{0.16, 0.24, 0.40},
                                                Colour{0.36, 0.38, 0.44}, Colour{0.56, 0.54, 0.46},
                                                Colour{0.79, 0.72, 0.38}, Colour{1.00, 0.93, 0.45}};
  const double at = std::clamp(share, 0.0, 1.0) * (kStops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), kStops.size() - 2);
  return mix(kStops[i], kStops[i + 1], at - static_cast<double>(i));
}

Colour occupancy_colour(double probability, double prior) {
  static constexpr Colour kUnknown{0.80, 0.80, 0.80}, kFree{0.90, 0.95, 1.0}, kOccupied{0.60, 0.18, 0.0},
      kLikely{0.95, 0.65, 0.25};
  const double odds = std::log(probability / (1 - probability)) - std::log(prior / (1 - prior));
  if (odds <= -std::numbers::ln2) return mix(kUnknown, kFree, std::min(1.0, -odds / 2));
  if (odds <= 0.2) return kUnknown;
  return probability < 0.5 ? mix(kUnknown, kLikely, std::min(1.0, odds / -std::log(prior / (1 - prior))))
                           : mix(kLikely, kOccupied, (probability - 0.5) * 2);
}

std::vector<double> ticks(double low, double high, int wanted) {
  std::vector<double> values;
  if (!(high > low) || wanted < 1) return values;
  const double raw = (high - low) / wanted;
  const double decade = std::pow(10.0, std::floor(std::log10(raw)));
  const double ratio = raw / decade;
  const double step = decade * (ratio < 1.5 ? 1 : ratio < 3.5 ? 2 : ratio < 7.5 ? 5 : 10);
  for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) values.push_back(i * step);
  return values;
}

void Canvas::Closer::operator()(cairo_t* context) const { cairo_destroy(context); }

Canvas::Canvas(int width_px, int height_px) : width_(width_px), height_(height_px) {
  cairo_surface_t* surface = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width_px, height_px);
  cairo_.reset(cairo_create(surface));
  cairo_surface_destroy(surface);  // the context holds it
  cairo_select_font_face(cairo_.get(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_source_rgb(cairo_.get(), 1, 1, 1);
  cairo_paint(cairo_.get());
}

std::string Canvas::png() const {
  std::string bytes;
  const auto append = [](void* to, const unsigned char* data, unsigned length) {
    static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
  };
  const cairo_status_t status = cairo_surface_write_to_png_stream(cairo_get_target(cairo_.get()), append, &bytes);
  if (status != CAIRO_STATUS_SUCCESS) throw Error(std::string("cannot draw: ") + cairo_status_to_string(status));
  return bytes;
}

void Canvas::save(const std::filesystem::path& file) const { write_whole_file(file, png()); }

void Canvas::set(const Stroke& stroke) const {
  const Colour& c = stroke.colour;
  cairo_set_source_rgba(cairo_.get(), c.red, c.green, c.blue, c.alpha);
  cairo_set_line_width(cairo_.get(), stroke.width_px);
  const std::array<double, 2> dash{5, 4};
  cairo_set_dash(cairo_.get(), dash.data(), stroke.dashed ? 2 : 0, 0);
}

void Canvas::fill(Colour c) const {
  cairo_set_source_rgba(cairo_.get(), c.red, c.green, c.blue, c.alpha);
  cairo_fill_preserve(cairo_.get());
}

void Canvas::line(double x0, double y0, double x1, double y1, const Stroke& stroke) const {
  set(stroke);
  cairo_move_to(cairo_.get(), x0, y0);
  cairo_line_to(cairo_.get(), x1, y1);
  cairo_stroke(cairo_.get());
}

void Canvas::text(double x, double y, const std::string& text, double size, Colour colour, double align,
                  bool halo) const {
  cairo_t* c = cairo_.get();
  cairo_set_font_size(c, size);
  cairo_text_extents_t extents;
  cairo_text_extents(c, text.c_str(), &extents);
  cairo_move_to(c, x - align * extents.width, y);
  if (halo) {
    cairo_text_path(c, text.c_str());
    set({{1, 1, 1, 0.85}, 3, false});
    cairo_stroke_preserve(c);
    cairo_set_source_rgba(c, colour.red, colour.green, colour.blue, colour.alpha);
    cairo_fill(c);
    return;
  }
  cairo_set_source_rgba(c, colour.red, colour.green, colour.blue, colour.alpha);
  cairo_show_text(c, text.c_str());
}

}  // namespace isobath

#if defined(__SANITIZE_ADDRESS__)
// Cairo finds its fonts through Fontconfig, which keeps some of its allocations until the process ends.
extern "C" const char* __lsan_default_suppressions() { return "leak:libfontconfig\n"; }  // NOLINT
extern "C" const char* __lsan_default_options() { return "print_suppressions=0"; }       // NOLINT
#endif
