#include <algorithm>
#include <cmath>
#include <isobath/perception/scan_control.hpp>
#include <utility>

namespace isobath {

double binary_entropy(double probability) {
  if (!(probability > 0 && probability < 1)) return 0;
  return -probability * std::log(probability) - (1 - probability) * std::log1p(-probability);
}

std::vector<double> entropy_by_azimuth(const SphericalGrid& grid, Angle height) {
  std::vector<double> sums(static_cast<std::size_t>(grid.buckets().azimuths()), 0);
  grid.cells().each_beam([&](const SphericalDirection& d, std::span<const SphericalCell> beam) {
    const Angle low = grid.buckets().elevation_edge(d.elevation), high = grid.buckets().elevation_edge(d.elevation + 1);
    if (high <= -height / 2 || low >= height / 2) return;
    for (const SphericalCell& cell : beam) {
      if (!cell.locked) sums[static_cast<std::size_t>(d.azimuth)] += binary_entropy(SphericalGrid::probability(cell));
    }
  });
  return sums;
}

ScanChoice ScanControl::next(const SphericalGrid& grid, Angle looking, const ScanReach& reach) {
  std::vector<double> worths = entropy_by_azimuth(grid, limits_.height);
  const auto n = static_cast<int>(worths.size());
  looks_.resize(worths.size(), 0);
  const auto index = [n](int i) { return static_cast<std::size_t>((i % n + n) % n); };
  const int turned = grid.cells().directions().turned();
  for (int i = 0; i < n; ++i) worths[index(i)] /= 1 + looks_[index(i - turned)];
  const Angle step = grid.buckets().step(), edge = grid.buckets().azimuth_edge(0) + grid.remainder();
  const int wide = std::clamp(static_cast<int>(std::lround(limits_.sector / step)), 1, n);
  const int now = static_cast<int>(std::floor((looking - edge) / step));
  double inside = 0;
  for (int i = 0; i < wide; ++i) inside += worths[index(now - i)];
  const Angle room = (reach.width - step * wide) / 2;
  const bool anywhere = reach.width >= Angle::degrees(360);
  ScanChoice best{reach.middle.wrapped(), 0};
  int best_last = static_cast<int>(std::floor((reach.middle - edge) / step)) + wide / 2;
  bool any = false;
  for (int k = 0; k < n; ++k) {  // sectors of the buckets last - wide + 1 ... last; clockwise, so azimuths decrease
    const int last = now - k;
    if (k > 0) inside += worths[index(last - wide + 1)] - worths[index(last + 1)];
    const Angle middle = (edge + step * (last + 1 - 0.5 * wide)).wrapped();
    if (!anywhere && abs((middle - reach.middle).wrapped()) > room + step / 2) continue;
    const double worth = inside - limits_.turn_cost * abs((middle - looking).wrapped()).radians();
    if (std::exchange(any, true) && worth <= best.worth + 1e-12) continue;
    best = {middle, worth};
    best_last = last;
  }
  for (int i = 0; i < wide; ++i) looks_[index(best_last - i - turned)] += 1;
  return best;
}

}  // namespace isobath
