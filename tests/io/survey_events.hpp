// What the tests of survey logs look at: where a reading met the bottom.
#pragma once

#include <isobath/event/event.hpp>
#include <vector>

namespace isobath::test {

struct Sounding {
  Navigation fix;  ///< the last one before the reading
  RangeReading reading;
  Eigen::Vector3d bottom;  ///< end of the range in W
};

inline std::vector<Sounding> soundings(const std::vector<Event>& events) {
  std::vector<Sounding> found;
  Navigation fix;
  for (const Event& event : events) {
    if (const auto* n = std::get_if<Navigation>(&event)) fix = *n;
    if (const auto* r = std::get_if<RangeReading>(&event)) {
      found.push_back({fix, *r, fix.X_WB * (r->X_BS * Eigen::Vector3d(*r->range_m, 0, 0))});
    }
  }
  return found;
}

template <class T>
std::vector<T> only(const std::vector<Event>& events) {
  std::vector<T> found;
  for (const Event& event : events) {
    if (const auto* e = std::get_if<T>(&event)) found.push_back(*e);
  }
  return found;
}

}  // namespace isobath::test
