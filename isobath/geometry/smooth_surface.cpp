#include <algorithm>
#include <cmath>
#include <Eigen/Cholesky>
#include <functional>
#include <isobath/base/error.hpp>
#include <isobath/geometry/smooth_surface.hpp>
#include <unordered_map>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

std::vector<Vector2d> places(const std::vector<SurveyPoint>& soundings) {
  std::vector<Vector2d> points(soundings.size());
  std::transform(soundings.begin(), soundings.end(), points.begin(), [](const SurveyPoint& s) { return s.north_east; });
  return points;
}

/// A neighbour of a node: its offset in units of the farthest neighbour's distance, and its rise.
struct Neighbour {
  Vector2d at;
  double rise;
};

/// Slope at the origin of the quadratic through the origin that best fits the neighbours. Second derivatives are damped
/// by a millionth, so that points in a row leave them at zero; planes are not affected.
Vector2d slope_of_quadratic(const std::vector<Neighbour>& neighbours) {
  using Vector5d = Eigen::Matrix<double, 5, 1>;
  using Matrix5d = Eigen::Matrix<double, 5, 5>;
  Matrix5d normal = Matrix5d::Zero();
  Vector5d right = Vector5d::Zero();
  for (const Neighbour& n : neighbours) {
    const double x = n.at.x(), y = n.at.y();
    Vector5d row;
    row << x, y, x * x, x * y, y * y;
    const double weight = 1 / (n.at.squaredNorm() + 0.1);  // flat near the node: close pairs must not set the slope
    normal += weight * row * row.transpose();
    right += weight * n.rise * row;
  }
  const double damping = 1e-6 * normal.diagonal().maxCoeff();
  for (int k = 2; k < 5; ++k) normal(k, k) += damping;
  return normal.ldlt().solve(right).head<2>();
}

/// A cubic over one third of a triangle, by its ten Bezier ordinates: b[i][j] belongs to a^i b^j s^(3-i-j).
struct Cubic {
  double b[4][4];

  /// Value and derivatives by the three barycentric coordinates.
  void evaluate(const Vector3d& w, double& value, Vector3d& derivative) const {
    double q[3][3] = {};  // after one step of de Casteljau: degree 2
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; i + j < 3; ++j) q[i][j] = w[0] * b[i + 1][j] + w[1] * b[i][j + 1] + w[2] * b[i][j];
    }
    double l[2][2] = {};
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; i + j < 2; ++j) l[i][j] = w[0] * q[i + 1][j] + w[1] * q[i][j + 1] + w[2] * q[i][j];
    }
    value = w[0] * l[1][0] + w[1] * l[0][1] + w[2] * l[0][0];
    derivative = 3 * Vector3d(l[1][0], l[0][1], l[0][0]);
  }
};

/// One triangle of the surface: corners relative to the centroid, values and slopes there.
struct Macro {
  Vector2d v[3];
  double f[3];
  Vector2d g[3];

  /// Ordinate next to the centre of side k (the one that faces corner k): the slope across the side is linear.
  [[nodiscard]] double beside(int k) const {
    const int a = (k + 1) % 3, b = (k + 2) % 3;
    const Vector2d side = v[b] - v[a];
    const double t = -v[a].dot(side) / side.squaredNorm();  // foot of the centroid on the side
    const double ab = f[a] + g[a].dot(side) / 3, ba = f[b] - g[b].dot(side) / 3;
    const double as = f[a] - g[a].dot(v[a]) / 3, bs = f[b] - g[b].dot(v[b]) / 3;
    const double at_a = as - (1 - t) * f[a] - t * ab;
    const double at_b = bs - (1 - t) * ba - t * f[b];
    return (at_a + at_b) / 2 + (1 - t) * ab + t * ba;
  }

  /// The cubic of the third at side k; corners a, b, centroid.
  [[nodiscard]] Cubic third(int k) const {
    const double m[3] = {beside(0), beside(1), beside(2)};
    double spoke[3], inner[3], centre = 0;
    for (int i = 0; i < 3; ++i) spoke[i] = f[i] - g[i].dot(v[i]) / 3;
    for (int i = 0; i < 3; ++i) {
      inner[i] = (m[(i + 1) % 3] + m[(i + 2) % 3] + spoke[i]) / 3;
      centre += inner[i] / 3;
    }
    const int a = (k + 1) % 3, b = (k + 2) % 3;
    const Vector2d side = v[b] - v[a];
    Cubic c{};
    c.b[3][0] = f[a];
    c.b[0][3] = f[b];
    c.b[0][0] = centre;
    c.b[2][1] = f[a] + g[a].dot(side) / 3;
    c.b[1][2] = f[b] - g[b].dot(side) / 3;
    c.b[2][0] = spoke[a];
    c.b[0][2] = spoke[b];
    c.b[1][0] = inner[a];
    c.b[0][1] = inner[b];
    c.b[1][1] = m[k];
    return c;
  }
};

}  // namespace

