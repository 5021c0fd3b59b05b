// PlanImage: a plan view of echoes: each bin covers its sector at the pose of its ping. Where bins overlap, the image
// shows the strongest echo. Ranges are treated as horizontal.
#pragma once

#include <isobath/geometry/pose.hpp>
#include <isobath/report/plot/picture.hpp>
#include <isobath/sonar/ping.hpp>
#include <optional>
#include <vector>

namespace isobath {

class PlanImage {
 public:
  /// `pixel_m`: edge of a pixel.
  PlanImage(const PlanExtent& extent, double pixel_m);

  /// `X_PS`: sensor in the frame of the picture (x up, y right).
  void add(const Ping& ping, const Pose& X_PS);
  /// Intensity relative to the strongest echo of the whole image; empty where no beam looked.
  [[nodiscard]] std::optional<double> share(double x, double y) const;

 private:
  void add_beam(const RangeWindow& window, double heading, Angle half_width, const Eigen::Vector2d& at);
  [[nodiscard]] std::ptrdiff_t index(double x, double y) const;

  PlanExtent extent_;
  double pixel_m_;
  std::ptrdiff_t rows_, columns_;
  std::vector<float> strongest_;  ///< negative: no beam looked there
  std::vector<float> profile_;
  float maximum_ = 0;
};

}  // namespace isobath
