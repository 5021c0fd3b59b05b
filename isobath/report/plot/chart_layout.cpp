#include <algorithm>
#include <cairo/cairo.h>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/geometry/contours.hpp>
#include <isobath/report/plot/chart_layout.hpp>
#include <numbers>
#include <sstream>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kLeft = 96, kTop = 84, kRight = 40, kBottom_px = 64, kBand = 9;  // px, around the plot
constexpr double kPanel = 300, kText = 15, kSmall = 13;
constexpr Colour kWhite{1, 1, 1, 1}, kOnDark{0.88, 0.94, 1, 1};
constexpr Colour kMagenta{0.65, 0.10, 0.45, 1};  // colour of warnings on charts

int plot_pixels(double length_m, double longest_m, int plot_px) {
  return std::max(1, static_cast<int>(std::ceil(length_m / longest_m * plot_px - 1e-6)));
}
double longest(const PlanExtent& e) { return std::max(e.x_max - e.x_min, e.y_max - e.y_min); }

/// Ticks of a graduated side: steps of 1, 2, 5 within a minute (2 dm at the least), then of whole minutes and degrees.
double minute_step(double range_min, double wanted) {
  for (const double step : {0.0001, 0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05,  0.1,
                            0.2,    0.5,    1.0,    2.0,   5.0,   10.0,  30.0, 60.0, 120.0, 300.0}) {
    if (range_min / step <= wanted) return step;
  }
  return 600;
}

/// 52 deg 20.25' N from minutes.
std::string degrees_and_minutes(double minutes, double step, const char* positive, const char* negative) {
  const int digits = step >= 1 ? 0 : step >= 0.1 ? 1 : step >= 0.01 ? 2 : step >= 0.001 ? 3 : 4;
  const double scale = std::pow(10, digits);
  const auto units = std::llround(std::abs(minutes) * scale);
  const auto per_degree = static_cast<long long>(60 * scale);
  return fmt::format("{}°{:0{}.{}f}'{}", units / per_degree, static_cast<double>(units % per_degree) / scale,
                     digits > 0 ? digits + 3 : 2, digits, minutes < 0 ? negative : positive);
}

std::string plain(double value) { return fmt::format("{:.6g}", std::abs(value) < 1e-9 ? 0.0 : value); }

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

void ChartLayout::trace(std::span<const Vector2d> points_px) const {
  for (const Vector2d& p : points_px) cairo_line_to(cairo_.get(), p.x(), p.y());
}

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
  const double width = text_width(label, kSmall) + 8;
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
    text_at_angle(middle, angle, label, kSmall, {stroke.colour.red, stroke.colour.green, stroke.colour.blue, 1});
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
  const double w = text_width(metres, kText), v = text_width(decimetres, 11);
  const Vector2d p = to_px(at);
  if (!take_room({p.x(), p.y(), (w + v) / 2 + 5, 12})) return false;
  const bool dark = is_dark(p);
  const Colour ink = dark ? kWhite : Colour{0.08, 0.10, 0.16, 1};
  const double x = p.x() - (w + v) / 2, y = p.y() + 5;
  begin_plot();
  text(x, y, metres, kText, ink, 0, !dark);
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
  const double w = text_width(label, kSmall);
  const bool left = p.x() + 14 + w > kLeft + columns_;
  text(left ? p.x() - 13 : p.x() + 13, p.y() + 5, label, kSmall, palette::kInk, left ? 1 : 0, true);
  end_plot();
  taken_.push_back({p.x() + (left ? -1 : 1) * w / 2, p.y(), w / 2 + 14, 13});
}

// The panel ----------------------------------------------------------------------------------------------------------

void ChartLayout::north_arrow_and_scale(const std::string& up) {
  const double x = kLeft + columns_ + kBand + 36, width = kPanel - 70;
  cairo_t* c = cairo_.get();
  // The arrow: two halves, one filled, as on a compass card.
  const double cx = x + 14, top = panel_y_ + 18;
  for (const double half : {-1.0, 1.0}) {
    if (up.empty()) break;
    cairo_new_path(c);
    cairo_move_to(c, cx, top);
    cairo_line_to(c, cx + half * 11, top + 46);
    cairo_line_to(c, cx, top + 36);
    cairo_close_path(c);
    fill(half < 0 ? palette::kInk : kWhite);
    set({palette::kInk, 1, false});
    cairo_stroke(c);
  }
  text(up.size() > 1 ? x : cx, top - 4, up, up.size() > 1 ? kSmall : 16, palette::kInk, up.size() > 1 ? 0 : 0.5);
  // The scale: a round length in four parts.
  const double room_m = (width - 60) * metres_per_px_;
  double length = std::pow(10, std::floor(std::log10(room_m)));
  length *= room_m >= 5 * length ? 5 : room_m >= 2 * length ? 2 : 1;
  const double left = up.empty() ? x : x + (up.size() > 1 ? 66 : 48), y = top + 22, part = length / 4 / metres_per_px_;
  for (int i = 0; i < 4; ++i) {
    cairo_new_path(c);
    cairo_rectangle(c, left + i * part, y, part, 7);
    fill(i % 2 == 0 ? palette::kInk : kWhite);
    set({palette::kInk, 1, false});
    cairo_stroke(c);
  }
  const bool kilometres = length >= 2000;
  for (const double share : {0.0, 0.5, 1.0}) {
    const double v = share * length / (kilometres ? 1000 : 1);
    text(left + share * 4 * part, y - 6, plain(v) + (share == 1 ? kilometres ? " km" : " m" : ""), kSmall,
         palette::kInk, 0.5);
  }
  panel_y_ += 92;
}

