#include <algorithm>
#include <cmath>
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <isobath/base/random.hpp>
#include <isobath/stereo/pair_motion.hpp>

namespace isobath {
namespace {

using Eigen::Matrix3d, Eigen::Vector2d, Eigen::Vector3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr int kEdge = Patch::kHalf + 2;
constexpr double kMinTexture = 8;  // grey levels: root of the lesser eigenvalue of the slopes' mean square
constexpr int kTriples = 300;      // random triples
constexpr double kGate = 11.34;    // chi-square, 3 degrees of freedom: 99 %
constexpr double kHuber = 1.5;     // standard deviations
constexpr int kIterations = 15;
constexpr int kApart_px = 3;  // a second place counts from here on

/// How well a patch tells where it is in both directions: Shi and Tomasi 1994.
double texture_at(const CameraImage& grey, int x, int y) {
  double xx = 0, xy = 0, yy = 0;
  for (int j = -Patch::kHalf; j <= Patch::kHalf; ++j) {
    for (int i = -Patch::kHalf; i <= Patch::kHalf; ++i) {
      const double u = grey(x + i + 1, y + j) - grey(x + i - 1, y + j);
      const double v = grey(x + i, y + j + 1) - grey(x + i, y + j - 1);
      xx += u * u;
      xy += u * v;
      yy += v * v;
    }
  }
  const double half = (xx + yy) / 2, root = std::hypot((xx - yy) / 2, xy);
  return std::sqrt(std::max(0.0, half - root) / Patch::kPixels);
}

struct PointPair {
  Vector3d p_K, p_N;
  Matrix3d covariance_K, covariance_N;
};

class MotionSearch {
 public:
  MotionSearch(const CameraImage& grey, const DisparityMap& map, const PairGeometry& geometry, double sigma_disparity,
               const PairMotionConfig& config)
      : grey_(grey), map_(map), geometry_(geometry), sigma_disparity_(sigma_disparity), config_(config) {}

  /// The points that are found again.
  [[nodiscard]] std::vector<PointPair> pairs(const MotionKey& key, const Pose& X_KN) const {
    std::vector<PointPair> pairs;
    const Pose X_NK = X_KN.inverse();
    const RectifiedPair& camera = geometry_.pair();
    for (const MotionKey::Point& point : key.points()) {
      const Vector3d p = X_NK * point.p_K;
      if (!(p.z() > 0.05)) continue;
      const Vector2d at(camera.cx + camera.focal_px * p.x() / p.z(), camera.cy + camera.focal_px * p.y() / p.z());
      const auto place = find(point.patch, at);
      if (!place) continue;
      const auto p_N = point_at(*place);
      if (p_N) pairs.push_back({point.p_K, *p_N, covariance(point.p_K), covariance(*p_N)});
    }
    return pairs;
  }

 private:
  [[nodiscard]] std::optional<Vector2d> find(const Patch& wanted, const Vector2d& at) const {
    const int n = config_.reach_px, side = 2 * n + 1;
    const int x0 = static_cast<int>(std::lround(at.x())) - n, y0 = static_cast<int>(std::lround(at.y())) - n;
    std::vector<double> score(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), -1);
    const auto score_at = [&](int i, int j) -> double& {
      return score[static_cast<std::size_t>(j) * static_cast<std::size_t>(side) + static_cast<std::size_t>(i)];
    };
    Patch patch;
    int bi = 0, bj = 0;
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        if (!patch_at(grey_, Vector2d(x0 + i, y0 + j), patch)) continue;
        score_at(i, j) = correlation(wanted, patch);
        if (score_at(i, j) > score_at(bi, bj)) {
          bi = i;
          bj = j;
        }
      }
    }
    const double best = score_at(bi, bj);
    if (best < config_.min_correlation || bi == 0 || bj == 0 || bi + 1 == side || bj + 1 == side) return {};
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        const bool apart = std::max(std::abs(i - bi), std::abs(j - bj)) > kApart_px;
        if (apart && score_at(i, j) > best - config_.uniqueness) return {};
      }
    }
    const auto peak = [best](double before, double after) {
      const double bend = before - 2 * best + after;
      return bend < 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
    };
    return Vector2d(x0 + bi + peak(score_at(bi - 1, bj), score_at(bi + 1, bj)),
                    y0 + bj + peak(score_at(bi, bj - 1), score_at(bi, bj + 1)));
  }

  [[nodiscard]] std::optional<Vector3d> point_at(const Vector2d& place) const {
    const int x = static_cast<int>(std::lround(place.x())), y = static_cast<int>(std::lround(place.y()));
    if (x < 0 || y < 0 || x >= map_.width || y >= map_.height || !std::isfinite(map_(x, y))) return {};
    return geometry_.point(place.x(), place.y(), map_(x, y));
  }

  [[nodiscard]] Matrix3d covariance(const Vector3d& p) const {
    const Vector3d along = p / p.z();
    const double across = p.z() * config_.sigma_px / geometry_.pair().focal_px;
    const double deep = geometry_.sigma_z(p.z(), sigma_disparity_);
    return Matrix3d(Vector3d(across * across, across * across, 1e-10).asDiagonal()) +
           deep * deep * along * along.transpose();
  }

  const CameraImage& grey_;
  const DisparityMap& map_;
  const PairGeometry& geometry_;
  double sigma_disparity_;
  const PairMotionConfig& config_;
};

