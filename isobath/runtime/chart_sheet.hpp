// ChartSheet: the paper of a chart: a plot in (north, east) within a graduated frame, and a panel beside it with the
// north arrow, the scale bar, colour bars, the legend and notes.
//
// North is up. With an origin the frame shows latitude and longitude (WGS 84) in degrees and decimal minutes, and each
// side is graduated on its own, so that the convergence of meridians shows; without one it shows metres. Drawn at 150
// pixels an inch: the smallest letters are 2.4 mm high. Text that does not fit into the panel is broken between words.
#pragma once

#include <isobath/geometry/geodesy.hpp>
#include <isobath/runtime/picture.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

class ChartSheet : public Canvas {
 public:
  /// The plot has whole pixels: its south and east sides may lie up to a pixel beyond the extent.
  ChartSheet(const PlanExtent& north_east, int plot_px, const std::string& title, std::optional<GeoOrigin> origin);

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] double metres_per_px() const { return metres_per_px_; }

  /// columns * rows colours, row-major from the north-west.
  void raster(const std::vector<Colour>& colours);
  void polyline(std::span<const Eigen::Vector2d> points, bool closed, const Stroke& stroke);
  /// A line with its depth written along it wherever there is room, upright, with a gap in the line; parts where
  /// `approximate` holds are dashed.
  void contour(std::span<const Eigen::Vector2d> points, bool closed, const Stroke& stroke, const std::string& label,
               const std::function<bool(const Eigen::Vector2d&)>& approximate);
  /// A sounding as charts print it: whole metres, decimetres small below the line. False where there is no room.
  bool sounding(const Eigen::Vector2d& at, double depth_m);
  /// A danger: a cross in a dotted circle, and its name.
  void danger(const Eigen::Vector2d& at, const std::string& label);

  // The panel, from top to bottom.
  void north_arrow_and_scale();
  struct Bar {
    std::string caption;
    std::function<Colour(double value)> colour;
  };
  /// Bars side by side from `low` (top) to `high`, with values at `marks`.
  void colour_bars(const std::string& caption, double low, double high, const std::vector<double>& marks,
                   const std::vector<Bar>& bars);
  void legend_fill(Colour colour, const std::string& text, bool hatched = false);
  void legend_line(const Stroke& stroke, const std::string& text);
  void legend_danger(const std::string& text);
  void note(const std::string& text, bool strong = false);

  /// The frame: call last.
  void finish();

 protected:
  struct Box {
    double x, y, half_width, half_height;
  };
  [[nodiscard]] Eigen::Vector2d to_px(const Eigen::Vector2d& north_east) const;
  /// False, and nothing is taken, where another has it already or it is outside of the plot.
  [[nodiscard]] bool take_room(const Box& box);
  void begin_plot() const;
  void end_plot() const;
  void trace(std::span<const Eigen::Vector2d> points_px) const;
  [[nodiscard]] double text_width(const std::string& text, double size) const;
  /// Where the next entry of the legend stands; moves on by `height_px`.
  Eigen::Vector2d next_entry(double height_px);

 private:
  struct Side;
  void text_at_angle(const Eigen::Vector2d& centre, double angle, const std::string& text, double size,
                     Colour colour) const;
  void danger_symbol(const Eigen::Vector2d& at_px) const;
  void graduate(const Side& side) const;

  PlanExtent extent_;
  std::string title_;
  std::optional<GeoOrigin> origin_;
  int columns_, rows_;
  double metres_per_px_;
  double panel_y_;
  std::vector<Box> taken_;
};

}  // namespace isobath