void ChartLayout::colour_bars(const std::string& caption, double low, double high, const std::vector<double>& marks,
                              const std::vector<Bar>& bars) {
  const double x = kLeft + columns_ + kBand + 36, top = panel_y_ + 44, height = 250, width = 30;
  text(x, panel_y_ + 14, caption, kText, palette::kInk);
  for (std::size_t b = 0; b < bars.size(); ++b) {
    const double left = x + static_cast<double>(b) * (width + 6);
    for (int i = 0; i < static_cast<int>(height); ++i) {
      cairo_new_path(cairo_.get());
      cairo_rectangle(cairo_.get(), left, top + i, width, 1.5);
      fill(bars[b].colour(low + (i + 0.5) / height * (high - low)));
    }
    cairo_new_path(cairo_.get());
    cairo_rectangle(cairo_.get(), left, top, width, height);
    set({palette::kInk, 1, false});
    cairo_stroke(cairo_.get());
  }
  const double right = x + static_cast<double>(bars.size()) * (width + 6);
  for (const double v : marks) {
    const double y = top + (v - low) / (high - low) * height;
    line(right - 6, y, right, y, {palette::kInk, 1, false});
    text(right + 5, y + 5, plain(v), kSmall, palette::kInk);
  }
  // Captions of the bars, one below the other; left, middle and right name the bar.
  double y = top + 12;
  for (std::size_t b = 0; b < bars.size() && bars.size() > 1; ++b, y += 20) {
    text(right + 44, y,
         fmt::format("{} {}",
                     b == 0                 ? "left:"
                     : b + 1 == bars.size() ? "right:"
                                            : "middle:",
                     bars[b].caption),
         kSmall, palette::kInk);
  }
  panel_y_ = top + height + 22;
}

Vector2d ChartLayout::next_entry(double height_px) {
  const Vector2d at(kLeft + columns_ + kBand + 36, panel_y_);
  panel_y_ += height_px;
  return at;
}

void ChartLayout::legend_fill(Colour colour, const std::string& words, bool hatched) {
  const double x = kLeft + columns_ + kBand + 36;
  cairo_new_path(cairo_.get());
  cairo_rectangle(cairo_.get(), x, panel_y_, 28, 15);
  fill(colour);
  set({palette::kFaint, 1, false});
  cairo_stroke(cairo_.get());
  for (int i = 0; hatched && i < 4; ++i)
    line(x + i * 7, panel_y_ + 10, x + i * 7 + 7, panel_y_ + 3, {kWhite, 1.2, false});
  text(x + 38, panel_y_ + 13, words, kSmall, palette::kInk);
  panel_y_ += 23;
}

void ChartLayout::legend_line(const Stroke& stroke, const std::string& words) {
  const double x = kLeft + columns_ + kBand + 36;
  line(x, panel_y_ + 8, x + 28, panel_y_ + 8, stroke);
  text(x + 38, panel_y_ + 13, words, kSmall, palette::kInk);
  panel_y_ += 23;
}

void ChartLayout::legend_danger(const std::string& words) {
  const double x = kLeft + columns_ + kBand + 36;
  danger_symbol({x + 14, panel_y_ + 9});
  text(x + 38, panel_y_ + 14, words, kSmall, palette::kInk);
  panel_y_ += 26;
}

