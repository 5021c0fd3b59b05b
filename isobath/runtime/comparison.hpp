// Two recordings of imaging sonars side by side, as statistics of their samples (sample_statistics.hpp): is this
// simulation like that sea, is this device like that one?
#pragma once

#include <filesystem>
#include <functional>
#include <isobath/io/event.hpp>
#include <isobath/runtime/compare_outcome.hpp>
#include <isobath/runtime/configuration.hpp>
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

/// Throws Error: an input that cannot be opened or has no image of a sonar, a folder that cannot be written.
CompareOutcome compare(const CompareRequest& request);
std::string to_json(const CompareOutcome& outcome);

/// A line of the table: what, in words with its unit; and the value on either side, as text.
struct ComparedValue {
  std::string what, a, b;
};
std::vector<ComparedValue> compared_values(const CompareOutcome& outcome);

}  // namespace isobath