/// Squared distance of a pair from a motion, in standard deviations.
double departure(const PointPair& pair, const Pose& X_KN) {
  const Matrix3d R = X_KN.rotation.matrix();
  const Vector3d r = pair.p_K - X_KN * pair.p_N;
  return r.dot((pair.covariance_K + R * pair.covariance_N * R.transpose()).ldlt().solve(r));
}

std::vector<PointPair> agreeing(const std::vector<PointPair>& pairs, const Pose& X_KN) {
  std::vector<PointPair> inliers;
  for (const PointPair& pair : pairs) {
    if (departure(pair, X_KN) < kGate) inliers.push_back(pair);
  }
  return inliers;
}

/// The motion of three pairs (Umeyama 1991).
Pose motion_of(const PointPair& a, const PointPair& b, const PointPair& c) {
  Matrix3d from, to;
  from << a.p_N, b.p_N, c.p_N;
  to << a.p_K, b.p_K, c.p_K;
  const Eigen::Matrix4d T = Eigen::umeyama(from, to, false);
  const Matrix3d R = T.topLeftCorner<3, 3>();
  return {Rotation::from_matrix(R), T.topRightCorner<3, 1>()};
}

/// The motion that most pairs agree with: the guess, or that of a triple.
std::vector<PointPair> consensus(const std::vector<PointPair>& pairs, Pose& X_KN) {
  std::vector<PointPair> best = agreeing(pairs, X_KN);
  Random random(20);
  for (int k = 0; k < kTriples; ++k) {
    const auto a = random.index(pairs.size()), b = random.index(pairs.size()), c = random.index(pairs.size());
    if (a == b || b == c || a == c) continue;
    const Pose motion = motion_of(pairs[a], pairs[b], pairs[c]);
    if (!motion.is_finite()) continue;
    std::vector<PointPair> inliers = agreeing(pairs, motion);
    if (inliers.size() <= best.size()) continue;
    best = std::move(inliers);
    X_KN = motion;
  }
  return best;
}

Matrix3d cross_matrix(const Vector3d& v) {
  return (Matrix3d() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
}

/// Gauss-Newton on (t, rotation vector in K). Returns the information.
Matrix6 refine(const std::vector<PointPair>& inliers, const MotionGuess& guess, Pose& X_KN) {
  Matrix6 H;
  for (int k = 0; k < kIterations; ++k) {
    H.setZero();
    Vector6 g = Vector6::Zero();
    const Matrix3d R = X_KN.rotation.matrix();
    for (const PointPair& pair : inliers) {
      const Vector3d turned = R * pair.p_N, r = pair.p_K - turned - X_KN.translation;
      const Matrix3d W = (pair.covariance_K + R * pair.covariance_N * R.transpose()).inverse();
      const double off = std::sqrt(r.dot(W * r)), weight = off > kHuber ? kHuber / off : 1;
      Eigen::Matrix<double, 3, 6> J;
      J << Matrix3d::Identity(), -cross_matrix(turned);
      H += weight * J.transpose() * W * J;
      g += weight * J.transpose() * W * r;
    }
    if (guess.sigma_rotation > 0) {
      const double w = 1 / (guess.sigma_rotation * guess.sigma_rotation);
      H.bottomRightCorner<3, 3>() += w * Matrix3d::Identity();
      g.tail<3>() += w * (guess.X_KN.rotation * X_KN.rotation.inverse()).log();
    }
    const Vector6 step = H.ldlt().solve(g);
    if (!step.allFinite()) break;
    X_KN = {Rotation::exp(step.tail<3>()) * X_KN.rotation, X_KN.translation + step.head<3>()};
    if (step.norm() < 1e-9) break;
  }
  return H;
}

}  // namespace