std::vector<SurveyPoint> merged(std::span<const SurveyPoint> soundings, double cell_m, Merge how) {
  struct Square {
    double x, y;
    bool operator==(const Square&) const = default;
  };
  const auto hash = [](const Square& s) { return std::hash<double>()(s.x) * 31 + std::hash<double>()(s.y); };
  std::unordered_map<Square, std::size_t, decltype(hash)> index(soundings.size(), hash);
  std::vector<SurveyPoint> result;
  std::vector<double> count;
  for (const SurveyPoint& s : soundings) {
    Square square{s.north_east.x() + 0.0, s.north_east.y() + 0.0};  // -0 and 0 are the same place
    if (cell_m > 0) square = {std::floor(square.x / cell_m) + 0.0, std::floor(square.y / cell_m) + 0.0};
    const auto [found, fresh] = index.emplace(square, result.size());
    if (fresh) {
      result.push_back(s);
      count.push_back(1);
      continue;
    }
    SurveyPoint& kept = result[found->second];
    if (how == Merge::kShoalest) {
      if (s.depth_m < kept.depth_m) kept = s;
    } else {
      const double share = 1 / ++count[found->second];
      if (cell_m > 0) kept.north_east += share * (s.north_east - kept.north_east);
      kept.depth_m += share * (s.depth_m - kept.depth_m);
    }
  }
  return result;
}

SmoothSurface::SmoothSurface(std::vector<SurveyPoint> soundings)
    : soundings_(std::move(soundings)), triangulation_(places(soundings_)) {
  estimate_gradients();
}

SmoothSurface::SmoothSurface(std::vector<SurveyPoint> soundings, std::vector<Vector2d> gradients)
    : soundings_(std::move(soundings)), triangulation_(places(soundings_)), gradients_(std::move(gradients)) {
  ISOBATH_ASSERT(gradients_.size() == soundings_.size());
}

// Uses the neighbours and their neighbours: these rings of the triangulation extend to the next survey line, where the
// nearest points would all lie on one line.
void SmoothSurface::estimate_gradients() {
  gradients_.assign(soundings_.size(), Vector2d::Zero());
  std::vector<int> seen(soundings_.size(), -1);
  std::vector<int> ring;
  std::vector<Neighbour> neighbours;
  for (int i = 0; i < static_cast<int>(soundings_.size()); ++i) {
    const auto first = triangulation_.around(i);
    if (first.empty()) continue;
    ring.assign(first.begin(), first.end());
    seen[static_cast<std::size_t>(i)] = i;
    for (const int n : first) seen[static_cast<std::size_t>(n)] = i;
    for (const int n : first) {
      for (const int m : triangulation_.around(n)) {
        if (std::exchange(seen[static_cast<std::size_t>(m)], i) != i) ring.push_back(m);
      }
    }
    const SurveyPoint& here = soundings_[static_cast<std::size_t>(i)];
    neighbours.clear();
    double farthest2 = 0;
    for (const int n : ring) {
      const SurveyPoint& other = soundings_[static_cast<std::size_t>(n)];
      neighbours.push_back({other.north_east - here.north_east, other.depth_m - here.depth_m});
      farthest2 = std::max(farthest2, neighbours.back().at.squaredNorm());
    }
    const double length = std::sqrt(farthest2);
    for (Neighbour& n : neighbours) n.at /= length;
    gradients_[static_cast<std::size_t>(i)] = slope_of_quadratic(neighbours) / length;
  }
}

std::optional<SmoothSurface::Sample> SmoothSurface::at(const Vector2d& p) const {
  const int id = triangulation_.triangle_at(p);
  if (id == Triangulation::kNone) return {};
  const auto& corner = triangulation_.triangles()[static_cast<std::size_t>(id)].corner;
  Macro macro;
  Vector2d centroid = Vector2d::Zero();
  Sample sample;
  for (int k = 0; k < 3; ++k) {
    const SurveyPoint& s = soundings_[static_cast<std::size_t>(corner[k])];
    macro.v[k] = s.north_east;
    macro.f[k] = s.depth_m;
    macro.g[k] = gradients_[static_cast<std::size_t>(corner[k])];
    centroid += s.north_east / 3;
  }
  for (Vector2d& v : macro.v) v -= centroid;
  const Vector3d w = triangulation_.barycentric(id, p);
  sample.flat_m = w.dot(Vector3d(macro.f[0], macro.f[1], macro.f[2]));
  int k = 0;
  w.minCoeff(&k);
  const int a = (k + 1) % 3, b = (k + 2) % 3;
  Vector3d slope;
  macro.third(k).evaluate({w[a] - w[k], w[b] - w[k], 3 * w[k]}, sample.depth_m, slope);
  // derivatives of the weights of a, b and the centroid in the third by p
  const double twice = cross(macro.v[a], macro.v[b]);
  const Vector2d da(macro.v[b].y() / twice, -macro.v[b].x() / twice);
  const Vector2d db(-macro.v[a].y() / twice, macro.v[a].x() / twice);
  sample.gradient = slope[0] * da + slope[1] * db - slope[2] * (da + db);
  sample.nearest = triangulation_.nearest_point(p);
  sample.distance_m = (soundings_[static_cast<std::size_t>(sample.nearest)].north_east - p).norm();
  return sample;
}

}  // namespace isobath
