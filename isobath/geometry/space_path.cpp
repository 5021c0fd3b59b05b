#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/geometry/space_path.hpp>

namespace isobath {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kStraight = 1e-9;  // 1/m

// Gauss-Legendre with five points on [-1, 1].
constexpr std::array<double, 5> kNode{-0.906179845938663993, -0.538469310105683091, 0, 0.538469310105683091,
                                      0.906179845938663993};
constexpr std::array<double, 5> kWeight{0.236926885056189088, 0.478628670499366468, 0.568888888888888889,
                                        0.478628670499366468, 0.236926885056189088};

Vector3d mirrored(const Vector3d& v, const Vector3d& across) {
  const double c = across.squaredNorm();
  return c > 0 ? Vector3d(v - 2 / c * across.dot(v) * across) : v;
}

/// One step of the double reflection: carries N from (p0, T0) to (p1, T1).
Vector3d carried_normal(const Vector3d& p0, const Vector3d& tangent0, const Vector3d& normal0, const Vector3d& p1,
                        const Vector3d& tangent1) {
  const Vector3d chord = p1 - p0;
  const Vector3d normal = mirrored(normal0, chord), tangent = mirrored(tangent0, chord);
  const Vector3d carried = mirrored(normal, tangent1 - tangent);
  return (carried - tangent1.dot(carried) * tangent1).normalized();  // keeps rounding errors from accumulating
}

/// T' by arc length, from the derivatives by the parameter.
Vector3d bend_of(const CurveJet& jet) {
  const double w2 = jet.d1.squaredNorm();
  return (jet.d2 - jet.d1.dot(jet.d2) / w2 * jet.d1) / w2;
}

Matrix3d columns(const Vector3d& tangent, const Vector3d& normal) {
  Matrix3d R;
  R << tangent, normal, tangent.cross(normal);
  return R;
}

}  // namespace

CurveJet operator*(const Pose& X_WL, const CurveJet& jet_L) {
  const Rotation& R_WL = X_WL.rotation;
  return {X_WL * jet_L.p, R_WL * jet_L.d1, R_WL * jet_L.d2, R_WL * jet_L.d3};
}

std::optional<PathFrame> frenet_frame(const CurveJet& jet) {
  const double w = jet.d1.norm();
  const Vector3d c = jet.d1.cross(jet.d2);
  const double curvature = c.norm() / (w * w * w);
  if (!(curvature > kStraight)) return std::nullopt;
  const Vector3d tangent = jet.d1 / w;
  return PathFrame{jet.p, columns(tangent, c.normalized().cross(tangent)), curvature, 0,
                   c.dot(jet.d3) / c.squaredNorm()};
}

SpacePath::SpacePath(Curve curve, double u_begin, double u_end, double step_m) : curve_(std::move(curve)) {
  if (!(u_end > u_begin) || !(step_m > 0)) throw Error("a path in space has no length");
  double rough = 0;
  constexpr int kRough = 64;
  for (int i = 0; i < kRough; ++i) {
    const double step = (u_end - u_begin) / kRough;
    rough += way(u_begin + i * step, u_begin + (i + 1) * step);
  }
  if (!std::isfinite(rough) || !(rough > 0)) throw Error("a path in space has no length");
  const int count = std::max(1, static_cast<int>(std::ceil(rough / step_m)));
  samples_.reserve(static_cast<std::size_t>(count) + 1);
  double s = 0;
  for (int i = 0; i <= count; ++i) {
    const double u = u_begin + (u_end - u_begin) * i / count;
    const CurveJet jet = curve_(u);
    if (!jet.p.allFinite() || !(jet.d1.norm() > 1e-12)) {
      throw Error("a path in space has a zero or non-finite derivative at its parameter " + std::to_string(u));
    }
    if (i > 0) s += way(samples_.back().u, u);
    Sample next{u, s, jet.p, jet.d1.normalized(), {}};
    if (i == 0) {
      const Vector3d level = Vector3d::UnitZ().cross(next.tangent);
      next.normal = level.norm() > 1e-6 ? level.normalized() : Vector3d(Vector3d::UnitY());
    } else {
      const Sample& last = samples_.back();
      next.normal = carried_normal(last.p, last.tangent, last.normal, next.p, next.tangent);
    }
    samples_.push_back(next);
  }
}

double SpacePath::way(double u_from, double u_to) const {
  const double half = 0.5 * (u_to - u_from), middle = 0.5 * (u_to + u_from);
  double sum = 0;
  for (std::size_t i = 0; i < kNode.size(); ++i) sum += kWeight[i] * curve_(middle + half * kNode[i]).d1.norm();
  return half * sum;
}

std::size_t SpacePath::sample_before(double s) const {
  const auto after =
      std::upper_bound(samples_.begin(), samples_.end(), s, [](double at, const Sample& x) { return at < x.s; });
  const auto index = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - samples_.begin() - 1, 0));
  return std::min(index, samples_.size() - 2);
}

double SpacePath::parameter_at(double s) const {
  if (s <= 0) return u_begin();
  if (s >= length()) return u_end();
  const Sample& from = samples_[sample_before(s)];
  const Sample& to = samples_[sample_before(s) + 1];
  double u = from.u + (to.u - from.u) * (s - from.s) / (to.s - from.s);
  for (int i = 0; i < 8; ++i) {
    const double step = (s - from.s - way(from.u, u)) / curve_(u).d1.norm();
    u = std::clamp(u + step, from.u, to.u);
    if (std::abs(step) < 1e-13 * (1 + std::abs(u))) break;
  }
  return u;
}

PathFrame SpacePath::frame_at(double s) const {
  const double within = std::clamp(s, 0.0, length());
  const Sample& from = samples_[sample_before(within)];
  const CurveJet jet = jet_at(within);
  const Vector3d tangent = jet.d1.normalized();
  PathFrame frame;
  frame.R_WF = columns(tangent, carried_normal(from.p, from.tangent, from.normal, jet.p, tangent));
  frame.p_W = jet.p + (s - within) * tangent;
  if (s != within) return frame;
  const Vector3d bend = bend_of(jet);
  frame.k1 = bend.dot(frame.R_WF.col(1));
  frame.k2 = bend.dot(frame.R_WF.col(2));
  return frame;
}

}  // namespace isobath
