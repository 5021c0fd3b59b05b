// PlanPicture and ChartPicture: plan views in metres and charts of curves, as PNG.
//
// A plan view shows the level body frame L (x forward is up, y starboard is right) or the world (north up, east right):
// both are "x up, y right" in metres, so one class serves. Colour-blind readers can tell the colours apart.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <isobath/report/plot/canvas.hpp>
#include <span>
#include <string>
#include <vector>

namespace isobath {

struct PlanExtent {
  double x_min = -10, x_max = 10;  ///< up, m
  double y_min = -10, y_max = 10;  ///< right, m
};

/// The frame of a plan view of what lies in the box: an even margin all round (4 % of the longer side), and at least
/// 15 % as wide as long.
PlanExtent frame_around(const Eigen::AlignedBox2d& content);

/// A plan view with a frame, ticks in metres, a title and a legend beside it.
class PlanPicture : public Canvas {
 public:
  struct Labels {
    std::string title;
    std::string up;     ///< "forward (m)"
    std::string right;  ///< "starboard (m)"
  };
  PlanPicture(const PlanExtent& extent, int plot_px, Labels labels);

  /// Fills the plot with `colour(x, y)` of the centre of each pixel.
  void raster(const std::function<Colour(double x, double y)>& colour);
  void polygon(std::span<const Eigen::Vector2d> points, const Stroke& stroke, Colour filling = {0, 0, 0, 0});
  void polyline(std::span<const Eigen::Vector2d> points, const Stroke& stroke);
  void label(const Eigen::Vector2d& at, const std::string& text, Colour colour = palette::kInk);
  void dot(const Eigen::Vector2d& at, double radius_px, Colour colour);
  /// A dart at `at` that points along the heading (clockwise from up).
  void vehicle(const Eigen::Vector2d& at, double heading_rad);
  /// Circles of equal range around `centre`, every `step_m`.
  void range_rings(const Eigen::Vector2d& centre, double step_m);
  struct LegendEntry {
    Colour colour;
    std::string text;
  };
  /// Draws frame, ticks, titles and the legend to the right. Call it last.
  void finish(const std::vector<LegendEntry>& legend);

 private:
  [[nodiscard]] Eigen::Vector2d to_px(const Eigen::Vector2d& p) const;
  void trace(std::span<const Eigen::Vector2d> points) const;
  void clip_to_plot() const;
  void unclip() const;

  PlanExtent extent_;
  Labels labels_;
  double scale_;  ///< px / m
  double left_, top_, plot_width_, plot_height_;
};

/// Curves with error bands over two axes. The name of a curve stands beside its end.
class ChartPicture : public Canvas {
 public:
  struct Axis {
    std::string label;
    double low = 0, high = 1;  ///< a linear axis may run backwards, with high below low
    bool logarithmic = false;
  };
  ChartPicture(int width_px, int height_px, std::string title, Axis x, Axis y);

  void curve(std::span<const double> x, std::span<const double> y, const Stroke& stroke, const std::string& name);
  /// Fills the area between low and high; makes no entry in the legend.
  void band(std::span<const double> x, std::span<const double> low, std::span<const double> high, Colour colour);
  void points(std::span<const double> x, std::span<const double> y, Colour colour, const std::string& name);
  /// A vertical line with a label at its top. Marks come from left to right.
  void mark(double x, const std::string& label, Colour colour);
  /// Draws frame, ticks and names. Call it last.
  void finish();

 private:
  struct Name {
    Colour colour;
    std::string text;
    double x, y;  ///< px, of the last place that was drawn
  };
  void name_line(std::span<const double> x, std::span<const double> y, Colour colour, const std::string& name);
  void draw_names();
  [[nodiscard]] double px_x(double x) const;
  [[nodiscard]] double px_y(double y) const;
  void draw_ticks(const Axis& axis, bool horizontal) const;

  std::string title_;
  Axis x_, y_;
  double left_ = 64, top_ = 34, plot_width_, plot_height_;
  std::vector<Name> names_;
  double last_mark_ = -1e9;  ///< px
  int mark_row_ = 0;
};

}  // namespace isobath
