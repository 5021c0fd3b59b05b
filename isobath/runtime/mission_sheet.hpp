// MissionSheet: a chart sheet for the way of one mission: outlines, circles, the vehicle, and numbered places that a
// table beside the chart explains.
#pragma once

#include <isobath/runtime/chart_sheet.hpp>

namespace isobath {

class MissionSheet : public ChartSheet {
 public:
  using ChartSheet::ChartSheet;

  void water(Colour colour);
  void area(std::span<const Eigen::Vector2d> outline, Colour filling, const Stroke& stroke);
  void circle(const Eigen::Vector2d& centre, double radius_m, const Stroke& stroke);
  void cross(const Eigen::Vector2d& centre, const Stroke& stroke);
  /// A word beside a place; takes its room.
  void name(const Eigen::Vector2d& at, const std::string& text, Colour colour);
  /// A dart of the vehicle's colour.
  void vehicle(const Eigen::Vector2d& at, double heading_rad);
  /// A number in a disc beside the place, with a line to it, where there is room.
  void numbered(const Eigen::Vector2d& at, int number, Colour colour);
  /// A length between two places, written beside its middle.
  void measure(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const std::string& text);

  void legend_circle(const Stroke& stroke, const std::string& text, bool crossed = false);
  void legend_number(Colour colour, const std::string& text);
  /// Room before what follows in the panel.
  void gap() { (void)next_entry(14); }

 private:
  void disc(const Eigen::Vector2d& at_px, const std::string& text, Colour colour) const;
  void cross_px(const Eigen::Vector2d& at, double half, const Stroke& stroke) const;
};

}  // namespace isobath
