// CompareOutcome: the sample statistics of two recordings, and how far apart they are (comparison.hpp).
#pragma once

#include <filesystem>
#include <isobath/studies/sample_statistics.hpp>
#include <vector>

namespace isobath {

struct CompareOutcome {
  SampleStatistics a, b;
  double background_distance = 0;            ///< largest difference of the cumulative shares (Kolmogorov-Smirnov)
  std::vector<std::filesystem::path> files;  ///< written, relative to the folder
};

}  // namespace isobath
