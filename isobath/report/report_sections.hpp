// report_sections: the order of a run's report. A report opens with what its kind of run is about: that of a mission
// with track, points reached and decisions; that of a survey with the depth map; that of an imaging sonar's log with
// the plan view of the obstacles. The replay of the run follows, then what else there is.
#pragma once

#include <cstdint>
#include <isobath/report/run_outcome.hpp>
#include <vector>

namespace isobath {

enum class ReportSection : std::uint8_t { kMission, kScan, kFan, kVoxels, kSphere, kDepth, kReplay };

/// The sections that the run has results for, in order; kReplay is always among them.
inline std::vector<ReportSection> report_sections(const RunOutcome& outcome) {
  using enum ReportSection;
  std::vector<ReportSection> order = {kScan, kFan, kReplay, kVoxels, kSphere, kDepth};
  if (outcome.mission) {
    order = {kMission, kReplay, kScan, kFan, kVoxels, kSphere, kDepth};
  } else if (outcome.counts.pings == 0 && outcome.depth) {
    order = {kDepth, kReplay, kVoxels, kSphere};
  } else if (outcome.counts.pings == 0 && outcome.voxels) {
    order = {kVoxels, kReplay, kScan, kFan, kSphere};
  }
  std::erase_if(order, [&](ReportSection s) {
    return (s == kFan && !outcome.sharpness) || (s == kVoxels && !outcome.voxels) ||
           (s == kSphere && !outcome.sphere) || (s == kDepth && !outcome.depth);
  });
  return order;
}

}  // namespace isobath
