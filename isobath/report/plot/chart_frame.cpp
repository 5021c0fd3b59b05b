// The frame of a ChartLayout: its sides, graduated in latitude and longitude or in metres, and the title.
#include <algorithm>
#include <cairo/cairo.h>
#include <cmath>
#include <fmt/format.h>
#include <isobath/geometry/contours.hpp>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/report/plot/chart_layout.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

/// Ticks of a graduated side: steps of 1, 2, 5 within a minute (2 m at the least), then of whole minutes and degrees.
double minute_step(double range_min, double wanted) {
  for (const double step :
       {0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0, 60.0, 120.0, 300.0}) {
    if (range_min / step <= wanted) return step;
  }
  return 600;
}

/// 52 deg 20.25' N from minutes.
std::string degrees_and_minutes(double minutes, double step, const char* positive, const char* negative) {
  const int digits = step >= 1 ? 0 : step >= 0.1 ? 1 : step >= 0.01 ? 2 : 3;
  const double scale = std::pow(10, digits);
  const auto units = std::llround(std::abs(minutes) * scale);
  const auto per_degree = static_cast<long long>(60 * scale);
  return fmt::format("{}°{:0{}.{}f}'{}", units / per_degree, static_cast<double>(units % per_degree) / scale,
                     digits > 0 ? digits + 3 : 2, digits, minutes < 0 ? negative : positive);
}

}  // namespace

std::string ChartLayout::plain_number(double value) {
  return fmt::format("{:.6g}", std::abs(value) < 1e-9 ? 0.0 : value);
}

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
    const std::string words = !origin_        ? plain_number(v)
                              : side.latitude ? degrees_and_minutes(v, side.step, "N", "S")
                                              : degrees_and_minutes(v, side.step, "E", "W");
    const Vector2d p = at + (kBand + 9) * side.outward;
    if (side.latitude) {
      text(p.x(), p.y() + 5, words, kSmallPx, palette::kInk, 1);
    } else {
      text(p.x(), p.y() + (side.outward.y() > 0 ? 12 : -1), words, kSmallPx, palette::kInk, 0.5);
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
  if (!origin_) text(kLeft - kBand, kTop + rows_ + 50, axes_, kSmallPx, palette::kInk);
}

}  // namespace isobath
