// result_text: results as text. This file alone defines the names and units of obstacles.json, scans.json,
// obstacles.geojson and the parts of manifest.json. The same results give the same text.
#pragma once

#include <isobath/geometry/geodesy.hpp>
#include <isobath/map/depth/revisit_record.hpp>
#include <isobath/map/occupancy/obstacle.hpp>
#include <isobath/map/occupancy/whole_obstacle.hpp>
#include <isobath/report/run_outcome.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace isobath {

/// The results at the end of one sweep.
struct ScanRecord {
  int number = 0;  ///< from 1
  Time time;
  Pose X_WB;
  bool posed = false;  ///< whether X_WB comes from navigation
  std::vector<Obstacle> obstacles;
};

/// When data were taken: "2025-01-17 to 2025-01-30, UTC", "2016-07-19, 22:13 UTC"; empty for a log without a date.
std::string date_text(Time first, Time last);

/// Obstacles in L, as in obstacles.json.
nlohmann::ordered_json obstacle_list(const std::vector<Obstacle>& obstacles);
/// `frame`, the time and pose of the scan, and its `obstacles`; an empty list if there was no scan.
std::string obstacles_json(const ScanRecord& scan);
std::string scans_json(std::span<const ScanRecord> scans);
/// RFC 7946: one polygon per obstacle, in longitude and latitude.
/// "behind a nearer obstacle; bottom": what a table of obstacles says beside the numbers.
std::string notes_on(const WholeObstacle& obstacle);
/// "moves at 1.50 m/s towards 090 deg"; empty where it is not known to move.
std::string motion_text(const Obstacle& obstacle);
std::string obstacles_geojson(const ScanRecord& scan, const GeoOrigin& origin);
/// Counts of a run by kind; rejected data by reason; alarms.
nlohmann::ordered_json counts_json(const RunOutcome& outcome);
nlohmann::ordered_json rejected_json(const RunOutcome& outcome);
nlohmann::ordered_json alarms_json(const RunOutcome& outcome);
/// The changed regions; and the track as row segments: north and east of the west end, and length, m.
nlohmann::ordered_json changes_json(const MapChanges& changes, const std::optional<GeoOrigin>& origin);
nlohmann::ordered_json track_json(const MapChanges& changes, const PixelGrid& grid);
nlohmann::ordered_json depth_json(const DepthOutcome& depth);
/// The uncertainty that a map states for its depths; null if it states none.
nlohmann::ordered_json uncertainty_json(const std::optional<RevisitRecord::Uncertainty>& uncertainty);
nlohmann::ordered_json voxels_json(const VoxelOutcome& voxels);
nlohmann::ordered_json sphere_json(const SphericalOutcome& sphere);
/// "spherical grid: 812 cells to 100 m, 96 occupied; ahead clear for 34 m, then unknown".
std::string sphere_text(const SphericalOutcome& sphere);
/// Found, missed and false obstacles of a simulated run; and the same as the text of a file.
nlohmann::ordered_json truth_json(const TruthScore& score);
std::string truth_text(const TruthScore& score);
/// What a live run dropped because its threads could not keep up, as one line.
std::string live_text(const LiveOutcome& live);
/// "14.9 s", "2.5 h", "12.9 days".
std::string span_text(double seconds);

}  // namespace isobath