std::vector<Field> fields(PairMotionConfig& c) {
  return {
      Field::integer("max_points", &c.max_points, {12, 5000}, "",
                     "Points of a pair that are looked for in later ones."),
      Field::integer("reach_px", &c.reach_px, {2, 200}, "pixels",
                     "How far about its expected place a point is looked for; the time grows with its square."),
      Field::real("min_correlation", &c.min_correlation, {0, 1}, "1", "Least correlation of a point that is found."),
      Field::real("point_uniqueness", &c.uniqueness, {0, 1}, "1",
                  "By how much a second place must correlate less; more leaves out repeated texture."),
      Field::real("sigma_px", &c.sigma_px, {0.01, 10}, "pixels", "Standard deviation of the place of a point."),
      Field::integer("min_inliers", &c.min_inliers, {6, 5000}, "", "Points that must agree with a motion."),
      Field::real("min_inlier_share", &c.min_inlier_share, {0, 1}, "1",
                  "Share of the points found that must agree with a motion."),
  };
}

MotionKey::MotionKey(const CameraImage& grey, const DisparityMap& map, const PairGeometry& geometry,
                     const PairMotionConfig& config) {
  // One point a cell, where it has most texture.
  const double area = static_cast<double>(grey.width) * grey.height / config.max_points;
  const int cell = std::max(4, static_cast<int>(std::lround(std::sqrt(area))));
  for (int y0 = kEdge; y0 + cell <= grey.height - kEdge; y0 += cell) {
    for (int x0 = kEdge; x0 + cell <= grey.width - kEdge; x0 += cell) {
      double most = kMinTexture;
      Vector2d at(-1, -1);
      for (int y = y0; y < y0 + cell; y += 2) {
        for (int x = x0; x < x0 + cell; x += 2) {
          if (!std::isfinite(map(x, y))) continue;
          const double texture = texture_at(grey, x, y);
          if (texture <= most) continue;
          most = texture;
          at = {x, y};
        }
      }
      if (at.x() < 0) continue;
      const auto p = geometry.point(at.x(), at.y(), map(static_cast<int>(at.x()), static_cast<int>(at.y())));
      Point point{at, {0, 0, 0}, {}};
      if (!p || !patch_at(grey, at, point.patch)) continue;
      point.p_K = *p;
      points_.push_back(point);
    }
  }
}

double MotionKey::median_range_m() const {
  if (points_.empty()) return 0;
  std::vector<double> all;
  for (const Point& point : points_) all.push_back(point.p_K.norm());
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return *middle;
}

std::optional<PairMotion> pair_motion(const MotionKey& key, const CameraImage& grey, const DisparityMap& map,
                                      const PairGeometry& geometry, double sigma_disparity, const MotionGuess& guess,
                                      const PairMotionConfig& config) {
  const MotionSearch search(grey, map, geometry, sigma_disparity, config);
  const std::vector<PointPair> pairs = search.pairs(key, guess.X_KN);
  if (static_cast<int>(pairs.size()) < config.min_inliers) return {};
  PairMotion motion;
  motion.X_KN = guess.X_KN;
  std::vector<PointPair> inliers = consensus(pairs, motion.X_KN);
  refine(inliers, guess, motion.X_KN);
  inliers = agreeing(pairs, motion.X_KN);  // the refined motion has more of them
  motion.found = static_cast<int>(pairs.size());
  motion.inliers = static_cast<int>(inliers.size());
  if (motion.inliers < config.min_inliers || motion.inliers < config.min_inlier_share * motion.found) return {};
  motion.covariance = refine(inliers, guess, motion.X_KN).inverse();
  if (!motion.X_KN.is_finite() || !motion.covariance.allFinite()) return {};
  return motion;
}

}  // namespace isobath
