// ChartLayout: the layout of a printed chart: a plot in (north, east) within a graduated frame, and a panel beside it
// with the north arrow, the scale bar, colour bars, the legend and notes.
//
// North is up. With an origin the frame shows latitude and longitude (WGS 84) in degrees and decimal minutes. Each side
// is graduated on its own, so that the convergence of meridians is visible. Without an origin the frame shows metres.
// A view that is no map (from the vehicle, from the side) names its own axes; up is then not north.
// The resolution is 150 pixels an inch: the smallest letters are 2.4 mm high. Text too wide for the panel is wrapped.
#pragma once

#include <isobath/geometry/geodesy.hpp>
#include <isobath/report/plot/picture.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// What a picture says about its data.
struct ChartSource {
  std::string survey{};  ///< name of the log, the survey or the scenario
  std::string date{};    ///< of the data; empty: unknown
  double cell_m = 0;     ///< edge of a cell of the map; 0: it has none
};

class ChartLayout : public Canvas {
 public:
  /// Height that the longest panel needs.
  static constexpr int kMinHeight = 900;
  /// The plot has whole pixels: its south and east sides may lie up to a pixel beyond the extent.
  ChartLayout(const PlanExtent& north_east, int plot_px, const std::string& title, std::optional<GeoOrigin> origin,
              int min_height_px = kMinHeight);

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] double metres_per_px() const { return metres_per_px_; }

  /// columns * rows colours, row-major from the north-west.
  void raster(const std::vector<Colour>& colours);
  void polyline(std::span<const Eigen::Vector2d> points, bool closed, const Stroke& stroke);
  /// A line with `label` written upright along it, in a gap of the line, wherever there is room. Parts where
  /// `approximate` holds are dashed.
  void contour(std::span<const Eigen::Vector2d> points, bool closed, const Stroke& stroke, const std::string& label,
               const std::function<bool(const Eigen::Vector2d&)>& approximate);
  /// A sounding as charts print it: whole metres, and small, lowered decimetres. False if there is no room.
  bool sounding(const Eigen::Vector2d& at, double depth_m);
  /// A danger: a cross in a dotted circle, and its name.
  void danger(const Eigen::Vector2d& at, const std::string& label);

  /// The axes of a frame in metres: "north and east in metres", unless another text is set.
  void name_axes(const std::string& axes) { axes_ = axes; }

  // The panel, from top to bottom.
  /// `up`: the direction of the arrow; empty: no arrow.
  void north_arrow_and_scale(const std::string& up = "N");
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
  /// Survey, date, cell, and the frame of the positions: WGS 84 and the plane of the map with an origin, else `frame`.
  void about(const ChartSource& source, const std::string& frame);

  /// Draws the frame. Call it last.
  void finish();

 protected:
  struct Box {
    double x, y, half_width, half_height;
  };
  [[nodiscard]] Eigen::Vector2d to_px(const Eigen::Vector2d& north_east) const;
  /// Reserves the box. False, without reserving it, if it overlaps another one or leaves the plot.
  [[nodiscard]] bool take_room(const Box& box);
  void begin_plot() const;
  void end_plot() const;
  [[nodiscard]] double text_width(const std::string& text, double size) const;
  /// Position of the next entry of the legend; advances by `height_px`.
  Eigen::Vector2d next_entry(double height_px);

 private:
  static constexpr double kLeft = 96, kTop = 84, kBand = 9;  ///< around the plot: margins, width of the frame, px
  static constexpr double kPanel = 300;                      ///< width of the panel, px
  static constexpr double kTextPx = 15, kSmallPx = 13;       ///< sizes of letters

  struct Side;
  static std::string plain_number(double value);
  void text_at_angle(const Eigen::Vector2d& centre, double angle, const std::string& text, double size,
                     Colour colour) const;
  void danger_symbol(const Eigen::Vector2d& at_px) const;
  [[nodiscard]] bool is_dark(const Eigen::Vector2d& at_px) const;
  void graduate(const Side& side) const;

  PlanExtent extent_;
  std::string title_, axes_ = "north and east in metres";
  std::optional<GeoOrigin> origin_;
  int columns_, rows_;
  double metres_per_px_;
  double panel_y_;
  std::vector<Box> taken_;
};

}  // namespace isobath
