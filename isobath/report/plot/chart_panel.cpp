// The panel of a ChartLayout: north arrow, scale bar, colour bars, legend and notes.
#include <cairo/cairo.h>
#include <cmath>
#include <fmt/format.h>
#include <isobath/report/plot/chart_layout.hpp>
#include <sstream>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr Colour kMagenta{0.65, 0.10, 0.45, 1};  // colour of warnings on charts

}  // namespace

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
    fill(half < 0 ? palette::kInk : palette::kPaper);
    set({palette::kInk, 1, false});
    cairo_stroke(c);
  }
  text(up.size() > 1 ? x : cx, top - 4, up, up.size() > 1 ? kSmallPx : 16, palette::kInk, up.size() > 1 ? 0 : 0.5);
  // The scale: a round length in four parts.
  const double room_m = (width - 60) * metres_per_px_;
  double length = std::pow(10, std::floor(std::log10(room_m)));
  length *= room_m >= 5 * length ? 5 : room_m >= 2 * length ? 2 : 1;
  const double left = up.empty() ? x : x + (up.size() > 1 ? 66 : 48), y = top + 22, part = length / 4 / metres_per_px_;
  for (int i = 0; i < 4; ++i) {
    cairo_new_path(c);
    cairo_rectangle(c, left + i * part, y, part, 7);
    fill(i % 2 == 0 ? palette::kInk : palette::kPaper);
    set({palette::kInk, 1, false});
    cairo_stroke(c);
  }
  const bool kilometres = length >= 2000;
  for (const double share : {0.0, 0.5, 1.0}) {
    const double v = share * length / (kilometres ? 1000 : 1);
    text(left + share * 4 * part, y - 6, plain_number(v) + (share == 1 ? kilometres ? " km" : " m" : ""), kSmallPx,
         palette::kInk, 0.5);
  }
  panel_y_ += 92;
}

void ChartLayout::colour_bars(const std::string& caption, double low, double high, const std::vector<double>& marks,
                              const std::vector<Bar>& bars) {
  const double x = kLeft + columns_ + kBand + 36, top = panel_y_ + 44, height = 250, width = 30;
  text(x, panel_y_ + 14, caption, kTextPx, palette::kInk);
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
    text(right + 5, y + 5, plain_number(v), kSmallPx, palette::kInk);
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
         kSmallPx, palette::kInk);
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
    line(x + i * 7, panel_y_ + 10, x + i * 7 + 7, panel_y_ + 3, {palette::kPaper, 1.2, false});
  text(x + 38, panel_y_ + 13, words, kSmallPx, palette::kInk);
  panel_y_ += 23;
}

void ChartLayout::legend_line(const Stroke& stroke, const std::string& words) {
  const double x = kLeft + columns_ + kBand + 36;
  line(x, panel_y_ + 8, x + 28, panel_y_ + 8, stroke);
  text(x + 38, panel_y_ + 13, words, kSmallPx, palette::kInk);
  panel_y_ += 23;
}

void ChartLayout::legend_danger(const std::string& words) {
  const double x = kLeft + columns_ + kBand + 36;
  danger_symbol({x + 14, panel_y_ + 9});
  text(x + 38, panel_y_ + 14, words, kSmallPx, palette::kInk);
  panel_y_ += 26;
}

void ChartLayout::note(const std::string& words, bool strong) {
  const double x = kLeft + columns_ + kBand + 36, width = kPanel - 56;
  const double size = strong ? kTextPx : kSmallPx;
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

}  // namespace isobath
