// SensorTable: identifies the sensor of a range reading. Readings carry no name, so their mounting identifies the
// sensor.
#pragma once

#include <algorithm>
#include <cstddef>
#include <isobath/geometry/pose.hpp>
#include <optional>
#include <vector>

namespace isobath {

class SensorTable {
 public:
  static constexpr std::size_t kMax = 64;

  SensorTable() { mountings_.reserve(kMax); }

  /// Index of the sensor in the order of first readings; empty beyond the 64th. Allocates nothing.
  std::optional<std::size_t> index_of(const Pose& X_BS) {
    const auto same = [&](const Pose& known) {
      return known.translation == X_BS.translation &&
             known.rotation.quaternion().coeffs() == X_BS.rotation.quaternion().coeffs();
    };
    const auto known = std::find_if(mountings_.begin(), mountings_.end(), same);
    if (known != mountings_.end()) return static_cast<std::size_t>(known - mountings_.begin());
    if (mountings_.size() == kMax) return std::nullopt;
    mountings_.push_back(X_BS);
    return mountings_.size() - 1;
  }
  [[nodiscard]] const std::vector<Pose>& mountings() const { return mountings_; }

 private:
  std::vector<Pose> mountings_;
};

}  // namespace isobath
