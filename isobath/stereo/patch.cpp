#include <algorithm>
#include <cmath>
#include <isobath/stereo/patch.hpp>

namespace isobath {

void Patch::settle() {
  double mean = 0;
  for (const double v : values) mean += v;
  mean /= kPixels;
  norm = 0;
  for (double& v : values) {
    v -= mean;
    norm += v * v;
  }
  norm = std::sqrt(norm);
}

bool patch_at(const CameraImage& grey, const Eigen::Vector2d& at, Patch& patch) {
  constexpr int kHalf = Patch::kHalf;
  const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
  if (x < kHalf || y < kHalf || x + kHalf + 1 >= grey.width || y + kHalf + 1 >= grey.height) return false;
  const double u = at.x() - x, v = at.y() - y;
  double* to = patch.values;
  for (int j = -kHalf; j <= kHalf; ++j) {
    const std::uint8_t* const upper = grey.samples.data() + grey.index(x - kHalf, y + j);
    const std::uint8_t* const lower = upper + grey.width;
    for (int i = 0; i <= 2 * kHalf; ++i) {
      *to++ = (1 - v) * ((1 - u) * upper[i] + u * upper[i + 1]) + v * ((1 - u) * lower[i] + u * lower[i + 1]);
    }
  }
  patch.settle();
  return true;
}

double correlation(const Patch& a, const Patch& b) {
  double sum = 0;
  for (int i = 0; i < Patch::kPixels; ++i) sum += a.values[i] * b.values[i];
  return sum / std::max(1e-9, a.norm * b.norm);
}

}  // namespace isobath
