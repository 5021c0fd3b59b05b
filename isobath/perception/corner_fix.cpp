#include <algorithm>
#include <cmath>
#include <Eigen/LU>
#include <isobath/perception/corner_fix.hpp>

namespace isobath {

using Eigen::Matrix2d;
using Eigen::Vector2d;

namespace {

constexpr double kSame_m = 1e-3;    // distance of the ends of two walls that meet
constexpr double kLeastWall_m = 2;  // a shorter one gives too few echoes for a line
const Angle kSameFace = Angle::degrees(20);
const double kSharpest = cos(Angle::degrees(20));  // of the angle between the walls of a corner

/// One end of a wall, and the direction of the wall from there.
struct WallEnd {
  Vector2d at, along;
};

bool same_faces(const std::array<Vector2d, 2>& a, const std::array<Vector2d, 2>& b) {
  const double least = cos(kSameFace);
  return (a[0].dot(b[0]) >= least && a[1].dot(b[1]) >= least) || (a[0].dot(b[1]) >= least && a[1].dot(b[0]) >= least);
}

void add_corner(const WallEnd& a, const WallEnd& b, std::vector<ChartedCorner>& corners) {
  const ChartedCorner corner{a.at, {a.along, b.along}};
  if (std::abs(a.along.dot(b.along)) > kSharpest) return;
  for (auto other = corners.rbegin(); other != corners.rend() && corner.at.x() - other->at.x() < kSame_m; ++other) {
    if ((other->at - corner.at).norm() < kSame_m && same_faces(other->along, corner.along)) return;
  }
  corners.push_back(corner);
}

}  // namespace

std::vector<ChartedCorner> corners_of(std::span<const ChartedWall> walls) {
  std::vector<WallEnd> ends;
  for (const ChartedWall& wall : walls) {
    const Vector2d way = wall.b - wall.a;
    if (!(way.norm() >= kLeastWall_m)) continue;
    ends.push_back({wall.a, way.normalized()});
    ends.push_back({wall.b, -way.normalized()});
  }
  std::stable_sort(ends.begin(), ends.end(), [](const WallEnd& a, const WallEnd& b) { return a.at.x() < b.at.x(); });
  std::vector<ChartedCorner> corners;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    for (std::size_t k = i + 1; k < ends.size() && ends[k].at.x() - ends[i].at.x() < kSame_m; ++k) {
      if ((ends[k].at - ends[i].at).norm() < kSame_m) add_corner(ends[i], ends[k], corners);
    }
  }
  return corners;
}

std::optional<CornerFix> corner_fix(const PlanePosition& believed, std::span<const PlaneCorner> seen,
                                    std::span<const ChartedCorner> charted, Angle heading_sigma, double gate) {
  CornerFix fix;
  Matrix2d information = Matrix2d::Zero();
  Vector2d weighted = Vector2d::Zero();
  for (const PlaneCorner& corner : seen) {
    const Vector2d sight = corner.at - believed.at, across = Vector2d(-sight.y(), sight.x()) * heading_sigma.radians();
    const Matrix2d covariance = corner.covariance + across * across.transpose();
    const Matrix2d together = (covariance + believed.covariance).inverse();
    const ChartedCorner* match = nullptr;
    int fitting = 0;
    for (const ChartedCorner& place : charted) {
      const Vector2d off = place.at - corner.at;
      if (off.dot(together * off) > gate * gate || !same_faces(place.along, corner.along)) continue;
      match = &place;
      ++fitting;
    }
    if (fitting != 1) continue;
    information += covariance.inverse();
    weighted += covariance.inverse() * (match->at - corner.at);
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
