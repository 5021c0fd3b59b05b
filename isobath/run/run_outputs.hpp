// The files that a run writes, and the check that none of them is one of its inputs.
#pragma once

#include <array>
#include <isobath/run/run_request.hpp>
#include <string>
#include <vector>

namespace isobath {

/// The files that a run may write into its folder; no run writes all of them. The manifest comes first here and is
/// written last: a folder with a manifest holds one complete run.
inline constexpr std::array kRunFiles{
    "manifest.json",    "report.html",       "configuration.toml", "obstacles.json",
    "scans.json",       "obstacles.geojson", "contacts.geojson",   "occupancy.tif",
    "occupancy.png",    "sonar.png",         "detections.png",     "truth.json",
    "depth.tif",        "chart.png",         "confidence.png",     "contours.geojson",
    "decisions.json",   "mission.json",      "mission.png",        "clearance.png",
    "voxels.bt",        "voxels.ply",        "voxels.sqlite",      "voxels.sqlite-journal",
    "voxels.vdb",       "voxels.png",        "voxels-south.png",   "voxels-east.png",
    "voxels-depth.png", "sphere-above.png",  "sphere-solid.png",   "placed.png",
    "sharpness.png"};

/// Throws Error if the recording or a file of the folder would overwrite an input of the run. `priors`: files that the
/// depth map starts from.
void check_run_outputs(const RunRequest& request, const std::vector<std::string>& priors);

}  // namespace isobath
