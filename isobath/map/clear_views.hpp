// ClearViews: how far the water was seen to be clear, from the places that the vehicle has looked from. It tells free
// water from water nobody has looked at (ledger S4-12, S4-50), which cells cannot: only what echoed is stored as cells.
//
// A view is a place and, for each direction that was looked at from it, the range up to which nothing was heard. Views
// move with the vehicle as wholes, so that nothing is ever re-binned and no error adds up; a point is clear where any
// view reaches it. A look from within `apart` of the newest view goes into it: a new one begins beyond. The oldest view
// is forgotten for it, and any that is older than is asked for.
//
// Whether something stands in clear water is not asked here: cells say so, and they come first. Frames: axes T of the
// grid, m. `is_clear` looks at each view at most once. One thread.
#pragma once

#include <Eigen/Core>
#include <isobath/base/time.hpp>
#include <isobath/map/spherical_directions.hpp>
#include <vector>

namespace isobath {

class ClearViews {
 public:
  /// `buckets` must outlive it.
  ClearViews(const DirectionBuckets& buckets, int most_views, double apart_m);

  /// From `from`, nothing was heard along the unit vector u and within half_width of it, up to clear_m.
  void look(const Eigen::Vector3d& from, const Eigen::Vector3d& u, Angle half_width, double clear_m, Time time);
  [[nodiscard]] bool is_clear(const Eigen::Vector3d& p) const;
  /// All views of another one, whose directions are the same.
  void copy_from(const ClearViews& other) { views_ = other.views_; }
  /// p' = R p + t of everything.
  void move(const Eigen::Matrix3d& R, const Eigen::Vector3d& t);
  /// Views whose last look was earlier.
  void forget_before(Time time);
  [[nodiscard]] int views() const { return static_cast<int>(views_.size()); }
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct View {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  ///< from T to the axes that the view was begun in
    Time last{};
    std::vector<std::int32_t> rows;  ///< by azimuth, where its elevations start in `clear`; -1: none
    std::vector<float> clear;        ///< m
  };
  View& view_at(const Eigen::Vector3d& from);
  void set(View& view, const SphericalDirection& d, double clear_m) const;

  const DirectionBuckets& buckets_;
  std::size_t most_views_;
  double apart_m_;
  std::vector<View> views_;  ///< the newest last
};

}  // namespace isobath
