#include <array>
#include <cairo/cairo.h>
#include <cmath>
#include <isobath/report/plot/mission_plot.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kText = 14, kDisc = 11;
constexpr Colour kWhite{1, 1, 1, 1};

}  // namespace

void MissionPlot::water(Colour colour) {
  raster(std::vector<Colour>(static_cast<std::size_t>(columns()) * static_cast<std::size_t>(rows()), colour));
}

void MissionPlot::area(std::span<const Vector2d> outline, Colour filling, const Stroke& stroke) {
  begin_plot();
  for (const Vector2d& p : outline) {
    const Vector2d at = to_px(p);
    cairo_line_to(cairo_.get(), at.x(), at.y());
  }
  cairo_close_path(cairo_.get());
  if (filling.alpha > 0) fill(filling);
  set(stroke);
  cairo_stroke(cairo_.get());
  end_plot();
}

void MissionPlot::circle(const Vector2d& centre, double radius_m, const Stroke& stroke) {
  const Vector2d p = to_px(centre);
  begin_plot();
  cairo_arc(cairo_.get(), p.x(), p.y(), radius_m / metres_per_px(), 0, 2 * std::numbers::pi);
  set(stroke);
  cairo_stroke(cairo_.get());
  end_plot();
}

void MissionPlot::cross_px(const Vector2d& at, double half, const Stroke& stroke) const {
  line(at.x() - half, at.y() - half, at.x() + half, at.y() + half, stroke);
  line(at.x() - half, at.y() + half, at.x() + half, at.y() - half, stroke);
}

void MissionPlot::cross(const Vector2d& centre, const Stroke& stroke) {
  begin_plot();
  cross_px(to_px(centre), 8, stroke);
  end_plot();
}

void MissionPlot::name(const Vector2d& at, const std::string& words, Colour colour) {
  const Vector2d p = to_px(at);
  const double half = text_width(words, kText) / 2;
  constexpr std::array<std::pair<double, double>, 6> kBeside{{{1, 0}, {-1, 0}, {0, -1}, {0, 1}, {1, -1}, {-1, 1}}};
  for (const double away : {14.0, 26.0, 40.0}) {
    for (const auto& [right, down] : kBeside) {
      const Vector2d middle(p.x() + right * (half + away), p.y() + down * away);
      if (!take_room({middle.x(), middle.y(), half + 3, 10})) continue;
      begin_plot();
      text(middle.x(), middle.y() + 5, words, kText, colour, 0.5, true);
      end_plot();
      return;
    }
  }
}

void MissionPlot::vehicle(const Vector2d& at, double heading_rad) {
  const Vector2d p = to_px(at);
  begin_plot();
  cairo_translate(cairo_.get(), p.x(), p.y());
  cairo_rotate(cairo_.get(), heading_rad);
  for (const auto& [x, y] : {std::pair(0.0, -15.0), {8.0, 10.0}, {0.0, 5.0}, {-8.0, 10.0}})
    cairo_line_to(cairo_.get(), x, y);
  cairo_close_path(cairo_.get());
  fill(palette::kTrack);
  set({kWhite, 1.2, false});
  cairo_stroke(cairo_.get());
  end_plot();
}

void MissionPlot::disc(const Vector2d& at, const std::string& words, Colour colour) const {
  cairo_new_path(cairo_.get());
  cairo_arc(cairo_.get(), at.x(), at.y(), kDisc, 0, 2 * std::numbers::pi);
  fill(colour);
  set({kWhite, 1.5, false});
  cairo_stroke(cairo_.get());
  text(at.x(), at.y() + 4.5, words, words.size() > 2 ? 10 : 13, kWhite, 0.5);
}

void MissionPlot::numbered(const Vector2d& at, int number, Colour colour) {
  const Vector2d p = to_px(at);
  for (const double away : {24.0, 44.0, 66.0, 92.0, 120.0}) {
    for (int i = 0; i < 12; ++i) {
      const double angle = -std::numbers::pi / 4 + i * std::numbers::pi / 6;  // to the upper right first
      const Vector2d beside = p + away * Vector2d(std::cos(angle), std::sin(angle));
      if (!take_room({beside.x(), beside.y(), kDisc + 2, kDisc + 2})) continue;
      begin_plot();
      line(p.x(), p.y(), beside.x(), beside.y(), {colour, 1.4, false});
      cairo_new_path(cairo_.get());
      cairo_arc(cairo_.get(), p.x(), p.y(), 3.5, 0, 2 * std::numbers::pi);
      fill(colour);
      disc(beside, std::to_string(number), colour);
      end_plot();
      return;
    }
  }
}

void MissionPlot::measure(const Vector2d& from, const Vector2d& to, const std::string& words) {
  const Vector2d a = to_px(from), b = to_px(to);
  begin_plot();
  line(a.x(), a.y(), b.x(), b.y(), {{0.75, 0.05, 0.10, 1}, 2, false});
  end_plot();
  name((from + to) / 2, words, {0.75, 0.05, 0.10, 1});
}

void MissionPlot::legend_circle(const Stroke& stroke, const std::string& words, bool crossed) {
  const Vector2d at = next_entry(25);
  const Vector2d centre(at.x() + 14, at.y() + 8);
  cairo_new_path(cairo_.get());
  cairo_arc(cairo_.get(), centre.x(), centre.y(), 9, 0, 2 * std::numbers::pi);
  set(stroke);
  cairo_stroke(cairo_.get());
  if (crossed) cross_px(centre, 6, stroke);
  text(at.x() + 38, at.y() + 13, words, 13, palette::kInk);
}

void MissionPlot::legend_number(Colour colour, const std::string& words) {
  const Vector2d at = next_entry(26);
  disc({at.x() + 14, at.y() + 9}, "1", colour);
  text(at.x() + 38, at.y() + 14, words, 13, palette::kInk);
}

}  // namespace isobath
