#include <algorithm>
#include <cmath>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <isobath/base/error.hpp>
#include <isobath/perception/plane_shapes.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kLineRounds = 3, kArcRounds = 12;

/// Direction to the nearest point of a line, the foot of the perpendicular from the sonar.
Vector2d nearest_of(const PlaneLine& line) { return -line.normal; }
/// Direction to the nearest point of a circle: towards the centre from outside, away from it from inside.
Vector2d nearest_of(const PlaneArc& arc, const Vector2d& from) {
  return (arc.hollow ? from - arc.centre : arc.centre - from).normalized();
}

struct PlaneMoments {
  double weight = 0;
  Vector2d centre = Vector2d::Zero();
  Matrix2d scatter = Matrix2d::Zero();  ///< about the centre, times the weights
};
PlaneMoments together(const PlaneMoments& a, const PlaneMoments& b) {
  PlaneMoments both;
  both.weight = a.weight + b.weight;
  const Vector2d apart = b.centre - a.centre;
  both.centre = a.centre + b.weight / both.weight * apart;
  both.scatter = a.scatter + b.scatter + a.weight * b.weight / both.weight * apart * apart.transpose();
  return both;
}
PlaneMoments moments_of(const PlaneLine& line) {
  return {
      line.weight, line.centre,
      line.spread * line.along() * line.along().transpose() + line.residual * line.normal * line.normal.transpose()};
}
/// The least-squares line, with its normal on the side of `to`.
PlaneLine line_of(const PlaneMoments& m, const Vector2d& to) {
  const Eigen::SelfAdjointEigenSolver<Matrix2d> axes(m.scatter);
  PlaneLine line;
  line.centre = m.centre;
  line.normal = axes.eigenvectors().col(0);
  if (line.height_of(to) < 0) line.normal = -line.normal;
  line.weight = m.weight;
  line.residual = std::max(0.0, axes.eigenvalues()[0]);
  line.spread = axes.eigenvalues()[1];
  return line;
}

/// x^2 + y^2 = 2 c.p + k, linear in c and k.
std::optional<PlaneArc> algebraic_circle(const PlaneScan& scan, std::span<const std::size_t> echoes) {
  Vector2d mean = Vector2d::Zero();
  for (const std::size_t i : echoes) mean += scan.point(scan.echoes[i]);
  mean /= static_cast<double>(echoes.size());
  Matrix3d normal = Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const std::size_t i : echoes) {
    const Vector2d p = scan.point(scan.echoes[i]) - mean;
    const Vector3d row(2 * p.x(), 2 * p.y(), 1);
    normal += row * row.transpose();
    right += p.squaredNorm() * row;
  }
  const Eigen::FullPivLU<Matrix3d> solver(normal);
  if (solver.rank() < 3) return {};
  const Vector3d x = solver.solve(right);
  PlaneArc arc;
  arc.centre = mean + x.head<2>();
  const double square = x.z() + x.head<2>().squaredNorm();
  if (!(square > 0)) return {};
  arc.radius = std::sqrt(square);
  arc.hollow = (scan.from - arc.centre).norm() < arc.radius;
  return arc;
}

/// Distance of an echo from the circle, its variance, and its gradient.
struct ArcResidual {
  double value, variance;
  Vector2d outward;
};
ArcResidual residual_of(const PlaneScan& scan, const PlaneEcho& echo, const PlaneArc& arc) {
  const Vector2d m = scan.point_towards(echo, nearest_of(arc, scan.from)) - arc.centre;
  const Vector2d u = m.normalized();
  return {m.norm() - arc.radius, scan.variance_along(u, echo), u};
}

void span_of(const PlaneScan& scan, std::span<const std::size_t> echoes, PlaneLine& line) {
  line.begin_m = line.end_m = line.along_of(scan.point_towards(scan.echoes[echoes[0]], nearest_of(line)));
  for (const std::size_t i : echoes) {
    const double s = line.along_of(scan.point_towards(scan.echoes[i], nearest_of(line)));
    line.begin_m = std::min(line.begin_m, s);
    line.end_m = std::max(line.end_m, s);
  }
}

/// The sweep of an arc excludes the widest gap between its echoes, as seen from the centre.
void sweep_of(const PlaneScan& scan, std::span<const std::size_t> echoes, PlaneArc& arc) {
  std::vector<double> at;
  for (const std::size_t i : echoes) {
    const Vector2d p = scan.point_towards(scan.echoes[i], nearest_of(arc, scan.from));
    at.push_back(plan_bearing(p - arc.centre).wrapped_positive().radians());
  }
  std::sort(at.begin(), at.end());
  double gap = at.front() + 2 * std::numbers::pi - at.back();
  arc.first = Angle::radians(at.front());
  for (std::size_t i = 1; i < at.size(); ++i) {
    if (at[i] - at[i - 1] <= gap) continue;
    gap = at[i] - at[i - 1];
    arc.first = Angle::radians(at[i]);
  }
  arc.sweep = Angle::radians(2 * std::numbers::pi - gap);
}

}  // namespace

