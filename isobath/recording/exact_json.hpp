// exact_json: numbers and vectors as JSON in the channels of a recording. Six decimals: micrometres, microseconds,
// microradians. What is not finite, or absent, is null.
#pragma once

#include <cmath>
#include <Eigen/Core>
#include <isobath/base/angle.hpp>
#include <nlohmann/json.hpp>
#include <optional>

namespace isobath {

inline nlohmann::ordered_json exact_enough(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(value * 1e6) / 1e6;
}
inline nlohmann::ordered_json exact_enough(Angle angle) { return exact_enough(angle.radians()); }
template <class Value>
nlohmann::ordered_json exact_enough(const std::optional<Value>& value) {
  return value ? exact_enough(*value) : nlohmann::ordered_json();
}
template <int kSize>
nlohmann::ordered_json components_of(const Eigen::Matrix<double, kSize, 1>& v) {
  nlohmann::ordered_json row = nlohmann::ordered_json::array();
  for (int i = 0; i < kSize; ++i) row.push_back(exact_enough(v[i]));
  return row;
}

}  // namespace isobath
