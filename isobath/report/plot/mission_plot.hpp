// MissionPlot: the chart of one mission: outlines, circles, the vehicle, and numbered places that the table of
// decisions explains.
#pragma once

#include <isobath/report/plot/chart_layout.hpp>

namespace isobath {

class MissionPlot : public ChartLayout {
 public:
  using ChartLayout::ChartLayout;

  void water(Colour colour);
  void area(std::span<const Eigen::Vector2d> outline, Colour filling, const Stroke& stroke);
  void circle(const Eigen::Vector2d& centre, double radius_m, const Stroke& stroke);
  void cross(const Eigen::Vector2d& centre, const Stroke& stroke);
  /// Text beside a place. Later labels do not overlap it; without free room it is left out.
  void name(const Eigen::Vector2d& at, const std::string& text, Colour colour);
  /// A dart in the colour of the vehicle.
  void vehicle(const Eigen::Vector2d& at, double heading_rad);
  /// A number in a disc beside the place, with a line to it; without free room it is left out.
  void numbered(const Eigen::Vector2d& at, int number, Colour colour);
  /// A line between two places, with text beside its middle.
  void measure(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const std::string& text);

  void legend_circle(const Stroke& stroke, const std::string& text, bool crossed = false);
  void legend_number(Colour colour, const std::string& text);
  /// Leaves some space before the next entry of the panel.
  void gap() { (void)next_entry(14); }

 private:
  void disc(const Eigen::Vector2d& at_px, const std::string& text, Colour colour) const;
  void cross_px(const Eigen::Vector2d& at, double half, const Stroke& stroke) const;
};

}  // namespace isobath
