#include <algorithm>
#include <cmath>
#include <isobath/map/spherical/clear_views.hpp>
#include <numbers>

namespace isobath {

ClearViews::ClearViews(const DirectionBuckets& buckets, int max_views, double apart_m)
    : buckets_(buckets), max_views_(static_cast<std::size_t>(max_views)), apart_m_(apart_m) {}

ClearViews::View& ClearViews::view_at(const Eigen::Vector3d& from) {
  if (!views_.empty() && (views_.back().origin - from).squaredNorm() <= apart_m_ * apart_m_) return views_.back();
  if (views_.size() < max_views_) {
    views_.emplace_back();
  } else {
    std::rotate(views_.begin(), views_.begin() + 1, views_.end());  // its arrays are used again
  }
  View& view = views_.back();
  view.origin = from;
  view.rows.assign(static_cast<std::size_t>(buckets_.azimuths()), -1);
  view.clear.clear();
  return view;
}

void ClearViews::set(View& view, const SphericalDirection& d, const View::Clear& clear) const {
  std::int32_t& row = view.rows[static_cast<std::size_t>(d.azimuth)];
  if (row < 0) {
    row = static_cast<std::int32_t>(view.clear.size());
    view.clear.resize(view.clear.size() + static_cast<std::size_t>(buckets_.elevations()));
  }
  view.clear[static_cast<std::size_t>(row) + static_cast<std::size_t>(d.elevation)] = clear;
}

// Sets the bucket of the axis, and those whose middle lies within half the beam's width of it in azimuth and in
// elevation, so that beams one bucket apart leave no gap between them. The clear range is a ray from the vehicle's
// position; seen from the view's own origin it ends at another range, in nearly the same direction.
void ClearViews::look(const Eigen::Vector3d& from, const Eigen::Vector3d& u, Angle half_width, const Stretch& clear,
                      Time time) {
  View& view = view_at(from);
  view.last = time;
  const Eigen::Vector3d end = from + clear.to_m * u - view.origin;
  const double range = end.norm();
  if (!(range > 0) || !(clear.to_m > clear.from_m)) return;
  const SphericalDirection axis = buckets_.at(end);
  // A sensor without a blind zone sees the whole way from the view's origin.
  const double begin = clear.from_m > 0 ? (from + clear.from_m * u - view.origin).norm() : 0;
  const View::Clear stretch{static_cast<float>(begin), static_cast<float>(range)};
  set(view, axis, stretch);
  const double step = buckets_.step().radians(), within = half_width.radians() * 1.01;  // edges that just touch
  const double up = std::atan2(end.z(), end.head<2>().norm()) + 0.5 * std::numbers::pi;
  const double round = std::atan2(end.y(), end.x()) + std::numbers::pi;
  const int n = buckets_.azimuths(), rows = static_cast<int>(within / step + 1);
  for (int e = std::max(0, axis.elevation - rows); e <= std::min(buckets_.elevations() - 1, axis.elevation + rows);
       ++e) {
    if (std::abs((e + 0.5) * step - up) > within) continue;
    const double aside = within / buckets_.cos_elevation(e);
    const int columns = static_cast<int>(std::min(aside / step + 1, 0.5 * n - 1));
    for (int i = -columns; i <= columns; ++i) {
      if (std::abs((axis.azimuth + i + 0.5) * step - round) <= aside) {
        set(view, {(axis.azimuth + i + n) % n, e}, stretch);
      }
    }
  }
}

bool ClearViews::is_clear(const Eigen::Vector3d& p) const {
  for (std::size_t i = views_.size(); i-- > 0;) {
    const View& view = views_[i];
    const Eigen::Vector3d q = p - view.origin;
    const double r2 = q.squaredNorm();
    if (!(r2 > 0)) return true;  // where the vehicle was
    const SphericalDirection d = buckets_.at(q);
    const std::int32_t row = view.rows[static_cast<std::size_t>(d.azimuth)];
    if (row < 0) continue;
    const View::Clear& clear = view.clear[static_cast<std::size_t>(row) + static_cast<std::size_t>(d.elevation)];
    const double r = std::sqrt(r2);
    if (r >= static_cast<double>(clear.from) && r < static_cast<double>(clear.to)) return true;
  }
  return false;
}

void ClearViews::move(const Eigen::Vector3d& t) {
  for (View& view : views_) view.origin += t;
}

void ClearViews::forget_before(Time time) {
  views_.erase(std::remove_if(views_.begin(), views_.end(), [&](const View& view) { return view.last < time; }),
               views_.end());
}

std::size_t ClearViews::bytes() const {
  std::size_t sum = 0;
  for (const View& view : views_) {
    sum += sizeof(View) + view.rows.size() * sizeof(view.rows[0]) + view.clear.size() * sizeof(view.clear[0]);
  }
  return sum;
}

}  // namespace isobath
