// DepthOutcome: the figures of a run's depth map, for reports.
#pragma once

#include <array>
#include <cstdint>
#include <isobath/world/depth_model.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

struct DepthOutcome {
  DepthCounts counts;
  std::map<std::string, std::uint64_t> refused;  ///< readings and soundings, by reason
  std::uint64_t generation = 0;                  ///< of the stored map; 0: not stored
  std::uint64_t known_pixels = 0, sensed_pixels = 0;
  std::uint64_t confirmed_pixels = 0;                   ///< charted, and confirmed by a depth sonar
  std::array<std::uint64_t, 5> sensed_by_confidence{};  ///< pixels of 0-4, 5-9, 10-14, 15-19, 20
  double pixel_m = 0;
  std::string datum;                            ///< depths are below it
  std::optional<double> shoalest_m, deepest_m;  ///< of the measured pixels
  std::uint64_t pixels_lost = 0;                ///< outside the operational area
  std::uint64_t leaves = 0, bytes = 0;          ///< of all three trees
  bool continued = false;
  std::vector<std::string> priors;
  std::map<std::string, std::uint64_t> prior_read, prior_left_out;
  MapChanges changes;               ///< of the whole map against its charts
  std::optional<GeoOrigin> origin;  ///< of the map
  FoundObjects found;               ///< obstacles as objects of the stored map
  std::vector<SensorLearning::Sensor> sensors;
  std::vector<std::string> damages;  ///< of the map that was continued, one line each
};

/// Over all known pixels. `model.snapshot()` must not be null.
DepthOutcome outcome_of(const DepthModel& model);

}  // namespace isobath
