// ClearViews: keeps, for each place from which the vehicle has looked, the ranges between which the water was clear in
// each direction. It tells free water from water that was never observed (ledger S4-12, S4-50). The cells of the grid
// cannot tell this, because only echoes create cells.
//
// A view is a place and, for each direction that was observed from it, the stretch of ranges without an echo. Views
// move rigidly with the vehicle, so that nothing is ever re-binned and no error accumulates. A point is clear where any
// view reaches it. A look from within `apart` of the newest view goes into that view; a look from farther away begins a
// new view. A new view replaces the oldest one when all are in use; views older than a given time are forgotten on
// request.
//
// This class does not hold obstacles. The cells of the grid hold them and take precedence: a point with an occupied
// cell is not free, even if a view reaches it. Positions are in the axes T of the grid, m. `is_clear` examines each
// view at most once. One thread at a time.
#pragma once

#include <Eigen/Core>
#include <isobath/base/time.hpp>
#include <isobath/map/spherical/spherical_directions.hpp>
#include <vector>

namespace isobath {

class ClearViews {
 public:
  /// `buckets` must outlive this object.
  ClearViews(const DirectionBuckets& buckets, int max_views, double apart_m);

  /// A part of a beam in which there was no echo, m from the sensor.
  struct Stretch {
    double from_m = 0;  ///< end of the sensor's blind zone
    double to_m = 0;
  };
  /// From `from`, there was no echo along the unit vector u and within half_width of it, on this stretch.
  void look(const Eigen::Vector3d& from, const Eigen::Vector3d& u, Angle half_width, const Stretch& clear, Time time);
  [[nodiscard]] bool is_clear(const Eigen::Vector3d& p) const;
  /// Copies all views of another object that has the same directions.
  void copy_from(const ClearViews& other) { views_ = other.views_; }
  /// Applies p' = p + t to all views.
  void move(const Eigen::Vector3d& t);
  /// Removes views whose last look was earlier than `time`.
  void forget_before(Time time);
  [[nodiscard]] int views() const { return static_cast<int>(views_.size()); }
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct View {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    Time last{};
    std::vector<std::int32_t> rows;  ///< by azimuth: where its elevations start in `clear`; -1: none
    struct Clear {
      float from = 0, to = 0;  ///< m from `origin`
    };
    std::vector<Clear> clear;
  };
  View& view_at(const Eigen::Vector3d& from);
  void set(View& view, const SphericalDirection& d, const View::Clear& clear) const;

  const DirectionBuckets& buckets_;
  std::size_t max_views_;
  double apart_m_;
  std::vector<View> views_;  ///< the newest last
};

}  // namespace isobath
