// compare: computes the sample statistics (sample_statistics.hpp) of two recordings of imaging sonars, side by side.
// They show how well a simulation matches the sea, or how well one device matches another.
#pragma once

#include <filesystem>
#include <functional>
#include <isobath/configuration/configuration.hpp>
#include <isobath/event/event.hpp>
#include <isobath/studies/compare_outcome.hpp>
#include <string>
#include <vector>

namespace isobath {

struct CompareRequest {
  std::filesystem::path a, b;  ///< log, folder of frames, or scene (.toml)
  std::filesystem::path out;   ///< made if absent
  Configuration configuration;
  int threads = 2;
  std::function<void(const SourceReport&, std::uint64_t pings)> progress;
};

/// Throws Error if an input cannot be opened or has no sonar image, or if the folder cannot be written.
CompareOutcome compare(const CompareRequest& request);
std::string to_json(const CompareOutcome& outcome);

/// A row of the table: the quantity with its unit, and its value in both recordings as text.
struct ComparedValue {
  std::string what, a, b;
};
std::vector<ComparedValue> compared_values(const CompareOutcome& outcome);

}  // namespace isobath
