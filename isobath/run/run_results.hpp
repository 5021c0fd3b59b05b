// The results of a finished run, as its outcome states them: counts, rejections, alarms, and what was wrong with the
// input.
#pragma once

#include <isobath/onboard/pipeline.hpp>
#include <isobath/report/run_outcome.hpp>
#include <isobath/world/depth_model.hpp>

namespace isobath {

/// Adds the results of the pipeline and the depth map (`mapped`: there are voxels), and any problem of the input.
/// `outcome.source` must be complete.
void add_results(RunOutcome& outcome, const Pipeline& pipeline, const DepthModel& depths, bool mapped);

}  // namespace isobath
