#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/perception/sensor_reliability.hpp>

namespace isobath {

Agreement agreement(std::optional<double> range_m, std::optional<double> predicted_m, double sigma_m, double gate) {
  if (!range_m && !predicted_m) return Agreement::kConfirming;
  if (!range_m || !predicted_m) return Agreement::kConflicting;
  return std::abs(*range_m - *predicted_m) <= gate * sigma_m ? Agreement::kConfirming : Agreement::kConflicting;
}

double ReliabilityCounts::sigma() const {
  const double n = static_cast<double>(confirming + conflicting);
  const double mean = reliability();
  return std::sqrt(mean * (1 - mean) / (n + 3));
}

void SensorReliability::count(std::size_t sensor, Agreement agreement) {
  ISOBATH_ASSERT(sensor < counts_.size());
  ReliabilityCounts& c = counts_[sensor];
  switch (agreement) {
    case Agreement::kConfirming: ++c.confirming; break;
    case Agreement::kConflicting: ++c.conflicting; break;
    case Agreement::kIrrelevant: ++c.irrelevant; break;
  }
}

std::vector<double> SensorReliability::suggested_weights(std::span<const double> in_force) const {
  ISOBATH_ASSERT(in_force.size() == counts_.size());
  double best = 0;
  for (const ReliabilityCounts& c : counts_) best = std::max(best, c.reliability());
  std::vector<double> weights(in_force.begin(), in_force.end());
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] *= counts_[i].reliability() / best;
  return weights;
}

}  // namespace isobath
