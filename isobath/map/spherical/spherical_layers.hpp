// SphericalLayers: the range cells of a spherical grid (Auran, Silven 1995, 4.2; ledger S4-04, S4-E07).
//
// Near the vehicle the layers are as thick as the sensor's resolution D0. From r_t = D0 / d_ang on (in whole layers)
// they grow by g = 1 + d_ang, so that a cell stays as deep as it is wide:
//   r_i = r_0 + D0 (g^i - 1) / (g - 1),  r_0 = D0 ceil(r_t / D0).
// D0 = 0.15 m and 2.5 degrees: 23 layers to 3.45 m and 63 more to 50 m, 79 to 100 m, 96 to 200 m.
//
// Layer i covers [inner(i), outer(i)), m; the last one may extend beyond the range. `layer_at` needs no logarithm: no
// layer is thinner than D0, so a table in steps of D0 is at most one layer off. Immutable: any number of threads.
#pragma once

#include <cstdint>
#include <isobath/base/angle.hpp>
#include <vector>

namespace isobath {

class SphericalLayers {
 public:
  /// All arguments are positive; throws Error if they give more than 4096 layers.
  SphericalLayers(double min_layer_m, Angle bucket, double range_m);

  [[nodiscard]] int count() const { return static_cast<int>(edges_.size()) - 1; }
  /// Number of layers of the finest thickness, before the growing ones.
  [[nodiscard]] int uniform() const { return uniform_; }
  [[nodiscard]] double range_m() const { return range_m_; }
  [[nodiscard]] double inner(int layer) const { return edges_[static_cast<std::size_t>(layer)]; }
  [[nodiscard]] double outer(int layer) const { return edges_[static_cast<std::size_t>(layer) + 1]; }
  [[nodiscard]] double middle(int layer) const { return 0.5 * (inner(layer) + outer(layer)); }
  [[nodiscard]] double thickness(int layer) const { return outer(layer) - inner(layer); }

  /// The layer of a range from 0 to range_m.
  [[nodiscard]] int layer_at(double range_m) const {
    const auto k = static_cast<std::size_t>(range_m * inverse_finest_);
    std::size_t i = first_[k < first_.size() ? k : first_.size() - 1];
    i += range_m >= upper_[i] ? 1 : 0;  // branch-free, because the branches would be unpredictable
    i += range_m >= upper_[i] ? 1 : 0;
    return static_cast<int>(i);
  }

 private:
  double range_m_, inverse_finest_;
  int uniform_;
  std::vector<double> edges_;
  std::vector<double> upper_;         ///< outer edge of each layer; infinite for the last
  std::vector<std::uint16_t> first_;  ///< layer at k D0, or the one before if an edge is that near
};

}  // namespace isobath