std::optional<PlaneLine> fit_line(const PlaneScan& scan, std::span<const std::size_t> echoes,
                                  std::span<const double> factors, const PlaneLine* about) {
  ISOBATH_ASSERT(factors.empty() || factors.size() == echoes.size());
  if (echoes.size() < 2) return {};
  std::optional<PlaneLine> line;
  if (about) line = *about;
  for (int round = about ? kLineRounds : 0; round <= kLineRounds; ++round) {
    PlaneMoments sum;
    for (std::size_t k = 0; k < echoes.size(); ++k) {
      const PlaneEcho& echo = scan.echoes[echoes[k]];
      const double factor = factors.empty() ? 1 : factors[k];
      if (!(factor > 0)) continue;
      const double variance =
          line ? scan.variance_along(line->normal, echo) : std::pow(scan.range_sigma(echo.range_m), 2);
      const Vector2d p = line ? scan.point_towards(echo, nearest_of(*line)) : scan.point(echo);
      sum = together(sum, {factor / variance, p, Matrix2d::Zero()});
    }
    if (!(sum.weight > 0)) return {};
    line = line_of(sum, scan.from);
    if (!(line->spread > 1e-9 * line->weight)) return {};
  }
  line->support = static_cast<int>(echoes.size());
  span_of(scan, echoes, *line);
  return line;
}

std::optional<PlaneArc> fit_arc(const PlaneScan& scan, std::span<const std::size_t> echoes, const PlaneArc* about) {
  if (echoes.size() < 4) return {};
  std::optional<PlaneArc> arc = about ? *about : algebraic_circle(scan, echoes);
  if (!arc) return {};
  for (int round = about ? kArcRounds - 2 : 0; round < kArcRounds; ++round) {
    Matrix3d information = Matrix3d::Zero();
    Vector3d right = Vector3d::Zero();
    arc->residual = 0;
    for (const std::size_t i : echoes) {
      const ArcResidual r = residual_of(scan, scan.echoes[i], *arc);
      const Vector3d row(-r.outward.x(), -r.outward.y(), -1);
      information += row * row.transpose() / r.variance;
      right -= row * (r.value / r.variance);
      arc->residual += r.value * r.value / r.variance;
    }
    const Eigen::FullPivLU<Matrix3d> solver(information);
    if (solver.rank() < 3) return {};
    const Vector3d step = solver.solve(right);
    arc->covariance = solver.inverse();
    if (!step.allFinite() || step.norm() > 1e3) return {};
    arc->centre += step.head<2>();
    arc->radius += step.z();
    if (!(arc->radius > 0)) return {};
    arc->hollow = (scan.from - arc->centre).norm() < arc->radius;
    if (step.norm() < 1e-6) break;
  }
  sweep_of(scan, echoes, *arc);
  arc->support = static_cast<int>(echoes.size());
  return arc;
}

double deviation(const PlaneScan& scan, const PlaneEcho& echo, const PlaneLine& line) {
  return line.height_of(scan.point_towards(echo, nearest_of(line))) / std::sqrt(scan.variance_along(line.normal, echo));
}

double deviation(const PlaneScan& scan, const PlaneEcho& echo, const PlaneArc& arc) {
  const ArcResidual r = residual_of(scan, echo, arc);
  return r.value / std::sqrt(r.variance);
}

PlaneLine merged(const PlaneLine& a, const PlaneLine& b) {
  PlaneLine line = line_of(together(moments_of(a), moments_of(b)), a.centre + a.normal);
  if (line.normal.dot(a.normal) < 0) line.normal = -line.normal;
  line.support = a.support + b.support;
  line.begin_m = line.end_m = line.along_of(a.at(a.begin_m));
  for (const Vector2d& end : {a.at(a.begin_m), a.at(a.end_m), b.at(b.begin_m), b.at(b.end_m)}) {
    line.begin_m = std::min(line.begin_m, line.along_of(end));
    line.end_m = std::max(line.end_m, line.along_of(end));
  }
  return line;
}

std::optional<PlaneCorner> corner_of(const PlaneLine& a, const PlaneLine& b, Angle least) {
  Matrix2d normals;
  normals << a.normal.transpose(), b.normal.transpose();
  if (std::abs(normals.determinant()) < sin(least)) return {};
  const Matrix2d inverse = normals.inverse();
  PlaneCorner corner;
  corner.at = inverse * Vector2d(a.normal.dot(a.centre), b.normal.dot(b.centre));
  const Vector2d variances(a.variance_at(a.along_of(corner.at)), b.variance_at(b.along_of(corner.at)));
  corner.covariance = inverse * variances.asDiagonal() * inverse.transpose();
  corner.convex = a.height_of(b.centre) < 0;
  const auto away = [&](const PlaneLine& line) {
    return Vector2d(std::copysign(1.0, -line.along_of(corner.at)) * line.along());
  };
  corner.along = {away(a), away(b)};
  return corner;
}

std::vector<double> factors_near(const PlaneScan& scan, std::span<const std::size_t> echoes, const PlaneLine& line,
                                 const Vector2d& corner) {
  std::vector<double> factors;
  const double to = line.along_of(corner);
  for (const std::size_t i : echoes) {
    const PlaneEcho& echo = scan.echoes[i];
    const Vector2d p = scan.point_towards(echo, nearest_of(line));
    const double squarely = std::abs(line.normal.dot(echo.axis));
    const double wide = echo.range_m * scan.sigma.radians() / std::max(squarely, 0.05);
    factors.push_back(std::min(1.0, std::abs(line.along_of(p) - to) / wide));
  }
  return factors;
}

}  // namespace isobath