void ChartLayout::note(const std::string& words, bool strong) {
  const double x = kLeft + columns_ + kBand + 36, width = kPanel - 56;
  const double size = strong ? kText : kSmall;
  cairo_select_font_face(cairo_.get(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         strong ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  std::istringstream in(words);
  std::string so_far, word;
  const auto flush = [&] {
    text(x, panel_y_ + 13, so_far, size, strong ? kMagenta : palette::kInk);
    panel_y_ += size + 5;
    so_far.clear();
  };
  while (in >> word) {
    const std::string longer = so_far.empty() ? word : so_far + " " + word;
    if (!so_far.empty() && text_width(longer, size) > width) {
      flush();
      so_far = word;
    } else {
      so_far = longer;
    }
  }
  if (!so_far.empty()) flush();
  cairo_select_font_face(cairo_.get(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  panel_y_ += 8;
}

void ChartLayout::about(const ChartSource& source, const std::string& frame) {
  if (!source.survey.empty()) note(source.survey);
  if (!source.date.empty()) note(source.date);
  if (source.cell_m > 0) note(fmt::format("Cells of {:g} m", source.cell_m));
  note(origin_ ? fmt::format("Positions: WGS 84. The map is the plane that touches the ellipsoid at {:.5f}°, {:.5f}°; "
                             "north is true north there.",
                             origin_->latitude_deg, origin_->longitude_deg)
               : frame);
}

// The frame ----------------------------------------------------------------------------------------------------------

/// One side of the frame, from its west or south end to its east or north end.
struct ChartLayout::Side {
  Vector2d from, to;  ///< north, east
  bool latitude;      ///< graduated in latitude, or northing; else in longitude, or easting
  Vector2d outward;   ///< px
  bool labelled;
  double step;
};

void ChartLayout::graduate(const Side& side) const {
  const auto value = [&](double share) {
    const Vector2d p = side.from + share * (side.to - side.from);
    if (!origin_) return side.latitude ? p.x() : p.y();
    const GeoPoint g = LocalPlane(*origin_).to_geo(p);
    return 60 * (side.latitude ? g.latitude_deg : g.longitude_deg);
  };
  const double low = value(0), high = value(1);
  if (!(high > low)) return;  // a side that crosses the date line gets no ticks
  const auto px_of = [&](double v) {
    double share = (v - low) / (high - low);
    for (int i = 0; i < 3; ++i) share += (v - value(share)) / (high - low);
    return to_px(side.from + std::clamp(share, 0.0, 1.0) * (side.to - side.from));
  };
  const double fine = side.step / 5;
  const auto first = static_cast<long long>(std::floor(low / fine));
  const auto last = static_cast<long long>(std::ceil(high / fine));
  for (long long i = first; i < last; ++i) {
    const auto v = static_cast<double>(i) * fine;
    if (i % 2 != 0) continue;
    const Vector2d a = px_of(std::max(v, low)), b = px_of(std::clamp(v + fine, low, high));
    const Vector2d middle = kBand / 2 * side.outward;
    line(a.x() + middle.x(), a.y() + middle.y(), b.x() + middle.x(), b.y() + middle.y(),
         {palette::kInk, kBand - 2, false});
  }
  for (long long i = static_cast<long long>(std::ceil(low / side.step - 1e-9));
       static_cast<double>(i) * side.step <= high; ++i) {
    const double v = static_cast<double>(i) * side.step;
    const Vector2d at = px_of(v), end = at + (kBand + 5) * side.outward;
    line(at.x(), at.y(), end.x(), end.y(), {palette::kInk, 1.4, false});
    if (!side.labelled) continue;
    const std::string words = !origin_        ? plain(v)
                              : side.latitude ? degrees_and_minutes(v, side.step, "N", "S")
                                              : degrees_and_minutes(v, side.step, "E", "W");
    const Vector2d p = at + (kBand + 9) * side.outward;
    if (side.latitude) {
      text(p.x(), p.y() + 5, words, kSmall, palette::kInk, 1);
    } else {
      text(p.x(), p.y() + (side.outward.y() > 0 ? 12 : -1), words, kSmall, palette::kInk, 0.5);
    }
  }
}

void ChartLayout::finish() {
  const double south = extent_.x_max - rows_ * metres_per_px_, east = extent_.y_min + columns_ * metres_per_px_;
  const Vector2d sw(south, extent_.y_min), se(south, east), nw(extent_.x_max, extent_.y_min), ne(extent_.x_max, east);
  const auto step = [&](const Vector2d& from, const Vector2d& to, bool latitude, double wanted) {
    if (!origin_) return nice_step(0, (to - from).norm(), wanted);
    const LocalPlane plane(*origin_);
    const GeoPoint a = plane.to_geo(from), b = plane.to_geo(to);
    return minute_step(60 * std::abs(latitude ? b.latitude_deg - a.latitude_deg : b.longitude_deg - a.longitude_deg),
                       wanted);
  };
  const double up = step(sw, nw, true, std::max(2.0, rows_ / 110.0));
  const double across = step(sw, se, false, std::max(2.0, columns_ / 150.0));
  graduate({sw, nw, true, {-1, 0}, true, up});
  graduate({se, ne, true, {1, 0}, false, up});
  graduate({sw, se, false, {0, 1}, true, across});
  graduate({nw, ne, false, {0, -1}, true, across});
  for (const double out : {0.0, kBand}) {
    cairo_new_path(cairo_.get());
    cairo_rectangle(cairo_.get(), kLeft - out, kTop - out, columns_ + 2 * out, rows_ + 2 * out);
    set({palette::kInk, out > 0 ? 1.6 : 1.0, false});
    cairo_stroke(cairo_.get());
  }
  cairo_select_font_face(cairo_.get(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_BOLD);
  text(kLeft - kBand, 38, title_, 24, palette::kInk);
  cairo_select_font_face(cairo_.get(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  if (!origin_) text(kLeft - kBand, kTop + rows_ + 50, axes_, kSmall, palette::kInk);
}

}  // namespace isobath
