#include <cmath>
#include <Eigen/Dense>
#include <fmt/format.h>
#include <isobath/studies/difference_statistics.hpp>
#include <isobath/studies/position_offset.hpp>
#include <vector>

namespace isobath {
namespace {

constexpr std::size_t kFewest = 100;
constexpr int kRounds = 8;
constexpr double kMinSlope = 0.02;  // minimum root mean square of the slope along either axis

double robust_sd(std::vector<double> values) { return difference_statistics(std::move(values)).robust_sd_m; }

}  // namespace

std::optional<PositionOffset> position_offset(std::span<const SlopeSample> samples) {
  if (samples.size() < kFewest) return std::nullopt;
  Eigen::Vector2d square = Eigen::Vector2d::Zero();
  std::vector<double> before;
  for (const SlopeSample& s : samples) {
    square += s.gradient.cwiseAbs2();
    before.push_back(s.difference_m);
  }
  if ((square / static_cast<double>(samples.size())).cwiseSqrt().minCoeff() < kMinSlope) return std::nullopt;
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  double scale = robust_sd(before);
  std::vector<double> left(samples.size());
  Eigen::Matrix3d normal = Eigen::Matrix3d::Identity();
  for (int round = 0; round < kRounds; ++round) {
    normal.setZero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const SlopeSample& s : samples) {
      const Eigen::Vector3d a{1, s.gradient.x(), s.gradient.y()};
      const double residual = s.difference_m - a.dot(x);
      const double share = residual / (2 * std::max(scale, 1e-3));
      const double weight = 1 / (1 + share * share);
      normal += weight * a * a.transpose();
      right += weight * s.difference_m * a;
    }
    x = normal.ldlt().solve(right);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      left[i] = samples[i].difference_m - x[0] - samples[i].gradient.dot(x.tail<2>());
    }
    scale = robust_sd(left);
  }
  PositionOffset found;
  found.n = samples.size();
  found.bias_m = x[0];
  found.offset_m = x.tail<2>();
  const Eigen::Matrix3d covariance = normal.inverse() * (scale * scale);
  found.sigma_m = {std::sqrt(covariance(1, 1)), std::sqrt(covariance(2, 2))};
  found.robust_sd_m = robust_sd(before);
  found.robust_sd_left_m = scale;
  return found;
}

std::string to_text(const PositionOffset& o) {
  return fmt::format(
      "the log is offset from the map: moving it by {:+.1f} m north, {:+.1f} m east and {:+.2f} m in depth would align "
      "it; the robust spread would fall from {:.2f} to {:.2f} m ({} soundings over slopes known to the map)",
      o.offset_m.x(), o.offset_m.y(), -o.bias_m, o.robust_sd_m, o.robust_sd_left_m, o.n);
}

}  // namespace isobath
