// PlanPicture and ChartPicture: plan views in metres and charts of curves, as PNG. Drawn by Cairo; the same input gives
// the same bytes.
//
// A plan view shows the level body frame L (x forward is up, y starboard is right) or the world (north up, east right):
// both are "x up, y right" in metres, so one class serves. Colour-blind readers can tell the colours apart.
#pragma once

#include <array>
#include <cstdint>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

using cairo_t = struct _cairo;  // NOLINT(bugprone-reserved-identifier): Cairo calls it so

namespace isobath {

struct Colour {
  double red = 0, green = 0, blue = 0, alpha = 1;
};

/// From dark blue through grey to yellow, with even steps of lightness; share in 0..1.
Colour intensity_colour(double share);
/// Unknown is grey, free blue-white, occupied dark orange. Probability in 0..1.
Colour occupancy_colour(double probability, double prior);

namespace palette {
inline constexpr Colour kInk{0.13, 0.14, 0.16, 1};
inline constexpr Colour kFaint{0.45, 0.47, 0.5, 0.6};
inline constexpr Colour kObstacle{0.84, 0.37, 0.0, 1};
inline constexpr Colour kHidden{0.34, 0.34, 0.6, 1};
inline constexpr Colour kTrack{0.0, 0.45, 0.7, 1};
inline constexpr Colour kTruth{0.0, 0.62, 0.45, 1};
inline constexpr Colour kVehicle{0.0, 0.62, 0.45, 1};
}  // namespace palette

struct PlanExtent {
  double x_min = -10, x_max = 10;  ///< up, m
  double y_min = -10, y_max = 10;  ///< right, m
};

/// The frame of a plan view of what lies in the box: an even margin all round (4 % of the longer side), and at least
/// 15 % as wide as long.
PlanExtent frame_around(const Eigen::AlignedBox2d& content);

struct Stroke {
  Colour colour = palette::kInk;
  double width_px = 1.5;
  bool dashed = false;
};

class Canvas {
 public:
  Canvas(int width_px, int height_px);
  /// Throws Error if the file cannot be written.
  void save(const std::filesystem::path& file) const;
  /// The bytes of the PNG file.
  [[nodiscard]] std::string png() const;

 protected:
  struct Closer {
    void operator()(cairo_t* context) const;
  };
  void text(double x_px, double y_px, const std::string& text, double size, Colour colour, double align = 0,
            bool halo = false) const;
  void line(double x0, double y0, double x1, double y1, const Stroke& stroke) const;
  void set(const Stroke& stroke) const;
  void fill(Colour colour) const;

  int width_;
  int height_;
  std::unique_ptr<cairo_t, Closer> cairo_;
};

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
  /// A vertical line with a label at its top.
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
};

/// Round values that divide [low, high] into about `wanted` parts.
std::vector<double> ticks(double low, double high, int wanted);

}  // namespace isobath
