#include <algorithm>
#include <cmath>
#include <isobath/stereo/vertical_residual.hpp>

namespace isobath {
namespace {

constexpr int kPatch = 4;      // half the side
constexpr int kEvery = 5;      // pixels
constexpr int kMinDetail = 5;  // mean change of brightness from row to row, grey levels

double detail_of(const CameraImage& grey, int x, int y) {
  int sum = 0;
  for (int j = -kPatch; j < kPatch; ++j) {
    for (int i = -kPatch; i <= kPatch; ++i) sum += std::abs(grey(x + i, y + j + 1) - grey(x + i, y + j));
  }
  return sum / double((2 * kPatch) * (2 * kPatch + 1));
}

/// Sum of squared differences with the right picture moved by `down` rows.
double difference(const CameraImage& left, const CameraImage& right, int x, int y, double disparity, int down) {
  const double from = x - disparity;
  const int whole = static_cast<int>(std::floor(from));
  const double part = from - whole;
  double sum = 0;
  for (int j = -kPatch; j <= kPatch; ++j) {
    for (int i = -kPatch; i <= kPatch; ++i) {
      const double there = (1 - part) * right(whole + i, y + j + down) + part * right(whole + i + 1, y + j + down);
      sum += (left(x + i, y + j) - there) * (left(x + i, y + j) - there);
    }
  }
  return sum;
}

std::optional<double> offset_at(const CameraImage& left, const CameraImage& right, int x, int y, double disparity) {
  constexpr int kReach = VerticalResidual::kReach;
  double costs[2 * kReach + 1];
  for (int k = -kReach; k <= kReach; ++k) costs[k + kReach] = difference(left, right, x, y, disparity, k);
  const auto best = static_cast<int>(std::min_element(costs, costs + 2 * kReach + 1) - costs);
  if (best == 0 || best == 2 * kReach) return {};
  double mean = 0;
  for (const double cost : costs) mean += cost / (2 * kReach + 1);
  if (costs[best] > 0.3 * mean) return {};  // none fits
  const double bend = costs[best - 1] - 2 * costs[best] + costs[best + 1];
  return best - kReach + (bend > 0 ? 0.5 * (costs[best - 1] - costs[best + 1]) / bend : 0);
}

double middle_offset(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::optional<VerticalResidual> vertical_residual(const CameraImage& left_picture, const CameraImage& right_picture,
                                                  const DisparityMap& map) {
  const CameraImage left = grey_of(left_picture), right = grey_of(right_picture);
  constexpr int kEdge = kPatch + VerticalResidual::kReach + 1;
  std::vector<double> offsets;
  for (int y = kEdge; y < map.height - kEdge; y += kEvery) {
    for (int x = kEdge; x < map.width - kEdge; x += kEvery) {
      const double d = map(x, y);
      if (!std::isfinite(d) || x - d < kEdge || x - d >= map.width - kEdge || detail_of(left, x, y) < kMinDetail)
        continue;
      if (const auto offset = offset_at(left, right, x, y, d)) offsets.push_back(*offset);
    }
  }
  if (offsets.size() < 50) return {};
  VerticalResidual residual;
  residual.patches = offsets.size();
  residual.median_px = middle_offset(offsets);
  for (double& offset : offsets) offset = std::abs(offset);
  residual.median_absolute_px = middle_offset(offsets);
  return residual;
}

}  // namespace isobath
