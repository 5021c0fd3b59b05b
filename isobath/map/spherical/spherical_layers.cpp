#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/map/spherical/spherical_layers.hpp>
#include <limits>

namespace isobath {

SphericalLayers::SphericalLayers(double min_layer_m, Angle bucket, double range_m)
    : range_m_(range_m), inverse_finest_(1 / min_layer_m) {
  constexpr std::size_t kMaxLayers = 4096;
  ISOBATH_ASSERT(min_layer_m > 0 && range_m > 0 && bucket.radians() > 0);
  const double d = bucket.radians();
  uniform_ = static_cast<int>(std::ceil(1 / d - 1e-9));
  const double enough = range_m * (1 - 1e-12);
  for (int i = 0; i <= uniform_; ++i) {
    edges_.push_back(i * min_layer_m);
    if (edges_.back() >= enough) break;
  }
  uniform_ = static_cast<int>(edges_.size()) - 1;
  const double r_0 = edges_.back();
  double power = 1;
  while (edges_.back() < enough && edges_.size() <= kMaxLayers) {
    power *= 1 + d;
    edges_.push_back(r_0 + min_layer_m * (power - 1) / d);
  }
  if (edges_.back() < enough) {
    throw Error("too many layers for this range", {{}, {}, {}, {}, "min_layer_m"}, "at most 4096 layers",
                "make cells coarser or the range shorter");
  }
  upper_.assign(edges_.begin() + 1, edges_.end());
  upper_.back() = std::numeric_limits<double>::infinity();
  std::uint16_t layer = 0;
  for (std::size_t k = 0; static_cast<double>(k) * min_layer_m < edges_.back(); ++k) {
    while (layer + 2u < edges_.size() && static_cast<double>(k) * min_layer_m >= edges_[layer + 1u]) ++layer;
    const bool near = static_cast<double>(k) * min_layer_m <= edges_[layer] * (1 + 1e-12);
    first_.push_back(near && layer > 0 ? static_cast<std::uint16_t>(layer - 1) : layer);
  }
}

}  // namespace isobath
