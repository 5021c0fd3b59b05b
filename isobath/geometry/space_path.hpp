// SpacePath: a smooth curve in space by its arc length, with a frame that moves along it without a jump.
//
// A curve is given as a function of any parameter u, with its first three derivatives. The parameter does not measure
// distance (ledger S5-E15): arc length s is found by Gauss-Legendre quadrature and inverted by Newton's method. Beyond
// its ends the path continues straight.
//
// Frames F, columns of R_WF, have their first axis T along the path. All frames obey, with ' = d/ds,
//   T' = k1 N + k2 B,   N' = -k1 T + torsion B,   B' = -k2 T - torsion N.
// Serret-Frenet: k1 the curvature, k2 = 0 (S5-49); undefined on straights, and it jumps at inflections.
// Rotation-minimising: torsion = 0, two curvatures; continuous along any smooth path (Bishop 1975; S5-55). It begins
// with N level to starboard and B as near to down as T allows, and is propagated by double reflection (Wang, Juettler,
// Zheng, Liu 2008).
//
// Lengths in m, curvatures in 1/m. Accuracy: s to 1e-9 of the length, the rotation-minimising frame to 1e-8 rad a metre
// for radii above a metre. Construction costs about 1 us a sample, and so does a query. Nothing changes after
// construction; queries do not allocate.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <isobath/geometry/pose.hpp>
#include <optional>
#include <vector>

namespace isobath {

/// A point of a curve and its derivatives by the curve's parameter.
struct CurveJet {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Vector3d d1 = Eigen::Vector3d::Zero();
  Eigen::Vector3d d2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d d3 = Eigen::Vector3d::Zero();
};

/// The same curve in another frame.
CurveJet operator*(const Pose& X_WL, const CurveJet& jet_L);

/// A frame of a path at one of its points.
struct PathFrame {
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  Eigen::Matrix3d R_WF = Eigen::Matrix3d::Identity();  ///< columns T, N, B
  double k1 = 0, k2 = 0;                               ///< 1/m, towards N and towards B
  double torsion = 0;                                  ///< 1/m

  [[nodiscard]] Eigen::Vector3d tangent() const { return R_WF.col(0); }
  /// Angular velocity of F in W per metre of path, components in F, rad/m.
  [[nodiscard]] Eigen::Vector3d turn_F() const { return {torsion, -k2, k1}; }
};

/// Serret-Frenet frame; empty where the curve is straight (curvature below 1e-9 / m) or its derivative is zero.
std::optional<PathFrame> frenet_frame(const CurveJet& jet);

class SpacePath {
 public:
  using Curve = std::function<CurveJet(double u)>;

  /// From u_begin up to u_end. `step_m`: approximate distance between the samples along which the frame is propagated,
  /// at most a quarter of the minimum radius. Throws Error where the curve's derivative is zero or not finite.
  SpacePath(Curve curve, double u_begin, double u_end, double step_m = 0.25);

  [[nodiscard]] double length() const { return samples_.back().s; }
  [[nodiscard]] double u_begin() const { return samples_.front().u; }
  [[nodiscard]] double u_end() const { return samples_.back().u; }
  /// The parameter of an arc length; clamped at the ends.
  [[nodiscard]] double parameter_at(double s) const;
  /// The curve itself, at the parameter.
  [[nodiscard]] CurveJet jet_at(double s) const { return curve_(parameter_at(s)); }
  /// Rotation-minimising frame.
  [[nodiscard]] PathFrame frame_at(double s) const;

 private:
  struct Sample {
    double u = 0, s = 0;
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    Eigen::Vector3d tangent = Eigen::Vector3d::UnitX(), normal = Eigen::Vector3d::UnitY();
  };
  [[nodiscard]] std::size_t sample_before(double s) const;
  [[nodiscard]] double way(double u_from, double u_to) const;

  Curve curve_;
  std::vector<Sample> samples_;
};

}  // namespace isobath
