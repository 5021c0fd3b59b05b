// Truth marks: the pings of a simulated log as marked frames, by the ground truth that the log carries (EchoTruth).
// Calibration then needs no marks by hand (ledger S6-D01 to S6-D03, S5-D02, S5-D03).
//
// A cell is marked if the direct echo of a body stands above the background there. A ping without any echo of a body is
// background; bottom, surface, spurious echoes and disturbances are part of it, as in a recording at sea. A ping with
// echoes of bodies but no direct one is left out. Errors: throws Error if the log has no ground truth, or none of the
// sonar.
#pragma once

#include <filesystem>
#include <functional>
#include <isobath/io/frames/marked_frames.hpp>
#include <isobath/io/open_source.hpp>
#include <string>
#include <vector>

namespace isobath {

struct TruthMarks {
  std::vector<MarkedFrame> frames;
  int left_out = 0;  ///< pings with indirect echoes of bodies only
};

/// `sonar`: name of the sonar in the scene; empty: that of the first ping.
TruthMarks read_truth_marks(const std::filesystem::path& log, const InputConfig& config, const std::string& sonar);

}  // namespace isobath
