#include <Eigen/LU>
#include <isobath/perception/corner_fix.hpp>

namespace isobath {

using Eigen::Matrix2d;
using Eigen::Vector2d;

std::optional<CornerFix> corner_fix(const PlanePosition& believed, std::span<const PlaneCorner> seen,
                                    std::span<const Vector2d> charted, Angle heading_sigma, double gate) {
  CornerFix fix;
  Matrix2d information = Matrix2d::Zero();
  Vector2d weighted = Vector2d::Zero();
  for (const PlaneCorner& corner : seen) {
    const Vector2d sight = corner.at - believed.at, across = Vector2d(-sight.y(), sight.x()) * heading_sigma.radians();
    const Matrix2d covariance = corner.covariance + across * across.transpose();
    const Matrix2d together = (covariance + believed.covariance).inverse();
    const Vector2d* match = nullptr;
    int fitting = 0;
    for (const Vector2d& place : charted) {
      const Vector2d off = place - corner.at;
      if (off.dot(together * off) > gate * gate) continue;
      match = &place;
      ++fitting;
    }
    if (fitting != 1) continue;
    information += covariance.inverse();
    weighted += covariance.inverse() * (*match - corner.at);
    ++fix.corners;
  }
  if (fix.corners == 0) return {};
  fix.covariance = information.inverse();
  fix.at = believed.at + fix.covariance * weighted;
  return fix;
}

PlanePosition fused(const PlanePosition& a, const PlanePosition& b) {
  const Matrix2d gain = a.covariance * (a.covariance + b.covariance).inverse();
  return {a.at + gain * (b.at - a.at), (Matrix2d::Identity() - gain) * a.covariance};
}

}  // namespace isobath
