#include <algorithm>
#include <cmath>
#include <isobath/report/plot/plan_image.hpp>

namespace isobath {

PlanImage::PlanImage(const PlanExtent& extent, double pixel_m)
    : extent_(extent),
      pixel_m_(pixel_m),
      rows_(static_cast<std::ptrdiff_t>(std::ceil((extent.x_max - extent.x_min) / pixel_m))),
      columns_(static_cast<std::ptrdiff_t>(std::ceil((extent.y_max - extent.y_min) / pixel_m))),
      strongest_(static_cast<std::size_t>(rows_ * columns_), -1.0f) {}

std::ptrdiff_t PlanImage::index(double x, double y) const {
  const auto row = static_cast<std::ptrdiff_t>(std::floor((x - extent_.x_min) / pixel_m_));
  const auto column = static_cast<std::ptrdiff_t>(std::floor((y - extent_.y_min) / pixel_m_));
  return row < 0 || column < 0 || row >= rows_ || column >= columns_ ? -1 : row * columns_ + column;
}

void PlanImage::add(const Ping& ping, const Pose& X_PS) {
  const BeamFan& fan = *ping.fan;
  profile_.resize(static_cast<std::size_t>(ping.window.bins));
  for (int b = 0; b < fan.beams(); ++b) {
    const auto i = static_cast<std::size_t>(b);
    Angle half = fan.width[i] / 2;  // widened below if beams are further apart, so that the picture has no gaps
    if (fan.beams() > 1) {
      const std::size_t other = i > 0 ? i - 1 : 1;
      half = std::max(half, abs(fan.azimuth[i] - fan.azimuth[other]) / 2);
    }
    const Eigen::Vector3d axis = X_PS.rotation * Eigen::Vector3d(cos(fan.azimuth[i]), sin(fan.azimuth[i]), 0);
    ping.intensity.copy_beam(b, profile_.data());
    add_beam(ping.window, std::atan2(axis.y(), axis.x()), half, X_PS.translation.head<2>());
  }
}

void PlanImage::add_beam(const RangeWindow& w, double heading, Angle half_width, const Eigen::Vector2d& at) {
  const double step = pixel_m_ / 2;
  for (double r = w.start_m + step / 2; r < w.end_m(); r += step) {
    const auto bin = std::min(static_cast<int>((r - w.start_m) / w.bin_m), w.bins - 1);
    const float value = profile_[static_cast<std::size_t>(bin)];
    const int across = std::max(0, static_cast<int>(std::ceil(half_width.radians() * r / step)));
    for (int i = -across; i <= across; ++i) {
      const double bearing = heading + (across > 0 ? half_width.radians() * i / across : 0);
      const std::ptrdiff_t pixel = index(at.x() + r * std::cos(bearing), at.y() + r * std::sin(bearing));
      if (pixel >= 0)
        strongest_[static_cast<std::size_t>(pixel)] = std::max(strongest_[static_cast<std::size_t>(pixel)], value);
    }
    maximum_ = std::max(maximum_, value);
  }
}

std::optional<double> PlanImage::share(double x, double y) const {
  const std::ptrdiff_t pixel = index(x, y);
  if (pixel < 0 || strongest_[static_cast<std::size_t>(pixel)] < 0) return std::nullopt;
  return maximum_ > 0 ? static_cast<double>(strongest_[static_cast<std::size_t>(pixel)] / maximum_) : 0.0;
}

}  // namespace isobath
