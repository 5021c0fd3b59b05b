#include <algorithm>
#include <cmath>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <isobath/geometry/trilateration.hpp>

namespace isobath {
namespace {

constexpr double kFlat = 1e-4;        // of the spread of the transponders, squared
constexpr double kMaxVariance = 1e6;  // of range_sigma^2
constexpr double kSameImage = 1e-6;   // m: the vehicle lies on the mirror plane

/// In the plane (D = 2) at a given depth, or in space (D = 3).
template <int D>
struct Problem {
  using Vector = Eigen::Matrix<double, D, 1>;
  using Matrix = Eigen::Matrix<double, D, D>;

  std::span<const TransponderRange> ranges;
  double depth;

  [[nodiscard]] double out_of_plane(const TransponderRange& r) const { return D == 2 ? depth - r.p_WT.z() : 0; }
  [[nodiscard]] double squared_range(const TransponderRange& r) const {
    return std::max(0.0, r.range * r.range - out_of_plane(r) * out_of_plane(r));
  }
  static Vector place(const TransponderRange& r) { return r.p_WT.head<D>(); }
  [[nodiscard]] double distance(const TransponderRange& r, const Vector& p) const {
    return std::max(std::hypot((p - place(r)).norm(), out_of_plane(r)), 1e-9);
  }
  /// Gradient of the distance by the position.
  [[nodiscard]] Vector gradient(const TransponderRange& r, const Vector& p) const {
    return (p - place(r)) / distance(r, p);
  }

  struct Start {
    Vector p;
    std::optional<Vector> image;
  };
  [[nodiscard]] std::optional<Start> start() const;
  /// Gauss-Newton; returns (J^T J)^-1 if it exists.
  std::optional<Matrix> refine(Vector& p) const;
};

/// Differences of squared ranges are linear in the position. Where the transponders do not span the space, they
/// determine the foot of the vehicle on their line or plane, and the ranges determine its distance from it.
template <int D>
auto Problem<D>::start() const -> std::optional<Start> {
  const Vector first = place(ranges[0]);
  const double range2 = squared_range(ranges[0]);
  Matrix A = Matrix::Zero();
  Vector b = Vector::Zero();
  for (const TransponderRange& r : ranges.subspan(1)) {
    const Vector baseline = place(r) - first;
    A += baseline * baseline.transpose();
    b += baseline * (0.5 * (baseline.squaredNorm() - squared_range(r) + range2));
  }
  const Eigen::SelfAdjointEigenSolver<Matrix> axes(A);  // values in ascending order
  const Vector& values = axes.eigenvalues();
  if (!(values[1] > kFlat * values[D - 1])) return std::nullopt;
  const bool flat = !(values[0] > kFlat * values[D - 1]);
  Start start{first, std::nullopt};
  for (int i = flat ? 1 : 0; i < D; ++i) {
    const Vector axis = axes.eigenvectors().col(i);
    start.p += axis * (axis.dot(b) / values[i]);
  }
  if (!flat) return start;
  double height2 = 0;
  for (const TransponderRange& r : ranges) height2 += squared_range(r) - (start.p - place(r)).squaredNorm();
  height2 = std::max(0.0, height2 / static_cast<double>(ranges.size()));
  const Vector off = axes.eigenvectors().col(0) * std::sqrt(height2);
  start.image = start.p - off;
  start.p += off;
  return start;
}

template <int D>
auto Problem<D>::refine(Vector& p) const -> std::optional<Matrix> {
  constexpr int kIterations = 20;
  Matrix inverse = Matrix::Zero();
  for (int i = 0; i < kIterations; ++i) {
    Matrix JtJ = Matrix::Zero();
    Vector Jte = Vector::Zero();
    for (const TransponderRange& r : ranges) {
      const Vector row = gradient(r, p);
      JtJ += row * row.transpose();
      Jte += row * (r.range - distance(r, p));
    }
    if (!(JtJ.determinant() > 0)) return std::nullopt;
    inverse = JtJ.inverse();
    if (!(inverse.trace() < kMaxVariance)) return std::nullopt;
    const Vector step = inverse * Jte;
    p += step;
    if (step.norm() < 1e-9) break;
  }
  if (!p.allFinite()) return std::nullopt;
  return inverse;
}

template <int D>
void judge_residuals(const Problem<D>& problem, const typename Problem<D>::Vector& p,
                     const typename Problem<D>::Matrix& inverse, const TrilaterationAid& aid, TrilaterationFix& fix) {
  const int spare = fix.ranges - D;
  if (spare <= 0) return;
  double sum = 0, worst = 0;
  for (std::size_t i = 0; i < problem.ranges.size(); ++i) {
    const TransponderRange& r = problem.ranges[i];
    const auto row = problem.gradient(r, p);
    const double error = r.range - problem.distance(r, p);
    sum += error * error;
    const double free = 1 - row.dot(inverse * row);
    if (free < 1e-6) continue;  // no other range checks this one
    const double normalised = std::abs(error) / (aid.range_sigma * std::sqrt(free));
    if (normalised <= worst) continue;
    worst = normalised;
    fix.suspect = i;
  }
  fix.residual = std::sqrt(sum / spare);
  fix.gross = worst > aid.gross;
  if (!fix.gross || spare < 2) fix.suspect.reset();
}

template <int D>
Result<TrilaterationFix, TrilaterationRefusal> solve(const Problem<D>& problem, const TrilaterationAid& aid) {
  if (problem.ranges.size() < D) return tl::unexpected(TrilaterationRefusal::kTooFewRanges);
  const auto start = problem.start();
  if (!start) return tl::unexpected(TrilaterationRefusal::kBadGeometry);
  typename Problem<D>::Vector p = start->p;
  if (start->image && (*start->image - p).norm() > kSameImage) {
    if (!aid.near) return tl::unexpected(TrilaterationRefusal::kMirrorImage);
    const typename Problem<D>::Vector near = aid.near->head<D>();
    if ((near - *start->image).squaredNorm() < (near - p).squaredNorm()) p = *start->image;
  }
  const auto inverse = problem.refine(p);
  if (!inverse) return tl::unexpected(TrilaterationRefusal::kBadGeometry);
  TrilaterationFix fix;
  fix.p_W.z() = problem.depth;
  fix.p_W.template head<D>() = p;
  fix.covariance.template topLeftCorner<D, D>() = *inverse * (aid.range_sigma * aid.range_sigma);
  fix.ranges = static_cast<int>(problem.ranges.size());
  judge_residuals(problem, p, *inverse, aid, fix);
  return fix;
}

}  // namespace

Result<TrilaterationFix, TrilaterationRefusal> trilaterate(std::span<const TransponderRange> ranges,
                                                           const TrilaterationAid& aid) {
  ISOBATH_ASSERT(aid.range_sigma > 0);
  return aid.depth ? solve(Problem<2>{ranges, *aid.depth}, aid) : solve(Problem<3>{ranges, 0}, aid);
}

}  // namespace isobath
